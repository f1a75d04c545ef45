//! One line of TAP 12 to 14.

/// What a line of a TAP stream is, without its indentation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TapLine {
    /// `TAP version 14`.
    Version,
    /// `1..5`, `1..0 # SKIP no arm`.
    Plan(Plan),
    /// `ok 1 - moves`, `not ok 2`.
    Point(TestPoint),
    /// `# Subtest: moves`.
    SubtestName(String),
    /// Any other comment, without `#`.
    Comment(String),
    /// `pragma +strict`: the pragmas.
    Pragma(Vec<String>),
    /// `Bail out! no power`: the reason.
    BailOut(String),
    /// The end of a subtest whose test line ended with `{`.
    BlockEnd,
    /// Not TAP: output of the program.
    Other,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// The number of test lines.
    pub count: u64,
    /// Why the whole stream is skipped.
    pub skip_reason: Option<String>,
}

/// A test line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TestPoint {
    /// `ok`, not `not ok`.
    pub ok: bool,
    pub number: Option<u64>,
    /// Its description, unescaped; may be empty.
    pub description: String,
    pub directive: Option<Directive>,
    /// It ends with `{`: its subtest follows in braces.
    pub opens_block: bool,
}

/// A directive, with its explanation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Directive {
    /// `# SKIP no arm`
    Skip(String),
    /// `# TODO not implemented`
    Todo(String),
}

impl TapLine {
    /// Classifies a line without its indentation and line end.
    pub fn parse(line: &str) -> Self {
        if let Some(comment) = line.strip_prefix('#') {
            let comment = comment.strip_prefix(' ').unwrap_or(comment);
            return match comment.strip_prefix("Subtest:") {
                Some(name) => Self::SubtestName(unescape(name.trim())),
                None => Self::Comment(comment.to_owned()),
            };
        }
        if let Some(version) = line.strip_prefix("TAP version ") {
            return if version.trim().parse::<u32>().is_ok() { Self::Version } else { Self::Other };
        }
        if let Some(pragmas) = line.strip_prefix("pragma ") {
            return Self::Pragma(pragmas.split([' ', ',']).map(str::to_owned).collect());
        }
        if let Some(reason) = strip_ignoring_case(line, "Bail out!") {
            return Self::BailOut(reason.trim().to_owned());
        }
        if line.trim_end() == "}" {
            return Self::BlockEnd;
        }
        parse_plan(line)
            .map(Self::Plan)
            .or_else(|| parse_point(line).map(Self::Point))
            .unwrap_or(Self::Other)
    }
}

fn parse_plan(line: &str) -> Option<Plan> {
    let rest = line.strip_prefix("1..")?;
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let count = rest[..digits].parse().ok()?;
    let rest = rest[digits..].trim();
    let skip_reason = match rest.strip_prefix('#') {
        Some(comment) if count == 0 => {
            let comment = comment.trim();
            // `SKIP`, `Skipped:`: the first word.
            let reason = match strip_ignoring_case(comment, "skip") {
                Some(rest) => rest.trim_start_matches(|c: char| !c.is_whitespace()).trim(),
                None => comment,
            };
            Some(reason.to_owned())
        }
        Some(_) => None,
        None if rest.is_empty() => (count == 0).then(String::new),
        None => return None,
    };
    Some(Plan { count, skip_reason })
}

fn parse_point(line: &str) -> Option<TestPoint> {
    let (ok, rest) = match line.strip_prefix("not ok") {
        Some(rest) => (false, rest),
        None => (true, line.strip_prefix("ok")?),
    };
    // `ok` must be a word.
    if rest.chars().next().is_some_and(|c| !c.is_whitespace() && c != '#') {
        return None;
    }
    let rest = rest.trim();
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let is_number = rest[digits..].chars().next().is_none_or(|c| c.is_whitespace() || c == '#');
    let (number, rest) = match rest[..digits].parse() {
        Ok(number) if is_number => (Some(number), rest[digits..].trim_start()),
        _ => (None, rest),
    };
    let rest = match rest.strip_prefix('-') {
        Some(text) if text.is_empty() || text.starts_with(' ') => text.trim_start(),
        _ => rest,
    };
    let (opens_block, rest) = match rest.strip_suffix('{') {
        Some(text) if text.is_empty() || text.ends_with(' ') => (true, text.trim_end()),
        _ => (false, rest),
    };
    let (description, directive) = split_directive(rest);
    Some(TestPoint { ok, number, description: unescape(description), directive, opens_block })
}

/// Separates the directive after the last unescaped `#` that starts one.
fn split_directive(text: &str) -> (&str, Option<Directive>) {
    for (index, _) in text.match_indices('#').collect::<Vec<_>>().into_iter().rev() {
        let backslashes = text[..index].bytes().rev().take_while(|byte| *byte == b'\\').count();
        let starts_word = index == 0 || text[..index].ends_with(char::is_whitespace);
        if backslashes % 2 == 1 || !starts_word {
            continue;
        }
        let word = text[index + 1..].trim_start();
        let explanation =
            |rest: &str| rest.trim_start_matches(|c: char| !c.is_whitespace()).trim().to_owned();
        if let Some(rest) = strip_ignoring_case(word, "skip") {
            return (text[..index].trim_end(), Some(Directive::Skip(explanation(rest))));
        }
        if let Some(rest) = strip_ignoring_case(word, "todo")
            && rest.chars().next().is_none_or(|c| !c.is_alphanumeric())
        {
            return (text[..index].trim_end(), Some(Directive::Todo(explanation(rest))));
        }
    }
    (text.trim_end(), None)
}

fn strip_ignoring_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let start = text.get(..prefix.len())?;
    start.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

/// Replaces `\#` and `\\`; other backslashes stay.
fn unescape(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match chars.peek() {
            Some(&next @ ('#' | '\\')) if c == '\\' => {
                result.push(next);
                chars.next();
            }
            _ => result.push(c),
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(line: &str) -> TestPoint {
        match TapLine::parse(line) {
            TapLine::Point(point) => point,
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn test_lines() {
        let all = point("not ok 12 - moves the arm");
        assert_eq!(
            (all.ok, all.number, all.description.as_str()),
            (false, Some(12), "moves the arm")
        );
        assert_eq!(point("ok"), TestPoint { ok: true, ..TestPoint::default() });
        assert_eq!(point("ok moves").description, "moves");
        assert_eq!(point("ok - moves").description, "moves");
        assert_eq!(point("ok 3").number, Some(3));
        // A description that starts with a number and a letter.
        assert_eq!(point("ok 3d view").description, "3d view");
        assert_eq!(point("ok 1 -3 is negative").description, "-3 is negative");
        for line in ["okay", "not okay", "ok: fine", "nok 1", "OK 1"] {
            assert_eq!(TapLine::parse(line), TapLine::Other, "{line}");
        }
    }

    #[test]
    fn directives() {
        let skip = |reason: &str| Some(Directive::Skip(reason.to_owned()));
        let todo = |reason: &str| Some(Directive::Todo(reason.to_owned()));
        assert_eq!(point("ok 6 # skip no arm").directive, skip("no arm"));
        assert_eq!(point("ok 6 - x # SKIPPED: no arm").directive, skip("no arm"));
        assert_eq!(point("ok 6 - x #SKIP").directive, skip(""));
        assert_eq!(point("not ok 4 x # TODO").directive, todo(""));
        assert_eq!(point("not ok 4 x # todo later # really").description, "x");
        // Not directives.
        for line in [r"ok 1 - a \# SKIP b", "ok 1 - issue #12", "ok 1 a # todos", "ok 1 - C# skip"]
        {
            assert_eq!(point(line).directive, None, "{line}");
        }
        assert_eq!(point(r"ok 1 - a \# b \\ c \n").description, r"a # b \ c \n");
        // Two backslashes are one character, so that the # is not escaped.
        assert_eq!(point(r"ok 1 - a \\ # SKIP b").description, r"a \");
    }

    #[test]
    fn plans() {
        let plan = |line| match TapLine::parse(line) {
            TapLine::Plan(plan) => (plan.count, plan.skip_reason),
            other => panic!("{other:?}"),
        };
        assert_eq!(plan("1..3"), (3, None));
        assert_eq!(plan("1..3 # three tests"), (3, None));
        assert_eq!(plan("1..0"), (0, Some(String::new())));
        assert_eq!(plan("1..0 # SKIP no arm"), (0, Some("no arm".to_owned())));
        assert_eq!(plan("1..0 # Skipped: no arm"), (0, Some("no arm".to_owned())));
        assert_eq!(TapLine::parse("1..x"), TapLine::Other);
        assert_eq!(TapLine::parse("1..3 apples"), TapLine::Other);
        assert_eq!(TapLine::parse("1..99999999999999999999"), TapLine::Other);
    }

    #[test]
    fn other_lines() {
        assert_eq!(TapLine::parse("# Subtest: a \\# b"), TapLine::SubtestName("a # b".to_owned()));
        assert_eq!(TapLine::parse("#   Failed"), TapLine::Comment("  Failed".to_owned()));
        assert_eq!(TapLine::parse("Bail out! no power"), TapLine::BailOut("no power".to_owned()));
        assert_eq!(TapLine::parse("TAP version 14"), TapLine::Version);
        assert_eq!(TapLine::parse("pragma +strict"), TapLine::Pragma(vec!["+strict".to_owned()]));
        assert_eq!(TapLine::parse("}"), TapLine::BlockEnd);
        assert_eq!(TapLine::parse("é"), TapLine::Other);
    }
}
