//! Small recordings: two seconds of a joint of one mode, told apart by their noise.

mod motion;

use motion::Joint;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

const JOINT: Joint = Joint {
    frequency: 4.0 * TAU,
    damping: 0.05,
    rate: 100.0,
    samples: 200,
    acceleration: 4.5,
};
const NOISE: f64 = 6e-6;

/// Of a motor position and a deformation in `data.csv`.
pub const MANIFEST: &str = r#"name = "joint"
[[channel]]
role = "motor_position"
file = "data.csv"
time = "time_s"
column = "motor_rad"
unit = "rad"
[[channel]]
role = "deformation"
file = "data.csv"
time = "time_s"
column = "deformation_rad"
unit = "rad"
"#;

/// The model of the joint, as it is believed.
pub const MODEL: &str =
    "kind = \"flexible_joint\"\nnatural_frequency_hz = 4.2\ndamping_ratio = 0.06\n";

/// Writes so many recordings below a folder, `r0000` and on, and returns their folders.
pub fn fleet(folder: &Path, count: u64) -> Vec<PathBuf> {
    let motion = JOINT.motion(&[(0.2, 0.35, 1.0), (1.0, 0.3, -1.0)], |_| 0.0);
    let one = |seed: u64| {
        let path = folder.join(format!("r{seed:04}"));
        fs::create_dir_all(&path).expect("a folder");
        fs::write(path.join("recording.toml"), MANIFEST).expect("a manifest");
        fs::write(path.join("data.csv"), cells(&motion, seed)).expect("a file");
        path
    };
    (0..count).map(one).collect()
}

fn cells(motion: &[[f64; 2]], seed: u64) -> String {
    let mut state = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut uniform = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut text = String::from("time_s,motor_rad,deformation_rad\n");
    for (sample, [motor, deformation]) in motion.iter().enumerate() {
        // The sum of twelve uniform numbers has the variance 1.
        let noise = NOISE * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0);
        let (time, deformation) = (sample as f64 / JOINT.rate, deformation + noise);
        writeln!(text, "{time},{motor:.9},{deformation:.9}").expect("text");
    }
    text
}

/// Writes a recording whose manifest names a file that is not there, at line 4.
pub fn poison(folder: &Path) -> PathBuf {
    let path = folder.join("poison");
    fs::create_dir_all(&path).expect("a folder");
    fs::write(path.join("recording.toml"), MANIFEST).expect("a manifest");
    path
}
