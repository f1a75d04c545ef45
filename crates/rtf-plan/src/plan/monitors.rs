//! The monitors of a suite: their formulas, checked against its signals, and those of its plan.

use std::ops::Range;

use rtf_model::{Diagnostic, Location, MonitorConfig, SignalsConfig};
use rtf_monitor::Formula;

use super::hosts::SIGNALS;
use super::of_tests::OfTests;
use super::{FixtureBody, SuitePlan};
use crate::suite::{DeclaredMonitor, DeclaredSignal, SourceText, episode_reference, position_of};
use crate::wording::{quoted, suggest_or};

/// Plans the monitors of a suite and of its tests, and reports invalid ones.
pub(super) fn plan(
    of_suite: &[DeclaredMonitor],
    of_tests: &OfTests<DeclaredMonitor>,
    signals: &[&DeclaredSignal],
    (source, problems): (&SourceText, &mut Vec<Diagnostic>),
) -> Vec<MonitorConfig> {
    let all = of_tests.with_suite(of_suite, source, problems);
    let mut plans = Vec::new();
    for (monitor, tests) in all {
        // Combinations of a matrix have the same problems.
        let mut found = FormulaCheck { monitor, signals, source }.problems();
        found.retain(|problem| !problems.contains(problem));
        problems.append(&mut found);
        let location = Location { file: source.name().to_owned(), line: source.line(monitor.span) };
        plans.push(MonitorConfig {
            name: monitor.name.value.clone(),
            formula: monitor.formula.value.clone(),
            severity: monitor.severity,
            location,
            origin: None,
            tests,
        });
    }
    plans
}

impl SuitePlan {
    /// Returns the monitors of its tests.
    #[must_use]
    pub fn monitors(&self) -> Vec<MonitorConfig> {
        let plugins = self.fixtures.iter().rev().filter_map(|fixture| match &fixture.body {
            FixtureBody::Plugin(plugin) if &*plugin.plugin_type == SIGNALS.name => Some(plugin),
            _ => None,
        });
        // The planner wrote the parameters.
        let configs = plugins.filter_map(|plugin| serde_json::from_str(&plugin.param).ok());
        configs.map(|config: SignalsConfig| config.monitors).next().unwrap_or_default()
    }
}

struct FormulaCheck<'a> {
    monitor: &'a DeclaredMonitor,
    signals: &'a [&'a DeclaredSignal],
    source: &'a SourceText,
}

impl FormulaCheck<'_> {
    fn problems(&self) -> Vec<Diagnostic> {
        // A parameter of a campaign is a number, which is not known yet.
        let text = episode_reference::replace(&self.monitor.formula.value, "1");
        let formula = match Formula::parse(&text) {
            Ok(formula) => formula,
            Err(error) => {
                let problem = Diagnostic::error("invalid-formula", error.message);
                return vec![self.at(problem, error.range, error.hint)];
            }
        };
        let references = formula.signals().iter();
        let mut problems: Vec<_> = references
            .filter(|reference| self.unit_of(&reference.name).is_none())
            .map(|reference| {
                self.at(self.unknown_signal(&reference.name), reference.range.clone(), None)
            })
            .collect();
        // Nothing is known about the unit of an unknown signal.
        if problems.is_empty()
            && let Err(errors) = formula.check_units(&|name| self.unit_of(name))
        {
            for error in errors {
                let problem = Diagnostic::error("unit-mismatch", error.message);
                problems.push(self.at(problem, error.range, error.hint));
            }
        }
        problems
    }

    fn unit_of(&self, name: &str) -> Option<String> {
        let signal = self.signals.iter().find(|signal| signal.name.value == name)?;
        Some(signal.unit.value.clone())
    }

    fn unknown_signal(&self, name: &str) -> Diagnostic {
        let problem = Diagnostic::error("unknown-signal", format!("there is no signal `{name}`"));
        let known = || self.signals.iter().map(|signal| signal.name.value.as_str());
        suggest_or(problem, name, known(), |problem| match self.signals {
            [] => problem.hint("declare it with `<signal>` in the suite"),
            _ => problem.note(format!("the suite has {}", quoted(known(), ", "))),
        })
    }

    fn at(&self, problem: Diagnostic, range: Range<usize>, hint: Option<String>) -> Diagnostic {
        let formula = &self.monitor.formula;
        let written = self.source.text().get(formula.span.range()).unwrap_or_default();
        let problem = Diagnostic { hint: hint.or(problem.hint), ..problem };
        if written.contains("${") {
            let note = format!("with its parameters, the formula is `{}`", formula.value);
            problem.label(self.source.label(formula.span, "")).note(note)
        } else {
            let span = position_of(self.source, formula, range);
            problem.label(self.source.label(span, ""))
        }
    }
}
