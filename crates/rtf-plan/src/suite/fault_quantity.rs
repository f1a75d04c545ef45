//! The quantities of faults: sizes, shares, bandwidths and times.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::FaultTime;

use super::reader::ElementReader;
use super::{DurationError, parse_duration};

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
    if reader.word(node, "cpu").is_none() {
        reader.missing(node, "the attribute `cpu`: the share of the time, for example `20%`");
        return None;
    }
    let parse = |text: &str| text.strip_suffix('%')?.trim().parse().ok();
    let parse = |text: &str| parse(text).filter(|percent| (1..=99).contains(percent));
    reader.parsed(node, "cpu", parse, ("is not a percentage from `1%` to `99%`", None))
}

/// A size in bytes, at least `min`.
pub(super) fn size(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
    min: u64,
) -> Option<u64> {
    let parse = |text: &str| parse_size(text).filter(|size| *size >= min);
    let hint = "write it like `500MB`, `2GiB` or `64KiB`";
    reader.parsed(node, name, parse, ("is not a size", Some(hint)))
}

fn parse_size(text: &str) -> Option<u64> {
    if text == "0" { Some(0) } else { parse_units(text, &UNITS) }
}

/// A whole number with the first of the units that fits.
fn parse_units(text: &str, units: &[(&str, u64)]) -> Option<u64> {
    let (number, factor) =
        units.iter().find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, *factor)))?;
    number.trim_end().parse::<u64>().ok()?.checked_mul(factor)
}

/// A percentage, in parts per million.
pub(super) fn share(reader: &mut ElementReader<'_>, node: Node<'_, '_>, name: &str) -> u32 {
    let parse = |text: &str| text.strip_suffix('%')?.trim_end().parse::<f64>().ok();
    let parse = |text: &str| parse(text).filter(|percent| (0.0..=100.0).contains(percent));
    let expected = ("is not a percentage from `0%` to `100%`", None);
    let percent = reader.parsed(node, name, parse, expected).unwrap_or_default();
    (percent * 1e4).round() as u32
}

/// A bandwidth, in bits per second.
pub(super) fn rate(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<u64> {
    let parse = |text: &str| parse_units(text, &RATES).filter(|rate| *rate > 0);
    let hint = "write it like `500kbit` or `10Mbit`, per second";
    reader.parsed(node, "rate", parse, ("is not a bandwidth", Some(hint)))
}

/// Reads a time, or a range of times: `1s..3s`.
pub(super) fn time(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
    min: Duration,
) -> Option<FaultTime> {
    let parse = |text: &str| {
        let (from, to) = text.split_once("..").unwrap_or((text, text));
        let [from, to] = [from, to].map(|time| parse_time(time).filter(|time| *time >= min));
        let (from, to) = from.zip(to).filter(|(from, to)| from <= to)?;
        Some(FaultTime { from_us: micros(from), to_us: micros(to) })
    };
    let hint = "write it like `250ms` or `2s`, or `1s..3s` for a random time";
    reader.parsed(node, name, parse, ("is not a duration or a range", Some(hint)))
}

pub(super) fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
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
