//! Arguments → request: what the user asks for, with the values of `rtf.toml` and of
//! past runs filled in. Everything after this stage reads the request only.

pub mod cluster;
pub mod config;
mod inputs;
pub mod local_run;
mod output;
pub mod run;

use std::path::PathBuf;

use rtf_engine::locks;
use rtf_run::error::Failure;
use rtf_run::history::HistoryTarget;
use rtf_web::{Limits, Settings};

use crate::cli::{HistoryFileArgs, ResultsArgs, WebAccessArgs};

pub use inputs::{tests, tests_of_suite};

/// Where runs and campaigns are imported; `None`: they are not.
pub fn target(
    no_history: bool,
    history: &HistoryFileArgs,
    results: &ResultsArgs,
) -> Result<Option<HistoryTarget>, Failure> {
    let resolve = || HistoryTarget::resolve(history.history.as_deref(), &results.results);
    (!no_history).then(resolve).transpose()
}

/// The settings of a web server.
pub fn web_settings(address: std::net::SocketAddr, args: &WebAccessArgs) -> Settings {
    Settings {
        address,
        allow_remote: args.web_allow_remote,
        token_file: args.web_token_file.clone(),
        tls: args.web_cert.clone().zip(args.web_key.clone()),
        hosts: args.web_hosts.clone(),
        limits: Limits::default(),
    }
}

/// The directory of this machine's locks.
pub fn locks_dir() -> PathBuf {
    let dir = std::env::var_os(locks::DIR_VARIABLE).filter(|dir| !dir.is_empty());
    dir.map_or_else(|| PathBuf::from(locks::DEFAULT_DIR), PathBuf::from)
}
