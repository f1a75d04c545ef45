//! Values that fixtures hand to tests, hooks and other fixtures.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::FixtureId;

/// A fixture provides a value during its set-up.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FixtureProvided {
    /// The fixture.
    pub fixture: FixtureId,
    /// The name of the value, unique in the fixture.
    pub name: String,
    /// Any JSON value except `null`; a secret has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<Value>,
    /// Whether the value is neither stored nor shown.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub secret: bool,
}

impl FixtureProvided {
    /// The text that reports show instead of a secret.
    pub const SECRET: &str = "***";
    /// The longest name, in characters.
    pub const MAX_NAME_LENGTH: usize = 32;

    /// Checks a name: a letter, followed by letters, digits, `-` and `_`.
    #[must_use]
    pub fn is_name(name: &str) -> bool {
        let known = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(known)
            && name.len() <= Self::MAX_NAME_LENGTH
    }

    /// The environment variable that holds the value `name` of a fixture.
    #[must_use]
    pub fn variable(fixture: &str, name: &str) -> String {
        let letter = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
        let letters = |text: &str| text.chars().map(letter).collect::<String>();
        format!("RTF_FIXTURE_{}_{}", letters(fixture), letters(name))
    }

    /// The text of the value for reports.
    #[must_use]
    pub fn text(&self) -> Cow<'_, str> {
        self.value.as_ref().map_or(Cow::Borrowed(Self::SECRET), value_text)
    }
}

/// The text of a value: of a string the string, of any other value its compact JSON.
#[must_use]
pub fn value_text(value: &Value) -> Cow<'_, str> {
    match value {
        Value::String(text) => Cow::Borrowed(text),
        other => Cow::Owned(other.to_string()),
    }
}
