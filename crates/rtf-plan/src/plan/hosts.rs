//! The catalogue of hosts: the types of plug-ins, and how to start the host of each.
//!
//! A new host is a new entry here; no other part of the runner depends on it. The types of
//! other test frameworks are in [`super::frameworks`].

use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::HostPlan;
use super::frameworks::{self, Framework};
use super::program::{in_path, list, searched_path, utf8};
use super::search_scope::SearchScope;
use super::unix::is_executable;

/// A type of plug-ins and its host.
#[derive(Debug)]
pub(super) struct HostKind {
    /// The name of the type in suites.
    pub name: &'static str,
    /// The extensions of its plug-ins, the usual one first.
    pub extensions: &'static [&'static str],
    /// Prefixes of the file names, the usual one first.
    pub prefixes: &'static [&'static str],
    /// The platform's variable with the directories of such plug-ins.
    pub library_path: Option<&'static str>,
    /// The namespace of the base classes `TestCase` and `FixtureManager`, with its separator.
    pub class_prefix: Option<&'static str>,
    /// For a type whose tests another framework runs.
    pub framework: Option<Framework>,
    /// How to start its host.
    pub start: HostStart,
}

/// The ways to start a host.
#[derive(Debug)]
pub(super) enum HostStart {
    /// A program that comes with `rtf`.
    Shipped {
        program: &'static str,
        arguments: &'static [&'static str],
        /// The SDK that its tests can import.
        sdk: Option<&'static Sdk>,
        /// Whether it can run as a fork server.
        forks: bool,
    },
    /// The user's interpreter with a module that comes with `rtf`.
    Interpreter {
        /// The name in `PATH`.
        program: &'static str,
        /// The variable that selects another program.
        variable: &'static str,
        arguments: &'static [&'static str],
        sdk: &'static Sdk,
        /// Whether the module can run as a fork server.
        forks: bool,
    },
}

/// The location of the interpreter's module.
#[derive(Debug)]
pub(super) struct Sdk {
    /// The directory in the installation's prefix.
    installed: &'static str,
    /// The directory in the source tree.
    source: &'static str,
    /// A path that exists in that directory.
    marker: &'static str,
    /// The interpreter's variable for module directories.
    variable: &'static str,
}

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

/// The Python SDK, with the host of Python plug-ins.
pub(super) static PYTHON_SDK: Sdk = Sdk {
    installed: "share/rtf/python",
    source: "sdk/python",
    marker: "rtf/host",
    variable: "PYTHONPATH",
};

static RUBY_SDK: Sdk = Sdk {
    installed: "share/rtf/ruby/lib",
    source: "sdk/ruby/lib",
    marker: "rtf/host.rb",
    variable: "RUBYLIB",
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
            arguments: &["-m", "rtf.host"],
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

impl HostKind {
    /// Finds the host for processes in `scope`.
    pub fn locate(&self, scope: &SearchScope<'_>) -> Result<HostPlan, Box<Diagnostic>> {
        match &self.start {
            HostStart::Shipped { program, arguments, sdk, forks } => {
                let file = shipped_host(program, scope)?;
                let env = sdk.map(|sdk| sdk.env(scope)).transpose()?.unwrap_or_default();
                Ok(HostPlan { command: command(&file, arguments)?, env, forks: *forks })
            }
            HostStart::Interpreter { program, variable, arguments, sdk, forks } => {
                let file = interpreter(self.name, program, variable, scope)?;
                let command = command(&file, arguments)?;
                Ok(HostPlan { command, env: sdk.env(scope)?, forks: *forks })
            }
        }
    }
}

fn command(program: &Path, arguments: &[&str]) -> Result<Vec<String>, Box<Diagnostic>> {
    let arguments = arguments.iter().map(|argument| (*argument).to_owned());
    Ok(std::iter::once(utf8(program)?).chain(arguments).collect())
}

impl Sdk {
    /// Puts the module's directory before the user's ones. If the directory is
    /// missing, the interpreter may still find an installed module.
    fn env(&self, scope: &SearchScope<'_>) -> Result<Vec<(String, String)>, Box<Diagnostic>> {
        let found = scope.runner.shipped(&[self.installed], self.source, self.marker);
        let Some(dir) = found else { return Ok(Vec::new()) };
        let mut value = utf8(&dir)?;
        if let Some(user) = scope.variable(self.variable).filter(|user| !user.is_empty()) {
            value.push(if cfg!(windows) { ';' } else { ':' });
            value.push_str(user);
        }
        Ok(vec![(self.variable.to_owned(), value)])
    }
}

/// Finds the user's Python.
pub(super) fn python(scope: &SearchScope<'_>) -> Result<PathBuf, Box<Diagnostic>> {
    interpreter("python", "python3", "RTF_PYTHON", scope)
}

/// Finds a host that comes with `rtf`: next to `rtf`, in its prefix, or in `PATH`.
fn shipped_host(program: &str, scope: &SearchScope<'_>) -> Result<PathBuf, Box<Diagnostic>> {
    let executable_dir = scope.runner.executable.parent().map(Path::to_path_buf);
    let libexec = scope.runner.prefix().map(|prefix| prefix.join("libexec/rtf"));
    let dirs: Vec<PathBuf> = executable_dir.into_iter().chain(libexec).collect();
    let installed = dirs.iter().map(|dir| dir.join(program)).find(|file| is_executable(file));
    installed.or_else(|| in_path(program, scope)).ok_or_else(|| {
        Diagnostic::error("no-such-host", format!("the host `{program}` is missing"))
            .note(format!("searched\n{}", list(&dirs)))
            .note(searched_path(scope))
            .hint("it is built and installed together with `rtf`")
            .into()
    })
}

/// Finds the user's interpreter. The one of an active virtual environment is
/// first in `PATH`.
fn interpreter(
    kind: &str,
    program: &str,
    variable: &str,
    scope: &SearchScope<'_>,
) -> Result<PathBuf, Box<Diagnostic>> {
    if let Some(selected) = scope.variable(variable).filter(|selected| !selected.is_empty()) {
        let base = SearchScope { dir: scope.base(variable), fallback_dir: None, ..*scope };
        return super::program::find(selected, &base).map_err(|mut problem| {
            problem.code = "no-such-interpreter".into();
            problem.message = format!("the interpreter `{selected}` is missing");
            problem.note(format!("`{variable}` selects it")).into()
        });
    }
    in_path(program, scope).ok_or_else(|| {
        let message = format!("plug-ins of type `{kind}` need `{program}`, which is missing");
        Diagnostic::error("no-such-interpreter", message)
            .note(searched_path(scope))
            .hint(format!("install it, or select another one in `{variable}`"))
            .into()
    })
}
