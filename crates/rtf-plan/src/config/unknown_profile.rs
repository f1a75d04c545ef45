//! The hint about a profile that does not exist.

use rtf_model::Diagnostic;

use crate::wording::{quoted, suggest};

/// Adds a hint with the most similar profile, or with all known ones.
pub(super) fn suggest_profile<'a>(
    problem: Diagnostic,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let mut known: Vec<&str> = known.collect();
    known.sort_unstable();
    known.dedup();
    let problem = suggest(problem, name, known.iter().copied());
    if problem.hint.is_some() {
        problem
    } else if known.is_empty() {
        problem.hint("a profile is a table `[profile.NAME]`")
    } else {
        problem.hint(format!("the profiles are {}", quoted(known, ", ")))
    }
}
