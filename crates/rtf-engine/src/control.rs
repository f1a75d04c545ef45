//! Requests to a running run: from signals, and from users of the page.

use std::time::Duration;

use rtf_model::{Episode, Respondent, SuiteId, TestId};
use tokio::sync::watch;

/// How quickly a suite must end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StopLevel {
    /// Stop the test, tear down.
    TearDown,
    /// Kill everything now, without tear-down; hooks run.
    Kill,
    /// Kill the hooks, too.
    KillHooks,
}

/// A request to end the run early.
#[derive(Clone, Debug)]
pub struct Stop {
    pub level: StopLevel,
    /// The reason, for users: `SIGINT`.
    pub reason: String,
    /// The limit for the end, tear-downs and hooks included; then the run continues as with
    /// [`StopLevel::Kill`].
    pub limit: Duration,
}

/// A request that concerns one test or suite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Control {
    /// Stop a running test, and skip its remaining repetitions.
    StopTest {
        test: TestId,
        /// The user who requested it.
        by: String,
    },
    /// Stop a suite's running tests, and skip the rest of the suite.
    SkipSuite {
        suite: SuiteId,
        /// The user who requested it.
        by: String,
    },
    /// Answer a question of a running test.
    Answer {
        test: TestId,
        /// The answer.
        reply: QuestionReply,
    },
    /// Run a further episode: of the only suite, whose plan awaits them.
    Episode(Episode),
    /// No further episode follows.
    EndOfEpisodes,
}

/// What an operator answers to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuestionReply {
    /// The number of the question, as in its event.
    pub question: u32,
    /// The answer; `None` declines to answer.
    pub answer: Option<String>,
    pub by: Respondent,
}

/// All requests of a run, the oldest first.
pub type Controls = watch::Receiver<Vec<Control>>;
