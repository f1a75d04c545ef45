//! A joint of a robot's model, and the XML of its limits.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::bound::{Bound, Bounds};
use super::limit::Quantity;
use crate::suite::{ElementReader, Span};

/// A joint that can move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModelJoint {
    pub name: String,
    /// The line and column of its limits.
    pub at: (u32, u32),
    pub limits: Vec<(Quantity, Bounds)>,
}

/// The units of a joint: position, velocity, torque or force.
pub(super) const REVOLUTE: [&str; 3] = ["rad", "rad/s", "Nm"];
/// Those of a prismatic joint.
pub(super) const PRISMATIC: [&str; 3] = ["m", "m/s", "N"];

/// Limits on both sides.
pub(super) fn range(low: f64, high: f64, unit: &str) -> Bounds {
    Bounds { min: Some(Bound::of_model(low, unit)), max: Some(Bound::of_model(high, unit)) }
}

pub(super) fn magnitude(most: f64, unit: &str) -> Bounds {
    Bounds { min: None, max: Some(Bound::of_model(most, unit)) }
}

pub(super) fn report(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    code: &str,
    message: String,
    hint: &str,
) {
    let problem = Diagnostic::error(code, message);
    let problem = problem.label(reader.source.label(ElementReader::tag(node), ""));
    reader.report(if hint.is_empty() { problem } else { problem.hint(hint) });
}

/// The line and column of an element.
pub(super) fn position(reader: &ElementReader<'_>, node: Node<'_, '_>) -> (u32, u32) {
    let label = reader.source.label(ElementReader::tag(node), "");
    (label.line, label.column)
}

/// Reads numbers that are separated by white space, and reports other values.
pub(super) fn numbers(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
    count: usize,
) -> Option<Vec<f64>> {
    let attribute = node.attribute_node(name)?;
    let words = attribute.value().split_whitespace();
    let numbers: Option<Vec<f64>> =
        words.map(|word| word.parse().ok().filter(|it: &f64| it.is_finite())).collect();
    let numbers = numbers.filter(|numbers| numbers.len() == count);
    if numbers.is_none() {
        let expected = if count == 1 { "a number".to_owned() } else { format!("{count} numbers") };
        let message = format!("`{name}` is `{}`, expected {expected}", attribute.value());
        reader.report(reader.error("invalid-value", Span::new(attribute.range_value()), message));
    }
    numbers
}

/// Reads a number, and reports another value.
pub(super) fn number(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
) -> Option<f64> {
    numbers(reader, node, name, 1)?.first().copied()
}
