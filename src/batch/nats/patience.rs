//! Waiting for a server that is restarted.

use std::fmt::Display;
use std::time::Duration;

use tokio::time::{Instant, sleep};

use crate::batch::error::BatchError;

/// How long a request is repeated: a server that is restarted is back within seconds, one that moves to
/// another machine within a minute.
const LONGEST: Duration = Duration::from_secs(60);
/// Pause between two tries.
const PAUSE: Duration = Duration::from_millis(250);

/// Repeats what fails, for a while. What is asked for must do no harm when it is done twice.
pub struct Patience {
    server: String,
}

impl Patience {
    /// For requests to a server of this name.
    pub fn new(server: String) -> Self {
        Self { server }
    }

    /// The server.
    pub fn server(&self) -> &str {
        &self.server
    }

    /// Tries until it is done.
    ///
    /// # Errors
    /// [`BatchError::Queue`] with what it said last, where it was tried for long.
    pub async fn of<T, E: Display, F: Future<Output = Result<T, E>>>(
        &self,
        what: &str,
        key: &str,
        attempt: impl Fn() -> F,
    ) -> Result<T, BatchError> {
        let since = Instant::now();
        loop {
            match attempt().await {
                Ok(done) => return Ok(done),
                Err(error) if since.elapsed() > LONGEST => {
                    return Err(self.failed(what, key, error.to_string()));
                }
                Err(error) => {
                    tracing::debug!(server = self.server, what, key, %error, "again");
                    sleep(PAUSE).await;
                }
            }
        }
    }

    /// The operation that failed.
    pub fn failed(&self, what: &str, key: &str, reason: String) -> BatchError {
        BatchError::Queue {
            server: self.server.clone(),
            what: format!("{what} {key}"),
            reason,
        }
    }
}
