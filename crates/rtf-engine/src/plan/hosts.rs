//! The catalogue of hosts: which types there are, and how each is started.
//!
//! A new host is a new entry here; nothing else in the runner knows of it.

use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::HostPlan;
use super::program::{in_path, searched};
use super::scope::Scope;
use super::unix::is_executable;

/// One type of plug-ins.
#[derive(Debug)]
pub(super) struct HostKind {
    /// The type as suites write it.
    pub name: &'static str,
    /// The extensions of its plug-ins, the usual one first.
    pub extensions: &'static [&'static str],
    /// What may stand before a plug-in's name.
    pub prefixes: &'static [&'static str],
    /// A variable of the platform with folders of such plug-ins.
    pub library_path: Option<&'static str>,
    /// What stands before `TestCase` and `FixtureManager` where plug-ins are
    /// classes that derive from them.
    pub classes_in: Option<&'static str>,
    start: Start,
}

/// How a host is started.
#[derive(Debug)]
enum Start {
    /// A program that comes with rtf.
    Own { program: &'static str },
    /// The user's interpreter with a module of ours.
    Interpreter {
        /// Its name in `PATH`.
        program: &'static str,
        /// The variable that names another one.
        variable: &'static str,
        arguments: &'static [&'static str],
        sdk: Sdk,
        /// Whether our module can be a server that forks hosts.
        forks: bool,
    },
}

/// Where an interpreter finds our module.
#[derive(Debug)]
struct Sdk {
    /// The folder below the installation's prefix.
    installed: &'static str,
    /// The folder below the root of the source tree.
    source: &'static str,
    /// What is in that folder.
    marker: &'static str,
    /// The interpreter's variable for such folders.
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

/// All of them; the first is the type of a test that does not say its own.
pub(super) static HOSTS: [HostKind; 4] = [
    HostKind {
        name: "dll",
        extensions: NATIVE_EXTENSIONS,
        prefixes: &["", "lib"],
        library_path: Some(LIBRARY_PATH),
        classes_in: Some("rtf::"),
        start: Start::Own { program: "rtf-host-native" },
    },
    HostKind {
        name: "lua",
        extensions: &["lua"],
        prefixes: &[""],
        library_path: None,
        classes_in: None,
        start: Start::Own { program: "rtf-host-lua" },
    },
    HostKind {
        name: "python",
        extensions: &["py"],
        prefixes: &[""],
        library_path: None,
        classes_in: Some("rtf."),
        start: Start::Interpreter {
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
        classes_in: Some("RTF::"),
        start: Start::Interpreter {
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

/// The type of this name. The predecessor took capital letters, too.
pub(super) fn by_name(name: &str) -> Option<&'static HostKind> {
    HOSTS.iter().find(|kind| kind.name.eq_ignore_ascii_case(name))
}

/// The type that a file's own extension tells. The rest of the path does not
/// count: a folder `my.sources` is not a shared library.
pub(super) fn by_extension(file: &Path) -> Option<&'static HostKind> {
    let extension = file.extension()?.to_str()?;
    // A suite that was written on another platform names its libraries so.
    if ["so", "dylib", "dll"].contains(&extension) {
        return Some(&HOSTS[0]);
    }
    HOSTS.iter().find(|kind| kind.extensions.contains(&extension))
}

impl HostKind {
    /// How to start this host for processes in `scope`.
    pub fn locate(&self, scope: &Scope<'_>) -> Result<HostPlan, Box<Diagnostic>> {
        match &self.start {
            Start::Own { program } => {
                let file = own_program(program, scope)?;
                Ok(HostPlan { command: vec![text(&file)?], env: Vec::new(), forks: true })
            }
            Start::Interpreter { program, variable, arguments, sdk, forks } => {
                let file = interpreter(self.name, program, variable, scope)?;
                let mut command = vec![text(&file)?];
                command.extend(arguments.iter().map(|argument| (*argument).to_owned()));
                Ok(HostPlan { command, env: sdk.env(scope)?, forks: *forks })
            }
        }
    }
}

impl Sdk {
    /// The folder of our module before the user's own ones. Without the
    /// folder the interpreter may still know the module by itself.
    fn env(&self, scope: &Scope<'_>) -> Result<Vec<(String, String)>, Box<Diagnostic>> {
        let executable = &scope.surroundings.executable;
        let installed = scope.surroundings.prefix().map(|prefix| prefix.join(self.installed));
        let source = executable.ancestors().skip(1).map(|folder| folder.join(self.source));
        let found = installed.into_iter().chain(source).find(|sdk| sdk.join(self.marker).exists());
        let Some(folder) = found else { return Ok(Vec::new()) };
        let mut value = text(&folder)?;
        if let Some(own) = scope.variable(self.variable).filter(|own| !own.is_empty()) {
            value.push(if cfg!(windows) { ';' } else { ':' });
            value.push_str(own);
        }
        Ok(vec![(self.variable.to_owned(), value)])
    }
}

/// The user's Python, for programs of ours.
pub(super) fn python(scope: &Scope<'_>) -> Result<PathBuf, Box<Diagnostic>> {
    interpreter("python", "python3", "RTF_PYTHON", scope)
}

/// A host of ours: beside `rtf`, below its prefix, or in `PATH`.
fn own_program(program: &str, scope: &Scope<'_>) -> Result<PathBuf, Box<Diagnostic>> {
    let beside = scope.surroundings.executable.parent().map(Path::to_path_buf);
    let libexec = scope.surroundings.prefix().map(|prefix| prefix.join("libexec/rtf"));
    let folders: Vec<PathBuf> = beside.into_iter().chain(libexec).collect();
    let nearby = folders.iter().map(|folder| folder.join(program)).find(|file| is_executable(file));
    nearby.or_else(|| in_path(program, scope)).ok_or_else(|| {
        let list: Vec<_> = folders.iter().map(|folder| format!("  {}", folder.display())).collect();
        Diagnostic::error("no-such-host", format!("the host `{program}` is not there"))
            .note(format!("searched\n{}", list.join("\n")))
            .note(searched(scope))
            .hint("it is built and installed together with `rtf`")
            .into()
    })
}

/// The user's interpreter: the one of the active virtual environment is the
/// first in `PATH`.
fn interpreter(
    kind: &str,
    program: &str,
    variable: &str,
    scope: &Scope<'_>,
) -> Result<PathBuf, Box<Diagnostic>> {
    if let Some(wanted) = scope.variable(variable).filter(|wanted| !wanted.is_empty()) {
        let base = scope.base(variable);
        let within = Scope { folder: base, beside: None, ..*scope };
        return super::program::find(wanted, &within).map_err(|mut problem| {
            problem.code = "no-such-interpreter".into();
            problem.message = format!("the interpreter `{wanted}` is not there");
            problem.note(format!("`{variable}` names it")).into()
        });
    }
    in_path(program, scope).ok_or_else(|| {
        let message = format!("plug-ins of type `{kind}` need `{program}`, which is not there");
        Diagnostic::error("no-such-interpreter", message)
            .note(searched(scope))
            .hint(format!("install it, or name another one in `{variable}`"))
            .into()
    })
}

/// A path for a command line and for the protocol, which are UTF-8.
pub(super) fn text(path: &Path) -> Result<String, Box<Diagnostic>> {
    path.to_str().map(str::to_owned).ok_or_else(|| {
        let message = format!("the path `{}` is not UTF-8", path.display());
        Diagnostic::error("path-encoding", message).into()
    })
}
