//! A recording as one file: a tar archive of its folder, created while it is read.

use std::fs::{self, File, Metadata};
use std::io::{self, Read, Write};
use std::path::PathBuf;

use tar::{Builder, Header};

use super::{Shelf, ShelfError, disk};

/// A recording for download as a tar archive.
pub struct Archive {
    name: String,
    /// Its files, in the order of their names.
    files: Vec<(PathBuf, Metadata)>,
    length: u64,
}

impl Shelf {
    /// A recording as one file.
    ///
    /// # Errors
    /// As [`Shelf::path`], and where the folder cannot be read.
    pub fn archive(&self, name: &str) -> Result<Archive, ShelfError> {
        let folder = self.path(name)?;
        let files = (|| {
            let mut files = Vec::new();
            for entry in fs::read_dir(&folder)? {
                let entry = entry?;
                let data = entry.metadata()?;
                if data.is_file() {
                    files.push((entry.path(), data));
                }
            }
            files.sort_by(|a, b| a.0.cmp(&b.0));
            io::Result::Ok(files)
        })();
        let mut archive = Archive {
            name: name.into(),
            files: files.map_err(|source| disk(&folder, source))?,
            length: 0,
        };
        let mut count = Count(0);
        let counted = archive.write_from(&mut count, |_| Ok(io::repeat(0)));
        counted.map_err(|source| disk(&folder, source))?;
        archive.length = count.0;
        Ok(archive)
    }
}

impl Archive {
    /// Its length, bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Writes it.
    ///
    /// # Errors
    /// Where a file has disappeared or become shorter in the meantime, or `out` refuses.
    pub fn write(&self, out: impl Write) -> io::Result<()> {
        self.write_from(out, |path| File::open(path))
    }

    fn write_from<R: Read>(
        &self,
        out: impl Write,
        open: impl Fn(&PathBuf) -> io::Result<R>,
    ) -> io::Result<()> {
        let mut archive = Builder::new(out);
        for (path, data) in &self.files {
            let mut header = Header::new_gnu();
            header.set_metadata(data);
            let file = path.file_name().unwrap_or_default();
            let name = PathBuf::from(&self.name).join(file);
            let mut bytes = open(path)?.take(data.len());
            archive.append_data(&mut header, name, &mut bytes)?;
            if bytes.limit() > 0 {
                let words = format!("{} has become shorter", path.display());
                return Err(io::Error::new(io::ErrorKind::UnexpectedEof, words));
            }
        }
        archive.finish()
    }
}

/// Counts written bytes.
struct Count(u64);

impl Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
