//! The limits of a robot's model.

use super::joint::{ModelJoint, report};
use super::{CompiledEnvelope, EnvelopeRequest, mjcf, read, urdf};
use crate::suite::{SourceText, Spanned, read_document};

#[derive(Clone, Debug)]
pub(super) struct Model {
    /// The file in messages.
    pub file: String,
    /// The joints that can move, in order.
    pub joints: Vec<ModelJoint>,
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
