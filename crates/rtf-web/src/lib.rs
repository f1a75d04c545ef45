//! Live and past runs in a browser: a page, an API, a stream of events.
//!
//! The server reads only journals, also that of the live run; see `spec/web.md`.
//! [`BoundServer::serve`] serves in a separate thread. A request finds its run in
//! [`runs`], which follows the run's journal with an [`index`]: a lean
//! [`rtf_model::Record`] and the positions of details in the journal. [`api`] creates
//! responses from it, [`feed`] event streams. [`access`] checks every request.
//!
//! The server does not slow down the run, which only contains its [`JournalNotifier`].

mod access;
mod api;
mod app;
mod campaign_report;
mod capabilities;
mod connections;
mod feed;
mod history_source;
pub mod html_report;
mod index;
mod journal_notifier;
mod legacy;
mod metrics;
mod page;
mod problem;
mod regular_file;
mod routes;
mod runs;
mod server;
mod stream_file;
mod tls;

pub use access::{TokenError, WrongToken};
pub use api::{description, model};
pub use campaign_report::{
    CampaignCell, CampaignMap, CampaignMapRow, CampaignParameter, CampaignProgress, CampaignReport,
    CampaignSource, EpisodeProblem,
};
pub use capabilities::{
    AnswerRequest, Capabilities, FinishedRun, RerunRejected, RunControl, RunStarter,
};
pub use connections::Limits;
pub use history_source::{HistorySource, TestCondition};
pub use journal_notifier::JournalNotifier;
pub use routes::Routes;
pub use server::{BoundServer, ServeError, Service, Settings, ShutdownHandle, WebServer};
pub use tls::TlsError;
