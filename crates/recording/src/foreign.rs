//! Known formats that cannot be read, with a remedy for each.

use std::path::Path;

/// A format that cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foreign {
    /// Its name, with an article.
    pub name: &'static str,
    /// How to convert it into a readable format.
    pub remedy: &'static str,
    /// Endings of its files.
    endings: &'static [&'static str],
    /// Its first bytes.
    magic: &'static [&'static [u8]],
}

/// Parquet, which only a build with the feature `parquet` reads.
pub(super) const PARQUET: Foreign = Foreign {
    name: "a Parquet file",
    remedy: "build quell with --features parquet, or read it with quell in Python: Recording.load(\"run.parquet\")",
    endings: &["parquet", "pq"],
    magic: &[b"PAR1"],
};

/// Known formats that cannot be read.
pub const FOREIGN: &[Foreign] = &[
    Foreign {
        name: "a MATLAB file",
        remedy: "read it in Python: quell.Recording.load(\"run.mat\", {\"deformation\": \"y\"}, time=\"t\"), or write it as CSV in \
                 MATLAB: writetable(table(t, y), \"run.csv\")",
        endings: &["mat"],
        magic: &[
            b"MATLAB 5.0 MAT-file",
            b"MATLAB 7.3 MAT-file",
            b"\x89HDF\r\n\x1a\n",
        ],
    },
    Foreign {
        name: "a ROS 2 bag (SQLite)",
        remedy: "convert it to MCAP, which is read: ros2 bag convert -i BAG -o out.yaml, with storage_id: mcap",
        endings: &["db3"],
        magic: &[b"SQLite format 3\0"],
    },
    Foreign {
        name: "the text of `ros2 topic echo`",
        remedy: "write it as CSV: ros2 topic echo --csv TOPIC > run.csv; or record it as MCAP: ros2 bag record -s mcap TOPIC",
        endings: &[],
        magic: &[
            b"header:\n  stamp:",
            b"---\nheader:\n",
            b"header:\r\n  stamp:",
        ],
    },
    Foreign {
        name: "a ROS 1 bag",
        remedy: "convert it to MCAP, which is read: mcap convert run.bag run.mcap",
        endings: &["bag"],
        magic: &[b"#ROSBAG V"],
    },
    #[cfg(not(feature = "parquet"))]
    PARQUET,
    Foreign {
        name: "a spreadsheet",
        remedy: "save its sheet as CSV (UTF-8)",
        endings: &["xlsx", "xls", "ods"],
        magic: &[b"PK\x03\x04", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"],
    },
    Foreign {
        name: "an archive of NumPy arrays",
        remedy: "read it in Python: quell.Recording.load(\"run.npz\", {\"deformation\": \"y\"}, time=\"t\")",
        endings: &["npz"],
        // It begins as any archive.
        magic: &[],
    },
    Foreign {
        name: "a NumPy file",
        remedy: "write it as CSV with Python: numpy.savetxt(\"run.csv\", data, delimiter=\",\")",
        endings: &["npy"],
        magic: &[b"\x93NUMPY"],
    },
    Foreign {
        name: "a spectrum that Klipper computed, without the samples",
        remedy: "give the raw data instead, raw_data_x_*.csv, which TEST_RESONANCES AXIS=X OUTPUT=raw_data writes",
        endings: &[],
        magic: &[b"freq,psd_x,", b"#freq,psd_x,", b"freq, psd_x,"],
    },
];

impl Foreign {
    /// Whether the extension is one of the format.
    pub(super) fn is_called(&self, path: &Path) -> bool {
        let ending = path.extension().and_then(|ending| ending.to_str());
        ending.is_some_and(|ending| self.endings.contains(&ending.to_ascii_lowercase().as_str()))
    }

    /// Whether the bytes begin as the format does.
    pub(super) fn begins(&self, bytes: &[u8]) -> bool {
        self.magic.iter().any(|magic| bytes.starts_with(magic))
    }
}

/// The format of a file by its extension, else by its first bytes; `None` where it may be text.
pub(super) fn of(path: &Path, bytes: &[u8]) -> Option<Foreign> {
    let begins = |format: &&Foreign| format.begins(bytes);
    by_ending(path).or_else(|| FOREIGN.iter().find(begins).copied())
}

/// The format of a file by its extension.
pub(super) fn by_ending(path: &Path) -> Option<Foreign> {
    FOREIGN
        .iter()
        .find(|format| format.is_called(path))
        .copied()
}
