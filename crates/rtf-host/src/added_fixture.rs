//! What the hosts of fixtures that `rtf` adds to suites have in common.

use std::path::Path;

use rtf_model::protocol::{Initialized, PROTOCOL_VERSION, Plugin, StackSupport};

use crate::{CheckedFile, LoadError, PluginKind};

/// Accepts every file for `--check`: there are no plug-ins.
#[must_use]
pub fn check(file: &Path) -> CheckedFile {
    CheckedFile::good(file, None)
}

/// Describes the host of the fixture `name`.
#[must_use]
pub fn describe(name: &str) -> Initialized {
    Initialized {
        protocol: PROTOCOL_VERSION,
        host: format!("{name} {}", env!("CARGO_PKG_VERSION")),
        stack: StackSupport::None,
        supports_shared: false,
        selects_cases: false,
        runs_episodes: false,
    }
}

/// Reads the settings that the runner passes to the fixture `name`.
///
/// # Errors
/// The plug-in is a test, or `read` fails.
pub fn settings<S>(
    name: &str,
    kind: PluginKind,
    plugin: &Plugin,
    read: impl FnOnce(&Plugin) -> Result<S, String>,
) -> Result<S, LoadError> {
    let settings = match kind {
        PluginKind::Fixture => read(plugin),
        PluginKind::Test => Err(format!("`{name}` is a fixture, not a test")),
    };
    settings.map_err(|message| LoadError { message, location: None })
}
