//! The catalogue of hosts: the types of plug-ins, and how to start the host of each.
//!
//! A new host is a new entry here, and one in [`super::sdk`] for an interpreter; no other part
//! of the runner depends on it. The types of other test frameworks are in [`super::frameworks`].

use std::path::Path;

use super::frameworks;
use super::host_kind::{HostKind, HostStart};
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
        framework: None,
        start: shipped("rtf-host-native"),
    },
    HostKind {
        name: "lua",
        extensions: &["lua"],
        prefixes: &[""],
        library_path: None,
        class_prefix: None,
        framework: None,
        start: shipped("rtf-host-lua"),
    },
    HostKind {
        name: "python",
        extensions: &["py"],
        prefixes: &[""],
        library_path: None,
        class_prefix: Some("rtf."),
        framework: None,
        start: HostStart::Interpreter {
            program: "python3",
            variable: "RTF_PYTHON",
            arguments: &["-m", "rtf_start", "rtf.host"],
            sdk: &PYTHON_SDK,
            forks: true,
        },
    },
    HostKind {
        name: "ruby",
        extensions: &["rb"],
        prefixes: &[""],
        library_path: None,
        class_prefix: Some("RTF::"),
        framework: None,
        start: HostStart::Interpreter {
            program: "ruby",
            variable: "RTF_RUBY",
            arguments: &["-e", "require 'rtf/host'; RTF::Host.main", "--"],
            sdk: &RUBY_SDK,
            forks: false,
        },
    },
];

/// The host of the fixture `signals`, which no suite names.
pub(super) static SIGNALS: HostKind = HostKind {
    name: "signals",
    extensions: &[],
    prefixes: &[],
    library_path: None,
    class_prefix: None,
    framework: None,
    start: HostStart::Shipped {
        program: "rtf-host-signals",
        arguments: &[],
        sdk: None,
        forks: false,
    },
};

/// The host of the fixture `faults`, which no suite names.
pub(super) static FAULTS: HostKind = HostKind {
    name: "faults",
    extensions: &[],
    prefixes: &[],
    library_path: None,
    class_prefix: None,
    framework: None,
    start: HostStart::Shipped {
        program: "rtf-host-faults",
        arguments: &[],
        sdk: None,
        forks: false,
    },
};

const fn shipped(program: &'static str) -> HostStart {
    HostStart::Shipped { program, arguments: &[], sdk: None, forks: true }
}

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
