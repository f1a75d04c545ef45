//! The shared state of all handlers.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use axum::body::Bytes;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use rtf_report::console::TestCommands;
use serde::Serialize;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};

use crate::access::Access;
use crate::campaign_report::CampaignSource;
use crate::capabilities::Capabilities;
use crate::history_source::HistorySource;
use crate::index::Index;
use crate::problem::Problem;
use crate::runs::{Run, Runs};

/// Maximum number of concurrent event streams.
pub const STREAMS: usize = 256;

/// The shared state of all handlers. Cheap to clone.
#[derive(Clone)]
pub struct App {
    pub runs: Arc<Runs>,
    pub history: Arc<dyn HistorySource>,
    pub campaigns: Arc<dyn CampaignSource>,
    /// Whether `/metrics` shows the history.
    pub metrics: bool,
    pub access: Arc<Access>,
    pub role: Capabilities,
    /// Creates the functions that return the commands for rerunning and replaying a test.
    pub commands: fn() -> TestCommands,
    /// Changes when the journal of that run has grown.
    pub grown: watch::Receiver<u64>,
    /// Becomes true when the server shuts down.
    pub ending: watch::Receiver<bool>,
    /// When the server exits after its run has ended.
    pub lingers: Arc<OnceLock<Instant>>,
    /// Positions for event streams.
    pub streams: Arc<Semaphore>,
    /// Positions for files that are sent.
    pub files: Arc<Semaphore>,
}

impl App {
    /// A permit for sending a file.
    ///
    /// # Errors
    /// 503: so many are sent already.
    pub fn place_for_file(&self) -> Result<OwnedSemaphorePermit, Problem> {
        self.files.clone().try_acquire_owned().map_err(|_| {
            Problem::new(StatusCode::SERVICE_UNAVAILABLE, "too many files are sent at once")
        })
    }

    /// Creates a response from a run and its index, in a thread that may block.
    ///
    /// # Errors
    /// There is no such run, it cannot be read, or `view` says no.
    pub async fn read<T: Serialize>(
        &self,
        run: String,
        view: impl FnOnce(&Run, &Index) -> Result<T, Problem> + Send + 'static,
    ) -> JsonResult {
        let runs = self.runs.clone();
        blocking(move || {
            let run = runs.find(&run)?;
            let value = view(&run, &*run.read()?)?;
            JsonText::of(&value)
        })
        .await
    }

    /// As [`App::read`]; the index is not locked while the answer is made.
    ///
    /// # Errors
    /// There is no such run, or `view` says no.
    pub async fn with_run<T: Send + 'static>(
        &self,
        run: String,
        view: impl FnOnce(&Arc<Run>) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let runs = self.runs.clone();
        blocking(move || view(&runs.find(&run)?)).await
    }
}

/// Runs a blocking function in a thread for blocking work.
///
/// # Errors
/// What `act` says; 500 when it panicked.
pub async fn blocking<T: Send + 'static>(
    act: impl FnOnce() -> Result<T, Problem> + Send + 'static,
) -> Result<T, Problem> {
    let failed = |_| Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "the answer failed");
    tokio::task::spawn_blocking(act).await.map_err(failed)?
}

#[derive(Debug)]
pub struct JsonText(Bytes);

pub type JsonResult = Result<JsonText, Problem>;

impl JsonText {
    /// The text of a value.
    ///
    /// # Errors
    /// It cannot be written as JSON.
    pub fn of<T: Serialize>(value: &T) -> Result<Self, Problem> {
        let text = serde_json::to_vec(value)
            .map_err(|error| Problem::new(StatusCode::INTERNAL_SERVER_ERROR, error.to_string()))?;
        Ok(Self(text.into()))
    }
}

impl IntoResponse for JsonText {
    fn into_response(self) -> Response {
        let kind = HeaderValue::from_static("application/json");
        ([(header::CONTENT_TYPE, kind)], self.0).into_response()
    }
}
