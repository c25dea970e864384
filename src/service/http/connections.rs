//! Connections: their number, pace and lifetime; and extra connections for a stop when all others are in use.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::future::{Future, poll_fn};
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::task::Poll;
use std::time::Duration;

use axum::Router;
use axum::http::StatusCode;
use axum::response::Response;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::TokioIo;
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};
use tokio::task::{AbortHandle, JoinSet};
use tokio::time::{Instant, sleep_until, timeout};

use super::App;
use super::pace::{Overdue, Pace};
use super::wire::Wire;

/// Longest head of a request, bytes.
const LONGEST_HEAD: usize = 16 * 1024;
/// Time for answers that have begun when the service ends.
const FAREWELL: Duration = Duration::from_secs(2);
/// Bytes that the system buffers for a connection; a bound, since a client may not read.
const SEND_BUFFER: usize = 128 * 1024;
/// Pause if the system has no connections left.
const PAUSE: Duration = Duration::from_millis(50);
/// Connections beyond the limit that are kept for a stop. Each carries one request, and the oldest gives way to
/// a new one, so that they cannot be blocked by holding all of them. A stop is executed at the moment at which
/// it is read. It is lost only if as many newer connections arrive between its connection and its first bytes.
const KEPT_FOR_STOP: usize = 16;

/// The answer to an overdue request head. The length is that of the body.
const TOO_SLOW: &[u8] = b"HTTP/1.1 408 Request Timeout\r\nContent-Type: application/json\r\n\
    Content-Length: 65\r\nConnection: close\r\n\r\n{\"error\": \"the head of the request was not here within a second\"}";

/// The handlers: for all requests, and for a stop only.
#[derive(Clone)]
pub struct Answers {
    /// For a connection within the limit.
    pub all: Router,
    /// For a connection beyond it.
    pub stop_only: Router,
}

/// Accepts connections until `shutdown`, up to a limit, and a few more for a stop.
pub async fn accept(
    listener: TcpListener,
    answers: Answers,
    most: usize,
    app: &Arc<App>,
    shutdown: impl Future<Output = ()>,
) {
    let (end, ending) = watch::channel(());
    let mut door = Door {
        places: Arc::new(Semaphore::new(most)),
        answers,
        app: Arc::clone(app),
        ending,
        open: JoinSet::new(),
        kept: Kept::default(),
    };
    let mut shutdown = pin!(shutdown);
    loop {
        tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) => door.let_in(stream).await,
                Err(error) => {
                    tracing::warn!(%error, "no connection can be taken");
                    tokio::time::sleep(PAUSE).await;
                }
            },
            Some(_) = door.open.join_next() => {}
            () = &mut shutdown => break,
        }
        let used = most - door.places.available_permits().min(most);
        app.counters.connections.store(used as u64, Relaxed);
    }
    drop(listener);
    // There may be no receiver.
    let _ = end.send(());
    farewell(door.open).await;
}

/// The acceptor of connections.
struct Door {
    places: Arc<Semaphore>,
    answers: Answers,
    app: Arc<App>,
    ending: watch::Receiver<()>,
    open: JoinSet<()>,
    kept: Kept,
}

impl Door {
    /// Serves a connection; only a stop if the limit is reached.
    async fn let_in(&mut self, stream: TcpStream) {
        let place = Arc::clone(&self.places).try_acquire_owned().ok();
        let beyond = place.is_none();
        let router = match beyond {
            true => self.answers.stop_only.clone(),
            false => self.answers.all.clone(),
        };
        let connection = Connection {
            place,
            ending: self.ending.clone(),
            app: Arc::clone(&self.app),
        };
        let task = self.open.spawn(connection.serve(stream, router));
        if beyond {
            self.kept.admit(task);
            // An admitted connection is read before the next one is accepted.
            tokio::task::yield_now().await;
        }
    }
}

/// The connections beyond the limit, oldest first.
#[derive(Default)]
struct Kept(VecDeque<AbortHandle>);

impl Kept {
    /// Admits one more; if the limit is reached, the oldest is cut.
    fn admit(&mut self, connection: AbortHandle) {
        self.0.retain(|other| !other.is_finished());
        while self.0.len() >= KEPT_FOR_STOP {
            if let Some(oldest) = self.0.pop_front() {
                oldest.abort();
            }
        }
        self.0.push_back(connection);
    }
}

/// Waits for answers that have begun, for a limited time.
async fn farewell(mut open: JoinSet<()>) {
    let all = async { while open.join_next().await.is_some() {} };
    if timeout(FAREWELL, all).await.is_err() {
        tracing::info!("connections that did not end in time are cut");
    }
}

/// One connection.
struct Connection {
    /// `None` beyond the limit.
    place: Option<OwnedSemaphorePermit>,
    ending: watch::Receiver<()>,
    app: Arc<App>,
}

impl Connection {
    async fn serve(mut self, stream: TcpStream, router: Router) {
        tune(&stream);
        let pace = Arc::new(Pace::new(Instant::now()));
        let wire = Wire::new(stream, Arc::clone(&pace));
        let connection = http1::Builder::new()
            // Its timeouts are those of its pace.
            .header_read_timeout(None)
            .keep_alive(self.place.is_some())
            .max_buf_size(LONGEST_HEAD)
            .serve_connection(TokioIo::new(wire.clone()), paced(router, &pace))
            .with_upgrades();
        let mut connection = pin!(connection);
        tokio::select! {
            ended = in_time(connection.as_mut(), &pace) => match ended {
                Ok(result) => return told(result),
                Err(Overdue::Head) => {
                    self.app.counters.answered(StatusCode::REQUEST_TIMEOUT);
                    return wire.farewell(TOO_SLOW);
                }
                Err(Overdue::Silent | Overdue::Idle | Overdue::Stalled) => return,
                Err(Overdue::Old) => {}
            },
            _ = self.ending.changed() => {}
        }
        connection.as_mut().graceful_shutdown();
        if let Ok(result) = timeout(FAREWELL, connection).await {
            told(result);
        }
    }
}

fn tune(stream: &TcpStream) {
    let tuned = stream.set_nodelay(true).and_then(|()| {
        Ok(rustix::net::sockopt::set_socket_send_buffer_size(
            stream,
            SEND_BUFFER,
        )?)
    });
    if let Err(error) = tuned {
        tracing::debug!(%error, "a connection keeps the system's buffers");
    }
}

/// The router, with the pace updated when a request is complete and when it is answered.
fn paced(
    router: Router,
    pace: &Arc<Pace>,
) -> impl Service<
    hyper::Request<Incoming>,
    Response = Response,
    Error = Infallible,
    Future = impl Future<Output = Result<Response, Infallible>> + Send + 'static,
> + Send
+ 'static {
    let (router, pace) = (TowerToHyperService::new(router), Arc::clone(pace));
    service_fn(move |request| {
        pace.asked(Instant::now());
        let (answer, pace) = (router.call(request), Arc::clone(&pace));
        async move {
            let answer = answer.await;
            pace.answered(Instant::now());
            answer
        }
    })
}

/// Drives a connection to its end, or until it is overdue.
async fn in_time<C: Future>(
    mut connection: Pin<&mut C>,
    pace: &Pace,
) -> Result<C::Output, Overdue> {
    let mut sleep = pin!(sleep_until(pace.deadline().0));
    poll_fn(|context| {
        // Only progress of the connection moves the deadline.
        if let Poll::Ready(end) = connection.as_mut().poll(context) {
            return Poll::Ready(Ok(end));
        }
        let (deadline, why) = pace.deadline();
        if sleep.deadline() != deadline {
            sleep.as_mut().reset(deadline);
        }
        sleep.as_mut().poll(context).map(|()| Err(why))
    })
    .await
}

fn told(result: Result<(), hyper::Error>) {
    if let Err(error) = result {
        tracing::debug!(%error, "a connection ended with an error");
    }
}
