//! A number with a unit, as a side of a limit.

use crate::suite::Span;

/// A side of a limit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bound {
    pub value: f64,
    /// The unit; empty for that of the signal.
    pub unit: String,
    /// Its position; `None` for one of the model.
    pub span: Option<Span>,
}

impl Bound {
    /// Reads `1.05rad`, `-2e-3 m` or `7`.
    pub fn parse(text: &str, span: Span) -> Option<Self> {
        let text = text.trim();
        let is_number = |(at, c): (usize, char)| {
            let next = text[at + c.len_utf8()..].chars().next();
            let is_exponent = matches!(c, 'e' | 'E')
                && next.is_some_and(|next| next.is_ascii_digit() || matches!(next, '+' | '-'));
            let is_signed = matches!(c, '+' | '-') && (at == 0 || text[..at].ends_with(['e', 'E']));
            c.is_ascii_digit() || c == '.' || is_exponent || is_signed
        };
        let end = text.char_indices().find(|it| !is_number(*it)).map_or(text.len(), |(at, _)| at);
        let value = text[..end].parse::<f64>().ok().filter(|value| value.is_finite())?;
        let unit = text[end..].trim().to_owned();
        let first = |c: char| c.is_alphabetic() || matches!(c, '%' | '°');
        let other = |c: char| c.is_alphanumeric() || matches!(c, '%' | '°' | '/' | '*' | '^' | '-');
        let is_unit = unit.is_empty() || (unit.starts_with(first) && unit.chars().all(other));
        is_unit.then_some(Self { value, unit, span: Some(span) })
    }

    pub fn of_model(value: f64, unit: &str) -> Self {
        Self { value, unit: unit.to_owned(), span: None }
    }

    /// As a constant of a formula, which has no exponents.
    pub fn constant(&self) -> String {
        format!("{}{}", self.value, self.unit)
    }

    fn with(&self, value: f64) -> Self {
        Self { value: rounded(value), ..self.clone() }
    }
}

/// The sides of a limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Bounds {
    pub min: Option<Bound>,
    pub max: Option<Bound>,
}

impl Bounds {
    pub fn tightened(&self, factor: f64) -> Self {
        if factor >= 1.0 {
            return self.clone();
        }
        match (&self.min, &self.max) {
            // Other units were reported.
            (Some(min), Some(max)) if min.unit == max.unit => {
                let middle = f64::midpoint(min.value, max.value);
                let half = (max.value - min.value) / 2.0 * factor;
                Self { min: Some(min.with(middle - half)), max: Some(max.with(middle + half)) }
            }
            (min, max) => {
                let lower = |value: f64| if value > 0.0 { value * factor } else { value / factor };
                let raise = |value: f64| if value > 0.0 { value / factor } else { value * factor };
                Self {
                    min: min.as_ref().map(|it| it.with(raise(it.value))),
                    max: max.as_ref().map(|it| it.with(lower(it.value))),
                }
            }
        }
    }
}

/// Removes the noise of the last binary digits: 1.05 · 0.9 is 0.945.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(text: &str) -> Option<(f64, String)> {
        Bound::parse(text, Span::new(0..1)).map(|bound| (bound.value, bound.unit))
    }

    #[test]
    fn numbers_and_units_are_separated() {
        let parsed = |value: f64, unit: &str| Some((value, unit.to_owned()));
        assert_eq!(bound("1.05rad"), parsed(1.05, "rad"));
        assert_eq!(bound(" -2e-3 m/s^2 "), parsed(-0.002, "m/s^2"));
        assert_eq!(bound("7"), parsed(7.0, ""));
        assert_eq!(bound("60°C"), parsed(60.0, "°C"));
        assert_eq!(bound("1e3"), parsed(1000.0, ""));
        assert_eq!(bound("2eV"), parsed(2.0, "eV"));
        for text in ["", "rad", "1-2", "1.2.3m", "inf", "nan", "1e999", "1 m m", "1*q", "1)or(q"] {
            assert_eq!(bound(text), None, "{text}");
        }
        assert_eq!(Bound::of_model(1e-7, "m").constant(), "0.0000001m");
    }

    #[test]
    fn tightened_limits_are_narrower() {
        let bounds = |min: Option<f64>, max: Option<f64>| Bounds {
            min: min.map(|value| Bound::of_model(value, "")),
            max: max.map(|value| Bound::of_model(value, "")),
        };
        let tight = |min, max, factor| bounds(min, max).tightened(factor);
        assert_eq!(tight(Some(-2.0), Some(1.0), 0.9), bounds(Some(-1.85), Some(0.85)));
        assert_eq!(tight(None, Some(1.05), 0.9), bounds(None, Some(0.945)));
        assert_eq!(tight(None, Some(-2.0), 0.5), bounds(None, Some(-4.0)));
        assert_eq!(tight(Some(0.1), None, 0.5), bounds(Some(0.2), None));
        assert_eq!(tight(Some(-1.0), None, 0.5), bounds(Some(-0.5), None));
        assert_eq!(tight(Some(0.0), Some(0.3), 1.0), bounds(Some(0.0), Some(0.3)));
    }
}
