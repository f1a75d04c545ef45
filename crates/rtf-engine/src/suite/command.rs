//! Splits a command line into words without a shell.

/// Splits like a shell splits words: white space, single and double quotes,
/// backslash. Nothing else is special, `#` included, which a shell takes for
/// the start of a comment.
///
/// # Errors
/// A quote is not closed.
pub(super) fn split(line: &str) -> Result<Vec<String>, shell_words::ParseError> {
    shell_words::split(&protect_hashes(line))
}

/// The words that mean something to a shell, and nothing here.
pub(super) fn shell_word(words: &[String]) -> Option<&str> {
    const SPECIAL: [&str; 9] = ["|", "||", "&&", "&", ";", ">", ">>", "<", "2>&1"];
    words.iter().map(String::as_str).find(|word| SPECIAL.contains(word))
}

/// Puts a backslash before each `#` that begins a word outside of quotes.
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
