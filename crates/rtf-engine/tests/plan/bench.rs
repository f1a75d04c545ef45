//! A folder with an installation whose hosts are shell scripts, and with
//! suites and plug-ins for the planner to find.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rtf_engine::plan::{self, Options, Outcome, Plan, Request, Surroundings};

pub struct Bench {
    // Kept for its end, which removes the files.
    _folder: tempfile::TempDir,
    pub root: PathBuf,
    pub options: Options,
}

impl Bench {
    /// `bin/` with `rtf` and its hosts, and the empty current folder `cell/`.
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        std::fs::create_dir(root.join("cell")).unwrap();
        let variables =
            [("PATH".to_owned(), format!("{}:/usr/bin:/bin", root.join("bin").display()))];
        let surroundings = Surroundings {
            current_folder: root.join("cell"),
            executable: root.join("bin/rtf"),
            variables: variables.into_iter().collect(),
        };
        let options = Options { verify: None, ..Options::new(surroundings) };
        let bench = Self { _folder: folder, root, options };
        for host in ["rtf-host-native", "rtf-host-lua", "python3"] {
            bench.program(&format!("bin/{host}"), "exit 0");
        }
        bench
    }

    /// Writes a file below the root; its folders are made.
    pub fn file(&self, path: &str, text: &str) -> PathBuf {
        let path = self.root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Writes an executable shell script below the root.
    ///
    /// Another process writes it: were it open for writing here while another
    /// test starts a host, that host would inherit it for a moment, and the
    /// script could not be executed ("text file busy").
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
        self.options.surroundings.variables.insert(variable.to_owned(), value.to_owned());
    }

    pub fn build(&self, paths: &[&str]) -> Outcome {
        let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
        plan::build(&paths, &self.options)
    }

    /// The plan of requests that are all right.
    pub fn plan_requests(&self, requests: &[Request]) -> Plan {
        let outcome = plan::build_requests(requests, &self.options);
        outcome.plan.unwrap_or_else(|| panic!("{:#?}", outcome.diagnostics))
    }

    /// The codes of what is wrong with requests.
    pub fn request_problems(&self, requests: &[Request]) -> Vec<String> {
        let outcome = plan::build_requests(requests, &self.options);
        outcome.diagnostics.into_iter().map(|found| found.code).collect()
    }

    /// The plan of paths that are all right.
    pub fn plan(&self, paths: &[&str]) -> Plan {
        let outcome = self.build(paths);
        outcome.plan.unwrap_or_else(|| panic!("{:#?}", outcome.diagnostics))
    }

    /// The codes and messages of what is wrong.
    pub fn problems(&self, paths: &[&str]) -> Vec<(String, String)> {
        let outcome = self.build(paths);
        outcome.diagnostics.into_iter().map(|found| (found.code, found.message)).collect()
    }

    /// What is wrong with a suite of this text, as a text: for each problem its
    /// code and message, its places, its notes and its hint.
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

    /// A path below the root.
    pub fn path(&self, path: &str) -> String {
        self.root.join(path).display().to_string()
    }

    /// A path without the root before it.
    pub fn relative(&self, path: &Path) -> String {
        path.strip_prefix(&self.root).unwrap_or(path).display().to_string()
    }
}

/// The names of the tests of a suite.
pub fn names(plan: &Plan, suite: usize) -> Vec<&str> {
    plan.suites[suite].tests.iter().map(|test| test.name.as_str()).collect()
}
