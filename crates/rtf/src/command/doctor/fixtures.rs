//! What the fixture managers need that come with rtf. They say it themselves,
//! in the table `needs.json` of their folder.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use rtf_plan::plan::{HostPlan, RunnerEnvironment, find_in_path, shipped_fixtures_dir};
use serde::Deserialize;

use super::{Finding, Missing, Part, own};

/// The table, and the folder of the fixture managers.
pub struct Table {
    folder: Option<PathBuf>,
    fixtures: BTreeMap<String, Needs>,
}

/// What one fixture manager needs.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Needs {
    about: String,
    needs: Vec<Need>,
}

/// One thing that it needs.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Need {
    /// Programs, one of which has to be there.
    #[serde(default)]
    programs: Vec<String>,
    /// A module that the user's Python has to have.
    module: Option<String>,
    install: String,
    /// What of the fixture needs it; without it: all of it.
    #[serde(rename = "for")]
    purpose: Option<String>,
}

impl Table {
    /// Reads it. A fixture manager that is not there is not in it.
    pub fn read(surroundings: &RunnerEnvironment) -> io::Result<Self> {
        let Some(folder) = shipped_fixtures_dir(surroundings) else {
            return Ok(Self { folder: None, fixtures: BTreeMap::new() });
        };
        let file = folder.join("needs.json");
        let named = |error: &dyn std::fmt::Display| {
            io::Error::other(format!("cannot read `{}`: {error}", file.display()))
        };
        let text = std::fs::read(&file).map_err(|error| named(&error))?;
        let mut fixtures: BTreeMap<String, Needs> =
            serde_json::from_slice(&text).map_err(|error| named(&error))?;
        fixtures.retain(|name, _| folder.join(name).with_extension("py").is_file());
        Ok(Self { folder: Some(folder), fixtures })
    }

    /// The fixture managers that are there.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.fixtures.keys().map(String::as_str)
    }

    /// Looks at what is asked for.
    pub fn look(
        &self,
        surroundings: &RunnerEnvironment,
        is_asked: &dyn Fn(&str) -> bool,
    ) -> Vec<Finding> {
        let asked: Vec<_> = self.fixtures.iter().filter(|(name, _)| is_asked(name)).collect();
        if asked.is_empty() {
            return Vec::new();
        }
        let python = own::python(surroundings);
        let looked = asked.into_iter();
        looked.map(|(name, needs)| self.finding(name, needs, &python, surroundings)).collect()
    }

    fn finding(
        &self,
        name: &str,
        needs: &Needs,
        python: &Result<HostPlan, String>,
        surroundings: &RunnerEnvironment,
    ) -> Finding {
        let mut missing = Vec::new();
        let mut found = Vec::new();
        if let Err(why) = python {
            let install = "`rtf doctor python` tells more".to_owned();
            missing.push(Missing { what: why.clone(), install, purpose: None });
        }
        for need in &needs.needs {
            match need.look(python.as_ref().ok(), surroundings) {
                Some(there) => found.push(there),
                None => missing.push(Missing {
                    what: need.what(),
                    install: need.install.clone(),
                    purpose: need.purpose.clone(),
                }),
            }
        }
        if needs.needs.is_empty() {
            found.extend(self.folder.iter().map(|folder| folder.display().to_string()));
        }
        let ok = missing.iter().all(|missing| missing.purpose.is_some());
        let (name, about) = (name.to_owned(), needs.about.clone());
        Finding { name, part: Part::Fixture, ok, about, found, missing }
    }
}

impl Need {
    /// What is there of it.
    fn look(&self, python: Option<&HostPlan>, surroundings: &RunnerEnvironment) -> Option<String> {
        if let Some(module) = &self.module {
            let program = python?.command.first()?;
            return imports(program, module).then(|| format!("{module} of {program}"));
        }
        let files = self.programs.iter().filter_map(|name| find_in_path(name, surroundings));
        files.map(|file| file.display().to_string()).next()
    }

    fn what(&self) -> String {
        if let Some(module) = &self.module {
            return format!("the `python3` on PATH has no module `{module}`");
        }
        let names: Vec<_> = self.programs.iter().map(|name| format!("`{name}`")).collect();
        format!("there is no program {} on PATH", names.join(" or "))
    }
}

/// Whether the user's Python has a module.
fn imports(program: &str, module: &str) -> bool {
    let code = "import importlib, sys; importlib.import_module(sys.argv[1])";
    let mut command = Command::new(program);
    command.args(["-c", code, module]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
