//! Which runs of a list are wanted.

use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use crate::index::State;
use crate::problem::Problem;
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
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct RunFilter {
    /// Runs with all of these words in their name, command, suites, commit, branch,
    /// robot or profile, in upper or lower case.
    q: Option<String>,
    /// Runs with this result, or still running.
    #[param(inline)]
    result: Option<RunResult>,
    /// Runs with a suite of this name.
    suite: Option<String>,
    /// Runs of this branch.
    branch: Option<String>,
    /// Runs of the commit whose hash begins so.
    #[param(pattern = "^[0-9A-Fa-f]{4,64}$")]
    commit: Option<String>,
    /// Runs for this robot.
    robot: Option<String>,
    /// Runs with this profile.
    profile: Option<String>,
    /// Runs that started on this day or later, in their own time zone.
    #[param(pattern = "^[0-9]{4}-[0-9]{2}-[0-9]{2}$")]
    since: Option<String>,
    /// Runs that started on this day or before.
    #[param(pattern = "^[0-9]{4}-[0-9]{2}-[0-9]{2}$")]
    until: Option<String>,
}

impl RunFilter {
    /// Checks the commit and the days.
    ///
    /// # Errors
    /// One of them is none.
    pub fn check(&self) -> Result<(), Problem> {
        let is_hash = |text: &String| {
            (4..=64).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_hexdigit())
        };
        if let Some(commit) = self.commit.as_ref().filter(|text| !is_hash(text)) {
            let expected = "expected 4 to 64 hexadecimal digits";
            return Err(Problem::bad_request(format!("`commit` is `{commit}`, {expected}")));
        }
        for (name, day) in [("since", &self.since), ("until", &self.until)] {
            if let Some(day) = day.as_ref().filter(|day| !is_day(day)) {
                let expected = "expected a day like `2026-11-21`";
                return Err(Problem::bad_request(format!("`{name}` is `{day}`, {expected}")));
            }
        }
        Ok(())
    }

    /// Whether every run is wanted.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { q, result, suite, branch, commit, robot, profile, since, until } = self;
        let texts = [suite, branch, commit, robot, profile, since, until];
        let has_no_words = q.as_ref().is_none_or(|words| words.trim().is_empty());
        has_no_words && result.is_none() && texts.iter().all(|text| text.is_none())
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
            && self
                .commit
                .as_ref()
                .is_none_or(|begin| commit.starts_with(&begin.to_ascii_lowercase()))
            && self.robot.as_ref().is_none_or(|robot| run.robots.contains(robot))
            && self.profile.as_ref().is_none_or(|wanted| Some(wanted) == run.profile.as_ref())
            && self.since.as_ref().is_none_or(|since| day >= &**since)
            && self.until.as_ref().is_none_or(|until| day <= &**until)
            && self.has_words(run)
    }

    fn has_words(&self, run: &RunInfo) -> bool {
        let Some(words) = &self.q else { return true };
        let revision = run.revision.as_ref();
        let mut text = format!("{} {}", run.run, run.command.join(" "));
        let more = run.suite_names.iter().chain(&run.robots).chain(&run.profile);
        let more = more.chain(revision.map(|revision| &revision.commit));
        for word in more.chain(revision.and_then(|revision| revision.branch.as_ref())) {
            text += " ";
            text += word;
        }
        let text = text.to_lowercase();
        words.to_lowercase().split_whitespace().all(|word| text.contains(word))
    }
}

fn is_day(text: &str) -> bool {
    let bytes = text.as_bytes();
    let digits = |mut range: std::ops::Range<usize>| range.all(|n| bytes[n].is_ascii_digit());
    bytes.len() == 10
        && (bytes[4], bytes[7]) == (b'-', b'-')
        && digits(0..4)
        && digits(5..7)
        && digits(8..10)
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
