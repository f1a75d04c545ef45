//! `<fault>`: a fault that is injected while a test runs.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::{Diagnostic, FaultAmount, FaultKind, FaultTime, NetworkFault};

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{
    DeclaredEffect, DeclaredFault, DeclaredTarget, DurationError, Span, Spanned, parse_duration,
    reference, value_fault,
};
use crate::wording::quoted;

/// The attributes of each kind, and their meaning where one is missing.
const PROCESSES: [&str; 2] = ["fixture", "process"];
const AMOUNT: [&str; 2] = ["size", "leave"];
const NETWORK: [&str; 8] =
    ["port", "delay", "jitter", "loss", "duplicate", "reorder", "rate", "refuse"];
/// Those that have an effect alone.
const NETWORK_EFFECTS: [&str; 5] = ["delay", "loss", "duplicate", "rate", "refuse"];
/// The attributes that all kinds have.
const COMMON: [&str; 5] = ["name", "kind", "at", "for", "seed"];

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

/// Reads a `<fault>`; `None` if it is not complete.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredFault> {
    check(reader, node, &schema::FAULT);
    for required in ["name", "kind"] {
        if !node.has_attribute(required) {
            reader.missing(node, &format!("the attribute `{required}`"));
        }
    }
    let name = reader.word(node, "name");
    let at = time(reader, node, "at", Duration::ZERO);
    let duration = time(reader, node, "for", Duration::from_micros(1));
    let seed = reader.number(node, "seed", 0).unwrap_or(0);
    let kind = reader.choice(node, "kind", &FaultKind::ALL)?;
    report_without_effect(reader, node, kind);
    let effect = effect(reader, node, kind)?;
    Some(DeclaredFault { span: ElementReader::tag(node), name: name?, effect, at, duration, seed })
}

/// Reads the faults of an element.
pub(super) fn read_all(reader: &mut ElementReader<'_>, parent: Node<'_, '_>) -> Vec<DeclaredFault> {
    let mut faults = Vec::new();
    for node in parent.children().filter(|child| child.has_tag_name("fault")) {
        faults.extend(read(reader, node));
    }
    faults
}

fn effect(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    kind: FaultKind,
) -> Option<DeclaredEffect> {
    match kind {
        FaultKind::Kill => target(reader, node).map(DeclaredEffect::Kill),
        FaultKind::Stop => target(reader, node).map(DeclaredEffect::Stop),
        FaultKind::Slow => {
            let percent = percent(reader, node);
            let target = target(reader, node)?;
            Some(DeclaredEffect::Slow { target, percent: percent? })
        }
        FaultKind::Memory => amount(reader, node).map(DeclaredEffect::Memory),
        FaultKind::Disk => {
            if !node.has_attribute("dir") {
                reader.missing(node, "the attribute `dir`: a directory on the file system");
            }
            let amount = amount(reader, node);
            let dir = reader.word(node, "dir")?;
            reference::check(reader, "dir", &dir);
            Some(DeclaredEffect::Disk { dir, amount: amount? })
        }
        FaultKind::Network => network(reader, node),
        FaultKind::Values => value_fault::read(reader, node),
    }
}

fn report_without_effect(reader: &mut ElementReader<'_>, node: Node<'_, '_>, kind: FaultKind) {
    let used: &[&[&str]] = match kind {
        FaultKind::Kill | FaultKind::Stop => &[&PROCESSES],
        FaultKind::Slow => &[&PROCESSES, &["cpu"]],
        FaultKind::Memory => &[&AMOUNT],
        FaultKind::Disk => &[&AMOUNT, &["dir"]],
        FaultKind::Network => &[&NETWORK],
        FaultKind::Values => &[&value_fault::ATTRIBUTES],
    };
    let used = used.concat();
    let known = schema::FAULT.attributes.iter();
    let unused = known.filter(|name| !COMMON.contains(name) && !used.contains(name));
    let unused = unused.chain((!kind.lasts()).then_some(&"for"));
    for name in unused {
        let Some(attribute) = node.attribute_node(*name) else { continue };
        let message = format!("`{name}` has no effect on a fault of the kind `{}`", kind.as_str());
        let label = reader.source.label(Span::new(attribute.range_qname()), "");
        let note = format!("this kind has {}", quoted(used.iter().copied(), ", "));
        reader.report(Diagnostic::error("wrong-type", message).label(label).note(note));
    }
    let range = |name| node.attribute(name).is_some_and(|value: &str| value.contains(".."));
    if !matches!(kind, FaultKind::Network | FaultKind::Values)
        && let Some(seed) = node.attribute_node("seed")
        && !range("at")
        && !range("for")
    {
        let label = reader.source.label(Span::new(seed.range_qname()), "");
        let message = "`seed` has no effect without a range in `at` or `for`";
        reader.report(Diagnostic::error("wrong-type", message).label(label));
    }
}

fn target(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredTarget> {
    if !node.has_attribute("fixture") {
        reader.missing(node, "the attribute `fixture`: the fixture whose processes are affected");
    }
    let process = reader.word(node, "process").map(|process| process.value);
    Some(DeclaredTarget { fixture: reader.word(node, "fixture")?, process })
}

fn percent(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<u32> {
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

fn amount(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<FaultAmount> {
    if AMOUNT.iter().filter(|name| node.has_attribute(**name)).count() != 1 {
        reader.missing(node, "one of the attributes `size` and `leave`");
        return None;
    }
    match reader.word(node, "size") {
        Some(text) => size(reader, "size", &text, 1).map(FaultAmount::Size),
        None => {
            let text = reader.word(node, "leave")?;
            size(reader, "leave", &text, 0).map(FaultAmount::Leave)
        }
    }
}

fn size(
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

fn network(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredEffect> {
    if !NETWORK_EFFECTS.iter().any(|name| node.has_attribute(*name)) {
        reader.missing(
            node,
            "one of the attributes `delay`, `loss`, `duplicate`, `rate` and `refuse`",
        );
        return None;
    }
    let refuses = reader.boolean(node, "refuse").unwrap_or(false);
    let unused = |name: &&str| match *name {
        "jitter" | "reorder" if !node.has_attribute("delay") => Some("without `delay`"),
        "port" | "refuse" => None,
        _ => refuses.then_some("with `refuse`"),
    };
    for (name, reason) in NETWORK.iter().filter_map(|name| Some((name, unused(name)?))) {
        let Some(attribute) = node.attribute_node(*name) else { continue };
        let label = reader.source.label(Span::new(attribute.range_qname()), "");
        let message = format!("`{name}` has no effect {reason}");
        reader.report(Diagnostic::error("wrong-type", message).label(label));
    }
    let port = reader.word(node, "port");
    if let Some(port) = &port
        && reference::check(reader, "port", port)
        && reference::example(&port.value).parse::<u16>().is_err()
    {
        reader.wrong("port", port, "is not a port", Some("write `8080` or `${port:camera}`"));
    }
    let micros = |time: Option<Duration>| {
        time.map_or(0, |time| u64::try_from(time.as_micros()).unwrap_or(u64::MAX))
    };
    let fault = NetworkFault {
        has_port: port.is_some(),
        delay_us: micros(reader.duration(node, "delay")),
        jitter_us: micros(reader.duration(node, "jitter")),
        loss_ppm: share(reader, node, "loss"),
        duplicate_ppm: share(reader, node, "duplicate"),
        reorder_ppm: share(reader, node, "reorder"),
        rate_bits: rate(reader, node),
        refuses,
    };
    Some(DeclaredEffect::Network { fault, port })
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
fn rate(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<u64> {
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
fn time(
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
