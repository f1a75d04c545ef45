//! The values that the fixtures of a suite have provided, and the parameters of an episode: how
//! they reach tests, hooks and fixtures, and how secrets are kept out of events.

use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::Arc;

use rtf_model::protocol::{FixtureValue, Plugin};
use rtf_model::{Episode, EventKind, FixtureProvided, Parameter, value_text};
use rtf_plan::plan::{FixtureBody, HookBody, HookPlan, HostPlan, SuitePlan};
use rtf_plan::suite::{episode_reference, fixture_reference};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::plan_texts::Substitution;

/// The number of the episode, for the processes of a suite.
const EPISODE_VARIABLE: &str = "RTF_EPISODE";
const SEED_VARIABLE: &str = "RTF_EPISODE_SEED";

/// The values that fixtures have provided; those of a restarted fixture replace the old ones.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FixtureValues {
    values: Vec<ProvidedValue>,
    /// Secrets that a restarted fixture has replaced: they are still not shown.
    former_secrets: Vec<String>,
    /// Increases with each change.
    version: u64,
    /// Whether texts of the plan refer to values.
    expands: bool,
    /// The running episode of a campaign.
    episode: Option<Episode>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct ProvidedValue {
    /// `simulator.port`.
    name: String,
    /// The index of the fixture in its suite.
    fixture: usize,
    variable: String,
    value: Value,
    text: String,
    is_secret: bool,
}

impl FixtureValues {
    pub fn new(suite: &SuitePlan) -> Self {
        Self { expands: suite.refers_to_values, ..Self::default() }
    }

    pub fn set(&mut self, fixture: usize, names: (&str, &str), value: Value, is_secret: bool) {
        let name = format!("{}.{}", names.0, names.1);
        let variable = FixtureProvided::variable(names.0, names.1);
        let text = value_text(&value).into_owned();
        if let Some(index) = self.values.iter().position(|known| known.name == name) {
            let former = self.values.remove(index);
            self.former_secrets.extend(former.is_secret.then_some(former.text));
        }
        self.values.push(ProvidedValue { name, fixture, variable, value, text, is_secret });
        self.version += 1;
    }

    pub fn begin_episode(&mut self, episode: Episode) {
        self.episode = Some(episode);
    }

    pub fn has_episode(&self) -> bool {
        self.episode.is_some()
    }

    /// A number that differs after each change of a value.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Returns the values that a fixture can use: of those that it depends on, directly or
    /// indirectly.
    pub fn of_dependencies(&self, suite: &SuitePlan, fixture: usize) -> Self {
        if self.values.is_empty() {
            return self.clone();
        }
        let mut depends = vec![false; suite.fixtures.len()];
        let mut open = suite.fixtures[fixture].depends.clone();
        while let Some(index) = open.pop() {
            if !std::mem::replace(&mut depends[index], true) {
                open.extend(&suite.fixtures[index].depends);
            }
        }
        let mut values = self.clone();
        values.values.retain(|value| depends[value.fixture]);
        values
    }

    /// Adds the values to an environment, and replaces references in it.
    pub fn extend_env(&self, env: &mut Vec<(String, String)>) {
        if self.expands {
            self.env(env);
        }
        let variables = self.values.iter();
        env.extend(variables.map(|value| (value.variable.clone(), value.text.clone())));
        env.extend(self.numbers_of_episode());
    }

    fn numbers_of_episode(&self) -> impl Iterator<Item = (String, String)> {
        let numbers = |episode: &Episode| {
            let (id, seed) = (episode.id.to_string(), episode.seed.to_string());
            [(EPISODE_VARIABLE.to_owned(), id), (SEED_VARIABLE.to_owned(), seed)]
        };
        self.episode.iter().flat_map(numbers)
    }

    /// Returns the variables of an environment that differ between episodes: a host that runs
    /// tests of several ones sets them before each. The last entry for a name counts.
    pub fn variables_of_episode<'e>(
        &self,
        env: impl DoubleEndedIterator<Item = &'e (String, String)>,
    ) -> Vec<Parameter> {
        let mut known = HashSet::new();
        let last = env.rev().filter(|(name, _)| known.insert(name));
        let refers = last.filter(|(_, value)| episode_reference::mentions(value));
        let expanded = refers.map(|(name, value)| (name.clone(), self.expand(value)));
        let all = expanded.chain(self.numbers_of_episode());
        all.map(|(name, value)| Parameter { name, value }).collect()
    }

    /// Adds the values to a request, and replaces references in it.
    pub fn extend_request(&self, request: &mut Plugin) {
        if self.expands {
            self.text(&mut request.param);
            self.texts(&mut request.args);
        }
        if let Some(episode) = &self.episode {
            request.parameters.extend(episode.parameters.iter().cloned());
        }
        request.fixture_values = self.values.iter().map(ProvidedValue::of_protocol).collect();
    }

    /// Returns a host whose environment has all references replaced.
    pub fn in_host(&self, host: &Arc<HostPlan>) -> Arc<HostPlan> {
        let mut host = Arc::clone(host);
        if self.expands && host.env.iter().any(|(_, value)| self.is_in(value)) {
            self.env(&mut Arc::make_mut(&mut host).env);
        }
        host
    }

    /// Replaces the references in a command.
    pub fn in_command(&self, command: &[String]) -> Vec<String> {
        let mut command = command.to_vec();
        if self.expands {
            self.texts(&mut command);
        }
        command
    }

    /// Returns the plan of a fixture with all references replaced.
    pub fn in_fixture<'p>(&self, body: &'p FixtureBody) -> Cow<'p, FixtureBody> {
        if !self.expands {
            return Cow::Borrowed(body);
        }
        let mut body = body.clone();
        self.fixture(&mut body);
        Cow::Owned(body)
    }

    /// Why a hook cannot run: it refers to a value that was never provided.
    pub fn missing_in(&self, plan: &HookPlan) -> Option<String> {
        let env = plan.env.iter().map(|(_, value)| value);
        let body: Vec<&String> = match &plan.body {
            HookBody::Plugin(plugin) => plugin.args.iter().chain([&plugin.param]).collect(),
            HookBody::Command(command) => command.iter().collect(),
        };
        self.missing(env.chain(body))
    }

    /// Describes the first of the references that has no value.
    pub fn missing<'t>(&self, texts: impl Iterator<Item = &'t String>) -> Option<String> {
        if !self.expands {
            return None;
        }
        let mut names = texts.flat_map(|text| fixture_reference::names(text));
        let name = names.find(|name| self.get(name).is_none())?;
        Some(format!("it needs `${{fixture:{name}}}`, which was not provided"))
    }

    fn get(&self, name: &str) -> Option<&ProvidedValue> {
        self.values.iter().find(|value| value.name == name)
    }

    /// The versions of blinded trials come first, the longest one first: one may be a part of another.
    fn secrets(&self) -> impl Iterator<Item = &str> {
        let masked = self.episode.iter().flat_map(|episode| &episode.masked);
        let present = self.values.iter().filter(|value| value.is_secret).map(|value| &value.text);
        masked.chain(present).chain(&self.former_secrets).map(String::as_str)
    }

    pub fn has_secrets(&self) -> bool {
        self.secrets().next().is_some()
    }

    /// Replaces all secrets in the texts of an event.
    pub fn mask(&self, kind: EventKind) -> EventKind {
        if !self.has_secrets() {
            return kind;
        }
        // The journal's format has all texts of every event.
        let Ok(event) = serde_json::to_value(&kind) else { return kind };
        let mut texts = Vec::new();
        find_texts(&event, &mut String::new(), &mut texts);
        texts.retain(|(_, text)| self.secrets().any(|it| !it.is_empty() && text.contains(it)));
        if texts.is_empty() {
            return kind;
        }
        let masked = |texts: &[&(String, String)]| {
            let mut event = event.clone();
            for (path, text) in texts {
                if let Some(found) = event.pointer_mut(path) {
                    *found = self.mask_text(text.clone()).into();
                }
            }
            serde_json::from_value(event)
        };
        // The name of an event or of one of its kinds, which contains a secret, is none.
        let is_text = |text: &&(String, String)| masked(&[text]).is_ok();
        let all: Vec<_> = texts.iter().collect();
        let checked = || masked(&texts.iter().filter(is_text).collect::<Vec<_>>());
        masked(&all).or_else(|_| checked()).unwrap_or(kind)
    }

    pub fn mask_text(&self, mut text: String) -> String {
        for secret in self.secrets().filter(|secret| !secret.is_empty()) {
            if text.contains(secret) {
                text = text.replace(secret, FixtureProvided::SECRET);
            }
        }
        text
    }

    /// The length of the longest end of `bytes` with which a secret may begin: the rest of
    /// the secret may come with the next bytes.
    pub fn secret_start_len(&self, bytes: &[u8]) -> usize {
        let start_len = |secret: &[u8]| {
            let complete = find_last(bytes, secret).map_or(0, |start| start + secret.len());
            let rest = &bytes[complete..];
            let longest = rest.len().min(secret.len().saturating_sub(1));
            (1..=longest).rev().find(|len| rest.ends_with(&secret[..*len])).unwrap_or(0)
        };
        self.secrets().map(|secret| start_len(secret.as_bytes())).max().unwrap_or(0)
    }

    /// The length of the longest begin of `bytes` with which a secret may end.
    pub fn secret_end_len(&self, bytes: &[u8]) -> usize {
        let end_len = |secret: &[u8]| {
            let longest = bytes.len().min(secret.len().saturating_sub(1));
            let end = |len: &usize| bytes.starts_with(&secret[secret.len() - len..]);
            (1..=longest).rev().find(end).unwrap_or(0)
        };
        self.secrets().map(|secret| end_len(secret.as_bytes())).max().unwrap_or(0)
    }
}

impl ProvidedValue {
    fn of_protocol(&self) -> FixtureValue {
        FixtureValue { name: self.name.clone(), value: self.value.clone() }
    }
}

impl Substitution for FixtureValues {
    fn is_in(&self, text: &str) -> bool {
        fixture_reference::mentions(text) || episode_reference::mentions(text)
    }

    fn expand(&self, text: &str) -> String {
        let value = |name: &str| Some(Cow::Borrowed(self.get(name)?.text.as_str()));
        let text = fixture_reference::expand(text, value);
        match &self.episode {
            Some(episode) => episode_reference::expand(&text, &episode.parameters),
            None => text,
        }
    }
}

/// Adds all texts in a value, each with its JSON pointer.
fn find_texts(value: &Value, path: &mut String, texts: &mut Vec<(String, String)>) {
    let mut step = |name: &str, inner: &Value| {
        let before = path.len();
        path.push('/');
        path.push_str(&name.replace('~', "~0").replace('/', "~1"));
        find_texts(inner, path, texts);
        path.truncate(before);
    };
    match value {
        Value::String(text) => texts.push((path.clone(), text.clone())),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, item)| step(&index.to_string(), item));
        }
        Value::Object(fields) => fields.iter().for_each(|(name, field)| step(name, field)),
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

fn find_last(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len().max(1)).rposition(|window| window == pattern)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(secret: &str) -> FixtureValues {
        let mut values = FixtureValues { expands: true, ..FixtureValues::default() };
        values.set(0, ("sim", "port"), 40123.into(), false);
        values.set(0, ("sim", "token"), secret.into(), true);
        values
    }

    #[test]
    fn a_secret_is_replaced_in_every_text_of_an_event() {
        let fixture = rtf_model::FixtureId(0);
        let log_tail = vec!["token abcabd".to_owned(), "40123".to_owned()];
        let reason = "abcabd was refused".to_owned();
        let masked =
            values("abcabd").mask(EventKind::FixtureCollapsed { fixture, reason, log_tail });
        let log_tail = vec!["token ***".to_owned(), "40123".to_owned()];
        let reason = "*** was refused".to_owned();
        assert_eq!(masked, EventKind::FixtureCollapsed { fixture, reason, log_tail });
    }

    #[test]
    fn a_secret_in_the_name_of_an_event_leaves_its_texts_masked() {
        let fixture = rtf_model::FixtureId(0);
        let event = |text: &str| EventKind::FixtureCollapsed {
            fixture,
            reason: text.to_owned(),
            log_tail: Vec::new(),
        };
        for secret in ["collapsed", "fixture"] {
            assert_eq!(
                values(secret).mask(event(&format!("{secret}!"))),
                event("***!"),
                "{secret}"
            );
        }
    }

    #[test]
    fn the_versions_of_a_blinded_trial_are_replaced() {
        let mut values = FixtureValues::default();
        let masked = vec!["act-large".to_owned(), "act".to_owned()];
        values.begin_episode(Episode { masked, ..Episode::new(1, 0, Vec::new()) });
        assert_eq!(values.mask_text("act-large or act".to_owned()), "*** or ***");
        assert_eq!(values.secret_start_len(b"loads act-lar"), 7);
    }

    #[test]
    fn a_secret_that_is_cut_is_recognised_at_both_ends() {
        let values = values("abcabd");
        for (bytes, start, end) in [
            ("x", 0, 0),
            ("xa", 1, 0),
            ("xabcab", 5, 0),
            ("abcabd", 0, 0),
            ("abcabdab", 2, 0),
            ("bd!", 0, 2),
            ("dx", 0, 1),
        ] {
            assert_eq!(values.secret_start_len(bytes.as_bytes()), start, "{bytes}");
            assert_eq!(values.secret_end_len(bytes.as_bytes()), end, "{bytes}");
        }
    }

    #[test]
    fn the_secret_before_a_restart_is_still_replaced() {
        let mut values = values("abcabd");
        values.set(0, ("sim", "token"), "second".into(), true);
        assert_eq!(values.mask_text("abcabd, second".to_owned()), "***, ***");
        assert_eq!(values.expand("${fixture:sim.token}"), "second");
    }

    #[test]
    fn values_of_a_restarted_fixture_replace_the_old_ones() {
        let mut values = values("abcabd");
        let before = values.version();
        values.set(0, ("sim", "port"), 40124.into(), false);
        assert_ne!(values.version(), before);
        assert_eq!(values.expand("${fixture:sim.port}"), "40124");
        let mut env = vec![("AT".to_owned(), "tcp:${fixture:sim.port}".to_owned())];
        values.extend_env(&mut env);
        let found: Vec<_> = env.iter().map(|(n, v)| format!("{n}={v}")).collect();
        let expected =
            ["AT=tcp:40124", "RTF_FIXTURE_SIM_TOKEN=abcabd", "RTF_FIXTURE_SIM_PORT=40124"];
        assert_eq!(found, expected);
    }
}
