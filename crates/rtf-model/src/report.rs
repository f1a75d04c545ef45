//! Reports of a plug-in: messages, measurements, attachments.

use serde::{Deserialize, Serialize};

use crate::{CaseId, Micros};

/// A location in a plug-in's source.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Location {
    /// The file, as the plug-in's compiler or interpreter names it.
    pub file: String,
    /// The line, from 1; 0 when it is unknown.
    #[serde(default)]
    pub line: u32,
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.line == 0 {
            f.write_str(&self.file)
        } else {
            write!(f, "{}:{}", self.file, self.line)
        }
    }
}

/// The effect of a [`Message`] on the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MessageKind {
    /// Information only.
    Report,
    /// A check held.
    Check,
    /// A check or an assertion did not hold: the robot is wrong.
    Failure,
    /// The plug-in could not run its checks: the bench is wrong.
    Error,
}

/// One message of a plug-in. Its text is never cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Message {
    /// Its effect on the verdict.
    pub kind: MessageKind,
    /// The text; may have several lines.
    pub text: String,
    /// Where in the plug-in it was reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    /// The numbers behind a near-equality check.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
    /// Whether it is unsafe to continue: the rest of the suite is skipped.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub critical: bool,
    /// The case in which it was reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<CaseId>,
    /// When a monitor is violated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<Box<SignalInterval>>,
}

impl Message {
    /// A message that is not critical and has no comparison.
    #[must_use]
    pub fn new(kind: MessageKind, text: impl Into<String>, location: Option<Location>) -> Self {
        let (text, comparison, critical) = (text.into(), None, false);
        Self { kind, text, location, comparison, critical, case: None, interval: None }
    }
}

/// A part of a test's time, and the signals that a problem in it is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalInterval {
    /// The zero of its times, from the runner: when the test was announced to the fixture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub since: Option<Micros>,
    /// Its start, in seconds since the zero.
    pub start: f64,
    /// Its end, in the same time.
    pub end: f64,
    /// The names of the signals.
    pub signals: Vec<String>,
}

/// The numbers behind a near-equality check of a scalar (one entry) or a vector.
/// A number that JSON cannot carry (NaN, infinities) is `null`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// The expected numbers.
    pub expected: Vec<Option<f64>>,
    /// The actual numbers.
    pub got: Vec<Option<f64>>,
    /// The largest accepted absolute difference.
    pub tolerance: f64,
    /// The index with the largest difference, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst: Option<u64>,
}

/// Whether a value is a finite number within its limits, as far as it has any.
pub(crate) fn is_within(value: Option<f64>, low: Option<f64>, high: Option<f64>) -> bool {
    value.is_some_and(|value| {
        low.is_none_or(|low| value >= low) && high.is_none_or(|high| value <= high)
    })
}

/// A number that a test measured, with its limits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measurement {
    /// Its name.
    pub name: String,
    /// The value; `null` when it is not a finite number, which no limit accepts.
    pub value: Option<f64>,
    /// The unit, empty for a pure number.
    #[serde(default)]
    pub unit: String,
    /// The smallest accepted value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// The largest accepted value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    /// Whether the limits are learned from earlier runs. The runner decides this.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub learned: bool,
    /// Where in the plug-in it was taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    /// The case in which it was reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<CaseId>,
}

impl Measurement {
    /// Whether the value lies within its limits. A value without limits does,
    /// a value that is not a finite number does not.
    #[must_use]
    pub fn is_within_limits(&self) -> bool {
        is_within(self.value, self.low, self.high)
    }

    /// Describes a violation of the limits; `None` within the limits.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        if self.is_within_limits() {
            return None;
        }
        let (name, value) = (&self.name, self.value_with_unit());
        Some(match self.limits() {
            limits if limits.is_empty() => format!("`{name}` is {value}"),
            limits if self.learned => {
                format!("`{name}` is {value}, its learned limits are {limits}")
            }
            limits => format!("`{name}` is {value}, its limits are {limits}"),
        })
    }

    /// The limits as text: `0.5 … 2`, `≥ 0.5`, `≤ 2`; empty without limits.
    #[must_use]
    pub fn limits(&self) -> String {
        self.limits_by(format_number)
    }

    /// The value with its unit, and the limits, for display: rounded,
    /// unless the value is outside its limits.
    #[must_use]
    pub fn for_display(&self) -> (String, String) {
        match self.value.filter(|_| self.is_within_limits()) {
            Some(value) => (self.with_unit(format_rounded(value)), self.limits_by(format_rounded)),
            None => (self.value_with_unit(), self.limits()),
        }
    }

    fn limits_by(&self, format: fn(f64) -> String) -> String {
        match (self.low, self.high) {
            (Some(low), Some(high)) => format!("{} … {}", format(low), format(high)),
            (Some(low), None) => format!("≥ {}", format(low)),
            (None, Some(high)) => format!("≤ {}", format(high)),
            (None, None) => String::new(),
        }
    }

    /// The value with its unit: `1.25 rad`, `not a finite number`.
    #[must_use]
    pub fn value_with_unit(&self) -> String {
        match self.value {
            Some(value) => self.with_unit(format_number(value)),
            None => "not a finite number".to_owned(),
        }
    }

    fn with_unit(&self, number: String) -> String {
        if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) }
    }
}

/// A number for display: very large and very small ones have an exponent.
#[must_use]
pub fn format_number(number: f64) -> String {
    match number.abs() {
        size if size != 0.0 && !(1e-5..1e15).contains(&size) => format!("{number:e}"),
        _ => number.to_string(),
    }
}

/// The same with six significant digits, which hide the rounding errors of
/// binary fractions. Not for a number next to a limit that it violates.
#[must_use]
pub fn format_rounded(number: f64) -> String {
    format_number(format!("{number:.5e}").parse().unwrap_or(number))
}

/// A file that a test attaches to its result.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Attachment {
    /// Its name in reports.
    pub name: String,
    /// Its path: from a host, any path; in an event, relative to the run's directory.
    pub path: String,
    /// Its media type (`image/png`), empty if unknown.
    #[serde(default)]
    pub media_type: String,
    /// The case in which it was reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<CaseId>,
    /// The stored picture that it is compared with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<Box<PictureCheck>>,
    /// In a merged run: the file was not kept (`rtf merge --keep`).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub omitted: bool,
}

/// A check that a picture resembles a stored one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PictureCheck {
    /// The file of the stored picture, relative to the working directory.
    pub reference: String,
    /// The largest accepted difference, at least 0: 1 minus the structural similarity.
    pub tolerance: f64,
    /// Where in the plug-in the check is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
}
