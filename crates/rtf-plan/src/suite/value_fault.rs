//! `<fault kind="values">`: wrong values of a proxy.

use roxmltree::Node;
use rtf_model::ValuesFault;

use super::DeclaredEffect;
use super::fault_quantity::{micros, share};
use super::reader::ElementReader;

/// The attributes of this kind.
pub(super) const ATTRIBUTES: [&str; 9] =
    ["fixture", "field", "set", "scale", "offset", "noise", "freeze", "loss", "delay"];
/// What happens to the numbers of a field.
const NUMBERS: [&str; 4] = ["set", "scale", "offset", "noise"];

/// Reads the attributes; `None` if they are not complete.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredEffect> {
    let has = |name: &str| node.has_attribute(name);
    let detail = ": the proxy whose messages are changed";
    let fixture = reader.required(node, "fixture", detail);
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
        let span = ElementReader::name_span(node, name);
        let Some((span, reason)) = span.zip(unused(name)) else { continue };
        let message = format!("`{name}` has no effect {reason}");
        reader.report(reader.error("wrong-type", span, message));
    }
    let [set, scale, offset, noise] = NUMBERS.map(|name| number(reader, node, name));
    let fault = ValuesFault {
        field: reader.word(node, "field").map(|field| field.value),
        set,
        scale,
        offset,
        noise,
        freezes,
        loss_ppm: share(reader, node, "loss"),
        delay_us: reader.duration(node, "delay").map_or(0, micros),
        seed: reader.number(node, "seed", 0).unwrap_or(0),
    };
    Some(DeclaredEffect::Values { fixture: fixture?, fault })
}

/// A number, also `nan` or `inf`, which a proxy reads from the same text.
fn number(reader: &mut ElementReader<'_>, node: Node<'_, '_>, name: &str) -> Option<String> {
    let (is_valid, what): (fn(f64) -> bool, _) = match name {
        "set" => (|_| true, "is not a number"),
        "noise" => (|it| it.is_finite() && it >= 0.0, "is not a standard deviation, 0 or more"),
        _ => (f64::is_finite, "is not a finite number"),
    };
    let parse = |text: &str| text.parse().is_ok_and(is_valid).then(|| text.to_owned());
    reader.parsed(node, name, parse, (what, None))
}
