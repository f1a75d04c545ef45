//! What holds, and where it comes from: `rtf config show`.

use std::collections::{BTreeMap, BTreeSet};

use super::keys::{Form, KEYS};
use super::param;
use super::read::Entry;
use super::run::RunValue;
use super::view::{Asked, View};
use crate::plan::defaults;
use crate::suite::{Source, Span};

/// One value that holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Its whole key.
    pub key: String,
    /// It; several only for `reports`.
    pub values: Vec<String>,
    /// Where it comes from: `rtf.toml:12`.
    pub from: String,
    /// Where it would come from otherwise, the nearest first.
    pub over: Vec<String>,
}

/// A suite's own values, with their places.
#[derive(Debug, Default)]
pub struct OfSuite {
    /// By the keys of an `rtf.toml`: `environment`, `env.NAME`.
    pub values: BTreeMap<String, (String, Span)>,
}

/// What is asked about.
#[derive(Debug)]
pub struct Question<'a> {
    /// The file of the suite, as its profile shows it.
    pub view: Option<View>,
    /// The suite.
    pub suite: Option<(&'a Source, &'a OfSuite)>,
    /// What the files say about the run.
    pub run: &'a [RunValue],
    /// The command line.
    pub asked: &'a Asked,
    /// The user's environment variables.
    pub user: &'a std::collections::HashMap<String, String>,
}

/// Where a value comes from that nobody wrote.
const BUILT_IN: &str = "built in";

type Candidates = Vec<(Vec<String>, String)>;

/// All that holds, in the order of the specification.
#[must_use]
pub fn show(question: &Question<'_>) -> Vec<Shown> {
    let mut shown = Vec::new();
    for (key, form) in KEYS {
        match form {
            Form::Named(_) => {
                for name in question.names(key) {
                    shown.extend(question.shown(format!("{key}.{name}")));
                }
            }
            Form::Table(keys) => {
                for (name, _) in *keys {
                    shown.extend(question.shown(format!("{key}.{name}")));
                }
            }
            _ => shown.extend(question.shown((*key).to_owned())),
        }
    }
    shown
}

impl Question<'_> {
    fn names(&self, table: &str) -> BTreeSet<String> {
        let view = self.view.iter().flat_map(|view| view.table(table));
        let mut names: BTreeSet<String> = view.map(|(name, _)| name.to_owned()).collect();
        let prefix = format!("{table}.");
        let suite = self.suite.iter().flat_map(|(_, suite)| suite.values.keys());
        names.extend(suite.filter_map(|key| key.strip_prefix(&prefix)).map(str::to_owned));
        if table == "param" {
            names.extend(self.asked.params.iter().map(|(name, _)| name.clone()));
        }
        names
    }

    fn shown(&self, key: String) -> Option<Shown> {
        let mut candidates = self.candidates(&key).into_iter();
        let (values, from) = candidates.next()?;
        let over = candidates.map(|(_, from)| from).filter(|from| from != BUILT_IN).collect();
        Some(Shown { key, values, from, over })
    }

    /// The values of a key, the one that holds first.
    fn candidates(&self, key: &str) -> Candidates {
        let mut found = self.given(key);
        let run = self.run.iter().find(|value| value.entry.key == key);
        if let Some(RunValue { file, entry }) = run {
            found.push(place(&file.source, entry));
        } else if let Some(view) = &self.view {
            let source = &view.file.source;
            let own = view.own(key).map(|entry| place(source, entry));
            let file = view.file.defaults.get(key).map(|entry| place(source, entry));
            // What the file says for all is weaker than what a suite says.
            found.extend(own.into_iter().chain(self.of_suite(key)).chain(file));
        } else {
            found.extend(self.of_suite(key));
        }
        found.extend(built_in(key).map(|value| (vec![value], BUILT_IN.to_owned())));
        found
    }

    /// What the command line and variables say.
    fn given(&self, key: &str) -> Candidates {
        let mut found = Vec::new();
        if let Some(name) = key.strip_prefix("param.") {
            let set = self.asked.params.iter().rev().find(|(known, _)| known == name);
            found.extend(set.map(|(_, value)| (vec![value.clone()], "--set".to_owned())));
        }
        let variable = match key {
            "results" => "RTF_RESULTS".to_owned(),
            "fork" => "RTF_FORK".to_owned(),
            _ => match key.strip_prefix("param.") {
                Some(name) => param::variable(name),
                None => return found,
            },
        };
        found.extend(self.user.get(&variable).map(|value| (vec![value.clone()], variable)));
        found
    }

    fn of_suite(&self, key: &str) -> Option<(Vec<String>, String)> {
        let (source, suite) = self.suite?;
        let (value, span) = suite.values.get(key)?;
        let label = source.label(*span, "");
        Some((vec![value.clone()], format!("{}:{}", label.file, label.line)))
    }
}

fn place(source: &Source, entry: &Entry) -> (Vec<String>, String) {
    let label = source.label(entry.span, "");
    let values = entry.values.iter().map(|value| value.value.clone()).collect();
    (values, format!("{}:{}", label.file, label.line))
}

fn built_in(key: &str) -> Option<String> {
    let (test, fixture) = (defaults::TEST, defaults::FIXTURE);
    let limit = match key {
        "timeouts.load" => test.load,
        "timeouts.setup" => test.setup,
        "timeouts.run" => test.run,
        "timeouts.teardown" => test.teardown,
        "timeouts.slow" => test.slow,
        "timeouts.grace" => test.grace,
        "timeouts.fixture-setup" => fixture.setup,
        "timeouts.fixture-check" => fixture.check,
        "timeouts.fixture-teardown" => fixture.teardown,
        "timeouts.hook" => defaults::HOOK,
        "timeouts.scale" => return Some("1".to_owned()),
        "results" => return Some("rtf-results".to_owned()),
        "fork" | "annotations" => return Some("auto".to_owned()),
        "shutdown-timeout" => return Some("60s".to_owned()),
        "jobs" => return Some("1".to_owned()),
        "flaky-result" => return Some("pass".to_owned()),
        _ => return None,
    };
    Some(format!("{}s", limit.as_secs()))
}
