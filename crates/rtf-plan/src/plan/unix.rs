//! File permissions on Unix.

use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

/// Checks whether any user may execute a file.
pub(super) fn is_executable(file: &Path) -> bool {
    file.metadata().is_ok_and(|found| found.is_file() && found.permissions().mode() & 0o111 != 0)
}
