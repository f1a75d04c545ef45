//! A type of plug-ins or tests, and how to start its host.

use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::HostPlan;
use super::framework_kind::Framework;
use super::program::{self, in_path, list, searched_path, utf8};
use super::sdk::Sdk;
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
    /// The host: a program that comes with `rtf`, or the name of an interpreter in `PATH`.
    pub program: &'static str,
    /// For the user's interpreter, the variable that selects another one.
    pub variable: Option<&'static str>,
    pub arguments: &'static [&'static str],
    /// The SDK that comes with `rtf`: the module of an interpreter, or what tests can import.
    pub sdk: Option<&'static Sdk>,
    /// Whether it can run as a fork server.
    pub forks: bool,
}

/// A host that comes with `rtf`, for entries of the catalogues.
pub(super) const SHIPPED: HostKind = HostKind {
    name: "",
    extensions: &[],
    prefixes: &[""],
    library_path: None,
    class_prefix: None,
    framework: None,
    program: "",
    variable: None,
    arguments: &[],
    sdk: None,
    forks: false,
};

impl HostKind {
    /// Finds the host for processes in `scope`.
    pub fn locate(&self, scope: &SearchScope<'_>) -> Result<HostPlan, Box<Diagnostic>> {
        let file = match self.variable {
            Some(variable) => interpreter(self.name, self.program, variable, scope)?,
            None => shipped_host(self.program, scope)?,
        };
        let env = self.sdk.map(|sdk| sdk.env(scope)).transpose()?.unwrap_or_default();
        Ok(HostPlan { command: command(&file, self.arguments)?, env, forks: self.forks })
    }
}

fn command(program: &Path, arguments: &[&str]) -> Result<Vec<String>, Box<Diagnostic>> {
    let arguments = arguments.iter().map(|argument| (*argument).to_owned());
    Ok(std::iter::once(utf8(program)?).chain(arguments).collect())
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
        return program::find(selected, &base).map_err(|mut problem| {
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
