//! `${param:name}`: a value that a suite leaves to the profile.

use crate::placeholder::{Segment, segments};

const OPEN: &str = "${param:";

/// Checks whether a text is a valid parameter name.
#[must_use]
pub fn is_name(text: &str) -> bool {
    let known = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(known)
}

/// Returns the environment variable that passes a parameter to the processes of a suite.
pub fn variable(name: &str) -> String {
    format!("RTF_PARAM_{}", name.to_ascii_uppercase().replace('-', "_"))
}

/// Describes two parameters that have the same environment variable.
pub fn describe_same_variable(first: &str, second: &str) -> String {
    if first == second {
        return format!("the parameter `{first}` occurs twice");
    }
    let variable = variable(second);
    format!("the parameters `{first}` and `{second}` would both be in `{variable}`")
}

/// Replaces each parameter by an example value, to check the syntax of the rest.
pub(crate) fn sample(text: &str) -> String {
    expand(text, |_| Some("1".to_owned()), &mut |_| {})
}

/// Replaces each parameter by the result of `value`, else by its default
/// (`${param:tolerance=0.02}`). Calls `missing` for parameters without a value.
/// `$${param:` stands for `${param:`.
pub(super) fn expand(
    text: &str,
    value: impl Fn(&str) -> Option<String>,
    missing: &mut dyn FnMut(&str),
) -> String {
    let mut expanded = String::new();
    for segment in segments(text, OPEN) {
        match segment {
            Segment::Text(text) => expanded += text,
            Segment::Placeholder(inside, _) => {
                let (name, default) = match inside.split_once('=') {
                    Some((name, default)) => (name, Some(default)),
                    None => (inside, None),
                };
                match value(name).or_else(|| default.map(str::to_owned)) {
                    Some(value) => expanded += &value,
                    None => missing(name),
                }
            }
            Segment::Unclosed(start) => {
                expanded += &text[start..];
                missing(&text[start + OPEN.len()..]);
            }
        }
    }
    expanded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expanded(text: &str) -> (String, Vec<String>) {
        let mut missing = Vec::new();
        let value = |name: &str| (name == "tolerance").then(|| "0.05".to_owned());
        let text = expand(text, value, &mut |name| missing.push(name.to_owned()));
        (text, missing)
    }

    #[test]
    fn parameters_are_replaced() {
        let (text, missing) = expanded("--tolerance ${param:tolerance} --rate ${param:rate=100}");
        assert_eq!((text.as_str(), missing.len()), ("--tolerance 0.05 --rate 100", 0));
        assert_eq!(expanded("${param:tolerance=1}").0, "0.05");
        assert_eq!(expanded("a${param:rate}b"), ("ab".to_owned(), vec!["rate".to_owned()]));
    }

    #[test]
    fn other_dollar_signs_are_literal_text() {
        for text in ["$HOME ${HOME} ${port:a} $", "${param", "é"] {
            assert_eq!(expanded(text), (text.to_owned(), Vec::new()));
        }
        assert_eq!(expanded("$${param:tolerance}").0, "${param:tolerance}");
        assert_eq!(expanded("${param:open").1, ["open"]);
    }
}
