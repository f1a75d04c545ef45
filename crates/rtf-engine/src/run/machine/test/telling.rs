//! What the plug-in of a test tells while it is carried out.

use rtf_model::protocol::Notification;
use rtf_model::{EventKind, Message, MessageKind, Phase, Source, Verdict};

use super::TestRun;
use crate::run::machine::judge::Problem;
use crate::run::machine::suite::Context;

impl TestRun<'_> {
    pub(super) fn told(&mut self, notification: Notification, cx: &mut Context<'_>) {
        let test = self.plan.id;
        match notification {
            Notification::Phase { phase } => self.enter(phase, cx),
            Notification::Message(message) => self.message(message, cx),
            Notification::Measured(measurement) => {
                let problem = measurement.problem();
                self.kept(problem, EventKind::Measured { test, fixture: None, measurement }, cx);
            }
            Notification::Sampled(samples) => {
                let problem = samples.problem();
                self.kept(problem, EventKind::Sampled { test, samples }, cx);
            }
            Notification::Stack { text } => self.stack_taken(text, cx),
            Notification::Attached(_) => {}
            Notification::Collapsed { .. } => {
                self.broke_protocol("sent `collapsed`, which is for fixtures".to_owned(), cx);
            }
        }
    }

    fn enter(&mut self, phase: Phase, cx: &mut Context<'_>) {
        if phase <= self.phase || phase >= Phase::Exit || self.evidence.answer.is_some() {
            let what = format!("entered {phase} after {}", self.phase);
            return self.broke_protocol(what, cx);
        }
        self.phase = phase;
        cx.emit(EventKind::TestPhase { test: self.plan.id, phase });
        if self.step.is_some() {
            return;
        }
        let limits = &self.plan.limits;
        let limit = match phase {
            Phase::Setup => limits.setup,
            Phase::Run => limits.run,
            _ => limits.teardown,
        };
        let slow = Some(limits.slow).filter(|slow| phase == Phase::Run && *slow < limit);
        self.measure(limit, slow, cx);
    }

    fn message(&mut self, message: Message, cx: &mut Context<'_>) {
        match message.kind {
            MessageKind::Failure => self.note(Verdict::Failed, message.text.clone()),
            MessageKind::Error => self.note(Verdict::Error, message.text.clone()),
            MessageKind::Report | MessageKind::Check => {}
        }
        if message.critical && message.kind != MessageKind::Check && self.critical.is_none() {
            self.critical = Some(message.text.clone());
        }
        cx.emit(EventKind::Message { source: Source::Test(self.plan.id), message, test: None });
    }

    fn kept(&mut self, problem: Option<String>, kept: EventKind, cx: &mut Context<'_>) {
        problem.into_iter().for_each(|problem| self.note(Verdict::Failed, problem));
        cx.emit(kept);
    }

    pub(super) fn own_error(&mut self, text: String, cx: &mut Context<'_>) {
        let (kind, location) = (MessageKind::Error, None);
        self.message(Message { kind, text, location, comparison: None, critical: false }, cx);
    }

    /// Remembers the first failure or error. Only `run` can show that the
    /// robot is wrong; what goes wrong around it is the bench's.
    pub(super) fn note(&mut self, verdict: Verdict, reason: String) {
        let verdict = if self.phase == Phase::Run { verdict } else { Verdict::Error };
        let phase = self.phase;
        self.evidence.first_problem.get_or_insert(Problem { verdict, reason, phase });
    }
}
