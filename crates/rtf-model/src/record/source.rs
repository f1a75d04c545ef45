//! The test, fixture or hook that an event belongs to.

use crate::{EventKind, Source};

/// The source of an event, for events of a test, a fixture or a hook.
pub(crate) fn source_of(kind: &EventKind) -> Option<Source> {
    match kind {
        EventKind::FixtureStarting { fixture, .. }
        | EventKind::FixtureReady { fixture }
        | EventKind::FixtureCollapsed { fixture, .. }
        | EventKind::FixtureStopping { fixture }
        | EventKind::FixtureStopped { fixture, .. }
        | EventKind::FixtureBroken { fixture, .. }
        | EventKind::FixtureReset { fixture, .. } => Some(Source::Fixture(*fixture)),
        EventKind::FixtureProvided(provided) => Some(Source::Fixture(provided.fixture)),
        EventKind::HookStarted { hook, .. } | EventKind::HookFinished { hook, .. } => {
            Some(Source::Hook(*hook))
        }
        EventKind::TestStarted { test, .. }
        | EventKind::TestPhase { test, .. }
        | EventKind::CasesPlanned { test, .. }
        | EventKind::Measured { test, .. }
        | EventKind::Sampled { test, .. }
        | EventKind::Attached { test, .. }
        | EventKind::FaultRemoved { test, .. }
        | EventKind::TestSlow { test }
        | EventKind::TestStopping { test, .. }
        | EventKind::TestRepeated { test, .. }
        | EventKind::TestSkipped { test, .. } => Some(Source::Test(*test)),
        EventKind::FaultInjected(fault) => Some(Source::Test(fault.test)),
        EventKind::CaseStarted(started) => Some(Source::Test(started.test)),
        EventKind::CaseFinished(end) => Some(Source::Test(end.test)),
        EventKind::QuestionAsked(asked) => Some(Source::Test(asked.test)),
        EventKind::QuestionClosed(closed) => Some(Source::Test(closed.test)),
        EventKind::TestFinished(finished) => Some(Source::Test(finished.test)),
        EventKind::Message { source, test, .. } => Some(test.map_or(*source, Source::Test)),
        EventKind::StackDumped { source, .. }
        | EventKind::ResourcesMeasured { source, .. }
        | EventKind::ProcessesLeaked { source, .. } => Some(*source),
        EventKind::Output(output) => Some(output.source),
        _ => None,
    }
}
