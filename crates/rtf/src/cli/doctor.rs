//! Options of `rtf doctor`.

use clap::{Args, ValueEnum};

/// What to look at.
#[derive(Debug, Args)]
pub struct DoctorArgs {
    /// Only these: fixture managers (`roslaunch`), or parts of rtf (`python`, `network`)
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,

    /// The form of what is found
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: DoctorFormat,
}

/// The form of what is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DoctorFormat {
    /// For people
    Text,
    /// One JSON document
    Json,
}
