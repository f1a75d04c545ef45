//! A directory with the files of a table, in which they are planned.

use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use rtf_model::Diagnostic;
use rtf_plan::config::{ConfigFiles, RunConfig, input_dir};
use rtf_plan::plan::{self, CheckAnswer, CheckReport, InputPath, ListedCase, Options, PlanOutcome};
use rtf_plan::select::{Selection, parse, select};
use rtf_plan::suite::SourceText;

use crate::bench::Bench;

/// The cases that each program of another framework has.
const CASES: [&str; 2] = ["Arm.Moves", "Arm moves"];

/// An installation, and the program `read`.
pub fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.program("cell/read", "");
    bench.file("share/rtf/fixtures/clock.py", "FixtureManager");
    for module in ["__init__", "probe", "recorded_signals"].map(|name| format!("{name}.py")) {
        bench.file(&format!("share/rtf/fixtures/rtf_fixtures/{module}"), "");
    }
    for module in ["ros1_signals", "ros2_signals", "yarp_signals"] {
        bench.file(&format!("share/rtf/fixtures/rtf_fixtures/{module}.py"), "");
    }
    bench
}

/// Writes the files of a table, plans and selects.
pub struct Desk {
    bench: Bench,
    options: Options,
    inputs: Vec<InputPath>,
    filters: Vec<String>,
}

impl Desk {
    pub fn new() -> Self {
        let bench = bench();
        let options = bench.options.clone();
        Self { bench, options, inputs: Vec::new(), filters: Vec::new() }
    }

    fn prepare(&mut self, text: &str) {
        self.options = self.bench.options.clone();
        self.filters.clear();
        self.inputs = vec![InputPath::Any("s.xml".into())];
        std::fs::remove_dir_all(self.bench.root.join("cell")).unwrap();
        self.write("A.lua", "");
        for name in ["sim", "read"] {
            self.write(&format!("program {name}"), "#!/bin/sh\n");
        }
        let mut files = text.split("\n== ");
        self.write("s.xml", files.next().unwrap());
        for (name, text) in files.map(|file| file.split_once('\n').unwrap_or((file, ""))) {
            self.write(name, text);
        }
    }

    fn write(&mut self, name: &str, text: &str) {
        let bench = &self.bench;
        match (name, name.strip_prefix("program ")) {
            ("command line", _) => self.command_line(text),
            ("environment", _) => {
                let variables = text.lines().filter_map(|line| line.split_once('='));
                let variables = variables.map(|(name, value)| (name.to_owned(), value.to_owned()));
                self.options.runner.variables.extend(variables);
            }
            (_, Some(program)) => {
                let file = bench.file(&format!("cell/{program}"), text);
                let mode = std::fs::Permissions::from_mode(0o755);
                std::fs::set_permissions(file, mode).unwrap();
            }
            _ => drop(bench.file(&format!("cell/{name}"), text)),
        }
    }

    /// An input or an option on each line.
    fn command_line(&mut self, text: &str) {
        let mut inputs = Vec::new();
        let request = &mut self.options.config_request;
        for line in text.lines() {
            match line.split_once(' ').unwrap_or((line, "")) {
                ("--filter", filter) => self.filters.push(filter.to_owned()),
                ("--profile", name) => request.profile = Some(name.to_owned()),
                ("--set", pair) => {
                    let (name, value) = pair.split_once('=').unwrap();
                    request.params.push((name.to_owned(), value.to_owned()));
                }
                ("--recursive", _) => self.options.recursive = true,
                _ => inputs.push(InputPath::Any(line.into())),
            }
        }
        if !inputs.is_empty() {
            self.inputs = inputs;
        }
    }

    /// The messages and hints about the files, as `rtf run` would print them.
    pub fn problems(&mut self, text: &str) -> Vec<(String, Option<String>)> {
        self.prepare(text);
        let outcome = self.checked();
        let mut problems = outcome.diagnostics;
        let mut selection = Selection::default();
        for filter in &self.filters {
            match parse(&SourceText::new("filter", filter.as_str())) {
                Ok(filter) => selection.filters.push(filter),
                Err(problem) => problems.push(*problem),
            }
        }
        problems
            .extend(outcome.plan.into_iter().flat_map(|plan| select(plan, &selection).problems));
        problems.extend(self.conflicts());
        let root = self.bench.root.display().to_string();
        let hint = |hint: String| hint.replace(&root, "[ROOT]");
        problems.into_iter().map(|problem| (problem.message, problem.hint.map(hint))).collect()
    }

    /// Plans with hosts that list the cases of programs, and the classes in Python files.
    fn checked(&self) -> PlanOutcome {
        let draft = plan::draft(&self.inputs, &self.options);
        let case = |name| ListedCase { name: String::from(name), ..ListedCase::default() };
        let report = |file: &Path| {
            let text = std::fs::read_to_string(file).unwrap();
            let kinds = [("TestCase", "test"), ("FixtureManager", "fixture")].into_iter();
            let kinds = kinds.filter(|(class, _)| text.contains(class));
            let is_python = file.extension().is_some_and(|extension| extension == "py");
            CheckAnswer::Report(CheckReport {
                file: file.display().to_string(),
                ok: true,
                message: None,
                line: None,
                kinds: is_python.then(|| kinds.map(|(_, kind)| kind.to_owned()).collect()),
                cases: file.extension().is_none().then(|| CASES.map(case).to_vec()),
            })
        };
        let answers = draft.check_groups().iter().map(|group| group.files().map(report).collect());
        let answers = answers.collect();
        draft.finish(answers)
    }

    /// Values of the whole run that differ between the files of its suites.
    fn conflicts(&self) -> Vec<Diagnostic> {
        let cell = &self.options.runner.current_dir;
        let dirs = self.inputs.iter().filter_map(|input| match input {
            InputPath::Any(path) => Some(input_dir(&cell.join(path))),
            _ => None,
        });
        let dirs: Vec<_> = dirs.collect();
        let mut files = ConfigFiles::new(cell);
        let request = &self.options.config_request;
        RunConfig::collect(dirs.iter().map(AsRef::as_ref), request, &mut files).problems
    }
}
