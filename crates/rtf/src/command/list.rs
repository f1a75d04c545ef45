//! `rtf list`: the tests that `rtf run` would run.

use std::io::Write;
use std::process::ExitCode;

use rtf_plan::plan::{Plan, SuitePlan, TestPlan};
use rtf_report::escape;
use serde::Serialize;

use super::Outcome;
use super::planning::{self, Planned};
use crate::cli::{ListArgs, ListFormat};
use crate::error::Failure;

/// Lists.
pub fn run(args: &ListArgs) -> Outcome {
    show(&planning::plan(&args.input, &args.results)?, args.format)
}

/// Lists the tests of a plan.
pub fn show(planned: &Planned, format: ListFormat) -> Outcome {
    planned.show_warnings()?;
    let mut out = std::io::BufWriter::new(anstream::stdout().lock());
    let written = match format {
        ListFormat::Text => write(&planned.plan, &mut out),
        ListFormat::Json => write_json(&planned.plan, &mut out),
    };
    Failure::unless_reader_left(written)?;
    Ok(ExitCode::SUCCESS)
}

fn each(plan: &Plan) -> impl Iterator<Item = (&SuitePlan, &TestPlan)> {
    plan.suites.iter().flat_map(|suite| suite.tests.iter().map(move |test| (suite, test)))
}

fn write(plan: &Plan, out: &mut impl Write) -> std::io::Result<()> {
    for (suite, test) in each(plan) {
        let name = format!("{}/{}", suite.name, test.name);
        writeln!(out, "{}{}", escape::line(&name), notes(test))?;
    }
    out.flush()
}

fn notes(test: &TestPlan) -> String {
    let mut notes = Vec::new();
    if test.repetitions > 1 {
        notes.push(format!("{} times", test.repetitions));
    }
    if test.critical {
        notes.push("critical".to_owned());
    }
    if test.exclusive {
        notes.push("exclusive".to_owned());
    }
    notes.extend(test.tags.iter().map(|tag| format!("#{}", escape::line(tag))));
    if notes.is_empty() { String::new() } else { format!("  ({})", notes.join(", ")) }
}

/// All that is listed.
#[derive(Serialize)]
struct List<'p> {
    tests: Vec<Listed<'p>>,
}

/// A test, for other programs. `docs/running.md` says what the fields mean.
#[derive(Serialize)]
struct Listed<'p> {
    suite: &'p str,
    name: &'p str,
    /// What `rtf run` takes for it alone.
    select: Option<String>,
    file: &'p str,
    r#type: &'p str,
    plugin: String,
    tags: &'p [String],
    repetition: u32,
    critical: bool,
    exclusive: bool,
    /// How many tests of its suite may run at once.
    parallel: u32,
}

fn write_json(plan: &Plan, out: &mut impl Write) -> std::io::Result<()> {
    let tests = each(plan)
        .map(|(suite, test)| Listed {
            suite: &suite.name,
            name: &test.name,
            select: (!suite.file.is_empty()).then(|| format!("{}::{}", suite.file, test.name)),
            file: &suite.file,
            r#type: &test.plugin.plugin_type,
            plugin: test.plugin.file.to_string_lossy().into_owned(),
            tags: &test.tags,
            repetition: test.repetitions,
            critical: test.critical,
            exclusive: test.exclusive,
            parallel: suite.parallel,
        })
        .collect();
    serde_json::to_writer_pretty(&mut *out, &List { tests })?;
    writeln!(out)?;
    out.flush()
}
