//! The keys and values of a TOML file with their positions, and the report of an invalid one.

use rtf_model::Diagnostic;
use toml::de::DeValue;

use crate::suite::{SourceText, Span};
use crate::wording::{nearest, quoted};

pub(super) type TomlKey<'a> = toml::Spanned<toml::de::DeString<'a>>;
pub(super) type TomlValue<'a> = toml::Spanned<DeValue<'a>>;

/// Reads the values of a file.
pub(super) struct TomlReader<'a> {
    pub source: &'a SourceText,
    pub problems: &'a mut Vec<Diagnostic>,
}

impl TomlReader<'_> {
    /// Reports an invalid value.
    pub fn wrong(&mut self, key: &str, value: &TomlValue<'_>, expected: &str) {
        let problem = Diagnostic::error("invalid-value", format!("`{key}` has to be {expected}"));
        self.problems.push(problem.label(self.source.label(span(value), "")));
    }

    /// Reports a key of a table that `prefix` names. Hints name keys after `hint_prefix`.
    pub fn unknown(&mut self, key: &TomlKey<'_>, prefix: &str, hint_prefix: &str, known: &[&str]) {
        let name = key.get_ref().as_ref();
        let message = format!("unknown key `{prefix}{name}`");
        let list = quoted(known.iter().copied(), ", ");
        let problem = self.source.error("unknown-key", span(key), message);
        let problem = problem.note(format!("the keys are {list}"));
        self.problems.push(match nearest(name, known.iter().copied()) {
            Some(near) => problem.hint(format!("did you mean `{hint_prefix}{near}`?")),
            None => problem,
        });
    }
}

pub(super) fn span<T>(value: &toml::Spanned<T>) -> Span {
    Span::new(value.span())
}

pub(super) fn is_text(value: &TomlValue<'_>) -> bool {
    matches!(value.get_ref(), DeValue::String(_))
}

/// Returns the text of a scalar value; numbers keep their notation.
pub(super) fn scalar(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
            .ok()
            .map(|number| number.to_string()),
        DeValue::Float(number) => Some(number.as_str().to_owned()),
        DeValue::Boolean(truth) => Some(truth.to_string()),
        _ => None,
    }
}
