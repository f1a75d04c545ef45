//! A file as one profile shows it.

use std::rc::Rc;
use std::time::Duration;

use rtf_model::Diagnostic;

use super::file::{ConfigFile, Files};
use super::read::{Entry, Layer};
use crate::suite::{nearest, parse_duration};

/// What the user asks for on the command line or by variables.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The profile.
    pub profile: Option<String>,
    /// Parameters, by name.
    pub params: Vec<(String, String)>,
}

impl Asked {
    /// The error of a profile that no file has, or warnings of files that have
    /// it not while others do.
    #[must_use]
    pub fn check_profile(&self, files: &Files) -> Vec<Diagnostic> {
        let Some(name) = &self.profile else { return Vec::new() };
        let message = format!("there is no profile `{name}`");
        let files = files.all();
        let (with, without): (Vec<_>, Vec<_>) = files
            .iter()
            .partition(|file| file.profiles.iter().any(|(known, _)| known.value == *name));
        if !with.is_empty() {
            let warn = |file: &&Rc<ConfigFile>| {
                let message = format!("{message} in `{}`", file.source.name());
                let hint = "what it says outside of profiles holds";
                Diagnostic::warning("unknown-profile", message).hint(hint)
            };
            return without.iter().map(warn).collect();
        }
        let problem = Diagnostic::error("unknown-profile", message);
        if files.is_empty() {
            let hint = "profiles are written in an `rtf.toml` beside the suites, or above them";
            return vec![problem.hint(hint)];
        }
        let looked = files.iter().map(|file| format!("looked in {}", file.source.name()));
        let problem = looked.fold(problem, Diagnostic::note);
        let known = files.iter().flat_map(|file| &file.profiles);
        vec![advise(problem, name, known.map(|(known, _)| known.value.as_str()))]
    }
}

/// Says which profiles there are.
pub(super) fn advise<'a>(
    problem: Diagnostic,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let mut known: Vec<&str> = known.collect();
    known.sort_unstable();
    known.dedup();
    match nearest(name, known.iter().copied()) {
        Some(near) => problem.hint(format!("did you mean `{near}`?")),
        None if known.is_empty() => problem.hint("a profile is a table `[profile.NAME]`"),
        None => {
            let list: Vec<_> = known.iter().map(|name| format!("`{name}`")).collect();
            problem.hint(format!("the profiles are {}", list.join(", ")))
        }
    }
}

/// A file as one profile shows it.
#[derive(Clone, Debug)]
pub struct View {
    /// The file.
    pub file: Rc<ConfigFile>,
    /// The profile's name, and its place in the file; `None` when the file has
    /// no such profile: then its defaults hold.
    pub profile: Option<(String, usize)>,
}

impl View {
    /// What the user sees of a file.
    #[must_use]
    pub fn of(file: Rc<ConfigFile>, asked: &Asked) -> Self {
        let default = || file.profile.as_ref().map(|name| name.value.clone());
        let name = asked.profile.clone().or_else(default);
        let place =
            |name: &String| file.profiles.iter().position(|(known, _)| known.value == *name);
        let profile = name.and_then(|name| place(&name).map(|place| (name, place)));
        Self { file, profile }
    }

    /// The profile's own values.
    #[must_use]
    pub fn overlay(&self) -> Option<&Layer> {
        let (_, place) = self.profile.as_ref()?;
        self.file.profiles.get(*place).map(|(_, layer)| layer)
    }

    /// A value of the profile itself.
    #[must_use]
    pub fn own(&self, key: &str) -> Option<&Entry> {
        self.overlay().and_then(|layer| layer.get(key))
    }

    /// A value: the profile's, else the file's.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.own(key).or_else(|| self.file.defaults.get(key))
    }

    /// The text of a value.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<&str> {
        self.get(key).and_then(Entry::text)
    }

    /// A duration.
    #[must_use]
    pub fn duration(&self, key: &str) -> Option<Duration> {
        self.text(key).and_then(|text| parse_duration(text).ok())
    }

    /// The entries of a table, those of the profile instead of the file's of the
    /// same name.
    pub fn table<'a>(&'a self, table: &'a str) -> impl Iterator<Item = (&'a str, &'a Entry)> {
        let inside = move |entry: &'a Entry| {
            let name = entry.key.strip_prefix(table)?.strip_prefix('.')?;
            Some((name, entry))
        };
        let own = self.overlay().into_iter().flat_map(|layer| &layer.0);
        let defaults = self.file.defaults.0.iter().filter(|entry| self.own(&entry.key).is_none());
        defaults.chain(own).filter_map(inside)
    }
}

impl Entry {
    /// Its text; the first of several.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        self.values.first().map(|value| value.value.as_str())
    }
}
