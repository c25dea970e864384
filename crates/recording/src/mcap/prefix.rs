//! A file to which nothing more is written after a refused write.

use crate::Sink;
use std::io::{self, ErrorKind, Write};

/// Passes bytes on until the disk refuses some.
///
/// A writer that is dropped writes its end, and the disk may have room again by then. That end would follow a
/// gap, where no reader finds it, and the data before it would look damaged. So the file stays a prefix of the
/// intended data.
pub struct Prefix {
    file: Sink,
    refused: bool,
}

impl Prefix {
    /// Into a file that is open.
    pub fn of(file: Sink) -> Self {
        let refused = false;
        Self { file, refused }
    }
}

impl Write for Prefix {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.refused {
            let reason = "an earlier part of the file could not be written";
            return Err(io::Error::other(reason));
        }
        let written = self.file.write(bytes);
        // A signal is no refusal: the caller tries again.
        let refusal = |error: &io::Error| error.kind() != ErrorKind::Interrupted;
        self.refused = written.as_ref().is_err_and(refusal);
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    /// Takes four bytes, refuses once, and has room again.
    struct Full(Arc<Mutex<Vec<u8>>>, u32);

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.1 += 1;
            if self.1 == 2 {
                return Err(ErrorKind::StorageFull.into());
            }
            let taken = bytes.len().min(4);
            self.0.lock().unwrap().extend(&bytes[..taken]);
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn nothing_stands_behind_what_was_refused() {
        let bytes = Arc::default();
        let mut file = Prefix::of(Box::new(Full(Arc::clone(&bytes), 0)));
        let refused = file.write_all(b"chunk one").unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::StorageFull);
        assert!(file.write_all(b"footer").is_err());
        assert_eq!(*bytes.lock().unwrap(), b"chun");
    }
}
