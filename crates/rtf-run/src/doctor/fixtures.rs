//! Checks the dependencies of the fixture managers that come with rtf, which are listed
//! in `needs.json` in their directory.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use rtf_plan::plan::{HostPlan, RunnerEnvironment, find_in_path, shipped_fixtures_dir};
use serde::Deserialize;

use super::{CheckResult, Component, Missing, components};

/// The fixture managers and their dependencies.
pub struct NeedsTable {
    dir: Option<PathBuf>,
    fixtures: BTreeMap<String, Needs>,
}

/// The dependencies of a fixture manager.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Needs {
    about: String,
    needs: Vec<Need>,
}

/// A dependency.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Need {
    /// Programs, one of which is needed.
    #[serde(default)]
    programs: Vec<String>,
    /// A module of the Python that runs plug-ins.
    module: Option<String>,
    install: String,
    /// The option that needs it; `None` if the fixture manager always does.
    #[serde(rename = "for")]
    purpose: Option<String>,
}

impl NeedsTable {
    /// Reads the dependencies of the installed fixture managers.
    pub fn read(runner: &RunnerEnvironment) -> io::Result<Self> {
        let Some(dir) = shipped_fixtures_dir(runner) else {
            return Ok(Self { dir: None, fixtures: BTreeMap::new() });
        };
        let file = dir.join("needs.json");
        let failed = |error: &dyn std::fmt::Display| {
            io::Error::other(format!("cannot read `{}`: {error}", file.display()))
        };
        let text = std::fs::read(&file).map_err(|error| failed(&error))?;
        let mut fixtures: BTreeMap<String, Needs> =
            serde_json::from_slice(&text).map_err(|error| failed(&error))?;
        fixtures.retain(|name, _| dir.join(name).with_extension("py").is_file());
        Ok(Self { dir: Some(dir), fixtures })
    }

    /// The installed fixture managers.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.fixtures.keys().map(String::as_str)
    }

    /// Checks the selected fixture managers.
    pub fn check(
        &self,
        runner: &RunnerEnvironment,
        is_selected: &dyn Fn(&str) -> bool,
    ) -> Vec<CheckResult> {
        let selected: Vec<_> = self.fixtures.iter().filter(|(name, _)| is_selected(name)).collect();
        if selected.is_empty() {
            return Vec::new();
        }
        let python = components::check_python(runner);
        let findings = selected.into_iter();
        findings.map(|(name, needs)| self.check_one(name, needs, &python, runner)).collect()
    }

    fn check_one(
        &self,
        name: &str,
        needs: &Needs,
        python: &Result<HostPlan, String>,
        runner: &RunnerEnvironment,
    ) -> CheckResult {
        let mut missing = Vec::new();
        let mut found = Vec::new();
        if let Err(error) = python {
            let install = "see `rtf doctor python`".to_owned();
            missing.push(Missing { what: error.clone(), install, purpose: None });
        }
        for need in &needs.needs {
            match need.find(python.as_ref().ok(), runner) {
                Some(location) => found.push(location),
                None => missing.push(Missing {
                    what: need.error(),
                    install: need.install.clone(),
                    purpose: need.purpose.clone(),
                }),
            }
        }
        if needs.needs.is_empty() {
            found.extend(self.dir.iter().map(|dir| dir.display().to_string()));
        }
        let ok = missing.iter().all(|missing| missing.purpose.is_some());
        let (name, about) = (name.to_owned(), needs.about.clone());
        CheckResult { name, part: Component::Fixture, ok, about, found, missing }
    }
}

impl Need {
    /// The location of the dependency.
    fn find(&self, python: Option<&HostPlan>, runner: &RunnerEnvironment) -> Option<String> {
        if let Some(module) = &self.module {
            let program = python?.command.first()?;
            return imports(program, module).then(|| format!("{module} in {program}"));
        }
        let files = self.programs.iter().filter_map(|name| find_in_path(name, runner));
        files.map(|file| file.display().to_string()).next()
    }

    fn error(&self) -> String {
        if let Some(module) = &self.module {
            return format!("the `python3` on PATH has no module `{module}`");
        }
        match self.programs.as_slice() {
            [program] => format!("`{program}` is not on PATH"),
            programs => format!("none of `{}` is on PATH", programs.join("`, `")),
        }
    }
}

/// Whether a Python interpreter can import a module.
fn imports(program: &str, module: &str) -> bool {
    let code = "import importlib, sys; importlib.import_module(sys.argv[1])";
    let mut command = Command::new(program);
    command.args(["-c", code, module]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
