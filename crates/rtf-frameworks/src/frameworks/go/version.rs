//! The version of Go: `go test -json` of Go 1.19 does not separate the events of a test from
//! what it prints without a line feed.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::framework::ListError;
use crate::listing;

/// The minor version of Go 1 that is required.
const MINIMUM: u32 = 20;

/// `go env` only reads files, but a first call may download the toolchain of `go.mod`.
const LIMIT: Duration = Duration::from_secs(300);

/// Refuses a Go that is too old. The module in the directory can select another one than that
/// on `PATH`.
///
/// # Errors
/// It is too old, or cannot be run.
pub(super) fn check(dir: &Path) -> Result<(), ListError> {
    let mut command = Command::new("go");
    command.args(["env", "GOVERSION"]).current_dir(dir);
    let listed = listing::run(command, LIMIT)?;
    if !listed.status.success() {
        return Err(ListError::new(format!("`go env` failed\n{}", listed.quote())));
    }
    refuse_old(String::from_utf8_lossy(&listed.stdout).trim())
}

/// Versions of another form are those of development.
fn refuse_old(version: &str) -> Result<(), ListError> {
    let number = version.strip_prefix("go1.").unwrap_or_default();
    let minor = number.split(|char: char| !char.is_ascii_digit()).next().unwrap_or_default();
    match minor.parse::<u32>() {
        Ok(minor) if minor < MINIMUM => Err(ListError::new(format!(
            "`{version}` is too old: Go 1.{MINIMUM} or later is needed\n\
             Debian 12 has it in its backports: `apt-get install -t bookworm-backports golang-go`"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_go_without_separate_output_is_refused() {
        let error = refuse_old("go1.19.8").unwrap_err();
        let expected = "`go1.19.8` is too old: Go 1.20 or later is needed\nDebian 12 has it";
        assert!(error.message.starts_with(expected), "{error}");
        assert!(refuse_old("go1.9").is_err());
        for version in ["go1.20", "go1.20rc1", "go1.26.8 X:nodwarf5", "devel go1.27-ab12", "go2.0"]
        {
            assert_eq!(refuse_old(version), Ok(()), "{version}");
        }
    }
}
