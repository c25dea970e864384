//! Time series on their own clocks: alignment, registration of frames, kinematics, spectra.
