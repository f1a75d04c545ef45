//! The effective settings and their origins: `rtf config show`.

use std::collections::{BTreeSet, HashMap};

use super::keys::{KEYS, Key, ValueFormat};
use super::param_reference;
use super::profile_view::{ConfigRequest, ProfileView};
use super::run_config::RunValue;
use super::toml_reader::Entry;
use crate::plan::defaults;
use crate::suite::{SharedSettings, SourceText};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Its full key.
    pub key: String,
    /// Several only for `reports`.
    pub values: Vec<String>,
    /// The origin of the value: `rtf.toml:12`.
    pub origin: String,
    /// The origins of the values that it overrides, in descending precedence.
    pub overridden: Vec<String>,
}

/// All sources of settings for one suite.
#[derive(Debug)]
pub struct SettingsQuery<'a> {
    /// The nearest `rtf.toml`.
    pub view: Option<ProfileView>,
    pub suite: Option<(&'a SourceText, &'a SharedSettings)>,
    pub run: &'a [RunValue],
    pub request: &'a ConfigRequest,
    /// The user's environment variables.
    pub user: &'a HashMap<String, String>,
}

/// The origin of a default value.
const BUILT_IN: &str = "built in";

/// A possible value of a setting and its origin.
type SettingCandidate = (Vec<String>, String);

/// Returns all effective settings in the order of the specification.
#[must_use]
pub fn effective_settings(query: &SettingsQuery<'_>) -> Vec<Setting> {
    let mut settings = Vec::new();
    for Key { name: key, format, .. } in KEYS {
        match format {
            ValueFormat::Named(_) => {
                for name in query.names(key) {
                    settings.extend(query.setting(format!("{key}.{name}")));
                }
            }
            ValueFormat::Table(keys) => {
                for Key { name, .. } in *keys {
                    settings.extend(query.setting(format!("{key}.{name}")));
                }
            }
            _ => settings.extend(query.setting((*key).to_owned())),
        }
    }
    settings
}

impl SettingsQuery<'_> {
    fn names(&self, table: &str) -> BTreeSet<String> {
        let view = self.view.iter().flat_map(|view| view.table(table));
        let mut names: BTreeSet<String> = view.map(|(name, _)| name.to_owned()).collect();
        let prefix = format!("{table}.");
        let suite = self.suite.iter().flat_map(|(_, settings)| settings.keys());
        names.extend(suite.filter_map(|key| key.strip_prefix(&prefix)).map(str::to_owned));
        if table == "param" {
            names.extend(self.request.params.iter().map(|(name, _)| name.clone()));
        }
        names
    }

    fn setting(&self, key: String) -> Option<Setting> {
        let mut candidates = self.candidates(&key).into_iter();
        let (values, origin) = candidates.next()?;
        let overridden =
            candidates.map(|(_, origin)| origin).filter(|origin| origin != BUILT_IN).collect();
        Some(Setting { key, values, origin, overridden })
    }

    /// Returns the values of a key in descending precedence.
    fn candidates(&self, key: &str) -> Vec<SettingCandidate> {
        let mut found = self.user_values(key);
        let run = self.run.iter().find(|value| value.entry.key == key);
        if let Some(RunValue { file, entry }) = run {
            found.push(file_value(&file.source, entry));
        } else if let Some(view) = &self.view {
            let source = &view.file.source;
            let profile = view.profile_value(key).map(|entry| file_value(source, entry));
            let file = view.file.defaults.get(key).map(|entry| file_value(source, entry));
            found.extend(profile.into_iter().chain(self.suite_value(key)).chain(file));
        } else {
            found.extend(self.suite_value(key));
        }
        found.extend(built_in(key).map(|value| (vec![value], BUILT_IN.to_owned())));
        found
    }

    /// Returns the values of the command line and of environment variables.
    fn user_values(&self, key: &str) -> Vec<SettingCandidate> {
        let mut found = Vec::new();
        if let Some(name) = key.strip_prefix("param.") {
            let set = self.request.params.iter().rev().find(|(known, _)| known == name);
            found.extend(set.map(|(_, value)| (vec![value.clone()], "--set".to_owned())));
        }
        let variable = match key {
            "results" => "RTF_RESULTS".to_owned(),
            "fork" => "RTF_FORK".to_owned(),
            "history.url" => "RTF_HISTORY_URL".to_owned(),
            _ => match key.strip_prefix("param.") {
                Some(name) => param_reference::variable(name),
                None => return found,
            },
        };
        found.extend(self.user.get(&variable).map(|value| (vec![value.clone()], variable)));
        found
    }

    fn suite_value(&self, key: &str) -> Option<SettingCandidate> {
        let (source, settings) = self.suite?;
        let (value, span) = settings.get(key)?;
        let label = source.label(*span, "");
        Some((vec![value.clone()], format!("{}:{}", label.file, label.line)))
    }
}

fn file_value(source: &SourceText, entry: &Entry) -> SettingCandidate {
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
        "history.enabled" => return Some("true".to_owned()),
        "fork" | "annotations" => return Some("auto".to_owned()),
        "shutdown-timeout" => return Some("60s".to_owned()),
        "jobs" => return Some("1".to_owned()),
        "flaky-result" => return Some("pass".to_owned()),
        "order" => return Some("file".to_owned()),
        _ => return None,
    };
    Some(format!("{}s", limit.as_secs()))
}
