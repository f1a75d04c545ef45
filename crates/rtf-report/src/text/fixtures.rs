//! Fixtures in the text report.

use rtf_model::{FixtureProvided, FixtureRecord, FixtureState};

use super::lines::TextLines;
use crate::explain::{self, Tone};
use crate::{escape, growth, words};

pub(super) fn show(lines: &mut TextLines, fixture: &FixtureRecord) {
    let plan = &fixture.plan;
    lines.fact(2, "fixture", &format!("{} ({})", plan.name, plan.plugin_type));
    lines.at(4, &format!("state: {}", state(fixture.state)));
    if fixture.starts > 1 {
        lines.at(4, &format!("starts: {}", fixture.starts));
    }
    if let Some((start, ready)) = fixture.started.zip(fixture.ready) {
        lines.at(4, &format!("ready after: {}", words::time(ready.since(start))));
    }
    values(lines, &fixture.values);
    for (at, reason) in &fixture.collapses {
        let label = format!("collapsed at {}", words::time(at.as_duration()));
        lines.fact(4, &label, reason);
    }
    // The problem that broke it is shown as `broken`.
    let broke = fixture.broken.as_ref();
    for (at, problem) in fixture.problems.iter().filter(|(_, problem)| broke != Some(problem)) {
        lines.fact(4, &format!("problem at {}", words::time(at.as_duration())), problem);
    }
    if let Some(reason) = &fixture.broken {
        lines.fact(4, "broken", reason);
    }
    growth::lines(&fixture.growth()).iter().for_each(|line| lines.at(4, line));
    for message in &fixture.messages {
        explain::message(message, &mut |_, line| lines.at(4, line));
    }
    explain::left(&fixture.leaked, &mut |_, line| lines.at(4, line));
    if !fixture.log_tail.is_empty() {
        lines.at(4, "last lines before the last problem:");
        fixture.log_tail.iter().for_each(|line| lines.quoted(6, line));
    }
}

/// Writes the values of the last start.
fn values(lines: &mut TextLines, values: &[FixtureProvided]) {
    if !values.is_empty() {
        lines.at(4, "values:");
    }
    for value in values {
        let label = format!("{}: ", escape::line(&value.name));
        explain::block(Tone::Plain, &value.text(), &label, &mut |_, line| lines.at(6, line));
    }
}

fn state(state: FixtureState) -> &'static str {
    match state {
        FixtureState::Pending => "not started",
        FixtureState::Starting => "starting",
        FixtureState::Ready => "ready",
        FixtureState::Collapsed => "collapsed",
        FixtureState::Stopping => "stopping",
        FixtureState::Stopped => "stopped",
        FixtureState::Broken => "broken",
    }
}
