//! `<command>` and `command="…"`: a command line that is split into words without a shell.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::reader::ElementReader;
use super::schema::{self, ElementSchema, check};
use super::{Spanned, reference};
use crate::wording::in_attribute;

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
    if let Some(problem) = shell_start(&words) {
        reader.report(problem.label(reader.source.label(line.span, "")));
        return None;
    }
    if let Some((word, hint)) = shell_syntax(&line.value, &words) {
        let message =
            format!("no shell reads this command: the program gets `{word}` as an argument");
        reader.report(reader.source.warning("no-shell", line.span, message).hint(hint));
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

/// Reports a first word that is no program, but has a meaning to a shell.
fn shell_start(words: &[String]) -> Option<Diagnostic> {
    const BUILTINS: [&str; 9] =
        ["source", ".", "export", "cd", "exec", "eval", "set", "unset", "ulimit"];
    let first = words.first()?;
    let problem = |message| Diagnostic::error("no-shell", message);
    if let Some((name, value)) = first.split_once('=')
        && is_variable(name)
    {
        let message = format!("no shell reads this command: `{first}` is no program");
        let value = in_attribute(value);
        let hint = format!("set the variable with `<env name=\"{name}\" value=\"{value}\"/>`");
        return Some(problem(message).hint(hint));
    }
    BUILTINS.contains(&first.as_str()).then(|| {
        let message = format!("no shell reads this command: `{first}` is a command of a shell");
        problem(message).hint("write `bash -c '…'` around it; in XML, `&&` is `&amp;&amp;`")
    })
}

/// Returns the first part of a command that has a meaning only to a shell, and a hint.
fn shell_syntax<'l>(line: &'l str, words: &'l [String]) -> Option<(&'l str, &'static str)> {
    const SPECIAL: [&str; 9] = ["|", "||", "&&", "&", ";", ">", ">>", "<", "2>&1"];
    const SHELL: &str = "if you want a shell, write `sh -c '…'`";
    const VARIABLE: &str = "`rtf` replaces `${port:NAME}`, `${fixture:NAME.VALUE}` and \
                            `${param:NAME}`. For a variable, as of `<env>`, write `sh -c '…'`";
    let is_special = |word: &&str| SPECIAL.contains(word) || *word == "~" || word.starts_with("~/");
    if let Some(word) = words.iter().map(String::as_str).find(is_special) {
        return Some((word, SHELL));
    }
    // The text of `-c` is for a shell or another interpreter.
    let is_code = |word: &String| matches!(word.as_str(), "-c" | "-lc" | "-ic" | "-ec" | "-e");
    let is_remote = words.first().is_some_and(|program| program.ends_with("ssh"));
    match words.iter().any(is_code) || is_remote {
        true => None,
        false => Some((expansion(line)?, VARIABLE)),
    }
}

/// Returns the first `$NAME`, `${NAME}`, `$(…)` or backquote outside of single quotes.
fn expansion(line: &str) -> Option<&str> {
    let (mut is_quoted, mut characters) = (false, line.char_indices());
    while let Some((start, c)) = characters.next() {
        match c {
            '\'' => is_quoted = !is_quoted,
            '\\' if !is_quoted => drop(characters.next()),
            '`' if !is_quoted => return Some("`"),
            '$' if !is_quoted => {
                let rest = &line[start + 1..];
                if rest.starts_with('$') {
                    characters.next();
                } else if let Some(length) = expansion_length(rest) {
                    return Some(&line[start..=start + length]);
                }
            }
            _ => {}
        }
    }
    None
}

/// The length of what a shell replaces after a `$`. `${word:…}` belongs to `rtf`.
fn expansion_length(rest: &str) -> Option<usize> {
    let name = |text: &str| text.find(|c: char| !is_name_character(c)).unwrap_or(text.len());
    match rest.strip_prefix('{') {
        Some(inside) => {
            let end = inside.find('}')?;
            let after = &inside[name(inside)..end];
            let is_reference = after.starts_with(':') && !after.starts_with(":-");
            (!is_reference).then_some(end + 2)
        }
        None if rest.starts_with('(') => Some(1),
        None => Some(name(rest)).filter(|_| rest.starts_with(is_name_start)),
    }
}

fn is_variable(name: &str) -> bool {
    name.starts_with(is_name_start) && name.chars().all(is_name_character)
}

fn is_name_start(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}

fn is_name_character(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
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
    use super::{expansion, shell_start, shell_syntax, split};

    #[test]
    fn what_only_a_shell_understands_is_found() {
        for (line, found) in [
            ("sim | tee log", Some("|")),
            ("sim ~/world.sdf", Some("~/world.sdf")),
            ("sim --port $PORT", Some("$PORT")),
            ("sim \"--port=$PORT\"", Some("$PORT")),
            ("sim ${PORT:-5000} x", Some("${PORT:-5000}")),
            ("sim ${PORT}", Some("${PORT}")),
            ("sim $(nproc)", Some("$(")),
            ("sim `nproc`", Some("`")),
            ("sim ${port:sim} ${fixture:a.b} ${param:x=1} $${port:x}", None),
            ("awk '{print $1 $NF}' \\$x 5$ $1", None),
            ("sh -c 'echo $HOME ${HOME}'", None),
            ("bash -lc \"echo $HOME\"", None),
            ("ssh robot \"echo $HOME\"", None),
        ] {
            let words = split(line).unwrap();
            let syntax = shell_syntax(line, &words);
            assert_eq!(syntax.map(|(word, _)| word), found, "{line}");
        }
        assert_eq!(expansion("\u{e9}$"), None);
    }

    #[test]
    fn a_line_for_a_shell_names_no_program() {
        let hint = |line: &str| shell_start(&split(line).unwrap()).and_then(|it| it.hint);
        let env = "set the variable with `<env name=\"PORT\" value=\"1\"/>`";
        assert_eq!(hint("PORT=1 sim").as_deref(), Some(env));
        for line in ["source setup.bash", ". setup.bash && sim", "cd sim && ./run"] {
            assert!(hint(line).is_some_and(|hint| hint.contains("bash -c")), "{line}");
        }
        for program in ["sim --port=1", "./a=b/sim", "./cd"] {
            assert_eq!(hint(program), None);
        }
    }

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
