//! CMake's regular expressions as those of the crate `regex`.
//!
//! CMake has `^ $ . [] * + ? | ()` only. `^` and `$` match at the ends of the whole output,
//! `.` also matches a line break, `{` is an ordinary character, a backslash makes any
//! character ordinary, and has no meaning in brackets, where there are no classes either.

use regex::Regex;

/// Compiles an expression in CMake's dialect.
///
/// # Errors
/// The expression is not valid.
pub fn compile(pattern: &str) -> Result<Regex, Box<regex::Error>> {
    Regex::new(&translate(pattern)).map_err(Box::new)
}

fn translate(pattern: &str) -> String {
    let mut result = String::from("(?s)");
    let mut chars = pattern.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '\\' => push_literal(&mut result, chars.next().unwrap_or('\\')),
            '[' => push_brackets(&mut result, &mut chars),
            '^' | '$' | '.' | '*' | '+' | '?' | '|' | '(' | ')' => {
                // `(?` is an error in CMake, not an option.
                result.push(c);
                if c == '(' && chars.peek() == Some(&'?') {
                    result.push('*');
                }
            }
            _ => push_literal(&mut result, c),
        }
    }
    // `$` matches only at the end, unlike in a multi-line expression.
    result
}

fn push_literal(result: &mut String, c: char) {
    result.push_str(&regex::escape(c.encode_utf8(&mut [0; 4])));
}

/// Copies the rest of a bracket expression. `]` is ordinary in the first position.
fn push_brackets(result: &mut String, chars: &mut std::iter::Peekable<std::str::Chars<'_>>) {
    result.push('[');
    if chars.next_if_eq(&'^').is_some() {
        result.push('^');
    }
    let mut is_first = true;
    while let Some(c) = chars.next() {
        match c {
            ']' if !is_first => {
                result.push(']');
                return;
            }
            // A range, unless it is at an end.
            '-' if !is_first && chars.peek().is_some_and(|next| *next != ']') => result.push('-'),
            _ => push_literal(result, c),
        }
        is_first = false;
    }
    // Not closed: the translation is not valid either.
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matches(pattern: &str, text: &str) -> bool {
        compile(pattern).unwrap().is_match(text)
    }

    /// The expected results are those of `string(REGEX MATCH)` of CMake 3.25.
    #[test]
    fn differences_of_the_dialects() {
        let cases = [
            ("^a.b$", "a\nb", true),
            ("^b", "a\nb", false),
            ("a$", "a\nb", false),
            ("a{2}", "a{2}", true),
            ("a{2}", "aa", false),
            (r"\d", "d", true),
            (r"\d", "7", false),
            (r"1\.5", "1x5", false),
            (r"[\d]", "\\", true),
            ("[]a]", "]", true),
            ("[^]a]", "]", false),
            ("[a-c]+x", "abcx", true),
            ("[a-]", "-", true),
            ("[-a]", "-", true),
            ("[&&~~]", "~", true),
            ("[[]x", "[x", true),
            ("[[:digit:]]", "7", false),
            ("(a|b)*c", "ababc", true),
            ("#x y", "#x y", true),
            ("é+", "éé", true),
        ];
        for (pattern, text, expected) in cases {
            assert_eq!(matches(pattern, text), expected, "{pattern} in {text:?}");
        }
    }

    #[test]
    fn invalid_expressions() {
        for pattern in ["(a", "a)", "[a", "*a", "(?i)a"] {
            assert!(compile(pattern).is_err(), "{pattern}");
        }
    }
}
