//! Wording that diagnostics share: suggestions and lists of names.

use rtf_model::Diagnostic;

/// Returns the known word that `word` most likely misspells.
pub(crate) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    known
        .map(|name| (strsim::damerau_levenshtein(&lower, &name.to_lowercase()), name))
        .filter(|(distance, name)| *distance <= name.chars().count().max(3) / 3)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// Adds the hint "did you mean …?" if a known word resembles `word`.
pub(crate) fn suggest<'a>(
    problem: Diagnostic,
    word: &str,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    suggest_or(problem, word, known, |problem| problem)
}

/// The same; `otherwise` completes the problem if no known word resembles `word`.
pub(crate) fn suggest_or<'a>(
    problem: Diagnostic,
    word: &str,
    known: impl Iterator<Item = &'a str>,
    otherwise: impl FnOnce(Diagnostic) -> Diagnostic,
) -> Diagnostic {
    match nearest(word, known) {
        Some(near) => problem.hint(format!("did you mean `{near}`?")),
        None => otherwise(problem),
    }
}

/// Escapes a text for an attribute in double quotes.
pub(crate) fn in_attribute(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// Formats names as a list: "`a`, `b`" with the separator ", ".
pub(crate) fn quoted<'a>(names: impl IntoIterator<Item = &'a str>, separator: &str) -> String {
    let quoted: Vec<_> = names.into_iter().map(|name| format!("`{name}`")).collect();
    quoted.join(separator)
}
