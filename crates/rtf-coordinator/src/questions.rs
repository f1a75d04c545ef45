//! The questions of workers, which the operator answers at the terminal of this process, one after
//! the other.

use std::collections::VecDeque;
use std::io;
use std::sync::mpsc::{self, Receiver, Sender};

use rtf_campaign::Campaign;
use rtf_engine::run::QuestionReply;
use rtf_report::console::{AskedHere, Operator, prompt, question_text};
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::operator::campaign::CampaignAnswer;
use rtf_run::operator::{self, AnswerSink};

use crate::pool::Pool;
use crate::progress::Progress;

/// The open questions.
pub struct QuestionDesk {
    /// Each with the number of its worker, in the order in which they arrived.
    open: VecDeque<(u32, AskedHere)>,
    /// The one that is shown.
    shown: Option<(u32, AskedHere)>,
    typed: Receiver<Typed>,
    operator: Operator,
}

/// What the operator has typed.
enum Typed {
    Answer(Box<AskedHere>, QuestionReply),
    /// Why a line is no answer.
    Problem(String),
}

struct TypedSink(Sender<Typed>);

impl AnswerSink for TypedSink {
    fn answer(&mut self, asked: &AskedHere, reply: QuestionReply) {
        // The receiver lives as long as the process.
        let _ = self.0.send(Typed::Answer(Box::new(asked.clone()), reply));
    }

    fn complain(&mut self, problem: &str) -> io::Result<()> {
        self.0.send(Typed::Problem(problem.to_owned())).map_err(io::Error::other)
    }
}

impl QuestionDesk {
    /// No question is open. Answers are read in a thread.
    pub fn open() -> Result<Self, Failure> {
        let (sender, typed) = mpsc::channel();
        let operator = operator::start(Box::new(TypedSink(sender)), None);
        let operator = operator.map_err(Failure::internal)?;
        Ok(Self { open: VecDeque::new(), shown: None, typed, operator })
    }

    /// Passes answers to the workers, and shows the question that is next.
    pub fn update(
        &mut self,
        pool: &mut impl Pool,
        progress: &mut Progress<'_>,
        (campaign, total): (&Campaign, usize),
    ) -> Result<(), Failure> {
        for typed in self.typed.try_iter() {
            match typed {
                Typed::Problem(problem) => {
                    progress.note(&format!("{:13}{}", "", escape::line(&problem)))?;
                }
                Typed::Answer(asked, reply) => {
                    let QuestionReply { question, answer, by } = reply;
                    let answer = CampaignAnswer { test: asked.test, question, answer, by };
                    if let Some((worker, _)) = self.shown.as_ref().filter(|(_, it)| *it == *asked) {
                        pool.answer(*worker, &answer);
                    }
                }
            }
        }
        let current = pool.questions();
        self.open.retain(|known| current.contains(known));
        for new in current {
            if !self.open.contains(&new) {
                self.open.push_back(new);
            }
        }
        if self.open.front() == self.shown.as_ref() {
            return Ok(());
        }
        self.shown = self.open.front().cloned();
        self.show(progress, (campaign, total))
    }

    fn show(
        &mut self,
        progress: &mut Progress<'_>,
        (campaign, total): (&Campaign, usize),
    ) -> Result<(), Failure> {
        // Before the prompt is visible: what was typed answers no earlier question.
        (self.operator)(self.shown.as_ref().map(|(_, asked)| asked.clone()));
        let Some((_, asked)) = &self.shown else { return progress.set_prompt(None) };
        let label = asked.episode.map(|id| campaign.episode_label(id, total));
        let title = label.iter().chain([&asked.name]).cloned().collect::<Vec<_>>().join("  ");
        progress.set_prompt(None)?;
        progress.note(question_text(&title, asked).trim_end())?;
        progress.set_prompt(Some(prompt(label.as_ref().unwrap_or(&asked.name))))
    }
}
