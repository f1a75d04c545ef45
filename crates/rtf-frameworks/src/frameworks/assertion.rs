//! Results of checks that C++ frameworks report, as messages.

use std::collections::HashMap;

use rtf_model::{Comparison, Location, Message, MessageKind};

use crate::case::{ListedCase, StartedCase};
use crate::xml_stream::Attributes;

/// A failure, an error or a passed check.
pub(super) fn message(kind: MessageKind, text: &str, location: Option<Location>) -> Message {
    Message::new(kind, text.trim(), location)
}

/// Makes a failure that the program accepts a report.
pub(super) fn tolerate(message: &mut Message) {
    message.kind = MessageKind::Report;
    message.text = format!("tolerated: {}", message.text);
}

/// The location in an element's attributes.
pub(super) fn location(attributes: &Attributes, file: &str) -> Option<Location> {
    let file = attributes.get(file).to_owned();
    let line = attributes.get("line").parse().unwrap_or(0);
    (!file.is_empty()).then_some(Location { file, line })
}

/// Text with further lines, such as messages that belong to a check.
pub(super) fn with_lines(mut text: String, lines: &[String]) -> String {
    for line in lines {
        text.push('\n');
        text.push_str(line.trim());
    }
    text
}

/// The text of a check that did not hold: `CHECK(position == 42) failed: 41 == 42`.
pub(super) fn failed_check(kind: &str, original: &str, expanded: &str) -> String {
    let check = if kind.is_empty() { original.to_owned() } else { format!("{kind}({original})") };
    match expanded.is_empty() || expanded == original {
        true => format!("{check} failed"),
        false => format!("{check} failed: {expanded}"),
    }
}

/// The numbers of `GOT == EXPECTED` and `GOT is within TOLERANCE of EXPECTED`.
pub(super) fn comparison(expanded: &str) -> Option<Comparison> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let (got, expected, tolerance) = match expanded.split_once(" == ") {
        Some((got, expected)) => (number(got)?, number(expected)?, 0.0),
        None => {
            let (got, rest) = expanded.split_once(" is within ")?;
            let (tolerance, expected) = rest.split_once(" of ")?;
            (number(got)?, number(expected)?, number(tolerance)?)
        }
    };
    let json = |number: f64| vec![number.is_finite().then_some(number)];
    Some(Comparison { expected: json(expected), got: json(got), tolerance, worst: None })
}

/// Gives cases of the same name different names: `NAME#2`. Only these have an `id`, the
/// common name.
pub(super) fn unique_names(cases: &mut [ListedCase]) {
    let mut numbers = HashMap::<String, usize>::new();
    for case in cases.iter() {
        *numbers.entry(case.name.clone()).or_default() += 1;
    }
    numbers.retain(|_, number| std::mem::take(number) > 1);
    for case in cases {
        let Some(number) = numbers.get_mut(&case.name) else { continue };
        *number += 1;
        case.id = Some(case.name.clone());
        if *number > 1 {
            case.name = format!("{}#{number}", case.name);
        }
    }
}

/// The cases that a process runs, for finding them by their name and location.
#[derive(Debug, Default)]
pub(super) struct RunningCases(Vec<ListedCase>);

impl RunningCases {
    pub fn new(cases: &[ListedCase]) -> Self {
        Self(cases.to_vec())
    }

    /// The start of a reported case. `None` for another case of a selected name, which the
    /// framework cannot exclude.
    pub fn start(&self, name: &str, location: Option<Location>) -> Option<StartedCase> {
        let has_name = |case: &&ListedCase| case.id.as_deref().unwrap_or(&case.name) == name;
        let is_same = |case: &&&ListedCase| case.id.is_none() || case.location == location;
        let of_name: Vec<&ListedCase> = self.0.iter().filter(has_name).collect();
        let found = of_name.iter().find(is_same);
        match (found, of_name.is_empty()) {
            (Some(case), _) => Some(case.start()),
            (None, true) => {
                let name = name.to_owned();
                Some(StartedCase { name, location, ..StartedCase::default() })
            }
            (None, false) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_compared() {
        let numbers = |text| comparison(text).map(|it| (it.got[0], it.expected[0], it.tolerance));
        assert_eq!(numbers("41 == 42"), Some((Some(41.0), Some(42.0), 0.0)));
        assert_eq!(numbers("0.5 is within 0.1 of 0.75"), Some((Some(0.5), Some(0.75), 0.1)));
        assert_eq!(numbers("nan == 1"), Some((None, Some(1.0), 0.0)));
        assert_eq!(numbers("\"a\" == \"b\""), None);
        assert_eq!(numbers("true"), None);
    }

    #[test]
    fn cases_of_the_same_name_are_found_by_their_line() {
        let case = |name: &str, line| {
            let location = Some(Location { file: "a.cpp".to_owned(), line });
            ListedCase { name: name.to_owned(), location, ..ListedCase::default() }
        };
        let mut listed = vec![case("a", 1), case("a", 2), case("b", 3)];
        unique_names(&mut listed);
        let running = RunningCases::new(&listed[1..]);
        let start = |name: &str, line| {
            let location = Some(Location { file: "a.cpp".to_owned(), line });
            running.start(name, location).map(|start| start.name)
        };
        assert_eq!(start("a", 2).as_deref(), Some("a#2"));
        assert_eq!(start("a", 1), None);
        assert_eq!(start("b", 3).as_deref(), Some("b"));
        assert_eq!(start("c", 4).as_deref(), Some("c"));
    }
}
