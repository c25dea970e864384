//! The queue in NATS JetStream: jobs and recordings in streams, answers in a bucket of keys and values.
//!
//! | what | where | why |
//! |---|---|---|
//! | jobs | stream `QUELL_JOBS`, a work queue, one subject a key | what is acknowledged is gone; a job is put in under the condition that its subject is empty, so that it is there once for as long as it is there |
//! | recordings | stream `QUELL_RECORDINGS`, in parts, subjects by the job's key | a part is below the server's bound of a message; parts are dropped with their job, and nothing of them is left, as of an object store's objects |
//! | answers | bucket `QUELL_ANSWERS` | a key is created and never changed: of two workers that did the same job the second is told so. An answer is some kilobytes, so that it needs no parts |
//!
//! A job comes from a durable pull consumer and is handed out again where nobody says for [`ACK_WAIT`] that
//! it is being worked at. A server that is restarted is waited for. All is kept in files.
//!
//! Source: NATS, JetStream model deep dive; ADR-4 (expected last subject sequence), ADR-8 (key-value store),
//! ADR-13 (pull consumers).

mod parts;
mod patience;
mod setup;
mod ticket;

use std::sync::Arc;
use std::time::Duration;

use async_nats::jetstream::consumer::PullConsumer;
use async_nats::jetstream::context::PublishErrorKind;
use async_nats::jetstream::kv::{CreateErrorKind, Store};
use async_nats::jetstream::message::PublishMessage;
use async_nats::jetstream::{Context, Message};
use futures_util::StreamExt;
use tokio::runtime::Runtime;

use super::answer::Answer;
use super::error::BatchError;
use super::job::Job;
use super::packed::Packed;
use super::queue::{Claim, Queue, Submitted, Taken};
use super::work::HEARTBEAT;
use parts::Parts;
use patience::Patience;
use ticket::Held;

/// The prefix of the key in a job's subject.
const JOB: &str = "quell-queue.job";
/// How long a job that is handed out may be silent: two signs of life may be lost, or late.
const ACK_WAIT: Duration = Duration::from_secs(3 * HEARTBEAT.as_secs());
/// How long a worker waits for a job before it looks whether it should end: a thousand idle workers ask the
/// server two hundred times a second.
const WAIT: Duration = Duration::from_secs(5);
/// Pause where the server does not answer.
const PAUSE: Duration = Duration::from_secs(1);

/// The queue at a server.
pub struct Nats(Arc<Link>);

/// The connection that the queue and those who hold its jobs share.
struct Link {
    runtime: Runtime,
    patience: Patience,
    context: Context,
    workers: PullConsumer,
    parts: Parts,
    answers: Store,
}

impl Nats {
    /// Connects, and makes streams, consumer and bucket where they are not there.
    ///
    /// # Errors
    /// [`BatchError::Queue`] where the address is none, nobody answers, or the server has no JetStream.
    pub fn connect(address: &str) -> Result<Self, BatchError> {
        Ok(Self(Arc::new(setup::link(address)?)))
    }

    /// Runs a request to its end.
    fn wait<T>(&self, request: impl Future<Output = T>) -> T {
        self.0.runtime.block_on(request)
    }
}

impl Link {
    /// The next job, if one comes in time.
    async fn next(&self) -> Result<Option<Message>, async_nats::Error> {
        let batch = self.workers.batch().max_messages(1).expires(WAIT);
        batch.messages().await?.next().await.transpose()
    }

    /// Puts a job in, unless it is there; says whether it was not.
    async fn publish(&self, job: &Job) -> Result<bool, String> {
        let text = serde_json::to_vec(job).map_err(|error| error.to_string())?;
        // It may be there only once: none may be the last of its subject.
        let message = PublishMessage::build().expected_last_subject_sequence(0);
        let subject = format!("{JOB}.{}", job.key);
        let sent = self
            .context
            .send_publish(subject, message.payload(text.into()));
        let taken = match sent.await {
            Ok(taken) => taken.await,
            Err(error) => Err(error),
        };
        match taken {
            Ok(_) => Ok(true),
            Err(error) if error.kind() == PublishErrorKind::WrongLastSequence => Ok(false),
            Err(error) => Err(error.to_string()),
        }
    }

    async fn has_answer(&self, key: &str) -> Result<bool, String> {
        let entry = self.answers.get(key).await;
        Ok(entry.map_err(|error| error.to_string())?.is_some())
    }

    async fn create(&self, key: &str, answer: &[u8]) -> Result<bool, String> {
        match self.answers.create(key, answer.to_vec().into()).await {
            Ok(_) => Ok(true),
            Err(error) if error.kind() == CreateErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(error.to_string()),
        }
    }
}

impl Queue for Nats {
    fn submit(&self, job: &Job, packed: Packed) -> Result<Submitted, BatchError> {
        let (link, key) = (&self.0, &job.key);
        self.wait(async {
            let answered = || link.has_answer(key);
            if link.patience.of("asking for", key, answered).await? {
                return Ok(Submitted::Answered);
            }
            let parts = || link.parts.put(key, &packed.bytes);
            link.patience.of("sending", key, parts).await?;
            let publish = || link.publish(job);
            Ok(match link.patience.of("putting in", key, publish).await? {
                true => Submitted::Queued,
                false => Submitted::Waiting,
            })
        })
    }

    fn take(&self) -> Result<Taken, BatchError> {
        let link = &self.0;
        let message = self.wait(async {
            let next = link.next().await;
            if next.is_err() {
                tokio::time::sleep(PAUSE).await;
            }
            next
        });
        let message = match message {
            Ok(Some(message)) => message,
            Ok(None) => return Ok(Taken::Nothing),
            Err(error) => {
                tracing::warn!(server = link.patience.server(), %error, "no job is to be had");
                return Ok(Taken::Nothing);
            }
        };
        let Ok(job) = serde_json::from_slice::<Job>(&message.payload) else {
            // Nobody could ever do it, and there is no key to answer under.
            tracing::warn!(subject = %message.subject, "what is there is no job: it is thrown away");
            Held::refuse(link, &message);
            return Ok(Taken::Nothing);
        };
        let delivered = message.info().map(|info| info.delivered);
        Ok(Taken::Job(Claim {
            deliveries: delivered.unwrap_or(1).unsigned_abs(),
            ticket: Box::new(Held::new(Arc::clone(link), &job.key, message)),
            job,
        }))
    }

    fn has_answer(&self, key: &str) -> Result<bool, BatchError> {
        let link = &self.0;
        self.wait(link.patience.of("asking for", key, || link.has_answer(key)))
    }

    fn store(&self, answer: &Answer) -> Result<bool, BatchError> {
        let (link, key) = (&self.0, &answer.about.key);
        // Texts, numbers and lists of them always have a form in JSON.
        let text = serde_json::to_vec(answer).unwrap_or_default();
        self.wait(link.patience.of("storing", key, || link.create(key, &text)))
    }

    fn left(&self) -> Result<u64, BatchError> {
        let link = &self.0;
        // The stream's own count would have what a server that was killed forgot to remove.
        let info = || link.workers.get_info();
        let info = self.wait(link.patience.of("asking for", "jobs", info))?;
        Ok(info.num_pending + info.num_ack_pending as u64)
    }

    fn answers(
        &self,
        each: &mut dyn FnMut(Answer) -> Result<(), BatchError>,
    ) -> Result<(), BatchError> {
        let link = &self.0;
        let failed = |what: &str, reason: String| link.patience.failed("reading", what, reason);
        self.wait(async {
            let keys = link.answers.keys().await;
            let mut keys = keys.map_err(|error| failed("the answers", error.to_string()))?;
            while let Some(key) = keys.next().await {
                let key = key.map_err(|error| failed("the answers", error.to_string()))?;
                let value = link.answers.get(key.as_str()).await;
                let value = value.map_err(|error| failed(&key, error.to_string()))?;
                let value = value.unwrap_or_default();
                let answer = serde_json::from_slice(&value);
                each(answer.map_err(|error| failed(&key, error.to_string()))?)?;
            }
            Ok(())
        })
    }
}
