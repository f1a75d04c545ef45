//! Questions of tests to an operator: shown when they are asked and answered, and one at a time with a
//! prompt if the person can answer here.

use rtf_model::{EventKind, Micros, Question, QuestionRecord, Record, TestId};

use super::options::View;
use super::page::ConsoleLines;
use super::style::{self, BOLD, LOUD};
use crate::explain::{self, Tone};
use crate::{escape, words};

/// The question that the person at this terminal can answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AskedHere {
    pub test: TestId,
    pub question: Question,
}

/// Is called with the question that the person can answer from now on, if there is one.
pub type Operator = Box<dyn FnMut(Option<AskedHere>) + Send>;

#[derive(Default)]
pub(super) struct QuestionPrompt {
    operator: Option<Operator>,
    current: Option<AskedHere>,
}

impl QuestionPrompt {
    pub fn new(operator: Operator) -> Self {
        Self { operator: Some(operator), current: None }
    }

    /// After the start or the end of a question: shows the question that is next if others were
    /// shown after it, and returns the new prompt, if it changes.
    pub fn update(
        &mut self,
        page: &mut ConsoleLines,
        view: View<'_>,
        kind: &EventKind,
    ) -> Option<Option<String>> {
        self.operator.as_ref()?;
        let next = oldest(view.record);
        if next == self.current {
            return None;
        }
        let is_shown = matches!((kind, &next), (EventKind::QuestionAsked(asked), Some(next))
            if asked.test == next.test && asked.question == next.question);
        if let Some(next) = next.as_ref().filter(|_| !is_shown) {
            asked(page, view, next.test, &next.question);
        }
        self.current = next;
        Some(self.current.as_ref().map(|asked| prompt(view.record, asked.test)))
    }

    /// Passes the question to the person.
    pub fn pass(&mut self) {
        if let Some(operator) = &mut self.operator {
            operator(self.current.clone());
        }
    }

    /// The run has ended: no question is open.
    pub fn end(&mut self) {
        if self.current.take().is_some() {
            self.pass();
        }
    }
}

fn prompt(record: &Record, test: TestId) -> String {
    let name = record.full_name(test);
    format!("{}  {}> ", style::paint(LOUD, &format!("{:>11}", "answer")), escape::line(&name))
}

/// The open question that was asked first.
fn oldest(record: &Record) -> Option<AskedHere> {
    let running = record.tests.iter().filter(|test| test.is_running());
    let open = running.flat_map(|test| {
        let questions = test.attempts.last().map_or(&[][..], |attempt| &attempt.questions);
        questions.iter().filter(|it| it.is_open()).map(|it| (test.plan.test, it))
    });
    let when =
        |(_, it): &(TestId, &QuestionRecord)| -> (Micros, u32) { (it.at, it.asked.question) };
    let (test, question) = open.min_by_key(when)?;
    Some(AskedHere { test, question: question.asked.clone() })
}

/// Shows a question.
fn asked(page: &mut ConsoleLines, view: View<'_>, test: TestId, question: &Question) {
    let View { options, record } = view;
    page.remark((BOLD, "question"), &escape::line(&record.full_name(test)));
    let sink = &mut |tone, line: &str| page.detail(tone, line);
    explain::block(Tone::Plain, &question.text, "", sink);
    if let Some(picture) = &question.picture {
        let shown = options.shown(picture.as_ref());
        sink(Tone::Dim, &format!("picture: {}", shown.as_deref().unwrap_or(picture)));
    }
    sink(Tone::Dim, &answers(question));
}

/// `1 yes, 2 no (default: no), within 60 s`.
fn answers(question: &Question) -> String {
    let choices = question.choices.iter().enumerate();
    let choices = choices.map(|(index, choice)| format!("{} {}", index + 1, escape::line(choice)));
    let mut text = choices.collect::<Vec<_>>().join(", ");
    if text.is_empty() {
        text = "a line of text".to_owned();
    }
    if let Some(default) = &question.default {
        text += &format!(" (default: {})", escape::line(default));
    }
    text + &format!(", within {}", words::time(question.timeout()).trim_start())
}

/// Shows the start or the end of a question.
pub(super) fn show(page: &mut ConsoleLines, view: View<'_>, kind: &EventKind) {
    match kind {
        EventKind::QuestionAsked(it) => asked(page, view, it.test, &it.question),
        EventKind::QuestionClosed(it) => closed(page, view.record, it.test, &it.summary()),
        _ => {}
    }
}

fn closed(page: &mut ConsoleLines, record: &Record, test: TestId, summary: &str) {
    let name = record.full_name(test);
    page.remark((BOLD, "answer"), &escape::line(&format!("{name}: {summary}")));
}
