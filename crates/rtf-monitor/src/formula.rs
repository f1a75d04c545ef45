//! A parsed formula.

use std::ops::Range;
use std::time::Duration;

use crate::syntax::{self, Condition, ParseError};
use crate::unit::{self, UnitError};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignalReference {
    pub name: String,
    /// The first place in the text, in bytes.
    pub range: Range<usize>,
}

/// A parsed formula. `spec/monitors.md` describes the language.
#[derive(Clone, Debug)]
pub struct Formula {
    pub(crate) text: String,
    pub(crate) condition: Condition,
    signals: Vec<SignalReference>,
}

impl Formula {
    /// Parses a formula.
    ///
    /// # Errors
    /// The text is not a formula, or exceeds a limit of length or nesting.
    pub fn parse(text: &str) -> Result<Self, ParseError> {
        let (condition, signals) = syntax::parse(text)?;
        Ok(Self { text: text.to_owned(), condition, signals })
    }

    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its signals, each once. The index of a signal identifies it in [`crate::Monitor::sample`].
    #[must_use]
    pub fn signals(&self) -> &[SignalReference] {
        &self.signals
    }

    /// Checks the units of constants and signals, and converts the constants and signals of a
    /// comparison to one unit: that of its first signal.
    ///
    /// `unit_of` maps the name of a signal to its unit: an empty text for a pure number, `None` if
    /// the unit is not known. A formula that has constants with units must be converted before it
    /// is monitored.
    ///
    /// # Errors
    /// All places where units do not match.
    pub fn check_units(
        &self,
        unit_of: &dyn Fn(&str) -> Option<String>,
    ) -> Result<Self, Vec<UnitError>> {
        let units: Vec<_> = self.signals.iter().map(|signal| unit_of(&signal.name)).collect();
        let condition = unit::convert(&self.condition, &units)?;
        Ok(Self { text: self.text.clone(), condition, signals: self.signals.clone() })
    }

    /// How far after a time samples may be necessary to judge the formula at this time. `None` if
    /// there is no bound: the formula has `always`, `eventually` or `until` without an interval.
    #[must_use]
    pub fn horizon(&self) -> Option<Duration> {
        Duration::try_from_secs_f64(self.condition.horizon()).ok()
    }
}
