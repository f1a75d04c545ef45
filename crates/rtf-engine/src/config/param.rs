//! `${param:name}`: a value that a suite leaves to the profile.

const OPEN: &str = "${param:";

/// Whether a text can be the name of a parameter.
#[must_use]
pub fn is_name(text: &str) -> bool {
    let known = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(known)
}

/// The variable in which every process of a suite finds a parameter.
pub(super) fn variable(name: &str) -> String {
    format!("RTF_PARAM_{}", name.to_ascii_uppercase().replace('-', "_"))
}

/// The text with some value for each parameter: to see whether the rest is right.
pub(crate) fn sample(text: &str) -> String {
    expand(text, |_| Some("1".to_owned()), &mut |_| {})
}

/// The text with its parameters replaced by what `value` says of their names,
/// else by what is written after the name: `${param:tolerance=0.02}`. `missing`
/// is told the names that nothing is known of. `$${param:` stands for `${param:`.
pub(super) fn expand(
    text: &str,
    value: impl Fn(&str) -> Option<String>,
    missing: &mut dyn FnMut(&str),
) -> String {
    let mut expanded = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(OPEN) {
        let (before, from) = rest.split_at(start);
        let inside = &from[OPEN.len()..];
        if let Some(escaped) = before.strip_suffix('$') {
            expanded += escaped;
            expanded += OPEN;
            rest = inside;
            continue;
        }
        expanded += before;
        let Some((written, after)) = inside.split_once('}') else {
            expanded += from;
            missing(inside);
            return expanded;
        };
        let (name, default) = match written.split_once('=') {
            Some((name, default)) => (name, Some(default)),
            None => (written, None),
        };
        match value(name).or_else(|| default.map(str::to_owned)) {
            Some(value) => expanded += &value,
            None => missing(name),
        }
        rest = after;
    }
    expanded + rest
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
    fn whatever_else_begins_with_a_dollar_means_itself() {
        for text in ["$HOME ${HOME} ${port:a} $", "${param", "é"] {
            assert_eq!(expanded(text), (text.to_owned(), Vec::new()));
        }
        assert_eq!(expanded("$${param:tolerance}").0, "${param:tolerance}");
        assert_eq!(expanded("${param:open").1, ["open"]);
    }
}
