//! A temporary directory with an installation, whose hosts are shell scripts, and
//! with suites and plug-ins.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use jiff::civil::date;
use rtf_plan::plan::{self, InputPath, Options, Plan, PlanDraft, PlanOutcome, RunnerEnvironment};

pub struct Bench {
    /// Removes the files when dropped.
    _dir: tempfile::TempDir,
    pub root: PathBuf,
    pub options: Options,
}

impl Bench {
    /// Creates `bin/` with `rtf` and its hosts, and the empty current directory `cell/`.
    pub fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        let root = dir.path().canonicalize().unwrap();
        std::fs::create_dir(root.join("cell")).unwrap();
        let variables =
            [("PATH".to_owned(), format!("{}:/usr/bin:/bin", root.join("bin").display()))];
        let runner = RunnerEnvironment {
            current_dir: root.join("cell"),
            executable: root.join("bin/rtf"),
            variables: variables.into_iter().collect(),
        };
        let options = Options::new(runner, date(2026, 7, 1));
        let bench = Self { _dir: dir, root, options };
        let hosts = ["native", "lua", "framework", "signals", "faults"];
        let hosts = hosts.map(|host| format!("rtf-host-{host}"));
        for host in hosts.iter().map(String::as_str).chain(["python3"]) {
            bench.program(&format!("bin/{host}"), "exit 0");
        }
        bench
    }

    /// Writes a file below the root and creates its directory.
    pub fn file(&self, path: &str, text: &str) -> PathBuf {
        let path = self.root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Writes an executable shell script below the root.
    ///
    /// A separate process writes it: a host that another test starts meanwhile would
    /// inherit a descriptor opened here, and the script could not be executed
    /// ("text file busy").
    pub fn program(&self, path: &str, script: &str) -> PathBuf {
        let path = self.root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let mut shell = Command::new("/bin/sh")
            .args(["-c", "cat > \"$0\" && chmod 755 \"$0\""])
            .arg(&path)
            .stdin(Stdio::piped())
            .spawn()
            .unwrap();
        let text = format!("#!/bin/sh\n{script}\n");
        shell.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        assert!(shell.wait().unwrap().success());
        path
    }

    pub fn set(&mut self, variable: &str, value: &str) {
        self.options.runner.variables.insert(variable.to_owned(), value.to_owned());
    }

    /// Plans paths without checking the plug-ins.
    pub fn draft(&self, paths: &[&str]) -> PlanDraft {
        let inputs: Vec<_> = paths.iter().map(|path| InputPath::Any(path.into())).collect();
        plan::draft(&inputs, &self.options)
    }

    pub fn build(&self, paths: &[&str]) -> PlanOutcome {
        self.draft(paths).unchecked()
    }

    /// Plans valid inputs.
    pub fn plan_inputs(&self, inputs: &[InputPath]) -> Plan {
        let outcome = plan::draft(inputs, &self.options).unchecked();
        outcome.plan.unwrap_or_else(|| panic!("{:#?}", outcome.diagnostics))
    }

    /// Returns the codes of the problems of inputs.
    pub fn input_problems(&self, inputs: &[InputPath]) -> Vec<String> {
        let outcome = plan::draft(inputs, &self.options).unchecked();
        outcome.diagnostics.into_iter().map(|found| found.code).collect()
    }

    /// Plans valid paths.
    pub fn plan(&self, paths: &[&str]) -> Plan {
        let outcome = self.build(paths);
        outcome.plan.unwrap_or_else(|| panic!("{:#?}", outcome.diagnostics))
    }

    /// Returns the codes and messages of all problems.
    pub fn problems(&self, paths: &[&str]) -> Vec<(String, String)> {
        let outcome = self.build(paths);
        outcome.diagnostics.into_iter().map(|found| (found.code, found.message)).collect()
    }

    /// Formats the problems of a suite: code and message, labels, notes and hint.
    pub fn shown(&self, suite: &str) -> String {
        self.file("cell/s.xml", suite);
        let outcome = self.build(&["s.xml"]);
        let mut out = String::new();
        for found in &outcome.diagnostics {
            writeln!(out, "{}: {}", found.code, found.message).unwrap();
            for label in &found.labels {
                let text = &outcome.sources.text(&label.file).unwrap();
                let range =
                    usize::try_from(label.start).unwrap()..usize::try_from(label.end).unwrap();
                let written = &text[range];
                let place = format!("{}:{} {}", label.line, label.column, written.trim());
                writeln!(out, "{}", format!("  {place} {}", label.text).trim_end()).unwrap();
            }
            found.notes.iter().for_each(|note| writeln!(out, "  note: {note}").unwrap());
            found.hint.iter().for_each(|hint| writeln!(out, "  hint: {hint}").unwrap());
        }
        assert_eq!(outcome.plan.is_none(), !out.is_empty(), "{out}");
        out.replace(&self.root.display().to_string(), "[ROOT]")
    }

    /// Returns the absolute path of a path below the root.
    pub fn path(&self, path: &str) -> String {
        self.root.join(path).display().to_string()
    }

    /// Returns a path relative to the root.
    pub fn relative(&self, path: &Path) -> String {
        path.strip_prefix(&self.root).unwrap_or(path).display().to_string()
    }
}

/// Returns the names of the tests of a suite.
pub fn names(plan: &Plan, suite: usize) -> Vec<&str> {
    plan.suites[suite].tests.iter().map(|test| test.name.as_str()).collect()
}
