//! Finds the change points of series, for comparisons with other programs.
//!
//! Each line of standard input is `{"values": […], "per_test": 0.001, "min_segment": 1}`, of
//! which only `values` is required; `null` is a value that is not a number. The answer is a line
//! of JSON.

use std::io::{BufRead, Write};

use rtf_history::statistics::change_points::{Level, Options, find_change_points};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Series {
    values: Vec<Option<f64>>,
    per_test: Option<f64>,
    per_series: Option<f64>,
    min_segment: Option<usize>,
    limits_span: Option<f64>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut output = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let series: Series = serde_json::from_str(&line?)?;
        let values = series.values.iter().map(|value| value.unwrap_or(f64::NAN));
        let default = Options::default();
        let level = series.per_test.map(Level::PerTest).or(series.per_series.map(Level::PerSeries));
        let options = Options {
            level: level.unwrap_or(default.level),
            min_segment: series.min_segment.unwrap_or(default.min_segment),
            limits_span: series.limits_span,
            ..default
        };
        let found = find_change_points(&values.collect::<Vec<_>>(), &options);
        serde_json::to_writer(&mut output, &found)?;
        writeln!(output)?;
    }
    Ok(())
}
