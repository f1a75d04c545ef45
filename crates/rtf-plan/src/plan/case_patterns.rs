//! The patterns of `<test cases="…">` (`spec/frameworks.md`).

use rtf_model::Diagnostic;

use super::ListedCase;
use crate::suite::split_param;
use crate::wording::{nearest, quoted, suggest_or};

/// The maximum number of cases that a diagnostic lists.
const MAX_NAMES: usize = 5;

/// A pattern: `*` stands for any text, `?` for one character.
#[derive(Debug)]
struct CasePattern {
    text: String,
    /// Whether it was written with `!`.
    excludes: bool,
}

/// Returns the listed cases that the patterns select, or the problems of the patterns.
pub(super) fn select<'l>(
    patterns: &str,
    test: &str,
    listed: &'l [ListedCase],
) -> Result<Vec<&'l str>, Vec<Diagnostic>> {
    let patterns: Vec<CasePattern> = split_param(patterns).into_iter().map(parse).collect();
    let problems: Vec<_> =
        patterns.iter().filter_map(|pattern| problem_of(pattern, test, listed)).collect();
    if !problems.is_empty() {
        return Err(problems);
    }
    let only_excludes = patterns.iter().all(|pattern| pattern.excludes);
    let any = |name: &str, excludes: bool| {
        let mut candidates = patterns.iter().filter(|pattern| pattern.excludes == excludes);
        candidates.any(|pattern| matches(&pattern.text, name))
    };
    let is_selected = |name: &&str| (only_excludes || any(name, false)) && !any(name, true);
    let selected: Vec<_> = listed.iter().map(|case| &*case.name).filter(is_selected).collect();
    if selected.is_empty() {
        let message = format!("`cases` excludes all cases of the test `{test}`");
        return Err(vec![Diagnostic::error("no-cases", message)]);
    }
    Ok(selected)
}

fn parse(argument: String) -> CasePattern {
    match argument.strip_prefix('!') {
        Some(text) => CasePattern { text: text.to_owned(), excludes: true },
        None => CasePattern { text: argument, excludes: false },
    }
}

fn problem_of(pattern: &CasePattern, test: &str, listed: &[ListedCase]) -> Option<Diagnostic> {
    let text = &pattern.text;
    if text.is_empty() {
        let problem = Diagnostic::error("invalid-value", "`cases` contains an empty pattern");
        return Some(problem.hint("quote a pattern together with its `!`: `\"!Arm moves\"`"));
    }
    if listed.iter().any(|case| matches(text, &case.name)) {
        return None;
    }
    let message = format!("no case of the test `{test}` matches `{text}`");
    let problem = Diagnostic::error("unknown-case", message);
    Some(match similar(text, listed) {
        Some(near) => problem.hint(format!("did you mean `{near}`?")),
        None => with_names(problem, listed),
    })
}

/// Suggests a name, or the pattern with another text before its first or after its last
/// wildcard.
fn similar(pattern: &str, listed: &[ListedCase]) -> Option<String> {
    let names = || listed.iter().map(|case| case.name.as_str());
    let is_wildcard = ['*', '?'];
    let (Some(first), Some(last)) = (pattern.find(is_wildcard), pattern.rfind(is_wildcard)) else {
        return nearest(pattern, names()).map(str::to_owned);
    };
    let (head, tail) = (&pattern[..first], &pattern[last + 1..]);
    // A part of about the same length with the same separator next to the wildcard.
    let heads = names().flat_map(|name| {
        let ends = near_lengths(head).filter_map(|length| nth_char(name, length));
        ends.map(|end| &name[..end])
    });
    let heads = heads.filter(|near| near.chars().last() == head.chars().last());
    let with_head = nearest(head, heads).map(|near| format!("{near}{}", &pattern[first..]));
    let tails = names().flat_map(|name| {
        let count = name.chars().count();
        let starts = near_lengths(tail).filter_map(move |length| count.checked_sub(length));
        starts.filter_map(|start| nth_char(name, start)).map(|start| &name[start..])
    });
    let tails = tails.filter(|near| near.chars().next() == tail.chars().next());
    let with_tail = nearest(tail, tails).map(|near| format!("{}{near}", &pattern[..=last]));
    let fits = |near: &String| names().any(|name| matches(near, name));
    with_head.filter(fits).or_else(|| with_tail.filter(fits))
}

/// Returns the number of characters of a text, and those that differ by one.
fn near_lengths(text: &str) -> impl Iterator<Item = usize> {
    let length = text.chars().count();
    length.saturating_sub(1)..=length + 1
}

/// Returns the offset of the character at this index, or after the last one.
fn nth_char(text: &str, index: usize) -> Option<usize> {
    text.char_indices().map(|(at, _)| at).chain([text.len()]).nth(index)
}

/// Reports a case that the test does not have.
pub(super) fn unknown_case(path: &str, test: &str, listed: &[ListedCase]) -> Diagnostic {
    let message = format!("there is no case `{path}` in the test `{test}`");
    let problem = Diagnostic::error("unknown-case", message);
    let names = listed.iter().map(|case| case.name.as_str());
    suggest_or(problem, path, names, |problem| with_names(problem, listed))
}

/// Lists the first cases of a test; `rtf list` shows no test of a suite with an error.
fn with_names(problem: Diagnostic, listed: &[ListedCase]) -> Diagnostic {
    if listed.is_empty() {
        return problem.note("the test has no cases");
    }
    let names = quoted(listed.iter().take(MAX_NAMES).map(|case| case.name.as_str()), ", ");
    match listed.len().saturating_sub(MAX_NAMES) {
        0 => problem.note(format!("its cases are {names}")),
        more => problem.note(format!("its cases are {names} and {more} more")),
    }
}

/// Checks whether a pattern matches a whole name.
fn matches(pattern: &str, name: &str) -> bool {
    let (mut pattern, mut name) = (pattern.chars(), name.chars());
    // The pattern after the last `*`, and the name where its next attempt starts.
    let mut retry = None;
    loop {
        match pattern.next() {
            Some('*') => {
                retry = Some((pattern.clone(), name.clone()));
                continue;
            }
            None if name.as_str().is_empty() => return true,
            expected => {
                let found = name.next();
                if found.is_some() && (expected == Some('?') || expected == found) {
                    continue;
                }
            }
        }
        let Some((after, start)) = &mut retry else { return false };
        if start.next().is_none() {
            return false;
        }
        (pattern, name) = (after.clone(), start.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wildcards() {
        for (pattern, name) in [
            ("*", ""),
            ("*", "Arm.Moves"),
            ("Arm.*", "Arm.Moves"),
            ("*Slow", "Arm.IsSlowSlow"),
            ("A*e*s", "Arm.Moves"),
            ("???", "aüb"),
            ("a*", "a/b,c \"d\" [e]"),
            ("a[0]", "a[0]"),
            ("**?", "ab"),
        ] {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [
            ("", "a"),
            ("?", ""),
            ("Arm.*", "Arm"),
            ("arm.*", "Arm.Moves"),
            ("*b", "abc"),
            ("a?c*d", "abbd"),
        ] {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
    }

    /// A regular expression with the same meaning.
    fn reference(pattern: &str) -> regex::Regex {
        let part = |c: char| match c {
            '*' => ".*".to_owned(),
            '?' => ".".to_owned(),
            other => regex::escape(&other.to_string()),
        };
        let parts: String = pattern.chars().map(part).collect();
        regex::Regex::new(&format!("(?s)^{parts}$")).unwrap()
    }

    proptest! {
        #[test]
        fn patterns_match_like_regular_expressions(pattern in "[ab*?/]{0,8}", name in "[ab/]{0,12}") {
            prop_assert_eq!(matches(&pattern, &name), reference(&pattern).is_match(&name));
        }

        #[test]
        fn any_names_and_patterns(pattern in any::<String>(), names in prop::collection::vec(any::<String>(), 0..4)) {
            let listed: Vec<_> = names.into_iter().map(listed_case).collect();
            let _ = select(&pattern, "arm_test", &listed);
        }
    }

    fn listed_case(name: impl Into<String>) -> ListedCase {
        ListedCase { name: name.into(), location: None, tags: Vec::new(), disabled: false }
    }

    fn selected(patterns: &str) -> Result<Vec<String>, String> {
        let names = ["Arm.Moves", "Arm.MovesSlow", "Gaze.Looks", "Arm moves, fast"];
        let listed = names.map(listed_case);
        let selected = select(patterns, "arm_test", &listed);
        selected.map(|names| names.into_iter().map(str::to_owned).collect()).map_err(|problems| {
            let advice = |it: &Diagnostic| it.notes.first().or(it.hint.as_ref()).cloned();
            let shown = problems
                .into_iter()
                .map(|it| format!("{} ({})", it.message, advice(&it).unwrap_or_default()));
            shown.collect::<Vec<_>>().join("\n")
        })
    }

    #[test]
    fn several_patterns() {
        assert_eq!(selected("Arm.* !*Slow").unwrap(), ["Arm.Moves"]);
        assert_eq!(selected("!*Slow").unwrap(), ["Arm.Moves", "Gaze.Looks", "Arm moves, fast"]);
        assert_eq!(selected("Gaze.Looks Arm.Moves").unwrap(), ["Arm.Moves", "Gaze.Looks"]);
        assert_eq!(selected("\"Arm moves, fast\"").unwrap(), ["Arm moves, fast"]);
        assert_eq!(
            selected("\"!Arm moves*\" !*.*s !*Slow").unwrap_err(),
            "`cases` excludes all cases of the test `arm_test` ()"
        );
    }

    #[test]
    fn a_pattern_that_matches_nothing() {
        let error = |patterns: &str| selected(patterns).unwrap_err();
        insta::assert_snapshot!(
            ["Arm.Mvoes", "Amr.*", "!*Solw", "*.xyz", "gaze.*", "!\"Arm moves\"", "Arm.* Gase.* !x"].map(error).join("\n"),
            @r#"
        no case of the test `arm_test` matches `Arm.Mvoes` (did you mean `Arm.Moves`?)
        no case of the test `arm_test` matches `Amr.*` (did you mean `Arm.*`?)
        no case of the test `arm_test` matches `*Solw` (did you mean `*Slow`?)
        no case of the test `arm_test` matches `*.xyz` (its cases are `Arm.Moves`, `Arm.MovesSlow`, `Gaze.Looks`, `Arm moves, fast`)
        no case of the test `arm_test` matches `gaze.*` (did you mean `Gaze.*`?)
        `cases` contains an empty pattern (quote a pattern together with its `!`: `"!Arm moves"`)
        no case of the test `arm_test` matches `Arm moves` (did you mean `Arm.Moves`?)
        no case of the test `arm_test` matches `Gase.*` (did you mean `Gaze.*`?)
        no case of the test `arm_test` matches `x` (its cases are `Arm.Moves`, `Arm.MovesSlow`, `Gaze.Looks`, `Arm moves, fast`)
        "#
        );
    }
}
