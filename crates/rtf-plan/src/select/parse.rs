//! Parses the filter language.
//!
//! ```text
//! filter    = term { ("|" | "or") term }
//! term      = factor { ("&" | "and") factor }
//! factor    = ("!" | "not") factor | "(" filter ")" | condition
//! condition = "all()" | "none()" | subject "(" matcher ")" | "case(" cases ")"
//! subject   = "tag" | "type" | "suite" | "name" | "file" | "param"
//! matcher   = "=" text | "~" text | "/" regex "/" | text
//! cases     = "=" text | "~" text | text
//! ```
//!
//! Cases are not known before a test runs: its host selects them, and can only select
//! the union of several. So `case` cannot be negated, and not be combined with another
//! `case` by `&`.
//!
//! A text ends before the closing parenthesis. Blanks around it are ignored, and
//! `\` escapes the next character.

use rtf_model::Diagnostic;
use rtf_model::protocol::CaseSelector;

use super::filter::{Filter, Matcher, SUBJECTS, Subject};
use crate::suite::{SourceText, Span};
use crate::wording::suggest_or;

/// The conditions that are not a [`Subject`].
const OTHER_CONDITIONS: [&str; 3] = ["case", "all", "none"];

/// The maximum nesting depth of parentheses and negations.
const MAX_DEPTH: usize = 100;

/// Parses a filter.
///
/// # Errors
/// The first syntax error.
pub fn parse(source: &SourceText) -> Result<Filter, Box<Diagnostic>> {
    let mut parser = Parser { source, at: 0, depth: 0 };
    let filter = parser.filter()?;
    parser.skip_blanks();
    if parser.rest().is_empty() {
        return Ok(filter);
    }
    let end = parser.word_end();
    Err(parser.problem(parser.at..end, "expected `&`, `|` or the end").into())
}

type Parsed<T> = Result<T, Box<Diagnostic>>;

/// Joins operands, in order, to a tree that is as flat as possible: a filter is applied and dropped
/// recursively, and may have thousands of operands.
fn join(mut operands: Vec<Filter>, operator: fn(Box<Filter>, Box<Filter>) -> Filter) -> Filter {
    while operands.len() > 1 {
        let mut rest = operands.into_iter();
        let mut pairs = Vec::with_capacity(rest.len().div_ceil(2));
        while let Some(left) = rest.next() {
            pairs.push(match rest.next() {
                Some(right) => operator(Box::new(left), Box::new(right)),
                None => left,
            });
        }
        operands = pairs;
    }
    operands.pop().unwrap_or(Filter::None)
}

struct Parser<'s> {
    source: &'s SourceText,
    at: usize,
    depth: usize,
}

impl Parser<'_> {
    fn filter(&mut self) -> Parsed<Filter> {
        let mut operands = vec![self.term()?];
        while self.take("|") || self.take_word("or") {
            operands.push(self.term()?);
        }
        Ok(join(operands, Filter::Or))
    }

    fn term(&mut self) -> Parsed<Filter> {
        let first = self.factor()?;
        let mut has_cases = first.has_cases();
        let mut operands = vec![first];
        while self.take("&") || self.take_word("and") {
            let start = self.after_blanks();
            let right = self.factor()?;
            if has_cases && right.has_cases() {
                let what = "`&` cannot combine two conditions on cases";
                return Err(self.problem(start..self.at, what).hint("use `|`").into());
            }
            has_cases |= right.has_cases();
            operands.push(right);
        }
        Ok(join(operands, Filter::And))
    }

    fn factor(&mut self) -> Parsed<Filter> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.problem(self.at..self.at + 1, "too deeply nested").into());
        }
        let start = self.after_blanks();
        let factor = if self.take("!") || self.take_word("not") {
            let inner = self.factor()?;
            if inner.has_cases() {
                let problem = self.problem(start..self.at, "`case` cannot be negated");
                return Err(problem.hint("select the other cases instead").into());
            }
            Filter::Not(Box::new(inner))
        } else if self.take("(") {
            let inner = self.filter()?;
            if !self.take(")") {
                let end = self.word_end();
                let problem = self.problem(self.at..end, "expected `)`");
                let opened = self.source.label(Span::new(start..start + 1), "opened here");
                return Err(problem.label(opened).into());
            }
            inner
        } else {
            self.condition()?
        };
        self.depth -= 1;
        Ok(factor)
    }

    fn condition(&mut self) -> Parsed<Filter> {
        let start = self.after_blanks();
        let end =
            start + self.rest().find(|c: char| !c.is_alphanumeric()).unwrap_or(self.rest().len());
        let word = &self.source.text()[start..end];
        if word.is_empty() {
            let end = self.word_end();
            let problem = self.problem(start..end, "expected a condition");
            return Err(problem.hint("for example `tag(slow)` or `name(/joint.*/)`").into());
        }
        self.at = end;
        let subject = SUBJECTS.into_iter().find(|subject| subject.word() == word);
        if subject.is_none() && !OTHER_CONDITIONS.contains(&word) {
            return Err(self.unknown_condition(start, word).into());
        }
        if !self.take("(") {
            let end = self.word_end();
            let what = format!("expected `(` after `{word}`");
            return Err(self.problem(self.at..end, &what).into());
        }
        let open = self.at - 1;
        let filter = match subject {
            Some(subject) => Filter::Has(subject, self.matcher(subject)?),
            None if word == "all" => Filter::All,
            None if word == "case" => Filter::Case(self.cases()?),
            None => Filter::None,
        };
        if self.take(")") {
            return Ok(filter);
        }
        let end = self.word_end();
        let problem = self.problem(self.at..end, "expected `)`");
        let opened = self.source.label(Span::new(open..open + 1), "opened here");
        Err(problem.label(opened).into())
    }

    fn unknown_condition(&self, start: usize, word: &str) -> Diagnostic {
        let what = format!("there is no condition `{word}`");
        let problem = self.problem(start..start + word.len(), &what);
        let words = SUBJECTS.map(Subject::word).into_iter().chain(OTHER_CONDITIONS);
        suggest_or(problem, word, words, |problem| {
            problem
                .note("the conditions are tag, type, suite, name, file, param, case, all and none")
        })
    }

    fn matcher(&mut self, subject: Subject) -> Parsed<Matcher> {
        let start = self.after_blanks();
        if self.take("/") {
            return self.regex(start);
        }
        let equals = self.take("=");
        let contains = !equals && self.take("~");
        let (text, span) = self.text();
        if text.is_empty() && !equals {
            let what = format!("expected a {}", subject.noun());
            return Err(self.problem(start..self.at.max(start + 1), &what).into());
        }
        if equals || (subject.is_whole_word() && !contains) {
            Ok(Matcher::Equals(text, self.source.label(span, "")))
        } else {
            Ok(Matcher::Contains(text))
        }
    }

    fn cases(&mut self) -> Parsed<CaseSelector> {
        let start = self.after_blanks();
        if self.take("/") {
            let problem = self.problem(start..self.at, "`case` has no regular expressions");
            return Err(problem.hint("`case(~text)` selects cases that contain a text").into());
        }
        let equals = self.take("=");
        if !equals {
            self.take("~");
        }
        let (text, _) = self.text();
        if text.is_empty() {
            let problem = self.problem(start..self.at.max(start + 1), "expected a case");
            return Err(problem.into());
        }
        Ok(if equals { CaseSelector::Equals(text) } else { CaseSelector::Contains(text) })
    }

    /// Parses up to the closing slash; `\/` is a slash.
    fn regex(&mut self, start: usize) -> Parsed<Matcher> {
        let mut pattern = String::new();
        let mut characters = self.rest().char_indices();
        let length = loop {
            match characters.next() {
                Some((at, '/')) => break at + 1,
                Some((_, '\\')) => match characters.next() {
                    Some((_, '/')) => pattern.push('/'),
                    Some((_, other)) => pattern.extend(['\\', other]),
                    None => pattern.push('\\'),
                },
                Some((_, other)) => pattern.push(other),
                None => {
                    return Err(self.problem(start..start + 1, "this `/` is never closed").into());
                }
            }
        };
        self.at += length;
        regex::Regex::new(&pattern).map(Matcher::Matches).map_err(|error| {
            let problem = self.problem(start..self.at, "this is not a regular expression");
            let text = error.to_string();
            Box::new(problem.note(text.lines().last().unwrap_or_default().to_owned()))
        })
    }

    /// Parses the text before the closing parenthesis, and returns its position.
    fn text(&mut self) -> (String, Span) {
        let start = self.after_blanks();
        let (mut text, mut kept, mut end) = (String::new(), 0, start);
        let mut characters = self.rest().char_indices();
        let length = loop {
            let (at, character) = match characters.next() {
                None => break self.rest().len(),
                Some((at, ')')) => break at,
                Some((at, '\\')) => (at, characters.next().map_or('\\', |(_, next)| next)),
                Some((_, character)) if character.is_whitespace() => {
                    text.push(character);
                    continue;
                }
                Some((at, character)) => (at, character),
            };
            text.push(character);
            (kept, end) = (text.len(), start + at + character.len_utf8());
        };
        text.truncate(kept);
        self.at = start + length;
        (text, Span::new(start..end))
    }

    fn rest(&self) -> &str {
        &self.source.text()[self.at..]
    }

    fn skip_blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn after_blanks(&mut self) -> usize {
        self.skip_blanks();
        self.at
    }

    /// Consumes a symbol if it is next.
    fn take(&mut self, symbol: &str) -> bool {
        self.skip_blanks();
        let found = self.rest().starts_with(symbol);
        if found {
            self.at += symbol.len();
        }
        found
    }

    /// Consumes a word if it is next and is not the beginning of a longer one.
    fn take_word(&mut self, word: &str) -> bool {
        self.skip_blanks();
        let after = self.rest().strip_prefix(word);
        let found = after
            .is_some_and(|after| !after.starts_with(|c: char| c.is_alphanumeric() || c == '('));
        // `not(…)` is a negation, not a condition.
        let found = found || (word == "not" && self.rest().starts_with("not("));
        if found {
            self.at += word.len();
        }
        found
    }

    /// Returns the end of the next word or symbol.
    fn word_end(&self) -> usize {
        let rest = self.rest();
        let length = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
        let symbol = rest.chars().next().map_or(0, char::len_utf8);
        self.at + length.max(symbol)
    }

    fn problem(&self, range: std::ops::Range<usize>, what: &str) -> Diagnostic {
        let label = self.source.label(Span::new(range), what);
        Diagnostic::error("filter", "invalid filter").label(label)
    }
}
