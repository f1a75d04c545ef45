//! Profiles of a file of limits: parts that replace values of the file.

use rtf_model::Diagnostic;

use super::yaml::{Node, Value};
use crate::suite::{SourceText, Spanned};

pub(super) const PROFILES: &str = "profiles";

/// Removes the profiles from a file, and returns them.
pub(super) fn take_profiles(
    root: &mut Node,
    source: &SourceText,
    problems: &mut Vec<Diagnostic>,
) -> Vec<(Spanned<String>, Node)> {
    let Value::Map(entries) = &mut root.value else { return Vec::new() };
    let Some(index) = entries.iter().position(|(key, _)| key.value == PROFILES) else {
        return Vec::new();
    };
    let (_, profiles) = entries.remove(index);
    match profiles.value {
        Value::Map(parts) => parts,
        _ => {
            let message = format!("`{PROFILES}` is {}, expected a mapping", profiles.kind());
            let problem = source.error("wrong-type", profiles.span, message);
            problems.push(problem.hint("write a part of the file for each profile"));
            Vec::new()
        }
    }
}

/// Replaces values as a JSON merge patch does (RFC 7396).
pub(super) fn apply(target: &mut Node, part: Node) {
    let (Value::Map(entries), Value::Map(replaced)) = (&mut target.value, &part.value) else {
        *target = part;
        return;
    };
    for (key, value) in replaced {
        let index = entries.iter().position(|(known, _)| known.value == key.value);
        match (index, &value.value) {
            (Some(index), Value::Null) => {
                entries.remove(index);
            }
            (None, Value::Null) => {}
            (Some(index), _) => apply(&mut entries[index].1, value.clone()),
            (None, _) => entries.push((key.clone(), value.clone())),
        }
    }
}
