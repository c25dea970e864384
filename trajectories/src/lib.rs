//! Jerk-limited joint moves, planned by Ruckig off the tick and sampled at the control period.
