//! `<fault>`: a fault that is injected while a test runs.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::{FaultAmount, FaultKind, NetworkFault};

use super::fault_quantity::{micros, percent, rate, share, size, time};
use super::reader::ElementReader;
use super::schema::{self, check};
use super::{DeclaredEffect, DeclaredFault, DeclaredTarget, reference, value_fault};
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
            let dir = reader.required(node, "dir", ": a directory on the file system");
            let amount = amount(reader, node);
            let dir = dir?;
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
        let Some(span) = ElementReader::name_span(node, name) else { continue };
        let message = format!("`{name}` has no effect on a fault of the kind `{}`", kind.as_str());
        let note = format!("this kind has {}", quoted(used.iter().copied(), ", "));
        reader.report(reader.error("wrong-type", span, message).note(note));
    }
    let range = |name| node.attribute(name).is_some_and(|value: &str| value.contains(".."));
    if !matches!(kind, FaultKind::Network | FaultKind::Values)
        && let Some(seed) = ElementReader::name_span(node, "seed")
        && !range("at")
        && !range("for")
    {
        let message = "`seed` has no effect without a range in `at` or `for`";
        reader.report(reader.error("wrong-type", seed, message));
    }
}

fn target(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredTarget> {
    let detail = ": the fixture whose processes are affected";
    let fixture = reader.required(node, "fixture", detail);
    let process = reader.word(node, "process").map(|process| process.value);
    Some(DeclaredTarget { fixture: fixture?, process })
}

fn amount(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<FaultAmount> {
    if AMOUNT.iter().filter(|name| node.has_attribute(**name)).count() != 1 {
        reader.missing(node, "one of the attributes `size` and `leave`");
        return None;
    }
    match node.has_attribute("size") {
        true => size(reader, node, "size", 1).map(FaultAmount::Size),
        false => size(reader, node, "leave", 0).map(FaultAmount::Leave),
    }
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
        let Some(span) = ElementReader::name_span(node, name) else { continue };
        let message = format!("`{name}` has no effect {reason}");
        reader.report(reader.error("wrong-type", span, message));
    }
    let port = reader.word(node, "port");
    if let Some(port) = &port
        && reference::check(reader, "port", port)
        && reference::example(&port.value).parse::<u16>().is_err()
    {
        reader.wrong("port", port, "is not a port", Some("write `8080` or `${port:camera}`"));
    }
    let fault = NetworkFault {
        has_port: port.is_some(),
        delay_us: reader.duration(node, "delay").map_or(0, micros),
        jitter_us: reader.duration(node, "jitter").map_or(0, micros),
        loss_ppm: share(reader, node, "loss"),
        duplicate_ppm: share(reader, node, "duplicate"),
        reorder_ppm: share(reader, node, "reorder"),
        rate_bits: rate(reader, node),
        refuses,
    };
    Some(DeclaredEffect::Network { fault, port })
}
