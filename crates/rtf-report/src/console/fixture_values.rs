//! The values of a fixture on its `ready` line.

use rtf_model::FixtureProvided;

use crate::escape;

/// Maximum number of values of a fixture.
const VALUES: usize = 5;

/// Maximum number of characters of a value.
const VALUE_CHARS: usize = 60;

/// `port=40123 device=/dev/ttyUSB0`; `None` without values.
pub(super) fn on_one_line(values: &[FixtureProvided]) -> Option<String> {
    if values.is_empty() {
        return None;
    }
    let shown = values.iter().take(VALUES);
    let shown = shown.map(|each| format!("{}={}", shortened(&each.name), shortened(&each.text())));
    let more = values.len().saturating_sub(VALUES);
    let more = (more > 0).then(|| format!("… and {more} more"));
    Some(shown.chain(more).collect::<Vec<_>>().join(" "))
}

fn shortened(text: &str) -> String {
    // A value has up to 64 KiB. Escaping never shortens it.
    let start: String = text.chars().take(VALUE_CHARS + 1).collect();
    let line = escape::line(&start);
    if line.chars().count() <= VALUE_CHARS {
        return line.into_owned();
    }
    line.chars().take(VALUE_CHARS - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use rtf_model::FixtureId;

    use super::*;

    fn provided(name: &str, value: &str) -> FixtureProvided {
        let (fixture, name) = (FixtureId(0), name.to_owned());
        FixtureProvided { fixture, name, value: Some(value.into()), secret: false }
    }

    #[test]
    fn a_value_is_one_line_of_limited_length() {
        let exact = "x".repeat(VALUE_CHARS);
        assert_eq!(shortened(&exact), exact);
        assert_eq!(shortened(&format!("{exact}x")), format!("{}…", "x".repeat(VALUE_CHARS - 1)));
        assert_eq!(shortened(&"\n".repeat(70)), format!("{}\\…", "\\n".repeat(29)));
        assert_eq!(shortened("a\x1b[31m\nb"), "a\\x1b[31m\\nb");
    }

    #[test]
    fn the_number_of_further_values_is_shown() {
        assert_eq!(on_one_line(&[]), None);
        let secret = FixtureProvided { value: None, secret: true, ..provided("token", "") };
        let mut values = vec![provided("port", "40123"), provided("empty", ""), secret];
        assert_eq!(on_one_line(&values).as_deref(), Some("port=40123 empty= token=***"));
        values.extend(["a", "b", "c", "d"].map(|name| provided(name, "1")));
        let line = on_one_line(&values);
        assert_eq!(line.as_deref(), Some("port=40123 empty= token=*** a=1 b=1 … and 2 more"));
    }
}
