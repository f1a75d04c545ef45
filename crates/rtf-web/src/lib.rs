//! Live and past runs in a browser: a page, an API, a stream of events.
//!
//! The server reads only journals, also that of the live run; see `spec/web.md`.
//! [`BoundServer::serve`] serves in a separate thread. A request finds its run in
//! [`runs`], which follows the run's journal with an [`index`]: a lean
//! [`rtf_model::Record`] and the positions of details in the journal. [`api`] responds with [`views`] of it,
//! [`feed`] with event streams. [`access`] checks every request.
//!
//! The server does not slow down the run, which only contains its [`JournalNotifier`].

mod access;
mod address;
mod api;
mod app;
mod attached_file;
mod byte_range;
mod campaign_report;
mod capabilities;
mod connections;
mod feed;
mod header;
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
mod service;
mod stream_file;
mod tls;
mod views;

pub use access::{TokenError, WrongToken};
pub use api::description;
pub use campaign_report::{
    CampaignCell, CampaignMap, CampaignMapRow, CampaignParameter, CampaignProgress, CampaignReport,
    CampaignSource, CampaignVersionRate, CampaignVersions, EpisodeAttempt, EpisodeProblem,
    EpisodeRanking, EpisodeRun, RankedEpisode,
};
pub use capabilities::{
    AnswerRequest, Capabilities, FinishedRun, RerunRejected, RunControl, RunStarter,
};
pub use connections::Limits;
pub use history_source::{HistorySource, TestCondition};
pub use journal_notifier::JournalNotifier;
pub use routes::Routes;
pub use server::{BoundServer, ShutdownHandle, WebServer};
pub use service::{ServeError, Service, Settings};
pub use tls::TlsError;
pub use views::model;
