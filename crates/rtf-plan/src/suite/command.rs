//! `<command>` and `command="…"`: a command line that is split into words without a shell.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::reader::ElementReader;
use super::schema::{self, ElementSchema, check};
use super::{Spanned, reference};

/// Reads a `<command>`; returns no words if it is invalid.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Spanned<Vec<String>> {
    const SCHEMA: ElementSchema = schema::text("command");
    check(reader, node, &SCHEMA);
    let Some(line) = reader.text(node) else {
        reader.missing(node, "a program as its text");
        return Spanned::new(Vec::new(), ElementReader::tag(node));
    };
    let words = words(reader, "<command>", &line).unwrap_or_default();
    Spanned::new(words, line.span)
}

/// Splits a command line into words and warns about shell syntax.
pub(super) fn words(
    reader: &mut ElementReader<'_>,
    name: &str,
    line: &Spanned<String>,
) -> Option<Vec<String>> {
    reference::check(reader, name, line);
    let Ok(words) = split(&line.value) else {
        reader.wrong(name, line, "has a quote that is not closed", None);
        return None;
    };
    if let Some(word) = shell_word(&words) {
        let message =
            format!("no shell reads this command: the program gets `{word}` as an argument");
        let problem = Diagnostic::warning("no-shell", message)
            .label(reader.source.label(line.span, ""))
            .hint("if you want a shell, write `sh -c '…'`");
        reader.report(problem);
    }
    if words.first().is_none_or(String::is_empty) {
        reader.wrong(name, line, "names no program", None);
        return None;
    }
    Some(words)
}

/// Splits a command line at white space, as a shell does, with single and
/// double quotes and backslashes. `#` is an ordinary character.
///
/// # Errors
/// A quote is not closed.
fn split(line: &str) -> Result<Vec<String>, shell_words::ParseError> {
    shell_words::split(&protect_hashes(line))
}

/// Returns the first word that has a meaning only to a shell.
fn shell_word(words: &[String]) -> Option<&str> {
    const SPECIAL: [&str; 9] = ["|", "||", "&&", "&", ";", ">", ">>", "<", "2>&1"];
    words.iter().map(String::as_str).find(|word| SPECIAL.contains(word))
}

/// Escapes each `#` that begins an unquoted word: `shell_words` would start a comment there.
fn protect_hashes(line: &str) -> String {
    let mut protected = String::with_capacity(line.len());
    let mut quote = None;
    let mut before = ' ';
    let mut escaped = false;
    for c in line.chars() {
        if c == '#' && quote.is_none() && !escaped && before.is_whitespace() {
            protected.push('\\');
        }
        protected.push(c);
        if escaped {
            escaped = false;
        } else if c == '\\' && quote != Some('\'') {
            escaped = true;
        } else if quote == Some(c) {
            quote = None;
        } else if quote.is_none() && (c == '"' || c == '\'') {
            quote = Some(c);
        }
        before = c;
    }
    protected
}

#[cfg(test)]
mod tests {
    use super::split;

    #[test]
    fn words_and_quotes() {
        assert_eq!(
            split(r#"sim --world "a b.sdf" 'c d' e\ f"#).unwrap(),
            ["sim", "--world", "a b.sdf", "c d", "e f"]
        );
        assert!(split("sim 'open").is_err());
    }

    #[test]
    fn a_hash_is_no_comment() {
        assert_eq!(split("sim #ff0000 --n 2").unwrap(), ["sim", "#ff0000", "--n", "2"]);
        assert_eq!(
            split(r##"sim "x #y" '#z' a#b \#c"##).unwrap(),
            ["sim", "x #y", "#z", "a#b", "#c"]
        );
    }
}
