//! Backlog: how much of each process waits to be reported.

use std::sync::{Mutex, PoisonError};

use rtf_model::{CaseStart, Event, EventKind, Question, Source};

/// Approximate memory of an event without its texts, in bytes.
const EVENT_BYTES: usize = 200;
/// Memory of a sample, in bytes.
const SAMPLE_BYTES: usize = 16;

/// The number of pending bytes of each process.
#[derive(Debug, Default)]
pub(crate) struct Backlog(Mutex<Waiting>);

#[derive(Debug, Default)]
struct Waiting {
    /// A list, because few processes have pending events at the same time.
    of: Vec<(Source, usize)>,
    is_closed: bool,
}

impl Backlog {
    pub fn add(&self, event: &Event) {
        let Some((source, bytes)) = size(&event.kind) else { return };
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.is_closed {
            return;
        }
        match waiting.of.iter_mut().find(|(of, _)| *of == source) {
            Some((_, known)) => *known += bytes,
            None => waiting.of.push((source, bytes)),
        }
    }

    /// Removes an event that was reported.
    pub fn remove(&self, event: &Event) {
        let Some((source, bytes)) = size(&event.kind) else { return };
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(place) = waiting.of.iter().position(|(of, _)| *of == source) else { return };
        let known = &mut waiting.of[place].1;
        *known = known.saturating_sub(bytes);
        if *known == 0 {
            waiting.of.swap_remove(place);
        }
    }

    /// Number of pending bytes of a process.
    pub fn of(&self, source: Source) -> usize {
        let waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.of.iter().find(|(of, _)| *of == source).map_or(0, |(_, bytes)| *bytes)
    }

    /// Drops all counts, and ignores further events.
    pub fn close(&self) {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *waiting = Waiting { of: Vec::new(), is_closed: true };
    }
}

/// The reporting process, and the memory that the event takes. `None` for events of the run,
/// and for output, which the run limits.
fn size(kind: &EventKind) -> Option<(Source, usize)> {
    let teller = |test, fixture: Option<_>| fixture.map_or(Source::Test(test), Source::Fixture);
    let (source, more) = match kind {
        EventKind::Message { source, message, .. } => {
            let compared = message.comparison.as_ref();
            let compared = compared.map_or(0, |it| it.expected.len() + it.got.len());
            (*source, message.text.len() + compared)
        }
        EventKind::Measured { test, fixture, .. } => (teller(*test, *fixture), 0),
        EventKind::Attached { test, fixture, .. } => (teller(*test, *fixture), 0),
        EventKind::Sampled { test, samples } => {
            (Source::Test(*test), samples.points.len() * SAMPLE_BYTES)
        }
        EventKind::CasesPlanned { test, names } => {
            let names = names.iter().map(|name| name.len() + size_of::<String>());
            (Source::Test(*test), names.sum())
        }
        EventKind::CaseStarted(started) => {
            let CaseStart { name, parameters, tags, location, .. } = &started.start;
            let tags: usize = tags.iter().map(String::len).sum();
            let parameters = parameters.iter().map(|it| it.name.len() + it.value.len());
            let location = location.as_ref().map_or(0, |location| location.file.len());
            (Source::Test(started.test), name.len() + parameters.sum::<usize>() + tags + location)
        }
        EventKind::CaseFinished(end) => {
            (Source::Test(end.test), end.reason.as_ref().map_or(0, String::len))
        }
        EventKind::QuestionAsked(asked) => {
            let Question { text, choices, .. } = &asked.question;
            let choices: usize = choices.iter().map(String::len).sum();
            (Source::Test(asked.test), text.len() + choices)
        }
        _ => return None,
    };
    Some((source, EVENT_BYTES + more))
}

#[cfg(test)]
mod tests {
    use rtf_model::{
        CaseFinished, CaseId, CaseStarted, FixtureId, Message, MessageKind, Micros, TestId, Verdict,
    };

    use super::*;

    fn message(source: Source) -> Event {
        let (text, kind) = ("x".repeat(100), MessageKind::Report);
        let message = Message {
            kind,
            text,
            location: None,
            comparison: None,
            critical: false,
            case: None,
            interval: None,
        };
        let kind = EventKind::Message { source, message, test: None };
        Event { seq: 0, at: Micros::default(), kind }
    }

    /// A test with a million cases must not fill the memory of the runner.
    #[test]
    fn cases_wait_like_messages() {
        let (test, backlog) = (TestId(3), Backlog::default());
        let (case, name) = (CaseId(1), "x".repeat(50));
        let start = CaseStart::new(case, name);
        let names = vec!["x".repeat(76)];
        let kinds = [
            EventKind::CasesPlanned { test, names },
            EventKind::CaseStarted(Box::new(CaseStarted { test, start })),
            EventKind::CaseFinished(CaseFinished {
                test,
                case,
                verdict: Verdict::Failed,
                reason: Some("x".repeat(50)),
                decided_by: None,
                duration_us: None,
                carried: false,
                rerun: false,
                episode: None,
            }),
        ];
        for (kind, bytes) in kinds.into_iter().zip([300, 550, 800]) {
            backlog.add(&Event { seq: 0, at: Micros::default(), kind });
            assert_eq!(backlog.of(Source::Test(test)), bytes);
        }
    }

    #[test]
    fn each_process_has_a_backlog_of_its_own() {
        let (backlog, test, fixture) =
            (Backlog::default(), Source::Test(TestId(3)), Source::Fixture(FixtureId(3)));
        backlog.add(&message(test));
        backlog.add(&message(test));
        assert_eq!((backlog.of(test), backlog.of(fixture)), (600, 0));
        backlog.add(&message(fixture));
        backlog.remove(&message(test));
        assert_eq!((backlog.of(test), backlog.of(fixture)), (300, 300));
        backlog.close();
        backlog.add(&message(test));
        assert_eq!((backlog.of(test), backlog.of(fixture)), (0, 0));
    }
}
