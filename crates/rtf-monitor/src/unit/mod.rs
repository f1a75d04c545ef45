//! Units: their names, and whether the sides of a comparison have compatible ones.

mod convert;
mod table;

use std::collections::BTreeMap;
use std::ops::Range;

pub(crate) use convert::convert;

/// A comparison, sum, `min` or `max` of values with different units.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct UnitError {
    /// The part of the text, in bytes.
    pub range: Range<usize>,
    pub message: String,
    pub hint: Option<String>,
}

/// A unit: powers of base units, and a factor.
#[derive(Clone, Debug, PartialEq)]
struct Unit {
    /// How it is written in messages.
    text: String,
    /// Its size in base units.
    scale: f64,
    /// The exponents of the base units that are not zero.
    powers: BTreeMap<String, i32>,
}

impl Unit {
    /// Parses a unit. A name that is not in the table is a base unit that only equals itself.
    fn parse(text: &str) -> Self {
        let text = text.trim();
        let mut unit = Self { text: text.to_owned(), scale: 1.0, powers: BTreeMap::new() };
        for (index, part) in text.split('/').enumerate() {
            let sign = if index == 0 { 1 } else { -1 };
            for factor in part.split(['*', '·', ' ']).filter(|factor| !matches!(*factor, "" | "1"))
            {
                unit.multiply_factor(factor, sign);
            }
        }
        unit
    }

    fn multiply_factor(&mut self, factor: &str, sign: i32) {
        let (name, exponent) = split_exponent(factor);
        let exponent = exponent.saturating_mul(sign);
        match table::find(name) {
            Some((scale, powers)) => {
                self.scale *= scale.powi(exponent);
                for (base, power) in powers {
                    self.multiply_base(base, power.saturating_mul(exponent));
                }
            }
            None => self.multiply_base(name, exponent),
        }
    }

    fn multiply_base(&mut self, base: &str, exponent: i32) {
        let power = self.powers.entry(base.to_owned()).or_default();
        *power = power.saturating_add(exponent);
        if *power == 0 {
            self.powers.remove(base);
        }
    }

    /// The product with a power of another unit.
    fn times(&self, other: &Self, exponent: i32) -> Self {
        let sign = if exponent < 0 { '/' } else { '*' };
        let mut product = self.clone();
        product.text = match (self.text.as_str(), other.text.as_str()) {
            (text, "") => text.to_owned(),
            ("", text) if exponent > 0 => text.to_owned(),
            ("", text) => format!("1/{text}"),
            (left, right) => format!("{left}{sign}{right}"),
        };
        product.scale *= other.scale.powi(exponent);
        for (base, power) in &other.powers {
            product.multiply_base(base, power.saturating_mul(exponent));
        }
        product
    }

    /// Whether values of both can be compared.
    fn is_compatible(&self, other: &Self) -> bool {
        self.powers == other.powers
    }
}

/// `m^2`, `m2`, `m²` → `m`, 2.
fn split_exponent(factor: &str) -> (&str, i32) {
    for (suffix, exponent) in [("²", 2), ("³", 3)] {
        if let Some(name) = factor.strip_suffix(suffix) {
            return (name, exponent);
        }
    }
    let digits = factor.trim_end_matches(|c: char| c.is_ascii_digit());
    let name = digits.strip_suffix('-').unwrap_or(digits);
    match factor[name.len()..].parse::<i32>() {
        Ok(exponent) if !name.is_empty() => (name.strip_suffix('^').unwrap_or(name), exponent),
        _ => (factor, 1),
    }
}

/// The length of the unit at the start of a text, which follows a number without a space: `rad`,
/// `m/s`, `m/s^2`. After `/` or `*`, only the name of a known unit belongs to it.
pub(crate) fn literal_length(text: &str) -> usize {
    let mut length = factor_length(text);
    while length > 0 {
        let Some(rest) = text[length..].strip_prefix(['/', '*', '·']) else { break };
        let next = factor_length(rest);
        if next == 0 || table::find(split_exponent(&rest[..next]).0).is_none() {
            break;
        }
        length = text.len() - rest.len() + next;
    }
    length
}

/// The length of a name and its exponent.
fn factor_length(text: &str) -> usize {
    let is_letter = |c: char| c.is_alphabetic() || matches!(c, '°' | '%');
    let rest = text.trim_start_matches(is_letter);
    if rest.len() == text.len() {
        return 0;
    }
    if let Some(rest) = rest.strip_prefix(['²', '³']) {
        return text.len() - rest.len();
    }
    let sign = rest.strip_prefix('^').map_or(rest, |rest| rest.strip_prefix('-').unwrap_or(rest));
    let digits = sign.trim_start_matches(|c: char| c.is_ascii_digit());
    let end = if digits.len() == sign.len() { rest } else { digits };
    text.len() - end.len()
}

#[cfg(test)]
mod tests {
    use super::{Unit, literal_length};

    #[test]
    fn units_with_the_same_powers_are_compatible() {
        let compatible = [
            ("rad", "deg"),
            ("m/s", "km/h"),
            ("Nm", "N*m"),
            ("Hz", "1/s"),
            ("m/s^2", "mm/s2"),
            ("°C", "degC"),
            ("%", ""),
            ("MiB", "kB"),
            ("rpm", "rad/s"),
            ("m²", "m*m"),
            ("ticks", "ticks"),
            ("W", "J/s"),
            ("V*A", "W"),
        ];
        for (left, right) in compatible {
            assert!(Unit::parse(left).is_compatible(&Unit::parse(right)), "{left} {right}");
        }
        let different =
            [("rad", "m"), ("", "rad"), ("°C", "K"), ("ticks", "tocks"), ("Hz", "rad/s")];
        for (left, right) in different {
            assert!(!Unit::parse(left).is_compatible(&Unit::parse(right)), "{left} {right}");
        }
    }

    #[test]
    fn sizes() {
        let size = |from: &str, to: &str| Unit::parse(from).scale / Unit::parse(to).scale;
        assert!((size("deg", "rad") - std::f64::consts::PI / 180.0).abs() < 1e-15);
        assert!((size("km/h", "m/s") - 1.0 / 3.6).abs() < 1e-15);
        assert!((size("m/s^2", "mm/s2") - 1000.0).abs() < 1e-9);
        assert!((size("MiB", "B") - 1_048_576.0).abs() < 1e-9);
        assert!((size("rpm", "rad/s") - std::f64::consts::TAU / 60.0).abs() < 1e-15);
    }

    #[test]
    fn the_unit_of_a_constant_ends_where_a_signal_may_begin() {
        let cases = [
            ("rad)", 3),
            ("m/s < 1", 3),
            ("m/s^2", 5),
            ("m/x", 1),
            ("m*s", 3),
            (" m", 0),
            ("%", 1),
            ("°C", 3),
            ("m²/s", 5),
            ("]", 0),
        ];
        for (text, length) in cases {
            assert_eq!(literal_length(text), length, "{text}");
        }
    }
}
