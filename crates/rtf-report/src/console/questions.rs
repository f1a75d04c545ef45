//! Questions of tests to an operator: shown when they are asked and answered, and one at a time with a
//! prompt if the person can answer here.

use rtf_model::{EventKind, Micros, Question, QuestionRecord, Record, TestId};

use serde::{Deserialize, Serialize};

use super::options::View;
use super::page::ConsoleLines;
use super::style::{self, BOLD, LOUD};
use crate::explain::{self, Tone};
use crate::{escape, words};

/// The question that the person at this terminal can answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AskedHere {
    pub test: TestId,
    /// The full name of the test.
    pub name: String,
    /// The episode of a campaign that runs.
    pub episode: Option<u64>,
    /// The path of its picture, for display.
    pub picture: Option<String>,
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
        let next = oldest(view);
        if next == self.current {
            return None;
        }
        let is_shown = matches!((kind, &next), (EventKind::QuestionAsked(asked), Some(next))
            if asked.test == next.test && asked.question == next.question);
        if let Some(next) = next.as_ref().filter(|_| !is_shown) {
            show_asked(page, &next.name, next);
        }
        self.current = next;
        Some(self.current.as_ref().map(|asked| prompt(&asked.name)))
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

/// The prompt for the answer to a question with this title.
#[must_use]
pub fn prompt(title: &str) -> String {
    format!("{}  {}> ", style::paint(LOUD, &format!("{:>11}", "answer")), escape::line(title))
}

/// The text of a question with this title, in lines.
#[must_use]
pub fn question_text(title: &str, asked: &AskedHere) -> String {
    let mut page = ConsoleLines::default();
    show_asked(&mut page, title, asked);
    page.text
}

/// The open question that was asked first.
fn oldest(view: View<'_>) -> Option<AskedHere> {
    let record = view.record;
    let running = record.tests.iter().filter(|test| test.is_running());
    let open = running.flat_map(|test| {
        let questions = test.attempts.last().map_or(&[][..], |attempt| &attempt.questions);
        questions.iter().filter(|it| it.is_open()).map(|it| (test.plan.test, it))
    });
    let when =
        |(_, it): &(TestId, &QuestionRecord)| -> (Micros, u32) { (it.at, it.asked.question) };
    let (test, question) = open.min_by_key(when)?;
    Some(asked_here(view, test, &question.asked))
}

fn asked_here(View { options, record }: View<'_>, test: TestId, question: &Question) -> AskedHere {
    let shown = |path: &String| options.shown(path.as_ref()).unwrap_or_else(|| path.clone());
    let suite = record.tests.get(test.index()).map(|test| test.plan.suite.index());
    let suite = suite.and_then(|suite| record.suites.get(suite));
    let episode = suite.and_then(|suite| suite.episodes.last());
    AskedHere {
        test,
        name: record.full_name(test).to_string(),
        episode: episode.filter(|it| it.finished.is_none()).map(|it| it.episode.id),
        picture: question.picture.as_ref().map(shown),
        question: question.clone(),
    }
}

/// Shows a question.
fn show_asked(page: &mut ConsoleLines, title: &str, asked: &AskedHere) {
    page.remark((BOLD, "question"), &escape::line(title));
    let sink = &mut |tone, line: &str| page.detail(tone, line);
    explain::block(Tone::Plain, &asked.question.text, "", sink);
    if let Some(picture) = &asked.picture {
        sink(Tone::Dim, &format!("picture: {picture}"));
    }
    sink(Tone::Dim, &answers(&asked.question));
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
        EventKind::QuestionAsked(it) => {
            let asked = asked_here(view, it.test, &it.question);
            show_asked(page, &asked.name, &asked);
        }
        EventKind::QuestionClosed(it) => closed(page, view.record, it.test, &it.summary()),
        _ => {}
    }
}

fn closed(page: &mut ConsoleLines, record: &Record, test: TestId, summary: &str) {
    let name = record.full_name(test);
    page.remark((BOLD, "answer"), &escape::line(&format!("{name}: {summary}")));
}
