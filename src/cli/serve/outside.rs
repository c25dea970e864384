//! Page, interface and recordings of a service.

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

/// Takes the address, before anything moves.
///
/// # Errors
/// [`CliError::Input`] where the address needs a token, [`CliError::Failure`] where it is not to be had.
pub async fn listen(config: &Config) -> Result<TcpListener, CliError> {
    let address = config.http.address;
    http::check(address, config.http.token.as_deref()).map_err(CliError::input)?;
    let refused = |error| CliError::failure(format!("HTTP at {address}: {error}"));
    TcpListener::bind(address).await.map_err(refused)
}

impl Outside {
    /// Records and serves what the engine does.
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
            // Its end being dropped is an end as well.
            let _ = ended.await;
        }));
        Self {
            end,
            served,
            recorder,
        }
    }

    /// Ends what has begun; what is being recorded is put onto the shelf.
    ///
    /// # Errors
    /// [`CliError::Failure`] where it did not serve at all.
    pub async fn end(self) -> Result<(), CliError> {
        // It may have ended by itself, and then says why.
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
