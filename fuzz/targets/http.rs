//! The body of a request: the first byte says of which, the rest is sent to the service's routes. An engine
//! that only listens stands behind them.
#![no_main]

use axum::body::{Body, to_bytes};
use axum::http::{Request as Asked, Response, StatusCode, header};
use axum::routing::Router;
use libfuzzer_sys::fuzz_target;
use quell::report::page;
use quell::service::contract::{Accepted, EngineEnds, JointSnapshot, Request, Snapshot, Target, channels};
use quell::service::http::{Settings, routes};
use quell_shapers::{Mode, SHAPERS};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use tokio::runtime::Runtime;
use tower::ServiceExt;

const PATHS: [&str; 6] = [
    "/api/move",
    "/api/stop",
    "/api/shaper",
    "/api/payload",
    "/api/recordings",
    "/api/diagnose",
];

/// Range of the joint, rad.
const RANGE: [f64; 2] = [-1.75, 1.75];

/// The last request to the engine.
type Last = Arc<Mutex<Option<Request>>>;

struct Service {
    runtime: Runtime,
    routes: Router,
    last: Last,
}

impl Service {
    fn start() -> Self {
        let mut builder = tokio::runtime::Builder::new_current_thread();
        let runtime = builder.enable_time().build().expect("a runtime");
        let (handle, ends) = channels(Snapshot {
            joints: vec![JointSnapshot {
                name: "joint_1".into(),
                range_rad: RANGE,
                ..JointSnapshot::default()
            }],
            ..Snapshot::default()
        });
        let settings = Settings {
            token: None,
            max_connections: 16,
            max_body_bytes: 4096,
            arcs: BTreeMap::new(),
            recorder: None,
            report: page,
        };
        let entered = runtime.enter();
        let routes = routes(handle, settings).expect("a thread");
        let last = Last::default();
        runtime.spawn(listen(ends, Arc::clone(&last)));
        drop(entered);
        Self {
            runtime,
            routes,
            last,
        }
    }

    fn answer(&self, path: &str, body: &[u8]) -> (StatusCode, Vec<u8>) {
        let asked = Asked::post(path)
            .header(header::HOST, "localhost")
            .header(header::CONTENT_TYPE, "application/json")
            .body(Body::from(body.to_vec()));
        let asked = asked.expect("a request");
        self.runtime.block_on(async {
            let answer: Response<Body> = match self.routes.clone().oneshot(asked).await {
                Ok(answer) => answer,
                Err(never) => match never {},
            };
            let (head, body) = answer.into_parts();
            let body = to_bytes(body, 1 << 20).await.expect("an answer");
            (head.status, body.to_vec())
        })
    }
}

/// An engine that takes whatever comes to it.
async fn listen(mut ends: EngineEnds, last: Last) {
    while let Some(envelope) = ends.requests.recv().await {
        *last.lock().expect("no panic before") = Some(envelope.request);
        // Whoever asked may have gone.
        let _ = envelope.reply.send(Ok(Accepted::Changed));
    }
}

thread_local! {
    static SERVICE: RefCell<Service> = RefCell::new(Service::start());
}

fuzz_target!(|bytes: &[u8]| {
    let Some((which, body)) = bytes.split_first() else {
        return;
    };
    let path = PATHS[usize::from(*which) % PATHS.len()];
    let (status, answer, asked) = SERVICE.with_borrow(|service| {
        let (status, answer) = service.answer(path, body);
        let asked = service.last.lock().expect("no panic before").take();
        (status, answer, asked)
    });
    let answer: serde_json::Value = serde_json::from_slice(&answer).expect("an answer in JSON");
    assert!(!status.is_server_error(), "{status}: {answer}");
    assert_eq!(
        status == StatusCode::OK,
        asked.is_some(),
        "{status}: {answer}"
    );
    match asked {
        Some(request) => check(request, body),
        None => assert!(
            answer["error"]
                .as_str()
                .is_some_and(|sentence| !sentence.is_empty())
        ),
    }
});

/// A request that comes to the engine has been looked at: it is in the range of the joint, or a mode for which the
/// shapers have a train or a word.
fn check(request: Request, body: &[u8]) {
    let is_object = body.trim_ascii_start().first() == Some(&b'{');
    assert!(
        is_object || !matches!(request, Request::Move { .. } | Request::Jog { .. } | Request::Feed { .. } | Request::MoveTogether { .. } | Request::Payload { .. } | Request::Shaping(_)),
        "values without names: {request:?}"
    );
    match request {
        Request::Move { target, .. } => assert!(RANGE[0] <= target && target <= RANGE[1]),
        Request::MoveTogether { targets, .. } => {
            let within = |one: &Target| (RANGE[0]..=RANGE[1]).contains(&one.target);
            assert!(targets.iter().all(within));
        }
        Request::Payload { mass } => assert!(mass.is_finite() && mass >= 0.0),
        Request::Shaping(change) => {
            let mode = change.mode.map(Mode::try_from);
            if let Some(Ok(mode)) = mode {
                let trains = SHAPERS
                    .iter()
                    .flat_map(|shaper| shaper.on_grid(mode, 0.004));
                for train in trains {
                    let sum: f64 = train.taps().iter().map(|tap| tap.amplitude).sum();
                    assert!((sum - 1.0).abs() < 1e-12, "{mode:?}: {sum}");
                }
            }
        }
        Request::Stop | Request::Forget { .. } | Request::Enable | Request::Disable | Request::Reset => {}
        Request::Jog { velocity, .. } => assert!(velocity.is_finite()),
        Request::Feed { share } => assert!((0.0..=1.0).contains(&share)),
    }
}
