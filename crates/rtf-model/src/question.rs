//! Questions of a test to an operator, and their answers.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::{CaseId, Location, TestId};

/// A question of a running test to an operator.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Question {
    /// Its number: from a host, unique in the host; in an event, unique in the suite.
    pub question: u32,
    /// The text; may have several lines.
    pub text: String,
    /// The possible answers. Without them, the answer is any line of text.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
    /// The answer if no operator answers; without it, this is an error of the test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// How long it waits for an answer, in milliseconds.
    pub timeout_ms: u64,
    /// The path of a picture that the test has attached: from a host, in its directory for
    /// attachments; in an event, relative to the run's directory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
    /// Where in the plug-in it was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    /// The case in which it was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<CaseId>,
}

/// The number of possible answers has this limit.
const MAX_CHOICES: usize = 100;

impl Question {
    /// The largest number of characters of an answer.
    pub const MAX_ANSWER_CHARS: usize = 500;
    /// The largest number of characters of the text.
    pub const MAX_TEXT_CHARS: usize = 10_000;
    /// The longest time for an answer.
    pub const MAX_TIMEOUT: Duration = Duration::from_secs(24 * 60 * 60);

    /// How long it waits for an answer.
    #[must_use]
    pub fn timeout(&self) -> Duration {
        Duration::from_millis(self.timeout_ms).min(Self::MAX_TIMEOUT)
    }

    /// Why it cannot be answered; `None` if it is valid.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        let chars = self.text.chars().count();
        if self.text.trim().is_empty() {
            return Some("its text is empty".to_owned());
        }
        if chars > Self::MAX_TEXT_CHARS {
            return Some(format!(
                "its text has {chars} characters, more than {}",
                Self::MAX_TEXT_CHARS
            ));
        }
        if self.choices.len() > MAX_CHOICES {
            return Some(format!("it has {} choices, more than {MAX_CHOICES}", self.choices.len()));
        }
        for (index, choice) in self.choices.iter().enumerate() {
            if let Some(problem) = line_problem(choice) {
                return Some(format!("the choice \"{}\" {problem}", choice.escape_debug()));
            }
            if self.choices[..index].contains(choice) {
                return Some(format!("the choice \"{choice}\" occurs twice"));
            }
        }
        let problem = self.default.as_ref().and_then(|default| self.answer_problem(default));
        problem.map(|problem| format!("the default answer {problem}"))
    }

    /// Why a text is no answer to it; `None` if it is one.
    #[must_use]
    pub fn answer_problem(&self, answer: &str) -> Option<String> {
        if let Some(problem) = line_problem(answer) {
            return Some(problem);
        }
        if self.choices.is_empty() || self.choices.iter().any(|choice| choice == answer) {
            return None;
        }
        Some(format!("is none of {}", self.choices.join(", ")))
    }
}

/// Why a text is no answer to any question.
fn line_problem(text: &str) -> Option<String> {
    let chars = text.chars().count();
    let problem = if text.trim().is_empty() {
        "is empty".to_owned()
    } else if text.chars().any(char::is_control) {
        "has a line break or another control character".to_owned()
    } else if chars > Question::MAX_ANSWER_CHARS {
        format!("has {chars} characters, more than {}", Question::MAX_ANSWER_CHARS)
    } else {
        return None;
    };
    Some(problem)
}

/// A test asks a question. [`QuestionClosed`] is the matching end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuestionAsked {
    /// The test.
    pub test: TestId,
    /// The question.
    #[serde(flatten)]
    pub question: Question,
}

/// A question was answered, or no operator can answer it any more.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuestionClosed {
    /// The test.
    pub test: TestId,
    /// The number of the question.
    pub question: u32,
    /// The answer that the test got.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer: Option<String>,
    /// Who answered or declined; missing for a default answer, and if the question ended for
    /// another reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<Respondent>,
    /// Why no operator answered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Who answered a question.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Respondent {
    /// Where.
    pub via: AnswerChannel,
    /// On the console, the user's name; otherwise the address of the client.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub who: Option<String>,
}

/// Where a question was answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum AnswerChannel {
    /// On the terminal of `rtf run`.
    Console,
    /// On the page, in a browser.
    Page,
    /// By a program that uses the API with the token.
    Api,
}

impl std::fmt::Display for Respondent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(who) = &self.who {
            write!(f, "{who}, ")?;
        }
        f.write_str(match self.via {
            AnswerChannel::Console => "on the console",
            AnswerChannel::Page => "on the page",
            AnswerChannel::Api => "over the API",
        })
    }
}

impl QuestionClosed {
    /// The result on one line: `yes (alice, on the console)`, `no (default: no operator answered
    /// within 5s)`, `not answered: the test was stopped`.
    #[must_use]
    pub fn summary(&self) -> String {
        let reason = self.reason.as_deref().unwrap_or_default();
        match (&self.answer, &self.by) {
            (Some(answer), Some(by)) => format!("{answer} ({by})"),
            (Some(answer), None) => format!("{answer} (default: {reason})"),
            (None, Some(by)) => format!("declined ({by})"),
            (None, None) => format!("not answered: {reason}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn question(choices: &[&str], default: Option<&str>) -> Question {
        Question {
            question: 1,
            text: "Is the gripper closed?".to_owned(),
            choices: choices.iter().map(|&choice| choice.to_owned()).collect(),
            default: default.map(str::to_owned),
            timeout_ms: 1000,
            ..Question::default()
        }
    }

    #[test]
    fn only_a_choice_is_an_answer_to_a_question_with_choices() {
        let question = question(&["yes", "no"], Some("no"));
        assert_eq!(question.problem(), None);
        assert_eq!(question.answer_problem("yes"), None);
        assert_eq!(question.answer_problem("Yes").unwrap(), "is none of yes, no");
    }

    #[test]
    fn any_line_is_an_answer_to_a_question_without_choices() {
        let question = question(&[], None);
        assert_eq!(question.answer_problem("SN-17 ä"), None);
        for wrong in ["", " ", "two\nlines", "\u{1b}[2J", &"x".repeat(501)] {
            assert!(question.answer_problem(wrong).is_some(), "{wrong:?}");
        }
    }

    #[test]
    fn a_question_that_nobody_can_answer_is_invalid() {
        let problem = |question: Question| question.problem().unwrap();
        assert_eq!(problem(question(&["yes"], Some("no"))), "the default answer is none of yes");
        assert_eq!(problem(question(&["a", "a"], None)), "the choice \"a\" occurs twice");
        assert_eq!(
            problem(question(&["a\n"], None)),
            "the choice \"a\\n\" has a line break or another control character"
        );
        let empty = Question { text: " \n".to_owned(), ..question(&[], None) };
        assert_eq!(problem(empty), "its text is empty");
    }

    #[test]
    fn the_summary_tells_who_answered_or_why_nobody_did() {
        let by = |via, who: Option<&str>| Some(Respondent { via, who: who.map(str::to_owned) });
        let closed = |answer: Option<&str>, by, reason: Option<&str>| {
            let (answer, reason) = (answer.map(str::to_owned), reason.map(str::to_owned));
            QuestionClosed { test: TestId(0), question: 1, answer, by, reason }.summary()
        };
        let console = by(AnswerChannel::Console, Some("alice"));
        assert_eq!(closed(Some("yes"), console.clone(), None), "yes (alice, on the console)");
        assert_eq!(closed(None, console, None), "declined (alice, on the console)");
        assert_eq!(closed(Some("a"), by(AnswerChannel::Api, None), None), "a (over the API)");
        assert_eq!(closed(Some("no"), None, Some("nobody")), "no (default: nobody)");
        assert_eq!(closed(None, None, Some("stopped")), "not answered: stopped");
    }
}
