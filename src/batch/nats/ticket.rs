//! A job that was handed out by the server.

use std::borrow::Cow;
use std::fmt::Display;
use std::sync::Arc;
use std::time::Duration;

use async_nats::jetstream::{AckKind, Message};

use super::Link;
use crate::batch::error::BatchError;
use crate::batch::queue::Ticket;

/// How long a job that was given back waits: who has the answer, if somebody has, has stored it then.
const LATER: Duration = Duration::from_secs(1);

/// A job that was handed out.
pub struct Held {
    link: Arc<Link>,
    key: String,
    message: Message,
}

impl Held {
    /// A job with this key.
    pub fn new(link: Arc<Link>, key: &str, message: Message) -> Self {
        Self {
            link,
            key: key.into(),
            message,
        }
    }

    /// Says that a message is none that could be done.
    pub fn refuse(link: &Link, message: &Message) {
        told(link.runtime.block_on(message.ack_with(AckKind::Term)));
    }
}

impl Ticket for Held {
    fn recording(&self) -> Result<Cow<'_, [u8]>, BatchError> {
        let (link, key) = (&self.link, &self.key);
        let packed = link.runtime.block_on(link.parts.get(key));
        let failed = |reason| link.patience.failed("fetching", key, reason);
        packed.map(Cow::Owned).map_err(failed)
    }

    fn alive(&self) {
        let alive = self.message.ack_with(AckKind::Progress);
        told(self.link.runtime.block_on(alive));
    }

    fn done(self: Box<Self>) {
        let link = &self.link;
        told(link.runtime.block_on(async {
            let drop = || link.parts.drop(&self.key);
            link.patience.of("dropping", &self.key, drop).await?;
            let acknowledge = || self.message.double_ack();
            link.patience
                .of("acknowledging", &self.key, acknowledge)
                .await
        }));
    }

    fn give_back(self: Box<Self>) {
        let back = self.message.ack_with(AckKind::Nak(Some(LATER)));
        told(self.link.runtime.block_on(back));
    }
}

/// A message that the server does not hear does no harm: the job is handed out again.
fn told(result: Result<(), impl Display>) {
    if let Err(error) = result {
        tracing::warn!(%error, "the server does not hear of a job");
    }
}
