"""Files of a case: manifests, gzipped columns, the nominal model; written and read back."""

import gzip
import io
from pathlib import Path

import numpy as np

# One line a channel that a case can have besides the encoder: role, file, columns, unit, digits after the point.
OUTPUTS = {
    "tip_position": ("tracker.csv.gz", ["x_m", "y_m", "z_m"], "m", 7),
    "deformation": ("deformation.csv.gz", ["deformation_rad"], "rad", 9),
    "tip_acceleration": ("accelerometer.csv.gz", ["tip_m_s2"], "m/s^2", 5),
}


def write_table(path, header, times, time_digits, values, digits):
    """Writes time and value columns as gzipped CSV, without a date in the archive so that runs repeat."""
    formats = [f"%.{time_digits}f"] + [f"%.{digits}f"] * values.shape[1]
    text = io.StringIO()
    np.savetxt(text, np.column_stack([times, values]), fmt=formats, delimiter=",", header=header, comments="")
    with open(path, "wb") as raw, gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0) as file:
        file.write(text.getvalue().encode())


def write_recording(folder, name, recording):
    """Writes `recording.toml` and its tables; `recording` is what `sensors.record` returns."""
    folder.mkdir(parents=True, exist_ok=True)
    write_table(folder / "encoder.csv.gz", "time_s,joint_1_rad", recording["encoder_time"], 4,
                recording["encoder"][:, None], 9)
    file, columns, unit, digits = OUTPUTS[recording["role"]]
    write_table(folder / file, ",".join(["time_s", *columns]), recording["time"], recording["time_digits"],
                recording["values"], digits)
    names = f'column = "{columns[0]}"' if len(columns) == 1 else "columns = [" + ", ".join(f'"{c}"' for c in columns) + "]"
    (folder / "recording.toml").write_text(
        f'name = "{name}"\n\n'
        '[[channel]]\nrole = "motor_position"\nfile = "encoder.csv.gz"\ntime = "time_s"\ncolumn = "joint_1_rad"\nunit = "rad"\n\n'
        f'[[channel]]\nrole = "{recording["role"]}"\nfile = "{file}"\ntime = "time_s"\n{names}\nunit = "{unit}"\n')


def write_model(path, nominal):
    """Writes the model that the engineer believes."""
    path.write_text(
        "# the nominal model: a flexible joint driven by its motor side\n"
        'kind = "flexible_joint"\n'
        f'natural_frequency_hz = {nominal["natural_frequency_hz"]:.3f}\n'
        f'damping_ratio = {nominal["damping_ratio"]:.3f}\n'
        f'lever_arm_m = {nominal["lever_arm_m"]:g}\n'
        f'tip_height_m = {nominal["tip_height_m"]:g}\n')


def read_recording(folder):
    """Reads encoder and output of a recording folder back, in the form of `sensors.record`."""
    folder = Path(folder)
    encoder = np.loadtxt(folder / "encoder.csv.gz", delimiter=",", skiprows=1)
    for role, (file, *_) in OUTPUTS.items():
        if (folder / file).exists():
            table = np.loadtxt(folder / file, delimiter=",", skiprows=1)
            return {"role": role, "encoder_time": encoder[:, 0], "encoder": encoder[:, 1],
                    "time": table[:, 0], "values": table[:, 1:]}
    raise FileNotFoundError(f"{folder}: no output channel")
