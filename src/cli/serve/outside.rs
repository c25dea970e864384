//! The page, the interface and the recordings of a service.

use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;

use crate::cli::CliError;
use crate::service::Service;
use crate::service::config::Config;
use crate::service::http::{self, HttpError, Settings};
use crate::service::recorder::Recorder;

/// The threads that listen until they are told to end.
pub struct Outside {
    end: oneshot::Sender<()>,
    served: JoinHandle<Result<(), HttpError>>,
    recorder: Option<Recorder>,
}

/// Binds the address, before any motion.
///
/// # Errors
/// [`CliError::Input`] where the address needs a token, [`CliError::Failure`] where it is not available.
pub async fn listen(config: &Config) -> Result<TcpListener, CliError> {
    let address = config.http.address;
    http::check(address, config.http.token.as_deref()).map_err(CliError::input)?;
    let refused = |error| CliError::failure(format!("HTTP at {address}: {error}"));
    TcpListener::bind(address).await.map_err(refused)
}

impl Outside {
    /// Records and serves the activity of the engine.
    pub fn start(listener: TcpListener, config: &Config, service: &Service) -> Self {
        let (handle, shelf) = (service.handle(), service.shelf());
        let recorder = shelf.map(|shelf| Recorder::start(&handle, shelf));
        let arcs = config.joints.iter().filter_map(|joint| {
            let arc = joint.arc?;
            Some((joint.name.clone(), arc))
        });
        let settings = Settings {
            token: config.http.token.clone(),
            max_connections: config.http.max_connections,
            max_body_bytes: config.http.max_body,
            arcs: arcs.collect(),
            recorder: recorder.clone(),
            report: crate::report::page,
            diagnosis_limit: config.diagnosis_limit,
        };
        let (end, ended) = oneshot::channel();
        let served = tokio::spawn(http::serve(listener, handle, settings, async {
            // A dropped sender ends the server as well.
            let _ = ended.await;
        }));
        Self {
            end,
            served,
            recorder,
        }
    }

    /// Ends the threads; the recording in progress is put onto the shelf.
    ///
    /// # Errors
    /// [`CliError::Failure`] where the server has failed.
    pub async fn end(self) -> Result<(), CliError> {
        // The server may have ended by itself; its result then has the reason.
        let _ = self.end.send(());
        if let Some(recorder) = &self.recorder {
            recorder.close().await;
        }
        self.served
            .await
            .map_err(CliError::failure)?
            .map_err(CliError::failure)
    }
}
