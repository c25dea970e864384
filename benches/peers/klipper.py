"""Runs Klipper's own calibration of an input shaper on a file of raw data: klipper.py KLIPPY FILE.

KLIPPY is the folder `klippy` of a checkout of Klipper. Prints the impulses that it recommends, a line each: instant in s
and amplitude.
"""

import importlib
import sys

import numpy

sys.path.insert(0, sys.argv[1])
calibrate = importlib.import_module("extras.shaper_calibrate")
definitions = importlib.import_module("extras.shaper_defs")

data = numpy.loadtxt(sys.argv[2], comments="#", delimiter=",", dtype=numpy.float64)
helper = calibrate.ShaperCalibrate(printer=None)
processed = helper.process_accelerometer_data("printer", data)
processed.normalize_to_frequencies()
shaper, _ = helper.find_best_shaper(processed)
amplitudes, times = definitions.init_shaper(
    shaper.name, shaper.freq, definitions.DEFAULT_DAMPING_RATIO
)
for time, amplitude in zip(times, amplitudes):
    print(time, amplitude)
