//! Which runs of a list are wanted.

use serde::Deserialize;
use utoipa::ToSchema;

use crate::index::State;
use crate::views::RunInfo;

/// The result of a run, or that it is running.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RunResult {
    /// It is running.
    Running,
    /// It has finished without any problem.
    Green,
    /// It has finished, and is not green.
    Red,
    /// It was ended early.
    Interrupted,
    /// Its runner died, or its journal has no end.
    Died,
    /// A part of its journal cannot be read.
    Damaged,
}

/// Which runs are wanted: those for which all of this holds.
#[derive(Clone, Debug, Default)]
pub struct RunFilter {
    /// Words in lower case.
    pub words: Vec<String>,
    /// How it ended.
    pub result: Option<RunResult>,
    /// The name of one of its suites.
    pub suite: Option<String>,
    /// The branch.
    pub branch: Option<String>,
    /// The beginning of the commit's hash, in lower case.
    pub commit: Option<String>,
    /// One of its robots.
    pub robot: Option<String>,
    /// The profile.
    pub profile: Option<String>,
    /// The first day.
    pub since: Option<String>,
    /// The last day.
    pub until: Option<String>,
}

impl RunFilter {
    /// Whether every run is wanted.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { words, result, suite, branch, commit, robot, profile, since, until } = self;
        let texts = [suite, branch, commit, robot, profile, since, until];
        words.is_empty() && result.is_none() && texts.iter().all(|text| text.is_none())
    }

    /// Whether this run is wanted.
    #[must_use]
    pub fn matches(&self, run: &RunInfo) -> bool {
        let branch = run.revision.as_ref().and_then(|revision| revision.branch.as_ref());
        let commit = run.revision.as_ref().map_or("", |revision| &revision.commit);
        let day = run.started_at.get(..10).unwrap_or_default();
        self.result.is_none_or(|result| result.is_of(run))
            && self.suite.as_ref().is_none_or(|suite| run.suite_names.contains(suite))
            && self.branch.as_ref().is_none_or(|wanted| Some(wanted) == branch)
            && self.commit.as_ref().is_none_or(|begin| commit.starts_with(&**begin))
            && self.robot.as_ref().is_none_or(|robot| run.robots.contains(robot))
            && self.profile.as_ref().is_none_or(|wanted| Some(wanted) == run.profile.as_ref())
            && self.since.as_ref().is_none_or(|since| day >= &**since)
            && self.until.as_ref().is_none_or(|until| day <= &**until)
            && self.has_words(run)
    }

    fn has_words(&self, run: &RunInfo) -> bool {
        if self.words.is_empty() {
            return true;
        }
        let revision = run.revision.as_ref();
        let mut text = format!("{} {}", run.run, run.command.join(" "));
        let more = run.suite_names.iter().chain(&run.robots).chain(&run.profile);
        let more = more.chain(revision.map(|revision| &revision.commit));
        for word in more.chain(revision.and_then(|revision| revision.branch.as_ref())) {
            text += " ";
            text += word;
        }
        let text = text.to_lowercase();
        self.words.iter().all(|word| text.contains(&**word))
    }
}

impl RunResult {
    fn is_of(self, run: &RunInfo) -> bool {
        let green = run.green == Some(true);
        match self {
            Self::Running => !run.state.is_over(),
            Self::Green => run.state == State::Finished && green,
            Self::Red => run.state == State::Finished && !green,
            Self::Interrupted => run.state == State::Interrupted,
            Self::Died => matches!(run.state, State::Died | State::Incomplete),
            Self::Damaged => !run.damages.is_empty(),
        }
    }
}
