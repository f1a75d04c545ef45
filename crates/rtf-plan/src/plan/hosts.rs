//! The catalogue of hosts: the types of plug-ins, and how to start the host of each.
//!
//! A new host is a new entry here, and one in [`super::sdk`] for an interpreter; no other part
//! of the runner depends on it. The types of other test frameworks are in [`super::frameworks`].

use std::path::Path;

use super::frameworks;
use super::host_kind::{HostKind, SHIPPED};
use super::sdk::{PYTHON_SDK, RUBY_SDK};

const NATIVE_EXTENSIONS: &[&str] = if cfg!(target_os = "macos") {
    &["dylib", "so"]
} else if cfg!(windows) {
    &["dll"]
} else {
    &["so"]
};

const LIBRARY_PATH: &str = if cfg!(target_os = "macos") {
    "DYLD_LIBRARY_PATH"
} else if cfg!(windows) {
    "PATH"
} else {
    "LD_LIBRARY_PATH"
};

/// The hosts of plug-ins; the first is the default type.
pub(super) static HOSTS: [HostKind; 4] = [
    HostKind {
        name: "dll",
        extensions: NATIVE_EXTENSIONS,
        prefixes: &["", "lib"],
        library_path: Some(LIBRARY_PATH),
        class_prefix: Some("rtf::"),
        program: "rtf-host-native",
        forks: true,
        ..SHIPPED
    },
    HostKind { name: "lua", extensions: &["lua"], program: "rtf-host-lua", forks: true, ..SHIPPED },
    HostKind {
        name: "python",
        extensions: &["py"],
        class_prefix: Some("rtf."),
        program: "python3",
        variable: Some("RTF_PYTHON"),
        arguments: &["-m", "rtf_start", "rtf.host"],
        sdk: Some(&PYTHON_SDK),
        forks: true,
        ..SHIPPED
    },
    HostKind {
        name: "ruby",
        extensions: &["rb"],
        class_prefix: Some("RTF::"),
        program: "ruby",
        variable: Some("RTF_RUBY"),
        arguments: &["-e", "require 'rtf/host'; RTF::Host.main", "--"],
        sdk: Some(&RUBY_SDK),
        ..SHIPPED
    },
];

/// The host of the fixture `signals`, which no suite names.
pub(super) static SIGNALS: HostKind =
    HostKind { name: "signals", program: "rtf-host-signals", ..SHIPPED };

/// The host of the fixture `faults`, which no suite names.
pub(super) static FAULTS: HostKind =
    HostKind { name: "faults", program: "rtf-host-faults", ..SHIPPED };

/// Returns the type of this name, ignoring case as 2.x did.
pub(super) fn by_name(name: &str) -> Option<&'static HostKind> {
    let plugins = HOSTS.iter().find(|kind| kind.name.eq_ignore_ascii_case(name));
    plugins.or_else(|| frameworks::by_name(name))
}

/// Returns the type of a file by its extension; a directory `my.sources` in the
/// path is irrelevant.
pub(super) fn by_extension(file: &Path) -> Option<&'static HostKind> {
    let extension = file.extension()?.to_str()?;
    // Suites of other platforms use these names for libraries.
    if ["so", "dylib", "dll"].contains(&extension) {
        return Some(&HOSTS[0]);
    }
    HOSTS.iter().find(|kind| kind.extensions.contains(&extension))
}
