//! Connections: how many, how slow, how long.

use std::future::Future;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};
use tokio::task::JoinSet;

use super::counters::{Counters, add};

/// Time in which the head of a request must be here; also how long an idle connection is kept.
const HEAD: Duration = Duration::from_secs(15);
/// Longest head of a request, bytes.
const LONGEST_HEAD: usize = 16 * 1024;
/// Time after which a connection ends after its answer; a client that reads an answer more slowly
/// than that holds its place no longer.
const LIFE: Duration = Duration::from_secs(600);
/// Time for answers that have begun when the service ends.
const FAREWELL: Duration = Duration::from_secs(2);
/// Bytes that the system keeps for a connection, so that a reader who does not read costs no more.
const SEND_BUFFER: usize = 128 * 1024;
/// Pause where the system is out of connections.
const PAUSE: Duration = Duration::from_millis(50);

/// What one that is too many is told.
const TOO_MANY: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\n\
    Content-Length: 44\r\nConnection: close\r\n\r\n{\"error\": \"too many connections; try again\"}";

/// Accepts connections until `shutdown`, so many at once.
pub async fn accept(
    listener: TcpListener,
    router: Router,
    most: usize,
    counters: &Counters,
    shutdown: impl Future<Output = ()>,
) {
    let places = Arc::new(Semaphore::new(most));
    let (end, ending) = watch::channel(());
    let mut open = JoinSet::new();
    let mut shutdown = pin!(shutdown);
    loop {
        tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) => match Arc::clone(&places).try_acquire_owned() {
                    Ok(place) => {
                        open.spawn(serve(stream, router.clone(), place, ending.clone()));
                    }
                    Err(_) => turned_away(&stream, counters),
                },
                Err(error) => {
                    tracing::warn!(%error, "no connection can be taken");
                    tokio::time::sleep(PAUSE).await;
                }
            },
            Some(_) = open.join_next() => {}
            () = &mut shutdown => break,
        }
        let used = most - places.available_permits().min(most);
        counters
            .connections
            .store(used as u64, std::sync::atomic::Ordering::Relaxed);
    }
    drop(listener);
    // Nobody may listen.
    let _ = end.send(());
    farewell(open).await;
}

fn turned_away(stream: &TcpStream, counters: &Counters) {
    add(&counters.connections_refused);
    // It is lost anyway; the words are a courtesy.
    let _ = stream.try_write(TOO_MANY);
}

/// Waits for answers that have begun, but not for ever.
async fn farewell(mut open: JoinSet<()>) {
    let all = async { while open.join_next().await.is_some() {} };
    if tokio::time::timeout(FAREWELL, all).await.is_err() {
        tracing::info!("connections that did not end in time are cut");
    }
}

async fn serve(
    stream: TcpStream,
    router: Router,
    _place: OwnedSemaphorePermit,
    mut ending: watch::Receiver<()>,
) {
    let tuned = stream.set_nodelay(true).and_then(|()| {
        Ok(rustix::net::sockopt::set_socket_send_buffer_size(
            &stream,
            SEND_BUFFER,
        )?)
    });
    if let Err(error) = tuned {
        tracing::debug!(%error, "a connection keeps the system's buffers");
    }
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_buf_size(LONGEST_HEAD)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    let mut connection = pin!(connection);
    tokio::select! {
        result = connection.as_mut() => return told(result),
        _ = ending.changed() => {}
        () = tokio::time::sleep(LIFE) => {}
    }
    connection.as_mut().graceful_shutdown();
    if let Ok(result) = tokio::time::timeout(FAREWELL, connection).await {
        told(result);
    }
}

fn told(result: Result<(), hyper::Error>) {
    if let Err(error) = result {
        tracing::debug!(%error, "a connection ended with an error");
    }
}
