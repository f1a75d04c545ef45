//! Parses an `rtf.toml` into [`Layer`]s and reports every problem with its position.

use rtf_model::Diagnostic;
use toml::de::{DeTable, DeValue};

use super::keys::{KEYS, Key, NameKind, REPORTS, ValueFormat};
use super::quarantine::{self, QUARANTINE, Quarantine};
use super::toml_value::{TomlKey, TomlReader, TomlValue, is_text, scalar, span};
use super::unknown_profile::suggest_profile;
use crate::suite::{SourceText, Span, Spanned, is_reserved, parse_duration};
use crate::wording::quoted;

/// One value of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its full key: `timeouts.run`.
    pub key: String,
    /// Its value as text; several only for `reports`.
    pub values: Vec<Spanned<String>>,
    /// The position of the key.
    pub span: Span,
}

/// The values of a file or of one of its profiles.
#[derive(Clone, Debug, Default)]
pub struct Layer {
    pub entries: Vec<Entry>,
    pub quarantines: Vec<Quarantine>,
}

impl Layer {
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }
}

/// The contents of an `rtf.toml`.
#[derive(Debug, Default)]
pub struct ParsedConfig {
    /// The profile that applies unless the user selects one.
    pub profile: Option<Spanned<String>>,
    /// The values outside of profiles.
    pub defaults: Layer,
    pub profiles: Vec<(Spanned<String>, Layer)>,
}

/// Parses the text of an `rtf.toml`, and adds every problem to `problems`.
pub fn parse(source: &SourceText, problems: &mut Vec<Diagnostic>) -> ParsedConfig {
    let (table, errors) = DeTable::parse_recoverable(source.text());
    for error in errors {
        let span = Span::new(error.span().unwrap_or_default());
        let message = format!("not TOML: {}", error.message().lines().next().unwrap_or_default());
        problems.push(source.error("not-toml", span, message));
    }
    let mut reader = TomlReader { source, problems };
    let mut parsed = ParsedConfig::default();
    for (key, value) in table.get_ref() {
        match (key.get_ref().as_ref(), value.get_ref()) {
            ("profile", DeValue::Table(profiles)) => {
                for (name, value) in profiles {
                    let name = Spanned::new(name.get_ref().to_string(), span(name));
                    let mut layer = Layer::default();
                    match value.get_ref() {
                        DeValue::Table(table) => reader.table(table, "", KEYS, &mut layer),
                        _ => reader.wrong(&format!("profile.{}", name.value), value, "a table"),
                    }
                    parsed.profiles.push((name, layer));
                }
            }
            ("default-profile", DeValue::String(name)) => {
                parsed.profile = Some(Spanned::new(name.to_string(), span(value)));
            }
            ("default-profile", _) => reader.wrong("default-profile", value, "a text"),
            ("profile", _) => {
                reader.wrong("profile", value, "a table of profiles: `[profile.NAME]`");
            }
            _ => reader.entry(key, value, ("", KEYS), &mut parsed.defaults),
        }
    }
    if let Some(name) = &parsed.profile {
        reader.check_default_profile(name, &parsed.profiles);
    }
    parsed
}

impl TomlReader<'_> {
    fn table(
        &mut self,
        table: &DeTable<'_>,
        prefix: &str,
        keys: &'static [Key],
        layer: &mut Layer,
    ) {
        for (key, value) in table {
            self.entry(key, value, (prefix, keys), layer);
        }
    }

    fn entry(
        &mut self,
        key: &TomlKey<'_>,
        value: &TomlValue<'_>,
        (prefix, keys): (&str, &'static [Key]),
        layer: &mut Layer,
    ) {
        let name = key.get_ref().as_ref();
        if prefix.is_empty() && name == QUARANTINE {
            let found = quarantine::read(self, value);
            return layer.quarantines.extend(found);
        }
        let Some(Key { format: form, .. }) = keys.iter().find(|known| known.name == name) else {
            let mut known: Vec<&str> = keys.iter().map(|known| known.name).collect();
            if prefix.is_empty() {
                known.extend([QUARANTINE, "profile", "default-profile"]);
            }
            return self.unknown(key, prefix, prefix, &known);
        };
        let whole = format!("{prefix}{name}");
        match (form, value.get_ref()) {
            (ValueFormat::Table(keys), DeValue::Table(table)) => {
                self.table(table, &format!("{whole}."), keys, layer);
            }
            (ValueFormat::Named(names), DeValue::Table(table)) => {
                for (key, value) in table {
                    self.named(key, value, (&whole, *names), layer);
                }
            }
            (ValueFormat::Table(_) | ValueFormat::Named(_), _) => {
                self.wrong(&whole, value, "a table")
            }
            (form, _) => {
                if let Some(values) = self.values(&whole, value, *form) {
                    layer.entries.push(Entry { key: whole, values, span: span(key) });
                }
            }
        }
    }

    fn values(
        &mut self,
        key: &str,
        value: &TomlValue<'_>,
        form: ValueFormat,
    ) -> Option<Vec<Spanned<String>>> {
        if let (ValueFormat::Reports, DeValue::Array(list)) = (form, value.get_ref()) {
            return Some(list.iter().filter_map(|value| self.report(value)).collect());
        }
        let text = scalar(value.get_ref());
        let (right, expected) = match form {
            ValueFormat::Text => (is_text(value), "a text".to_owned()),
            ValueFormat::Path => (
                is_text(value) && text.as_ref().is_some_and(|t| !t.is_empty()),
                "a text".to_owned(),
            ),
            ValueFormat::Duration => {
                let good = text.as_ref().is_some_and(|text| parse_duration(text).is_ok());
                (good, "a duration like `\"250ms\"`, `\"2min\"` or `90` (seconds)".to_owned())
            }
            ValueFormat::Scale => {
                let number = text.as_ref().and_then(|text| text.parse::<f64>().ok());
                let good = number.is_some_and(|n| n > 0.0 && n <= 1000.0);
                (good, "a number above 0, up to 1000".to_owned())
            }
            ValueFormat::Count(least, most) => {
                let number = text.as_ref().and_then(|text| text.parse::<u32>().ok());
                let good = number.is_some_and(|n| (least..=most).contains(&n));
                (good, format!("a whole number from {least} to {most}"))
            }
            ValueFormat::Boolean => {
                (matches!(value.get_ref(), DeValue::Boolean(_)), "`true` or `false`".to_owned())
            }
            ValueFormat::Words(words) => {
                let list: Vec<_> = words.iter().map(|word| format!("`\"{word}\"`")).collect();
                let good = text.as_ref().is_some_and(|text| words.contains(&text.as_str()));
                (good, list.join(" or "))
            }
            _ => (false, "a list of `\"FORMAT=PATH\"`".to_owned()),
        };
        match text.filter(|_| right) {
            Some(text) => Some(vec![Spanned::new(text, span(value))]),
            None => {
                self.wrong(key, value, &expected);
                None
            }
        }
    }

    fn report(&mut self, value: &TomlValue<'_>) -> Option<Spanned<String>> {
        let text = scalar(value.get_ref()).filter(|_| is_text(value)).unwrap_or_default();
        match text.split_once('=') {
            Some((format, path)) if REPORTS.contains(&format) && !path.is_empty() => {
                Some(Spanned::new(text, span(value)))
            }
            _ => {
                let formats = quoted(REPORTS, ", ");
                let expected = format!("`\"FORMAT=PATH\"`, where FORMAT is one of {formats}");
                self.wrong("reports", value, &expected);
                None
            }
        }
    }

    /// Reads an entry of a table with user-defined names.
    fn named(
        &mut self,
        key: &TomlKey<'_>,
        value: &TomlValue<'_>,
        (table, names): (&str, NameKind),
        layer: &mut Layer,
    ) {
        let name = key.get_ref().as_ref();
        let wrong = match names {
            NameKind::Variables if name.is_empty() || name.contains('=') => {
                Some("is not the name of a variable")
            }
            NameKind::Variables if is_reserved(name) => Some("is a variable that rtf sets itself"),
            NameKind::Parameters if !super::param_reference::is_name(name) => {
                Some("is not the name of a parameter: letters, digits, `-` and `_`, a letter first")
            }
            _ => None,
        };
        if let Some(wrong) = wrong {
            let problem =
                Diagnostic::error("invalid-value", format!("`{name}` in `{table}` {wrong}"));
            self.problems.push(problem.label(self.source.label(span(key), "")));
            return;
        }
        let whole = format!("{table}.{name}");
        match scalar(value.get_ref()) {
            Some(text) => {
                let values = vec![Spanned::new(text, span(value))];
                layer.entries.push(Entry { key: whole, values, span: span(key) });
            }
            None => self.wrong(&whole, value, "a text, a number, `true` or `false`"),
        }
    }

    fn check_default_profile(
        &mut self,
        name: &Spanned<String>,
        profiles: &[(Spanned<String>, Layer)],
    ) {
        if profiles.iter().any(|(known, _)| known.value == name.value) {
            return;
        }
        let known = profiles.iter().map(|(known, _)| known.value.as_str());
        let label = self.source.label(name.span, "");
        let problem =
            Diagnostic::error("unknown-profile", format!("there is no profile `{}`", name.value));
        self.problems.push(suggest_profile(problem.label(label), &name.value, known));
    }
}
