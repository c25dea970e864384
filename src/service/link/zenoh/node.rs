//! A ROS 2 node on a Zenoh session, named and announced as by `rmw_zenoh`.
//!
//! Data of a topic have the key `<domain>/<topic>/<type>/<hash>`. Each message has an attachment: its
//! number (i64), when it was sent (i64, ns since 1970), 16 as a byte, and the sender's 16 bytes. Node,
//! publishers and subscriptions are each announced by a token of liveliness,
//! `@ros2_lv/<domain>/<session>/<node>/<entity>/<kind>/<enclave>/<namespace>/<name>` and, but for the node,
//! `/<topic>/<type>/<hash>/<qos>`; in names `%` stands for `/`.
//!
//! Source: `rmw_zenoh`, docs/design.md; rmw_zenoh_cpp/src/detail, `liveliness_utils.cpp` and
//! `attachment_helpers.cpp`.

use std::io;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::time::{SystemTime, UNIX_EPOCH};

use twox_hash::xxhash3_128::Hasher;
use zenoh::liveliness::LivelinessToken;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Config, Session, Wait};

use super::messages::MessageType;
use crate::service::config::ZenohConfig;

/// Name of the node.
const NAME: &str = "quell";
/// Reliable, volatile, the last 10 kept: the default of ROS 2.
const QOS: &str = "::,10:,:,:,,";

/// A node and its session, which ends with the last holder.
pub struct Node {
    session: Session,
    domain: u32,
    /// Entities so far; the node is the first.
    entities: AtomicU32,
    _token: LivelinessToken,
}

/// Sends the messages of a topic.
pub(super) struct Publisher {
    inner: zenoh::pubsub::Publisher<'static>,
    _token: LivelinessToken,
    identity: [u8; 16],
    sent: i64,
}

/// Receives the messages of a topic until it is dropped.
pub(super) struct Subscription {
    _inner: zenoh::pubsub::Subscriber<()>,
    _token: LivelinessToken,
}

impl Node {
    /// Opens a session. Unreachable endpoints are tried again and again.
    ///
    /// # Errors
    /// Zenoh's error, for an endpoint that is invalid or that it cannot listen on.
    pub fn open(config: &ZenohConfig) -> io::Result<Self> {
        let settings = settings(config)?;
        // Zenoh does not start on a thread that runs an asynchronous runtime of one thread.
        let opened = std::thread::spawn(move || zenoh::open(settings).wait()).join();
        let session = opened.map_err(|_| io::Error::other("the session's thread has ended"))?;
        let session = session.map_err(io::Error::other)?;
        let domain = config.domain;
        let token = format!("@ros2_lv/{domain}/{}/0/0/NN/%/%/{NAME}", session.zid());
        let token = session.liveliness().declare_token(token).wait();
        Ok(Self {
            _token: token.map_err(io::Error::other)?,
            session,
            domain,
            entities: AtomicU32::new(1),
        })
    }

    /// A publisher of a topic. If the network is too slow, messages are dropped, since the next one is newer.
    ///
    /// # Errors
    /// Zenoh's error.
    pub(super) fn publisher(
        &self,
        topic: &str,
        kind: &MessageType,
        priority: Priority,
    ) -> io::Result<Publisher> {
        let name = self.announcement("MP", topic, kind);
        let inner = self.session.declare_publisher(self.key(topic, kind));
        let inner = inner
            .congestion_control(CongestionControl::Drop)
            .priority(priority)
            .express(true)
            .wait();
        Ok(Publisher {
            inner: inner.map_err(io::Error::other)?,
            identity: Hasher::oneshot(name.as_bytes()).to_le_bytes(),
            _token: self.announce(name)?,
            sent: 0,
        })
    }

    /// Calls `take` with the body of each message of a topic, on a thread of Zenoh's.
    ///
    /// # Errors
    /// Zenoh's error.
    pub(super) fn subscribe(
        &self,
        topic: &str,
        kind: &MessageType,
        take: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> io::Result<Subscription> {
        let inner = self
            .session
            .declare_subscriber(self.key(topic, kind))
            .callback(move |sample| take(&sample.payload().to_bytes()))
            .wait();
        Ok(Subscription {
            _inner: inner.map_err(io::Error::other)?,
            _token: self.announce(self.announcement("MS", topic, kind))?,
        })
    }

    fn key(&self, topic: &str, kind: &MessageType) -> String {
        let topic = topic.trim_start_matches('/');
        format!("{}/{topic}/{}/{}", self.domain, kind.name, kind.hash)
    }

    fn announcement(&self, entity: &str, topic: &str, kind: &MessageType) -> String {
        let (domain, session) = (self.domain, self.session.zid());
        let number = self.entities.fetch_add(1, Relaxed);
        let topic = topic.replace('/', "%");
        let MessageType { name, hash } = kind;
        format!(
            "@ros2_lv/{domain}/{session}/0/{number}/{entity}/%/%/{NAME}/{topic}/{name}/{hash}/{QOS}"
        )
    }

    fn announce(&self, name: String) -> io::Result<LivelinessToken> {
        let token = self.session.liveliness().declare_token(name).wait();
        token.map_err(io::Error::other)
    }
}

impl Publisher {
    /// Sends a message; returns whether Zenoh accepted it.
    pub fn put(&mut self, body: &[u8]) -> bool {
        self.sent += 1;
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let now = now.map_or(0, |since| since.as_nanos() as i64);
        let mut attachment = Vec::with_capacity(33);
        attachment.extend(self.sent.to_le_bytes());
        attachment.extend(now.to_le_bytes());
        attachment.push(16);
        attachment.extend(self.identity);
        let put = self.inner.put(body).attachment(attachment);
        put.wait().is_ok()
    }
}

fn settings(config: &ZenohConfig) -> io::Result<Config> {
    let mut settings = Config::default();
    let keys = [
        ("mode", "\"peer\"".to_owned()),
        ("connect/endpoints", serde_json::to_string(&config.connect)?),
        ("listen/endpoints", serde_json::to_string(&config.listen)?),
        ("scouting/multicast/enabled", config.multicast.to_string()),
    ];
    for (key, value) in keys {
        let set = settings.insert_json5(key, &value);
        set.map_err(|error| io::Error::other(format!("{key} = {value}: {error}")))?;
    }
    Ok(settings)
}
