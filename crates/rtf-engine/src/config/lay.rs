//! Lays an `rtf.toml` over a suite, before it is planned.

use std::collections::HashMap;
use std::time::Duration;

use rtf_model::Diagnostic;

use super::param;
use super::view::{Asked, View};
use crate::plan::defaults;
use crate::suite::{
    FixtureKind, HookKind, Plugin, Probe, Question, Source, Span, Suite, WrittenLimits,
};

/// Deadlines stay as far from the end of every clock as those of suites.
const LONGEST: Duration = Duration::from_secs(366 * 24 * 60 * 60);

/// Lays what holds over a suite. `user` are the variables of the user.
pub(crate) fn lay(
    suite: &mut Suite,
    source: &Source,
    view: Option<&View>,
    (asked, user): (&Asked, &HashMap<String, String>),
) -> Vec<Diagnostic> {
    let params = Params { view, asked, user };
    if let Some(view) = view {
        environment(suite, view);
        variables(&mut suite.env, view);
        limits(suite, view);
        parallel(suite, view);
    }
    let problems = Filler { params: &params, source, problems: Vec::new() }.fill(suite);
    suite.env.splice(0..0, params.variables());
    problems
}

fn environment(suite: &mut Suite, view: &View) {
    let default = view.file.defaults.get("environment").filter(|_| suite.environment.is_empty());
    if let Some(entry) = view.own("environment").or(default) {
        suite.environment = entry.text().unwrap_or_default().to_owned();
    }
}

/// File < suite < profile.
fn variables(env: &mut Vec<(String, String)>, view: &View) {
    for (name, entry) in view.table("env") {
        let own = view.own(&entry.key).is_some();
        let value = entry.text().unwrap_or_default();
        match env.iter_mut().find(|(known, _)| known == name) {
            Some((_, written)) if own => value.clone_into(written),
            Some(_) => {}
            None => env.push((name.to_owned(), value.to_owned())),
        }
    }
}

/// A file can only take away: which tests bear each other, their suite alone knows.
fn parallel(suite: &mut Suite, view: &View) {
    let most = view.text("parallel").and_then(|text| text.parse().ok());
    suite.parallel = suite.parallel.min(most.unwrap_or(u32::MAX));
}

fn limits(suite: &mut Suite, view: &View) {
    let scale = scale(view);
    let limit = |written: Option<Duration>, key: &str, built_in: Duration| {
        let known = written.or_else(|| view.duration(&format!("timeouts.{key}")));
        (scale != 1.0).then(|| scaled(known.unwrap_or(built_in), scale)).or(known)
    };
    for test in &mut suite.tests {
        test.limits = test_limits(test.limits, view, scale);
    }
    for fixture in &mut suite.fixtures {
        fixture.setup = limit(fixture.setup, "fixture-setup", defaults::FIXTURE.setup);
        fixture.check = limit(fixture.check, "fixture-check", defaults::FIXTURE.check);
        fixture.teardown = limit(fixture.teardown, "fixture-teardown", defaults::FIXTURE.teardown);
    }
    for hook in &mut suite.hooks {
        hook.timeout = limit(hook.timeout, "hook", defaults::HOOK);
    }
    let suite_limit = suite.timeout.or_else(|| view.duration("timeouts.suite"));
    suite.timeout = suite_limit.map(|limit| scaled(limit, scale));
}

/// What holds for plug-ins that are given directly.
#[derive(Debug)]
pub(crate) struct Singles {
    /// Their environment string.
    pub environment: String,
    /// Their variables.
    pub env: Vec<(String, String)>,
    /// Their limits.
    pub limits: WrittenLimits,
}

/// What holds for plug-ins that are given directly, with this environment string.
pub(crate) fn of_singles(
    view: Option<&View>,
    environment: &str,
    (asked, user): (&Asked, &HashMap<String, String>),
) -> Singles {
    let params = Params { view, asked, user };
    let mut singles = Singles {
        environment: environment.to_owned(),
        env: params.variables(),
        limits: WrittenLimits::default(),
    };
    if let Some(view) = view {
        variables(&mut singles.env, view);
        singles.limits = test_limits(singles.limits, view, scale(view));
        if environment.is_empty() {
            singles.environment = view.text("environment").unwrap_or_default().to_owned();
        }
    }
    singles
}

fn scale(view: &View) -> f64 {
    view.text("timeouts.scale").and_then(|text| text.parse().ok()).unwrap_or(1.0)
}

fn test_limits(written: WrittenLimits, view: &View, scale: f64) -> WrittenLimits {
    let built_in = defaults::TEST;
    let limit = |written: Option<Duration>, key: &str, built_in: Duration| {
        let known = written.or_else(|| view.duration(&format!("timeouts.{key}")));
        (scale != 1.0).then(|| scaled(known.unwrap_or(built_in), scale)).or(known)
    };
    WrittenLimits {
        load: limit(written.load, "load", built_in.load),
        setup: limit(written.setup, "setup", built_in.setup),
        run: limit(written.run, "run", built_in.run),
        teardown: limit(written.teardown, "teardown", built_in.teardown),
        slow: limit(written.slow, "slow", built_in.slow),
        // Force must not come later because the robot is slow.
        grace: written.grace.or_else(|| view.duration("timeouts.grace")),
    }
}

fn scaled(limit: Duration, scale: f64) -> Duration {
    Duration::try_from_secs_f64(limit.as_secs_f64() * scale).map_or(LONGEST, |it| it.min(LONGEST))
}

/// Where parameters come from: command line > user's variables > profile > file.
struct Params<'a> {
    view: Option<&'a View>,
    asked: &'a Asked,
    user: &'a HashMap<String, String>,
}

impl Params<'_> {
    fn get(&self, name: &str) -> Option<String> {
        let given = self.asked.params.iter().rev().find(|(known, _)| known == name);
        let given = given.map(|(_, value)| value.clone());
        given
            .or_else(|| self.user.get(&param::variable(name)).cloned())
            .or_else(|| Some(self.view?.text(&format!("param.{name}"))?.to_owned()))
    }

    /// All that are known, as variables.
    fn variables(&self) -> Vec<(String, String)> {
        let written = self.view.into_iter().flat_map(|view| view.table("param"));
        let names = written.map(|(name, _)| name.to_owned());
        let mut names: Vec<_> =
            names.chain(self.asked.params.iter().map(|(name, _)| name.clone())).collect();
        names.sort();
        names.dedup();
        let value = |name: String| Some((param::variable(&name), self.get(&name)?));
        names.into_iter().filter_map(value).collect()
    }
}

/// Replaces `${param:…}` in a suite.
struct Filler<'a> {
    params: &'a Params<'a>,
    source: &'a Source,
    problems: Vec<Diagnostic>,
}

impl Filler<'_> {
    fn fill(mut self, suite: &mut Suite) -> Vec<Diagnostic> {
        let span = suite.span;
        self.text(&mut suite.environment, span);
        self.env(&mut suite.env, span);
        for test in &mut suite.tests {
            self.env(&mut test.env, test.span);
            self.plugin(&mut test.plugin);
        }
        for fixture in &mut suite.fixtures {
            self.env(&mut fixture.env, fixture.span);
            match &mut fixture.body {
                FixtureKind::Plugin(plugin) => self.plugin(plugin),
                FixtureKind::Process(process) => {
                    let span = process.command.span;
                    self.words(&mut process.command.value, span);
                    self.probes(process.ready.iter_mut().chain(&mut process.alive));
                }
                FixtureKind::Attached(attached) => {
                    self.probes(attached.ready.iter_mut().chain(&mut attached.alive));
                }
            }
        }
        for hook in &mut suite.hooks {
            match &mut hook.body {
                HookKind::Plugin(plugin) => {
                    self.plugin(plugin);
                    self.env(&mut hook.env, plugin.name.span);
                }
                HookKind::Command(command) => {
                    self.words(&mut command.value, command.span);
                    self.env(&mut hook.env, command.span);
                }
            }
        }
        self.problems
    }

    fn probes<'p>(&mut self, probes: impl Iterator<Item = &'p mut Probe>) {
        for probe in probes {
            match &mut probe.question {
                Question::Tcp(text) | Question::Http(text) | Question::File(text) => {
                    self.text(text, probe.span);
                }
                Question::Command(words) => self.words(words, probe.span),
                Question::Middleware(asked) => self.text(&mut asked.name, probe.span),
                Question::Log(_) => {}
            }
        }
    }

    fn plugin(&mut self, plugin: &mut Plugin) {
        self.text(&mut plugin.param, plugin.name.span);
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
        let value = |name: &str| self.params.get(name);
        *text = param::expand(text, value, &mut |name| missing.push(name.to_owned()));
        for name in missing {
            self.problems.push(self.unknown(&name, span));
        }
    }

    fn unknown(&self, name: &str, span: Span) -> Diagnostic {
        let problem =
            Diagnostic::error("unknown-param", format!("nothing says what `${{param:{name}}}` is"))
                .label(self.source.label(span, "needed here"));
        let known = self.params.view.into_iter().flat_map(|view| view.table("param"));
        match crate::suite::nearest(name, known.map(|(known, _)| known)) {
            Some(near) => problem.hint(format!("did you mean `${{param:{near}}}`?")),
            None => problem.hint(format!(
                "write it under `[param]` in `rtf.toml`, give `--set {name}=VALUE`, or a default: \
                 `${{param:{name}=VALUE}}`"
            )),
        }
    }
}
