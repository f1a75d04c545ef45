//! The catalogue of hosts: the types of plug-ins, and how to start the host of each.
//!
//! A new host is a new entry here; no other part of the runner depends on it.

use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::HostPlan;
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
    start: HostStart,
}

/// The ways to start a host.
#[derive(Debug)]
enum HostStart {
    /// A program that comes with `rtf`.
    Shipped { program: &'static str },
    /// The user's interpreter with a module that comes with `rtf`.
    Interpreter {
        /// The name in `PATH`.
        program: &'static str,
        /// The variable that selects another program.
        variable: &'static str,
        arguments: &'static [&'static str],
        sdk: Sdk,
        /// Whether the module can run as a fork server.
        forks: bool,
    },
}

/// The location of the interpreter's module.
#[derive(Debug)]
struct Sdk {
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

/// All hosts; the first is the default type.
pub(super) static HOSTS: [HostKind; 4] = [
    HostKind {
        name: "dll",
        extensions: NATIVE_EXTENSIONS,
        prefixes: &["", "lib"],
        library_path: Some(LIBRARY_PATH),
        class_prefix: Some("rtf::"),
        start: HostStart::Shipped { program: "rtf-host-native" },
    },
    HostKind {
        name: "lua",
        extensions: &["lua"],
        prefixes: &[""],
        library_path: None,
        class_prefix: None,
        start: HostStart::Shipped { program: "rtf-host-lua" },
    },
    HostKind {
        name: "python",
        extensions: &["py"],
        prefixes: &[""],
        library_path: None,
        class_prefix: Some("rtf."),
        start: HostStart::Interpreter {
            program: "python3",
            variable: "RTF_PYTHON",
            arguments: &["-m", "rtf.host"],
            sdk: Sdk {
                installed: "share/rtf/python",
                source: "sdk/python",
                marker: "rtf/host",
                variable: "PYTHONPATH",
            },
            forks: true,
        },
    },
    HostKind {
        name: "ruby",
        extensions: &["rb"],
        prefixes: &[""],
        library_path: None,
        class_prefix: Some("RTF::"),
        start: HostStart::Interpreter {
            program: "ruby",
            variable: "RTF_RUBY",
            arguments: &["-e", "require 'rtf/host'; RTF::Host.main", "--"],
            sdk: Sdk {
                installed: "share/rtf/ruby/lib",
                source: "sdk/ruby/lib",
                marker: "rtf/host.rb",
                variable: "RUBYLIB",
            },
            forks: false,
        },
    },
];

/// Returns the type of this name, ignoring case as 2.x did.
pub(super) fn by_name(name: &str) -> Option<&'static HostKind> {
    HOSTS.iter().find(|kind| kind.name.eq_ignore_ascii_case(name))
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
            HostStart::Shipped { program } => {
                let file = shipped_host(program, scope)?;
                Ok(HostPlan { command: vec![utf8(&file)?], env: Vec::new(), forks: true })
            }
            HostStart::Interpreter { program, variable, arguments, sdk, forks } => {
                let file = interpreter(self.name, program, variable, scope)?;
                let mut command = vec![utf8(&file)?];
                command.extend(arguments.iter().map(|argument| (*argument).to_owned()));
                Ok(HostPlan { command, env: sdk.env(scope)?, forks: *forks })
            }
        }
    }
}

impl Sdk {
    /// Puts the module's directory before the user's ones. If the directory is
    /// missing, the interpreter may still find an installed module.
    fn env(&self, scope: &SearchScope<'_>) -> Result<Vec<(String, String)>, Box<Diagnostic>> {
        let executable = &scope.runner.executable;
        let installed = scope.runner.prefix().map(|prefix| prefix.join(self.installed));
        let source = executable.ancestors().skip(1).map(|dir| dir.join(self.source));
        let found = installed.into_iter().chain(source).find(|sdk| sdk.join(self.marker).exists());
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
