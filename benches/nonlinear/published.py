"""Figures that others published on the nonlinear system identification benchmarks.

Source of every figure: tables 3 and 4 of M. D. Champneys, G. I. Beintema, R. Toth, M. Schoukens, T. J. Rogers, Baseline
Results for Selected Nonlinear System Identification Benchmarks, IFAC-PapersOnLine 58-15 (2024), arXiv 2405.10779 v2, as
a public transcription of these tables gives them: the tables themselves were not at hand. `by` is whom they cite for the
best figure that was known to them; their own ten baselines are told by the best one.
"""

SOURCE = "arXiv 2405.10779 v2, tables 3 and 4, by a public transcription"

# Root mean square error of a free run over the test part: the best known to the paper, and its best baseline.
PUBLISHED = {
    "silverbox multisine": [("DT-SUBNET", 0.36, "Beintema et al. 2021"), ("GP-NARX", 0.301, "baseline")],
    "silverbox arrow": [("DT-SUBNET", 1.4, "Beintema et al. 2021"), ("GP-NARX", 0.60, "baseline")],
    "silverbox arrow, no extrapolation": [("DT-SUBNET", 0.32, "Beintema et al. 2021"), ("GP-NARX", 0.259, "baseline")],
    "emps pulses": [("dynoNet", 0.452, "Forgione and Piga 2021"), ("pNARX", 5.17, "baseline")],
    "tanks": [("grey-box", 0.191, "Worden et al. 2018"), ("GRU", 0.396, "baseline")],
    "drives, low amplitude": [("CT-SUBNET", 0.115, "Beintema et al. 2023"), ("RNN", 0.096, "baseline")],
    "drives, high amplitude": [("CT-SUBNET", 0.074, "Beintema et al. 2023"), ("GP-NARX", 0.090, "baseline")],
}
