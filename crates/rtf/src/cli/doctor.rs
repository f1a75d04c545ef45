//! Options of `rtf doctor`.

use clap::{Args, ValueEnum};

/// Options of `rtf doctor`.
#[derive(Debug, Args)]
pub struct DoctorArgs {
    /// Check only these fixture managers (`roslaunch`) or parts of rtf (`python`, `network`)
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: DoctorFormat,
}

/// The format of the findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DoctorFormat {
    /// Text for people
    Text,
    /// One JSON document
    Json,
}
