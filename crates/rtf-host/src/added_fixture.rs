//! What the hosts of fixtures that `rtf` adds to suites have in common.

use rtf_model::protocol::{Initialized, PROTOCOL_VERSION, Plugin, StackSupport};

use crate::{LoadError, PluginKind};

/// Describes the host of the fixture `name`.
#[must_use]
pub fn describe(name: &str) -> Initialized {
    Initialized {
        protocol: PROTOCOL_VERSION,
        host: format!("{name} {}", env!("CARGO_PKG_VERSION")),
        stack: StackSupport::None,
        supports_shared: false,
        selects_cases: false,
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
