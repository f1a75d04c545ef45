//! Runs the commands of a scheduler.

use std::io;
use std::path::PathBuf;
use std::process::{Output, Stdio};

use tokio::process::Command;

/// A command of a scheduler failed.
#[derive(Debug, thiserror::Error)]
pub enum ClusterError {
    /// A command could not be started.
    #[error("cannot execute `{command}`")]
    Execute {
        command: &'static str,
        /// The cause.
        #[source]
        source: io::Error,
    },
    /// A command reported an error.
    #[error("`{command}` failed: {message}")]
    Failed {
        command: &'static str,
        /// Its standard error.
        message: String,
    },
    /// The output of a command cannot be read.
    #[error("the output of `{command}` is invalid")]
    Invalid {
        command: &'static str,
        /// The cause.
        #[source]
        source: serde_json::Error,
    },
    /// A file of the submission cannot be read or written.
    #[error("cannot access `{}`", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The cause.
        #[source]
        source: io::Error,
    },
}

/// A command that a terminal's signals do not reach.
pub fn command(name: &'static str) -> Command {
    let mut command = Command::new(name);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
    command
}

/// Runs a command and returns its standard output.
pub async fn run(name: &'static str, mut command: Command) -> Result<String, ClusterError> {
    let child = command.spawn().map_err(|source| execute(name, source))?;
    let Output { status, stdout, stderr } =
        child.wait_with_output().await.map_err(|source| execute(name, source))?;
    if status.success() {
        return Ok(String::from_utf8_lossy(&stdout).into_owned());
    }
    let message = String::from_utf8_lossy(&stderr);
    let message = match message.trim() {
        "" => status.to_string(),
        text => text.lines().collect::<Vec<_>>().join("; "),
    };
    Err(ClusterError::Failed { command: name, message })
}

/// A command could not be started.
pub fn execute(command: &'static str, source: io::Error) -> ClusterError {
    ClusterError::Execute { command, source }
}
