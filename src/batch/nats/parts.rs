//! Recordings in a stream, in parts.

use async_nats::jetstream::Context;
use async_nats::jetstream::message::PublishMessage;
use async_nats::jetstream::stream::Stream;

use crate::batch::pack::MOST_BYTES;

/// The prefix of key and number in a part's subject.
pub const PART: &str = "quell-queue.part";
/// Bytes of a part: half of what a server takes as one message by default.
const BYTES: usize = 512 << 10;
/// The header that says how many parts there are.
const COUNT: &str = "Quell-Parts";

/// The stream of recordings.
pub struct Parts {
    context: Context,
    stream: Stream,
}

impl Parts {
    /// The stream, which keeps the last message of each subject.
    pub fn new(context: Context, stream: Stream) -> Self {
        Self { context, stream }
    }

    /// Puts a job's recording in; again the same, where it is there.
    ///
    /// # Errors
    /// The server's error.
    pub async fn put(&self, key: &str, packed: &[u8]) -> Result<(), String> {
        let count = packed.len().div_ceil(BYTES).to_string();
        for (number, part) in packed.chunks(BYTES).enumerate() {
            let message = PublishMessage::build()
                .header(COUNT, count.as_str())
                .payload(part.to_vec().into());
            let sent = self.context.send_publish(subject(key, number), message);
            let taken = sent.await.map_err(|error| error.to_string())?;
            taken.await.map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    /// A job's recording.
    ///
    /// # Errors
    /// The server's error, or that it is too large.
    pub async fn get(&self, key: &str) -> Result<Vec<u8>, String> {
        let (mut packed, mut count) = (Vec::new(), 1);
        let mut number = 0;
        while number < count {
            let part = self
                .stream
                .direct_get_last_for_subject(subject(key, number));
            let part = part.await.map_err(|error| error.to_string())?;
            let header = part.headers.get(COUNT).map(|count| count.as_str());
            count = header.and_then(|count| count.parse().ok()).unwrap_or(1);
            packed.extend_from_slice(&part.payload);
            // The archive is a little longer than the files in it.
            if packed.len() as u64 > MOST_BYTES + MOST_BYTES / 8 {
                return Err(format!("it has more than {MOST_BYTES} bytes"));
            }
            number += 1;
        }
        Ok(packed)
    }

    /// Drops a job's recording.
    ///
    /// # Errors
    /// The server's error.
    pub async fn drop(&self, key: &str) -> Result<(), String> {
        let purged = self.stream.purge().filter(format!("{PART}.{key}.*")).await;
        purged.map(|_| ()).map_err(|error| error.to_string())
    }
}

fn subject(key: &str, number: usize) -> String {
    format!("{PART}.{key}.{number}")
}
