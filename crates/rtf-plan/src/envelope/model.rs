//! The limits of a robot's model.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::bound::{Bound, Bounds};
use super::limit::Quantity;
use super::{CompiledEnvelope, EnvelopeRequest, mjcf, read, urdf};
use crate::suite::{ElementReader, SourceText, Span, Spanned, read_document};

/// The joints of a model.
#[derive(Clone, Debug)]
pub(super) struct Model {
    /// The file in messages.
    pub file: String,
    /// The joints that can move, in order.
    pub joints: Vec<ModelJoint>,
}

/// A joint that can move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModelJoint {
    /// The name.
    pub name: String,
    /// The line and column of its limits.
    pub at: (u32, u32),
    /// The limits.
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

/// A limit of a magnitude.
pub(super) fn magnitude(most: f64, unit: &str) -> Bounds {
    Bounds { min: None, max: Some(Bound::of_model(most, unit)) }
}

/// Reads the model of a file, and reports every problem of it.
pub(super) fn load(
    request: &EnvelopeRequest<'_>,
    name: &Spanned<String>,
    referrer: &SourceText,
    compiled: &mut CompiledEnvelope,
) -> Option<Model> {
    let in_suite = std::path::Path::new(request.file);
    let path = in_suite.parent().unwrap_or(in_suite).join(&name.value);
    let path = path.to_string_lossy();
    let before = compiled.problems.len();
    let source = read(request.dir, request.shown_dir, &path, compiled);
    for problem in &mut compiled.problems[before..] {
        if problem.labels.is_empty() {
            problem.labels.push(referrer.label(name.span, ""));
        }
    }
    let source = source?;
    let model = read_document(&source, &mut compiled.problems, |reader, root| {
        let joints = match root.tag_name().name() {
            "robot" => urdf::read(reader, root),
            "mujoco" => mjcf::read(reader, root),
            other => {
                let message =
                    format!("`{}` is neither a URDF nor an MJCF: `<{other}>`", source.name());
                report(reader, root, "not-a-model", message, "");
                return None;
            }
        };
        Some(Model { file: source.name().to_owned(), joints })
    });
    let is_valid = !compiled.problems[before..]
        .iter()
        .any(|problem| problem.severity == rtf_model::Severity::Error);
    model.filter(|_| is_valid)
}

/// Reports a problem of an element.
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
        let label = reader.source.label(Span::new(attribute.range_value()), "");
        reader.report(Diagnostic::error("invalid-value", message).label(label));
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
