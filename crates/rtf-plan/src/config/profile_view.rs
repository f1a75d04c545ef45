//! The values of an `rtf.toml` under the selected profile.

use std::rc::Rc;
use std::time::Duration;

use rtf_model::Diagnostic;

use super::file::{ConfigFile, ConfigFiles};
use super::quarantine::Quarantine;
use super::toml_reader::{Entry, Layer};
use super::unknown_profile::suggest_profile;
use crate::suite::parse_duration;

/// The profile and parameters that the user selects on the command line or by variables.
#[derive(Clone, Debug, Default)]
pub struct ConfigRequest {
    pub profile: Option<String>,
    /// Parameters: name and value.
    pub params: Vec<(String, String)>,
}

impl ConfigRequest {
    /// Returns an error if no file has the selected profile, or a warning for
    /// each file without it if others have it.
    #[must_use]
    pub fn check_profile(&self, files: &ConfigFiles) -> Vec<Diagnostic> {
        let Some(name) = &self.profile else { return Vec::new() };
        let message = format!("there is no profile `{name}`");
        let files = files.all();
        let (with, without): (Vec<_>, Vec<_>) = files
            .iter()
            .partition(|file| file.profiles.iter().any(|(known, _)| known.value == *name));
        if !with.is_empty() {
            let warn = |file: &&Rc<ConfigFile>| {
                let message = format!("{message} in `{}`", file.source.name());
                let hint = "its values outside of profiles apply";
                Diagnostic::warning("unknown-profile", message).hint(hint)
            };
            return without.iter().map(warn).collect();
        }
        let problem = Diagnostic::error("unknown-profile", message);
        if files.is_empty() {
            let hint = "define profiles in an `rtf.toml` next to the suites, or above them";
            return vec![problem.hint(hint)];
        }
        let searched = files.iter().map(|file| format!("searched {}", file.source.name()));
        let problem = searched.fold(problem, Diagnostic::note);
        let known = files.iter().flat_map(|file| &file.profiles);
        vec![suggest_profile(problem, name, known.map(|(known, _)| known.value.as_str()))]
    }
}

/// A file under the selected profile.
#[derive(Clone, Debug)]
pub struct ProfileView {
    pub file: Rc<ConfigFile>,
    /// The profile's name and its index in the file; `None` if the file does
    /// not have the profile: its defaults apply.
    pub profile: Option<(String, usize)>,
}

impl ProfileView {
    /// Selects the requested profile of a file, else its default profile.
    #[must_use]
    pub fn new(file: Rc<ConfigFile>, request: &ConfigRequest) -> Self {
        let default = || file.profile.as_ref().map(|name| name.value.clone());
        let name = request.profile.clone().or_else(default);
        let index =
            |name: &String| file.profiles.iter().position(|(known, _)| known.value == *name);
        let profile = name.and_then(|name| index(&name).map(|index| (name, index)));
        Self { file, profile }
    }

    /// Returns the values of the profile itself.
    #[must_use]
    pub fn profile_layer(&self) -> Option<&Layer> {
        let (_, index) = self.profile.as_ref()?;
        self.file.profiles.get(*index).map(|(_, layer)| layer)
    }

    /// Returns a value of the profile itself.
    #[must_use]
    pub fn profile_value(&self, key: &str) -> Option<&Entry> {
        self.profile_layer().and_then(|layer| layer.get(key))
    }

    /// Returns a value of the profile, else of the file.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.profile_value(key).or_else(|| self.file.defaults.get(key))
    }

    /// Returns the quarantines of the profile, then those of the file.
    pub fn quarantines(&self) -> impl Iterator<Item = &Quarantine> {
        let profile = self.profile_layer().into_iter().flat_map(|layer| &layer.quarantines);
        profile.chain(&self.file.defaults.quarantines)
    }

    #[must_use]
    pub fn text(&self, key: &str) -> Option<&str> {
        self.get(key).and_then(Entry::text)
    }

    #[must_use]
    pub fn duration(&self, key: &str) -> Option<Duration> {
        self.text(key).and_then(|text| parse_duration(text).ok())
    }

    /// Returns the names and entries of a table. An entry of the profile
    /// replaces the file's entry of the same name.
    pub fn table<'a>(&'a self, table: &'a str) -> impl Iterator<Item = (&'a str, &'a Entry)> {
        let inside = move |entry: &'a Entry| {
            let name = entry.key.strip_prefix(table)?.strip_prefix('.')?;
            Some((name, entry))
        };
        let profile = self.profile_layer().into_iter().flat_map(|layer| &layer.entries);
        let is_default = |entry: &&Entry| self.profile_value(&entry.key).is_none();
        let defaults = self.file.defaults.entries.iter().filter(is_default);
        defaults.chain(profile).filter_map(inside)
    }
}

impl Entry {
    /// Returns the text of the value; the first of several.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        self.values.first().map(|value| value.value.as_str())
    }
}
