//! Filter expressions: what is accepted means the same after it is printed.

use rtf_model::protocol::CaseSelector;
use rtf_plan::select::filter::{FilterSubject, Matcher, Subject};
use rtf_plan::select::{Filter, parse};
use rtf_plan::suite::SourceText;

use super::labels::{NAME, check_label};

const TOO_DEEP: &str = "too deeply nested";

/// A filter expression.
pub fn check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let source = SourceText::new(NAME, text);
    let filter = match parse(&source) {
        Ok(filter) => filter,
        Err(problem) => {
            assert!(!problem.labels.is_empty(), "a problem without a position");
            return problem.labels.iter().for_each(|label| check_label(text, label));
        }
    };
    let printed = print(&filter);
    let again = match parse(&SourceText::new(NAME, printed.clone())) {
        Ok(again) => again,
        // The printed parentheses are further levels.
        Err(problem) if problem.labels.iter().any(|label| label.text == TOO_DEEP) => return,
        Err(problem) => panic!("`{printed}`: {problem:?}"),
    };
    assert_eq!(print(&again), printed, "printed twice");
    for subject in SUBJECTS {
        let matched = filter.apply(&subject);
        assert_eq!(again.apply(&subject), matched, "`{printed}` matches otherwise");
        // Only conditions on cases can select some of them.
        assert!(filter.has_cases() || !format!("{matched:?}").starts_with("Cases"));
    }
    filter.for_each_equals(&mut |_, _, label| check_label(text, label));
}

/// A test with one value of each subject.
struct Test(&'static str);

const SUBJECTS: [Test; 4] = [Test("slow"), Test("arm/joint=0"), Test(""), Test("a(b) c\\é")];

impl FilterSubject for Test {
    fn visit_values(&self, _: Subject, visit: &mut dyn FnMut(&str)) {
        visit(self.0);
    }
}

/// Prints a filter with all parentheses.
fn print(filter: &Filter) -> String {
    match filter {
        Filter::All => "all()".to_owned(),
        Filter::None => "none()".to_owned(),
        Filter::Not(inner) => format!("!{}", print(inner)),
        Filter::And(..) => chain(filter, " & "),
        Filter::Or(..) => chain(filter, " | "),
        Filter::Has(subject, matcher) => {
            let matcher = match matcher {
                Matcher::Equals(text, _) => format!("={}", escape(text)),
                Matcher::Contains(text) => format!("~{}", escape(text)),
                Matcher::Matches(regex) => format!("/{}/", escape_regex(regex.as_str())),
            };
            format!("{}({matcher})", subject.word())
        }
        Filter::Case(CaseSelector::Equals(text)) => format!("case(={})", escape(text)),
        Filter::Case(CaseSelector::Contains(text)) => format!("case(~{})", escape(text)),
    }
}

/// The operands of a chain of one operator, which the parser nests as flat as possible.
fn chain(filter: &Filter, operator: &str) -> String {
    let mut operands = Vec::new();
    collect(filter, operator, &mut operands);
    format!("({})", operands.join(operator))
}

fn collect(filter: &Filter, operator: &str, operands: &mut Vec<String>) {
    match filter {
        Filter::And(left, right) if operator == " & " => {
            collect(left, operator, operands);
            collect(right, operator, operands);
        }
        Filter::Or(left, right) if operator == " | " => {
            collect(left, operator, operands);
            collect(right, operator, operands);
        }
        other => operands.push(print(other)),
    }
}

/// Escapes every character that has a meaning, also white space at the ends.
fn escape(text: &str) -> String {
    text.chars().flat_map(|c| if c.is_alphanumeric() { vec![c] } else { vec!['\\', c] }).collect()
}

/// Escapes the slashes. A slash that the pattern itself escapes stays.
fn escape_regex(pattern: &str) -> String {
    let (mut text, mut characters) = (String::new(), pattern.chars());
    while let Some(character) = characters.next() {
        match character {
            '/' => text.push_str("\\/"),
            '\\' => {
                text.push('\\');
                text.extend(characters.next());
            }
            other => text.push(other),
        }
    }
    text
}
