//! Overlays an `rtf.toml` on a suite before it is planned.

use std::collections::HashMap;
use std::time::Duration;

use rtf_model::{Diagnostic, Parameter};

use super::param_reference;
use super::profile_view::{ConfigRequest, ProfileView};
use crate::plan::defaults;
use crate::suite::{
    DeclaredLimits, DeclaredMonitor, DeclaredPlugin, DeclaredProbeKind, DeclaredProbes,
    DeclaredProvide, DeclaredSourceKind, DeclaredSuite, DeclaredValueSource, FixtureKind, HookKind,
    MAX_DURATION, SourceText, Span,
};
use crate::wording::nearest;

/// Applies the settings to a suite. `user` contains the user's environment variables.
pub(crate) fn overlay_suite(
    suite: &mut DeclaredSuite,
    source: &SourceText,
    view: Option<&ProfileView>,
    (request, user): (&ConfigRequest, &HashMap<String, String>),
) -> Vec<Diagnostic> {
    let params = Params { view, request, user };
    if let Some(view) = view {
        overlay_environment(suite, view);
        overlay_variables(&mut suite.env, view);
        overlay_limits(suite, view);
        overlay_parallel(suite, view);
    }
    let substitution =
        ParamSubstitution { params: &params, source, own: Vec::new(), problems: Vec::new() };
    let problems = substitution.run(suite);
    suite.env.splice(0..0, params.variables());
    problems
}

fn overlay_environment(suite: &mut DeclaredSuite, view: &ProfileView) {
    let default =
        view.file.defaults.get("environment").filter(|_| suite.settings.environment.is_empty());
    if let Some(entry) = view.profile_value("environment").or(default) {
        suite.settings.environment = entry.text().unwrap_or_default().to_owned();
    }
}

/// Precedence: file < suite < profile.
fn overlay_variables(env: &mut Vec<(String, String)>, view: &ProfileView) {
    for (name, entry) in view.table("env") {
        let in_profile = view.profile_value(&entry.key).is_some();
        let value = entry.text().unwrap_or_default();
        match env.iter_mut().find(|(known, _)| known == name) {
            Some((_, declared)) if in_profile => value.clone_into(declared),
            Some(_) => {}
            None => env.push((name.to_owned(), value.to_owned())),
        }
    }
}

/// A file can only lower the number: only the suite knows which tests may run concurrently.
fn overlay_parallel(suite: &mut DeclaredSuite, view: &ProfileView) {
    let most = view.text("parallel").and_then(|text| text.parse().ok());
    suite.settings.parallel = suite.settings.parallel.min(most.unwrap_or(u32::MAX));
}

fn overlay_limits(suite: &mut DeclaredSuite, view: &ProfileView) {
    let scale = scale(view);
    for test in &mut suite.tests {
        test.limits = test_limits(test.limits, view, scale);
    }
    let default = defaults::FIXTURE;
    for fixture in &mut suite.fixtures {
        fixture.setup = limit(fixture.setup, ("fixture-setup", default.setup), view, scale);
        fixture.check = limit(fixture.check, ("fixture-check", default.check), view, scale);
        fixture.teardown =
            limit(fixture.teardown, ("fixture-teardown", default.teardown), view, scale);
    }
    for hook in &mut suite.hooks {
        hook.timeout = limit(hook.timeout, ("hook", defaults::HOOK), view, scale);
    }
    let suite_limit = suite.settings.timeout.or_else(|| view.duration("timeouts.suite"));
    suite.settings.timeout = suite_limit.map(|limit| scaled(limit, scale));
}

/// The settings of plug-ins that are given directly.
#[derive(Debug)]
pub(crate) struct DirectPluginConfig {
    pub environment: String,
    pub env: Vec<(String, String)>,
    pub limits: DeclaredLimits,
}

/// Returns the settings of plug-ins that are given directly. `environment` is
/// the environment string of the command line.
pub(crate) fn direct_plugin_config(
    view: Option<&ProfileView>,
    environment: &str,
    (request, user): (&ConfigRequest, &HashMap<String, String>),
) -> DirectPluginConfig {
    let params = Params { view, request, user };
    let mut config = DirectPluginConfig {
        environment: environment.to_owned(),
        env: params.variables(),
        limits: DeclaredLimits::default(),
    };
    if let Some(view) = view {
        overlay_variables(&mut config.env, view);
        config.limits = test_limits(config.limits, view, scale(view));
        if environment.is_empty() {
            config.environment = view.text("environment").unwrap_or_default().to_owned();
        }
    }
    config
}

fn scale(view: &ProfileView) -> f64 {
    view.text("timeouts.scale").and_then(|text| text.parse().ok()).unwrap_or(1.0)
}

/// Returns the declared limit, else the one in `timeouts`, scaled; a scale also
/// applies to the default. `None` if nothing deviates from the default.
fn limit(
    declared: Option<Duration>,
    (key, default): (&str, Duration),
    view: &ProfileView,
    scale: f64,
) -> Option<Duration> {
    let known = declared.or_else(|| view.duration(&format!("timeouts.{key}")));
    (scale != 1.0).then(|| scaled(known.unwrap_or(default), scale)).or(known)
}

fn test_limits(declared: DeclaredLimits, view: &ProfileView, scale: f64) -> DeclaredLimits {
    let default = defaults::TEST;
    DeclaredLimits {
        load: limit(declared.load, ("load", default.load), view, scale),
        setup: limit(declared.setup, ("setup", default.setup), view, scale),
        run: limit(declared.run, ("run", default.run), view, scale),
        teardown: limit(declared.teardown, ("teardown", default.teardown), view, scale),
        slow: limit(declared.slow, ("slow", default.slow), view, scale),
        // Not scaled: a slow robot must not delay the kill.
        grace: declared.grace.or_else(|| view.duration("timeouts.grace")),
        case: declared.case.map(|limit| scaled(limit, scale)),
    }
}

fn scaled(limit: Duration, scale: f64) -> Duration {
    Duration::try_from_secs_f64(limit.as_secs_f64() * scale)
        .map_or(MAX_DURATION, |it| it.min(MAX_DURATION))
}

/// The values of parameters: command line > user's variables > profile > file.
struct Params<'a> {
    view: Option<&'a ProfileView>,
    request: &'a ConfigRequest,
    user: &'a HashMap<String, String>,
}

impl Params<'_> {
    fn get(&self, name: &str) -> Option<String> {
        let set = self.request.params.iter().rev().find(|(known, _)| known == name);
        set.map(|(_, value)| value.clone())
            .or_else(|| self.user.get(&param_reference::variable(name)).cloned())
            .or_else(|| Some(self.view?.text(&format!("param.{name}"))?.to_owned()))
    }

    /// Returns all known parameters as environment variables.
    fn variables(&self) -> Vec<(String, String)> {
        let configured = self.view.into_iter().flat_map(|view| view.table("param"));
        let configured = configured.map(|(name, _)| name.to_owned());
        let mut names: Vec<_> =
            configured.chain(self.request.params.iter().map(|(name, _)| name.clone())).collect();
        names.sort();
        names.dedup();
        let value = |name: String| Some((param_reference::variable(&name), self.get(&name)?));
        names.into_iter().filter_map(value).collect()
    }
}

/// Replaces `${param:…}` in a suite.
struct ParamSubstitution<'a> {
    params: &'a Params<'a>,
    source: &'a SourceText,
    /// The values of the test's matrix, which take precedence.
    own: Vec<Parameter>,
    problems: Vec<Diagnostic>,
}

impl ParamSubstitution<'_> {
    fn run(mut self, suite: &mut DeclaredSuite) -> Vec<Diagnostic> {
        let span = suite.span;
        self.text(&mut suite.settings.environment, span);
        self.env(&mut suite.env, span);
        for test in &mut suite.tests {
            let combination = test.combination.as_ref();
            self.own = combination.map(|it| it.parameters.clone()).unwrap_or_default();
            let reported = self.problems.len();
            self.env(&mut test.env, test.span);
            self.plugin(&mut test.plugin);
            self.monitors(&mut test.monitors);
            if let Some(patterns) = test.cases.as_mut().and_then(|cases| cases.patterns.as_mut()) {
                self.text(&mut patterns.value, patterns.span);
            }
            if combination.is_some_and(|combination| !combination.is_first) {
                // The first combination has the same ones.
                self.problems.truncate(reported);
            }
        }
        self.own.clear();
        self.monitors(&mut suite.monitors);
        for fixture in &mut suite.fixtures {
            self.env(&mut fixture.env, fixture.span);
            self.provides(&mut fixture.provides);
            if let Some(reset) = &mut fixture.reset {
                self.action(&mut reset.body);
            }
            match &mut fixture.body {
                FixtureKind::Plugin(plugin) => self.plugin(plugin),
                FixtureKind::Process(process) => {
                    let span = process.command.span;
                    self.words(&mut process.command.value, span);
                    if let Some(host) = &mut process.host {
                        self.text(&mut host.value, host.span);
                    }
                    self.probes(&mut process.probes);
                }
                FixtureKind::Attached(probes) => self.probes(probes),
            }
        }
        suite.signals.iter_mut().for_each(|source| self.source(&mut source.kind));
        for envelope in &mut suite.envelopes {
            self.text(&mut envelope.file.value, envelope.file.span);
        }
        for hook in &mut suite.hooks {
            self.action(&mut hook.body);
            let span = match &hook.body {
                HookKind::Plugin(plugin) => plugin.name.span,
                HookKind::Command(command) => command.span,
            };
            self.env(&mut hook.env, span);
        }
        self.problems
    }

    /// The body of a hook or a reset.
    fn action(&mut self, body: &mut HookKind) {
        match body {
            HookKind::Plugin(plugin) => self.plugin(plugin),
            HookKind::Command(command) => self.words(&mut command.value, command.span),
        }
    }

    fn provides(&mut self, provides: &mut [DeclaredProvide]) {
        for provide in provides {
            match &mut provide.source {
                DeclaredValueSource::File(path) => self.text(path, provide.name.span),
                DeclaredValueSource::Command(words) => self.words(&mut words.value, words.span),
                DeclaredValueSource::Plugin | DeclaredValueSource::Log(_) => {}
            }
        }
    }

    fn probes(&mut self, probes: &mut DeclaredProbes) {
        for probe in probes.ready.iter_mut().chain(&mut probes.alive) {
            match &mut probe.kind {
                DeclaredProbeKind::Tcp(text)
                | DeclaredProbeKind::Http(text)
                | DeclaredProbeKind::File(text) => {
                    self.text(text, probe.span);
                }
                DeclaredProbeKind::Command(words) => self.words(words, probe.span),
                DeclaredProbeKind::Middleware(query) => self.text(&mut query.name, probe.span),
                DeclaredProbeKind::Log(_) => {}
            }
        }
    }

    fn plugin(&mut self, plugin: &mut DeclaredPlugin) {
        self.text(&mut plugin.param, plugin.name.span);
    }

    fn source(&mut self, source: &mut DeclaredSourceKind) {
        match source {
            DeclaredSourceKind::Program { command, .. } => {
                self.words(&mut command.value, command.span);
            }
            DeclaredSourceKind::Recording { file, .. } => self.text(&mut file.value, file.span),
            DeclaredSourceKind::Topic { .. }
            | DeclaredSourceKind::Test(_)
            | DeclaredSourceKind::Fixture { .. } => {}
        }
    }

    fn monitors(&mut self, monitors: &mut [DeclaredMonitor]) {
        for monitor in monitors {
            self.text(&mut monitor.formula.value, monitor.formula.span);
        }
    }

    fn env(&mut self, env: &mut [(String, String)], span: Span) {
        env.iter_mut().for_each(|(_, value)| self.text(value, span));
    }

    fn words(&mut self, words: &mut [String], span: Span) {
        words.iter_mut().for_each(|word| self.text(word, span));
    }

    fn text(&mut self, text: &mut String, span: Span) {
        if !text.contains("${param:") {
            return;
        }
        let mut missing = Vec::new();
        let value = |name: &str| {
            let own = self.own.iter().find(|own| own.name == name);
            own.map(|own| own.value.clone()).or_else(|| self.params.get(name))
        };
        let expanded =
            param_reference::expand(text, value, &mut |name| missing.push(name.to_owned()));
        let written = std::mem::replace(text, expanded);
        for name in missing {
            let is_closed = written.contains(&format!("${{param:{name}}}"));
            self.problems.push(if is_closed { self.unknown(&name, span) } else { self.open(span) });
        }
    }

    fn open(&self, span: Span) -> Diagnostic {
        Diagnostic::error("unknown-param", "`${param:` is not closed")
            .label(self.source.label(span, "a `}` is missing after it"))
            .hint("`$${param:` stands for these characters")
    }

    fn unknown(&self, name: &str, span: Span) -> Diagnostic {
        let problem =
            Diagnostic::error("unknown-param", format!("the parameter `{name}` has no value"))
                .label(self.source.label(span, "needed here"));
        let known = self.params.view.into_iter().flat_map(|view| view.table("param"));
        match nearest(name, known.map(|(known, _)| known)) {
            Some(near) => problem.hint(format!("did you mean `${{param:{near}}}`?")),
            None if !param_reference::is_name(name) => {
                problem.hint("a name is letters, digits, `-` and `_`, a letter first")
            }
            None => problem.hint(format!(
                "write it under `[param]` in `rtf.toml`, give `--set {name}=VALUE`, or a default: \
                 `${{param:{name}=VALUE}}`"
            )),
        }
    }
}
