//! The quantities of faults: sizes, shares, bandwidths and times.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::FaultTime;

use super::reader::ElementReader;
use super::{DurationError, Spanned, parse_duration};

/// Units of sizes.
const UNITS: [(&str, u64); 8] = [
    ("KiB", 1 << 10),
    ("MiB", 1 << 20),
    ("GiB", 1 << 30),
    ("kB", 1_000),
    ("KB", 1_000),
    ("MB", 1_000_000),
    ("GB", 1_000_000_000),
    ("B", 1),
];

/// Units of bandwidths, the longest first.
const RATES: [(&str, u64); 4] =
    [("kbit", 1_000), ("Mbit", 1_000_000), ("Gbit", 1_000_000_000), ("bit", 1)];

/// The share of the time in which slow processes may run, in percent.
pub(super) fn percent(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<u32> {
    let Some(cpu) = reader.word(node, "cpu") else {
        reader.missing(node, "the attribute `cpu`: the share of the time, for example `20%`");
        return None;
    };
    let percent = cpu.value.strip_suffix('%').and_then(|number| number.trim().parse::<u32>().ok());
    let percent = percent.filter(|percent| (1..=99).contains(percent));
    if percent.is_none() {
        reader.wrong("cpu", &cpu, "is not a percentage from `1%` to `99%`", None);
    }
    percent
}

/// A size in bytes, at least `min`.
pub(super) fn size(
    reader: &mut ElementReader<'_>,
    name: &str,
    text: &Spanned<String>,
    min: u64,
) -> Option<u64> {
    let size = parse_size(&text.value).filter(|size| *size >= min);
    if size.is_none() {
        let hint = "write it like `500MB`, `2GiB` or `64KiB`";
        reader.wrong(name, text, "is not a size", Some(hint));
    }
    size
}

fn parse_size(text: &str) -> Option<u64> {
    if text == "0" {
        return Some(0);
    }
    let (number, factor) =
        UNITS.iter().find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, *factor)))?;
    number.trim_end().parse::<u64>().ok()?.checked_mul(factor)
}

/// A percentage, in parts per million.
pub(super) fn share(reader: &mut ElementReader<'_>, node: Node<'_, '_>, name: &str) -> u32 {
    let Some(text) = reader.word(node, name) else { return 0 };
    let percent = text.value.strip_suffix('%').and_then(|it| it.trim_end().parse::<f64>().ok());
    match percent.filter(|percent| (0.0..=100.0).contains(percent)) {
        Some(percent) => (percent * 1e4).round() as u32,
        None => {
            reader.wrong(name, &text, "is not a percentage from `0%` to `100%`", None);
            0
        }
    }
}

/// A bandwidth, in bits per second.
pub(super) fn rate(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<u64> {
    let text = reader.word(node, "rate")?;
    let parsed = RATES.iter().find_map(|(unit, factor)| {
        let number = text.value.strip_suffix(unit)?.trim_end().parse::<u64>().ok()?;
        number.checked_mul(*factor)
    });
    let rate = parsed.filter(|rate| *rate > 0);
    if rate.is_none() {
        let hint = "write it like `500kbit` or `10Mbit`, per second";
        reader.wrong("rate", &text, "is not a bandwidth", Some(hint));
    }
    rate
}

/// Reads a time, or a range of times: `1s..3s`.
pub(super) fn time(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
    min: Duration,
) -> Option<FaultTime> {
    let text = reader.word(node, name)?;
    let (from, to) = text.value.split_once("..").unwrap_or((&text.value, &text.value));
    let times = [from, to].map(|time| parse_time(time).filter(|time| *time >= min));
    match times {
        [Some(from), Some(to)] if from <= to => {
            let micros = |time: Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
            Some(FaultTime { from_us: micros(from), to_us: micros(to) })
        }
        _ => {
            let hint = "write it like `250ms` or `2s`, or `1s..3s` for a random time";
            reader.wrong(name, &text, "is not a duration or a range", Some(hint));
            None
        }
    }
}

/// A duration that may be zero.
fn parse_time(text: &str) -> Option<Duration> {
    match parse_duration(text) {
        Ok(duration) => Some(duration),
        Err(DurationError::NotPositive) if !text.contains('-') => Some(Duration::ZERO),
        Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_times() {
        assert_eq!(parse_size("500MB"), Some(500_000_000));
        assert_eq!(parse_size("2 GiB"), Some(2 << 30));
        assert_eq!(parse_size("0"), Some(0));
        for text in ["", "5", "GB", "-1MB", "1.5GB", "99999999999GiB"] {
            assert_eq!(parse_size(text), None, "{text}");
        }
        assert_eq!(parse_time("0"), Some(Duration::ZERO));
        assert_eq!(parse_time("0s"), Some(Duration::ZERO));
        assert_eq!(parse_time("-1s"), None);
        assert_eq!(parse_time(""), None);
    }
}
