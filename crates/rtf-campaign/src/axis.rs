//! The values of a parameter, to count results by them.

use std::collections::BTreeMap;

use rtf_statistics::{CONFIDENCE, strata};

use crate::episodes::sampler::number_of;

/// A parameter with more different numbers is divided into bins.
const MAX_WORDS: usize = 8;
const BINS: usize = 6;

/// The values of a parameter: words, or ranges of numbers.
pub(crate) struct Axis {
    /// The values, or the ranges, in their order.
    pub labels: Vec<String>,
    /// The upper ends of the ranges but the last; `None` for words.
    ends: Option<Vec<f64>>,
}

impl Axis {
    pub fn new(values: &[&str]) -> Self {
        let numbers: Option<Vec<f64>> = values.iter().map(|text| number_of(text)).collect();
        let words: BTreeMap<_, _> = values.iter().map(|text| (sort_key(text), *text)).collect();
        match numbers {
            Some(numbers) if words.len() > MAX_WORDS => {
                let numbers: Vec<_> = numbers.into_iter().map(|number| (number, true)).collect();
                let bins = strata(&numbers, BINS, CONFIDENCE);
                let label = |low: f64, high: f64| format!("{} to {}", short(low), short(high));
                Self {
                    labels: bins.iter().map(|bin| label(bin.low, bin.high)).collect(),
                    ends: Some(bins.iter().skip(1).map(|bin| bin.low).collect()),
                }
            }
            _ => {
                let labels = words.into_values().map(str::to_owned).collect();
                Self { labels, ends: None }
            }
        }
    }

    /// The index of the label of a value.
    pub fn place(&self, text: &str) -> usize {
        match &self.ends {
            Some(ends) => {
                let number = number_of(text).unwrap_or_default();
                ends.partition_point(|end| *end <= number)
            }
            None => self.labels.iter().position(|label| label == text).unwrap_or_default(),
        }
    }
}

/// Numbers in their order, then words.
fn sort_key(text: &str) -> (bool, u64, &str) {
    match number_of(text) {
        Some(number) => {
            let bits = number.to_bits();
            let ordered = if number.is_sign_negative() { !bits } else { bits | (1 << 63) };
            (false, ordered, text)
        }
        None => (true, 0, text),
    }
}

/// A number with three significant digits.
fn short(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let digits = 2 - number.abs().log10().floor() as i32;
    let text = format!("{number:.*}", usize::try_from(digits.clamp(0, 12)).unwrap_or_default());
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 0.166_666, 1.0, 12.345, 1234.5, -0.000_123_4].map(short);
        assert_eq!(texts, ["0", "0.167", "1", "12.3", "1234", "-0.000123"]);
    }
}
