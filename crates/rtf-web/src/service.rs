//! What is served, and how.

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_report::console::TestCommands;

use crate::access::{TokenError, WrongToken};
use crate::campaign_report::CampaignSource;
use crate::capabilities::Capabilities;
use crate::connections::Limits;
use crate::history_source::HistorySource;
use crate::tls::TlsError;

#[derive(Clone, Debug)]
pub struct Settings {
    /// Where to listen. Port 0 is any that is free.
    pub address: SocketAddr,
    /// Whether clients on other machines may connect.
    pub allow_remote: bool,
    /// A file with the token; a new one is made without it.
    pub token_file: Option<PathBuf>,
    /// A certificate and its key.
    pub tls: Option<(PathBuf, PathBuf)>,
    /// Other names under which this server is reached.
    pub hosts: Vec<String>,
    pub limits: Limits,
}

#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The address is not of this machine alone.
    #[error("`{0}` can be reached from beyond this machine")]
    Remote(IpAddr),
    #[error("cannot listen on `{address}`")]
    Listen {
        address: SocketAddr,
        #[source]
        source: io::Error,
    },
    #[error(transparent)]
    Token(#[from] TokenError),
    #[error(transparent)]
    Tls(#[from] TlsError),
    #[error("cannot start the server")]
    Start(#[source] io::Error),
}

impl ServeError {
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Remote(_) => Some(
                "`--web-allow-remote` allows that: reading then needs the token, and TLS is used",
            ),
            Self::Token(TokenError::Open { .. }) => {
                Some("`chmod 600` it: who has the token controls the run")
            }
            Self::Listen { .. } => Some("choose another address with `--web=ADDR:PORT`"),
            _ => None,
        }
    }
}

pub struct Service<'a> {
    pub results: &'a Path,
    pub history: Arc<dyn HistorySource>,
    pub campaigns: Arc<dyn CampaignSource>,
    /// Whether `/metrics` shows the history.
    pub metrics: bool,
    pub role: Capabilities,
    /// Creates the functions that return the commands for rerunning and replaying a test.
    pub commands: fn() -> TestCommands,
    pub wrong_token: Box<dyn Fn(WrongToken) + Send>,
}
