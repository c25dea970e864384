//! Streams, consumer and bucket of the queue.

use async_nats::jetstream::consumer::{AckPolicy, PullConsumer, pull};
use async_nats::jetstream::stream::{self, DiscardPolicy, RetentionPolicy, StorageType};
use async_nats::jetstream::{Context, kv};
use async_nats::{ConnectOptions, ServerAddr};
use tokio::runtime::Builder;

use super::parts::{PART, Parts};
use super::patience::Patience;
use super::{ACK_WAIT, JOB, Link};
use crate::batch::error::BatchError;

const JOBS: &str = "QUELL_JOBS";
const RECORDINGS: &str = "QUELL_RECORDINGS";
const ANSWERS: &str = "QUELL_ANSWERS";
/// The durable consumer that all workers share.
const WORKERS: &str = "workers";
/// Workers that may wait at once; the server's own bound is 512.
const MOST_WAITING: i64 = 65_536;
/// As many jobs at work at once as there are workers.
const UNBOUNDED: i64 = -1;

/// Connects, and makes what is not there.
///
/// # Errors
/// [`BatchError::Queue`] where the address is none, nobody answers, or the server has no JetStream.
pub fn link(address: &str) -> Result<Link, BatchError> {
    let runtime = Builder::new_multi_thread()
        .worker_threads(1)
        .thread_name("quell-nats")
        .enable_all()
        .build()
        .map_err(|error| BatchError::Thread(error.to_string()))?;
    let parsed = address.parse::<ServerAddr>();
    // An address may hold a password, so that what could not be read is not repeated.
    let nowhere = Patience::new("--queue".into());
    let parsed =
        parsed.map_err(|error| nowhere.failed("reading", "its address", error.to_string()))?;
    let patience = Patience::new(format!("nats://{}:{}", parsed.host(), parsed.port()));
    let connected = runtime.block_on(ConnectOptions::new().name("quell").connect(parsed));
    let client = connected
        .map_err(|error| patience.failed("connecting to", "the server", error.to_string()))?;
    // It starts a task of its own.
    let context = {
        let _within = runtime.enter();
        async_nats::jetstream::new(client)
    };
    let made = runtime.block_on(make(&context));
    let failed = |(what, error): (&str, String)| patience.failed("making", what, error);
    let (recordings, workers, answers) = made.map_err(failed)?;
    Ok(Link {
        runtime,
        patience,
        parts: Parts::new(context.clone(), recordings),
        context,
        workers,
        answers,
    })
}

/// The stream of recordings, the consumer of jobs, the bucket of answers; or what is not to be had, and why.
async fn make(
    context: &Context,
) -> Result<(stream::Stream, PullConsumer, kv::Store), (&'static str, String)> {
    let of = |what| move |error| (what, error);
    let jobs = stream(context, jobs()).await.map_err(of(JOBS))?;
    let recordings = stream(context, recordings()).await;
    let recordings = recordings.map_err(of(RECORDINGS))?;
    let consumer = jobs.get_or_create_consumer(WORKERS, workers()).await;
    let consumer = consumer.map_err(|error| (WORKERS, error.to_string()))?;
    sweep(&jobs, &consumer).await.map_err(of(JOBS))?;
    let answers = bucket(context).await.map_err(of(ANSWERS))?;
    Ok((recordings, consumer, answers))
}

async fn stream(context: &Context, config: stream::Config) -> Result<stream::Stream, String> {
    let made = context.get_or_create_stream(config).await;
    made.map_err(|error| error.to_string())
}

fn jobs() -> stream::Config {
    stream::Config {
        name: JOBS.into(),
        subjects: vec![format!("{JOB}.*")],
        retention: RetentionPolicy::WorkQueue,
        storage: StorageType::File,
        ..stream::Config::default()
    }
}

/// Removes what was acknowledged and is still there: a server that is killed may forget a removal, and then
/// neither hands the job out again nor takes it a second time.
async fn sweep(jobs: &stream::Stream, workers: &PullConsumer) -> Result<(), String> {
    let info = workers.get_info().await;
    let info = info.map_err(|error| error.to_string())?;
    let floor = info.ack_floor.stream_sequence;
    // To a server "all below the first" is everything.
    if floor == 0 {
        return Ok(());
    }
    // Everything up to the floor is acknowledged; what is below a number goes.
    let done = jobs.purge().sequence(floor + 1);
    done.await.map(|_| ()).map_err(|error| error.to_string())
}

fn recordings() -> stream::Config {
    stream::Config {
        name: RECORDINGS.into(),
        subjects: vec![format!("{PART}.*.*")],
        max_messages_per_subject: 1,
        storage: StorageType::File,
        allow_direct: true,
        ..stream::Config::default()
    }
}

fn workers() -> pull::Config {
    pull::Config {
        durable_name: Some(WORKERS.into()),
        ack_policy: AckPolicy::Explicit,
        ack_wait: ACK_WAIT,
        // The workers count, and answer with an error.
        max_deliver: UNBOUNDED,
        max_ack_pending: UNBOUNDED,
        max_waiting: MOST_WAITING,
        ..pull::Config::default()
    }
}

/// The bucket, whose stream is laid out as ADR-8 says. It is made as a stream, since servers before 2.10 do
/// not say of an account all that the making of a bucket asks for.
async fn bucket(context: &Context) -> Result<kv::Store, String> {
    let config = stream::Config {
        name: format!("KV_{ANSWERS}"),
        subjects: vec![format!("$KV.{ANSWERS}.>")],
        max_messages_per_subject: 1,
        discard: DiscardPolicy::New,
        storage: StorageType::File,
        allow_rollup: true,
        deny_delete: true,
        allow_direct: true,
        ..stream::Config::default()
    };
    stream(context, config).await?;
    let store = context.get_key_value(ANSWERS).await;
    store.map_err(|error| error.to_string())
}
