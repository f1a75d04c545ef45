//! `<fault kind="values">`: wrong values of a proxy.

use roxmltree::Node;
use rtf_model::{Diagnostic, ValuesFault};

use super::fault_quantity::share;
use super::reader::ElementReader;
use super::{DeclaredEffect, Span};

/// The attributes of this kind.
pub(super) const ATTRIBUTES: [&str; 9] =
    ["fixture", "field", "set", "scale", "offset", "noise", "freeze", "loss", "delay"];
/// What happens to the numbers of a field.
const NUMBERS: [&str; 4] = ["set", "scale", "offset", "noise"];

/// Reads the attributes; `None` if they are not complete.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredEffect> {
    let has = |name: &str| node.has_attribute(name);
    if !has("fixture") {
        reader.missing(node, "the attribute `fixture`: the proxy whose messages are changed");
    }
    let freezes = reader.boolean(node, "freeze").unwrap_or(false);
    let changes = freezes || NUMBERS.iter().any(|name| has(name));
    if has("field") && !changes {
        reader.missing(
            node,
            "one of the attributes `set`, `scale`, `offset`, `noise` and `freeze` for `field`",
        );
    } else if !has("field") && !has("loss") && !has("delay") {
        reader.missing(node, "one of the attributes `field`, `loss` and `delay`");
    }
    let unused = |name: &str| match name {
        _ if !has("field") => Some("without `field`"),
        "freeze" => None,
        _ => freezes.then_some("with `freeze`"),
    };
    for name in NUMBERS.iter().chain([&"freeze"]) {
        let Some((attribute, reason)) = node.attribute_node(*name).zip(unused(name)) else {
            continue;
        };
        let label = reader.source.label(Span::new(attribute.range_qname()), "");
        let message = format!("`{name}` has no effect {reason}");
        reader.report(Diagnostic::error("wrong-type", message).label(label));
    }
    let [set, scale, offset, noise] = NUMBERS.map(|name| number(reader, node, name));
    let delay = reader.duration(node, "delay").map_or(0, |it| it.as_micros());
    let fault = ValuesFault {
        field: reader.word(node, "field").map(|field| field.value),
        set,
        scale,
        offset,
        noise,
        freezes,
        loss_ppm: share(reader, node, "loss"),
        delay_us: u64::try_from(delay).unwrap_or(u64::MAX),
        seed: reader.number(node, "seed", 0).unwrap_or(0),
    };
    Some(DeclaredEffect::Values { fixture: reader.word(node, "fixture")?, fault })
}

/// A number, also `nan` or `inf`, which a proxy reads from the same text.
fn number(reader: &mut ElementReader<'_>, node: Node<'_, '_>, name: &str) -> Option<String> {
    let text = reader.word(node, name)?;
    let number = text.value.parse::<f64>().ok();
    let is_valid = number.is_some_and(|number| match name {
        "set" => true,
        "noise" => number.is_finite() && number >= 0.0,
        _ => number.is_finite(),
    });
    if !is_valid {
        let what = match name {
            "set" => "is not a number",
            "noise" => "is not a standard deviation, 0 or more",
            _ => "is not a finite number",
        };
        reader.wrong(name, &text, what, None);
        return None;
    }
    Some(text.value)
}
