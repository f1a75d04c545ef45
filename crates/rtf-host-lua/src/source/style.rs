//! Detects plug-ins that were written for robot-testing-framework 1.x and 2.x.
//!
//! Both styles fill in the table `TestCase`, but `setup` has other arguments and results,
//! so the host must know the style before it calls `setup`. It follows from the names in
//! the code.

/// The predecessor's tables.
const TABLES: [&str; 2] = ["robottestingframework", "RTF"];

/// The predecessor's functions, which could also be called on `TestCase`.
const FUNCTIONS: [&str; 8] = [
    "setName",
    "testReport",
    "testCheck",
    "testFail",
    "testFailIf",
    "assertError",
    "assertFail",
    "getEnvironment",
];

/// The API that a plug-in was written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    /// The table `rtf`.
    Present,
    /// The predecessor's functions.
    Predecessor,
}

impl Style {
    /// A file that uses one of the predecessor's tables or functions, but never the table
    /// `rtf`, has the predecessor's style.
    pub(crate) fn of(source: &str) -> Self {
        let mut before = "";
        let mut predecessor = false;
        for token in Tokens(source) {
            match token {
                "rtf" if before != "." && before != "local" => return Self::Present,
                name if before != "." && TABLES.contains(&name) => predecessor = true,
                name if before == "." && FUNCTIONS.contains(&name) => predecessor = true,
                _ => {}
            }
            before = token;
        }
        if predecessor { Self::Predecessor } else { Self::Present }
    }
}

/// Names and other characters of Lua code, without comments and strings.
struct Tokens<'a>(&'a str);

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        loop {
            self.0 = self.0.trim_start();
            let first = self.0.chars().next()?;
            if let Some(comment) = self.0.strip_prefix("--") {
                let line = comment.find('\n').unwrap_or(comment.len());
                self.0 = after_long_bracket(comment).unwrap_or(&comment[line..]);
            } else if first == '"' || first == '\'' {
                self.0 = after_text(&self.0[1..], first);
            } else if let Some(rest) = after_long_bracket(self.0) {
                self.0 = rest;
            } else {
                let is_part = |c: char| c.is_alphanumeric() || c == '_';
                let name = self.0.find(|c| !is_part(c)).unwrap_or(self.0.len());
                let (token, rest) = self.0.split_at(name.max(first.len_utf8()));
                self.0 = rest;
                return Some(token);
            }
        }
    }
}

/// The rest after a quoted string; `text` starts behind the opening quote.
fn after_text(text: &str, quote: char) -> &str {
    let mut escaped = false;
    for (index, character) in text.char_indices() {
        match character {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if character == quote => return &text[index + quote.len_utf8()..],
            _ => {}
        }
    }
    ""
}

/// The rest after `[[…]]` or `[==[…]==]`, if the code begins with one.
fn after_long_bracket(code: &str) -> Option<&str> {
    let level = code.strip_prefix('[')?.find(|c| c != '=')?;
    let open = "=".repeat(level);
    let inside = code[1 + level..].strip_prefix('[')?;
    let close = format!("]{open}]");
    Some(inside.split_once(&close).map_or("", |(_, rest)| rest))
}

#[cfg(test)]
mod tests {
    use super::Style;

    #[test]
    fn the_style_follows_from_the_names_in_the_code() {
        let predecessors = [
            "TestCase.run = function() robottestingframework.testReport('rtf') end",
            "TestCase.run = function() TestCase.testCheck(true, 'fine') end",
            "local rtf = RTF\nfunction TestCase.run() end",
            "--[[ rtf.check ]] RTF.assertFail('x') -- rtf",
            "local text = [==[ ]] rtf ]==] TestCase . testReport(text)",
        ];
        for source in predecessors {
            assert_eq!(Style::of(source), Style::Predecessor, "{source}");
        }
        let present = [
            "",
            "function TestCase.run() rtf.check(true, 'fine') end",
            "function TestCase.run() error('robottestingframework') end",
            "-- robottestingframework\nfunction TestCase.run() end",
            "robottestingframework.testReport('old') rtf.report('and new')",
            "local s = 'it\\'s' .. \"RTF\" function TestCase.run() end",
            "local own = { testReport = 1 } function TestCase.run() end",
        ];
        for source in present {
            assert_eq!(Style::of(source), Style::Present, "{source}");
        }
    }
}
