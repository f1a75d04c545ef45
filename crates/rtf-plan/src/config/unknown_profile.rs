//! The hint about a profile that does not exist.

use rtf_model::Diagnostic;

use crate::wording::{quoted, suggest_or};

/// Adds a hint with the most similar profile, or with all known ones.
pub(super) fn suggest_profile<'a>(
    problem: Diagnostic,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let mut known: Vec<&str> = known.collect();
    known.sort_unstable();
    known.dedup();
    suggest_or(problem, name, known.iter().copied(), |problem| match known.is_empty() {
        true => problem.hint("a profile is a table `[profile.NAME]`"),
        false => problem.hint(format!("the profiles are {}", quoted(known.iter().copied(), ", "))),
    })
}
