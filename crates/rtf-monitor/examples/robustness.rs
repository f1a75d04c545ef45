//! Judges formulas, for comparisons with other programs.
//!
//! Each line of standard input is
//! `{"formula": "always x < 1", "signals": {"x": [[0, 0.5], [1, 0.7]]}, "end": 2}`; a value `null`
//! is not a number. The answer is a line `{"verdict": "holds", "robustness": "0.3", "online": …}`
//! or `{"error": "…"}`. `online` is the verdict, the robustness, and the time at which the monitor
//! reports a violation while the samples arrive in the order of their times.

use std::collections::BTreeMap;
use std::io::{BufRead, Write};

use rtf_monitor::{Formula, Monitor, Outcome, judge};
use serde::Deserialize;
use serde_json::{Value, json};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Task {
    formula: String,
    signals: BTreeMap<String, Vec<(f64, Option<f64>)>>,
    end: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut output = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let task: Task = serde_json::from_str(&line?)?;
        let answer = answer(&task).unwrap_or_else(|error| json!({ "error": error.to_string() }));
        writeln!(output, "{answer}")?;
    }
    Ok(())
}

fn answer(task: &Task) -> Result<Value, Box<dyn std::error::Error>> {
    let formula = Formula::parse(&task.formula)?;
    let traces: Vec<Vec<(f64, f64)>> = formula
        .signals()
        .iter()
        .map(|signal| {
            let samples = task.signals.get(&signal.name).into_iter().flatten();
            samples.map(|(time, value)| (*time, value.unwrap_or(f64::NAN))).collect()
        })
        .collect();
    let mut answer = describe(&judge(&formula, &traces, task.end)?);
    let mut monitor = Monitor::new(&formula)?;
    let mut samples: Vec<(f64, usize, f64)> = Vec::new();
    for (signal, trace) in traces.iter().enumerate() {
        samples.extend(trace.iter().map(|(time, value)| (*time, signal, *value)));
    }
    samples.sort_by(|left, right| left.0.total_cmp(&right.0));
    let mut violated = None;
    for (time, signal, value) in samples {
        if let Some(violation) = monitor.sample(signal, time, value) {
            violated = Some(violation.time);
        }
    }
    answer["online"] = describe(&monitor.finish(task.end));
    answer["online"]["time"] = json!(violated);
    Ok(answer)
}

/// A robustness is a text, because JSON has no infinite numbers.
fn describe(outcome: &Outcome) -> Value {
    json!({
        "verdict": format!("{:?}", outcome.verdict),
        "robustness": outcome.robustness.map(|robustness| format!("{robustness:?}")),
    })
}
