//! Diagnostics of a test line: a YAML block, or comments as Test::More, bats and tap.py write
//! them.
//!
//! Producers print YAML without a library, and often not correctly (unquoted text, `diff` with tabs), and
//! a block that a strict parser rejects must not be lost. So this reads the mapping of the
//! block line by line, and keeps the text of everything else.

/// Diagnostics of a test line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    pub message: Option<String>,
    pub expected: Option<String>,
    pub actual: Option<String>,
    /// File and line.
    pub location: Option<(String, u32)>,
    /// Milliseconds.
    pub duration: Option<f64>,
    /// Everything else: keys and their text.
    pub other: Vec<(String, String)>,
}

impl Diagnostics {
    /// Reads the lines between `---` and `...`.
    pub fn from_yaml(lines: &[String]) -> Self {
        let entries = mapping(&dedent(lines));
        if entries.is_empty() && !lines.is_empty() {
            return Self { message: Some(dedent(lines).join("\n")), ..Self::default() };
        }
        let mut found = Self::default();
        let (mut file, mut line) = (None, None);
        for Entry { key, text, nested } in entries {
            let nested_entries = || mapping(&nested);
            match key.as_str() {
                "message" | "error" if found.message.is_none() => found.message = Some(text),
                "expected" | "expect" | "wanted" if found.expected.is_none() => {
                    found.expected = Some(text);
                }
                "actual" | "got" | "found" if found.actual.is_none() => found.actual = Some(text),
                "duration_ms" if text.parse::<f64>().is_ok() => found.duration = text.parse().ok(),
                "file" if file.is_none() => file = Some(text),
                "line" if line.is_none() && text.parse::<u32>().is_ok() => line = text.parse().ok(),
                "at" | "location" if found.location.is_none() => {
                    found.location = location_of(&text).or_else(|| nested_location(&nested));
                    if found.location.is_none() {
                        found.other.push((key, text));
                    }
                }
                "data" if found.expected.is_none() && found.actual.is_none() => {
                    for entry in nested_entries() {
                        match entry.key.as_str() {
                            "expected" | "expect" | "wanted" => found.expected = Some(entry.text),
                            "actual" | "got" | "found" => found.actual = Some(entry.text),
                            _ => found.other.push((format!("data.{}", entry.key), entry.text)),
                        }
                    }
                    if nested.is_empty() {
                        found.other.push((key, text));
                    }
                }
                _ => found.other.push((key, text)),
            }
        }
        if let (None, Some(file)) = (&found.location, file) {
            found.location = Some((file, line.unwrap_or(0)));
        } else if let Some(line) = line {
            found.other.push(("line".to_owned(), line.to_string()));
        }
        found
    }

    /// Reads the comments after a test line, without `#`.
    pub fn from_comments(lines: &[String]) -> Self {
        let lines = dedent(lines);
        let mut found = Self::default();
        let mut rest = Vec::new();
        for line in &lines {
            let text = line.trim();
            if let Some(location) = perl_location(text) {
                found.location.get_or_insert(location);
            } else if text.starts_with("Failed test") || text.starts_with("Failed (TODO) test") {
                // Repeats the description.
            } else if let Some(value) = text.strip_prefix("got: ") {
                found.actual.get_or_insert_with(|| value.to_owned());
            } else if let Some(value) = text.strip_prefix("expected: ") {
                found.expected.get_or_insert_with(|| value.to_owned());
            } else {
                let location = bats_location(text);
                found.location = location.or(found.location);
                rest.push(line.as_str());
            }
        }
        // The innermost frame of a Python traceback.
        let frame = lines.iter().rev().find_map(|line| python_location(line.trim()));
        found.location = found.location.or(frame);
        let last = rest.iter().rev().find(|line| !line.trim().is_empty()).map(|it| it.trim());
        let rest = match (rest.first(), last) {
            // The exception is at the end; overviews show the first line.
            (Some(first), Some(last)) if first.starts_with("Traceback") => {
                format!("{last}\n{}", rest.join("\n"))
            }
            _ => rest.join("\n"),
        };
        found.message = (!rest.trim().is_empty()).then_some(rest);
        found
    }
}

/// An entry of a mapping.
struct Entry {
    key: String,
    /// The value: a scalar without quotes, or the text of anything else.
    text: String,
    /// The lines of a nested collection.
    nested: Vec<String>,
}

/// The entries of a block mapping; none if the lines are not one.
fn mapping(lines: &[String]) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut lines = lines.iter().peekable();
    while let Some(line) = lines.next() {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let Some((key, value)) = key_of(line) else { return Vec::new() };
        let mut block: Vec<String> = Vec::new();
        while let Some(next) = lines.next_if(|next| is_inner(next)) {
            block.push(next.clone());
        }
        while block.last().is_some_and(|line| line.trim().is_empty()) {
            block.pop();
        }
        let block = dedent(&block);
        let is_block_scalar = value.starts_with(['|', '>']);
        let text = match value {
            _ if is_block_scalar => block.join("\n"),
            "" => block.join("\n"),
            _ if block.is_empty() => scalar(value),
            _ => scalar(&format!("{value}\n{}", block.join("\n"))),
        };
        let nested = if value.is_empty() { block } else { Vec::new() };
        entries.push(Entry { key, text, nested });
    }
    entries
}

/// Whether a line belongs to the entry before it.
fn is_inner(line: &str) -> bool {
    line.starts_with([' ', '\t']) || line.trim().is_empty() || line.starts_with("- ")
}

fn key_of(line: &str) -> Option<(String, &str)> {
    let (key, value) = line.split_once(':')?;
    let is_key = !key.is_empty() && !key.starts_with([' ', '-', '{', '[']);
    let is_separated = value.is_empty() || value.starts_with([' ', '\t']);
    (is_key && is_separated).then(|| (scalar(key.trim()), value.trim()))
}

/// A scalar without its quotes.
fn scalar(text: &str) -> String {
    let quoted = |quote| text.strip_prefix(quote)?.strip_suffix(quote);
    if let Some(inner) = quoted('\'') {
        return inner.replace("''", "'");
    }
    let Some(inner) = quoted('"') else { return text.to_owned() };
    // The escapes that producers use are JSON's.
    serde_json::from_str(&format!("\"{inner}\"")).unwrap_or_else(|_| inner.to_owned())
}

/// Removes the common indentation.
fn dedent(lines: &[String]) -> Vec<String> {
    let indentation = |line: &String| line.len() - line.trim_start().len();
    let filled = lines.iter().filter(|line| !line.trim().is_empty());
    let common = filled.map(indentation).min().unwrap_or(0);
    lines.iter().map(|line| line.get(common..).unwrap_or_default().trim_end().to_owned()).collect()
}

/// `FILE:LINE`, `FILE:LINE:COLUMN`, `function (FILE:LINE:COLUMN)`, on one line.
fn location_of(text: &str) -> Option<(String, u32)> {
    let text = text.trim();
    if text.contains('\n') {
        return None;
    }
    let text = match text.strip_suffix(')') {
        Some(inner) => inner.rsplit_once('(')?.1,
        None => text,
    };
    let (rest, last) = text.rsplit_once(':')?;
    let last: u32 = last.trim().parse().ok()?;
    let with_column =
        rest.rsplit_once(':').and_then(|(file, line)| Some((file, line.parse().ok()?)));
    let (file, line) = with_column.unwrap_or((rest, last));
    (!file.is_empty()).then(|| (file.strip_prefix("file://").unwrap_or(file).to_owned(), line))
}

/// `{file: …, line: …}` as lines.
fn nested_location(lines: &[String]) -> Option<(String, u32)> {
    let entries = mapping(lines);
    let find = |names: &[&str]| {
        entries.iter().find(|entry| names.contains(&entry.key.as_str())).map(|it| it.text.clone())
    };
    let file = find(&["file", "fileName", "filename"])?;
    let line = find(&["line", "lineNumber"]).and_then(|line| line.parse().ok());
    Some((file, line.unwrap_or(0)))
}

/// `at t/arm.t line 3.`
fn perl_location(text: &str) -> Option<(String, u32)> {
    let (file, line) = text.strip_prefix("at ")?.strip_suffix('.')?.rsplit_once(" line ")?;
    Some((file.to_owned(), line.parse().ok()?))
}

/// `(in test file arm.bats, line 2)`; also as the second line of a call stack.
fn bats_location(text: &str) -> Option<(String, u32)> {
    let (_, rest) = text.split_once("in test file ")?;
    let (file, line) = rest.strip_suffix(')')?.rsplit_once(", line ")?;
    Some((file.to_owned(), line.parse().ok()?))
}

/// `File "test_arm.py", line 9, in test_moves`
fn python_location(text: &str) -> Option<(String, u32)> {
    let (file, rest) = text.strip_prefix("File \"")?.split_once("\", line ")?;
    let line = rest.split(',').next()?;
    Some((file.to_owned(), line.trim().parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yaml(text: &str) -> Diagnostics {
        Diagnostics::from_yaml(&text.lines().map(str::to_owned).collect::<Vec<_>>())
    }

    fn comments(text: &str) -> Diagnostics {
        Diagnostics::from_comments(&text.lines().map(str::to_owned).collect::<Vec<_>>())
    }

    fn at(file: &str, line: u32) -> Option<(String, u32)> {
        Some((file.to_owned(), line))
    }

    #[test]
    fn a_block_of_tape() {
        let found = yaml(
            "    operator: deepEqual\n    expected: |-\n      { a: 2 }\n    actual: |-\n      { a: 1 }\n    \
             at: Test.<anonymous> (/tmp/t.js:2:64)\n    stack: |-\n      Error: x\n          at y\n",
        );
        assert_eq!(found.expected.as_deref(), Some("{ a: 2 }"));
        assert_eq!(found.actual.as_deref(), Some("{ a: 1 }"));
        assert_eq!(found.location, at("/tmp/t.js", 2));
        let stack = ("stack".to_owned(), "Error: x\n    at y".to_owned());
        assert_eq!(found.other, [("operator".to_owned(), "deepEqual".to_owned()), stack]);
    }

    #[test]
    fn a_block_of_node() {
        let found = yaml(
            "duration_ms: 1.75\nlocation: '/tmp/n.js:2:30'\nerror: |-\n  Not equal:\n  \n  1 !== 2\n  \n\
             code: 'it''s'\nname: \"a\\nb\"\n",
        );
        assert_eq!(found.duration, Some(1.75));
        assert_eq!(found.location, at("/tmp/n.js", 2));
        assert_eq!(found.message.as_deref(), Some("Not equal:\n\n1 !== 2"));
        let other = [("code", "it's"), ("name", "a\nb")].map(|(k, v)| (k.to_owned(), v.to_owned()));
        assert_eq!(found.other, other);
    }

    #[test]
    fn the_block_of_the_specification() {
        let found = yaml(
            "message: 'First line invalid'\nseverity: fail\ndata:\n  got: 'Flirble'\n  expect: 'Fnible'\n",
        );
        assert_eq!(found.message.as_deref(), Some("First line invalid"));
        assert_eq!(found.actual.as_deref(), Some("Flirble"));
        assert_eq!(found.expected.as_deref(), Some("Fnible"));
        let lists = yaml("found:\n- 1\n- 2\nwanted:\n  - 1\nat:\n  file: a.c\n  line: 7\n");
        assert_eq!(lists.actual.as_deref(), Some("- 1\n- 2"));
        assert_eq!(lists.location, at("a.c", 7));
        assert_eq!(yaml("file: a.c\nline: 3\n").location, at("a.c", 3));
    }

    #[test]
    fn text_that_is_no_mapping_is_the_message() {
        assert_eq!(yaml("  no: arm\n  at all\n").message.as_deref(), Some("no: arm\nat all"));
        assert_eq!(yaml("- 1\n- 2").message.as_deref(), Some("- 1\n- 2"));
        assert_eq!(yaml("at: the elbow").other, [("at".to_owned(), "the elbow".to_owned())]);
    }

    #[test]
    fn comments_of_producers() {
        let perl = comments(
            "  Failed test 'x'\n  at t/arm.t line 3.\n         got: '1'\n    expected: '2'\n",
        );
        assert_eq!(perl.location, at("t/arm.t", 3));
        assert_eq!((perl.actual.as_deref(), perl.expected.as_deref()), (Some("'1'"), Some("'2'")));
        assert_eq!(perl.message, None);
        let bats = comments(
            "(from function `f' in file a.bash, line 9,\n in test file t.bats, line 2)\n  `f' failed",
        );
        assert_eq!(bats.location, at("t.bats", 2));
        assert!(bats.message.is_some_and(|text| text.ends_with("`f' failed")));
        let python = comments(
            "Traceback:\n  File \"case.py\", line 57, in x\n  File \"t.py\", line 9, in y\nAssertionError: 1 != 0",
        );
        assert_eq!(python.location, at("t.py", 9));
        assert!(
            python
                .message
                .is_some_and(|text| text.starts_with("AssertionError: 1 != 0\nTraceback"))
        );
    }
}
