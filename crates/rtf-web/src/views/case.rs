//! The cases of an attempt of a test.

use std::collections::BTreeMap;

use rtf_model::{AttemptCases, CaseEpisode, CaseRecord, EpisodeEnd, Location, Parameter, Verdict};
use serde::Serialize;
use utoipa::ToSchema;

use super::model;

/// A named result inside an attempt.
#[derive(Debug, Serialize, ToSchema)]
pub struct Case {
    /// Counts all cases of the attempt, from 1.
    pub case: u32,
    /// The case that contains it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parent: Option<u32>,
    /// Its name, unique in its parent.
    pub name: String,
    /// Its name, after the names of the cases that contain it: `Arm/Moves`.
    pub path: String,
    /// Its parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<model::Parameter>, required = false)]
    pub parameters: Vec<Parameter>,
    /// Its tags.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub tags: Vec<String>,
    /// Where in the plug-in it starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Location>)]
    pub location: Option<Location>,
    /// When it started.
    pub started: u64,
    /// Microseconds that it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_us: Option<u64>,
    /// Whether it ran in an earlier attempt, which a collapse interrupted.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub carried: bool,
    /// How often its framework ran it before, in this attempt of the test.
    #[serde(skip_serializing_if = "super::is_default")]
    #[schema(required = false)]
    pub earlier_attempts: u32,
    /// Whether a later attempt of it, or of a case around it, decides.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub superseded: bool,
    /// The verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Verdict>)]
    pub verdict: Option<Verdict>,
    /// Why it did not pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The episode that it is, of a test that runs many.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub episode: Option<EpisodeOfCase>,
}

/// The episode that a case is, and what its test reported about it at its end.
#[derive(Debug, Serialize, ToSchema)]
pub struct EpisodeOfCase {
    /// The number of the episode.
    pub id: u64,
    /// For its random numbers.
    pub seed: u32,
    /// How many steps it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Microseconds of simulated time that it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_us: Option<u64>,
    /// The same text for the same first observation, such as its hash.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_observation: Option<String>,
}

impl EpisodeOfCase {
    fn of(case: &CaseRecord) -> Option<Self> {
        let CaseEpisode { id, seed } = case.start.episode?;
        let end = case.finished.as_ref().and_then(|(_, finished)| finished.episode.clone());
        let EpisodeEnd { steps, time_us, first_observation } = *end.unwrap_or_default();
        Some(Self { id, seed, steps, time_us, first_observation })
    }
}

/// A page of the cases of an attempt.
#[derive(Debug, Serialize, ToSchema)]
pub struct Cases {
    /// The cases, in the order in which they started.
    pub cases: Vec<Case>,
    /// The `after` of the next page.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<u32>,
    /// Number of passed cases that are counted, but not listed; the journal has them.
    #[serde(skip_serializing_if = "super::is_default")]
    #[schema(required = false)]
    pub omitted: u64,
    /// On the last page, the first announced cases that have not started; up to `limit`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub not_run: Vec<String>,
}

/// How many announced cases that did not run are listed.
const NOT_RUN: usize = 1000;

impl Cases {
    /// All cases of an attempt, on one page.
    pub fn all(cases: &AttemptCases) -> Self {
        let not_run = cases.not_run().names().take(NOT_RUN).map(str::to_owned);
        Self {
            cases: cases.kept().iter().map(Case::of).collect(),
            next: None,
            omitted: cases.omitted(),
            not_run: not_run.collect(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.cases.is_empty() && self.not_run.is_empty() && self.omitted == 0
    }
}

/// Number of cases of an attempt.
#[derive(Debug, Serialize, ToSchema)]
pub struct CaseCounts {
    /// All: finished, running, and announced.
    pub total: u64,
    /// Announced cases that have not started.
    pub not_run: u64,
    /// Finished cases by verdict.
    #[schema(schema_with = super::info::by_verdict)]
    pub verdicts: BTreeMap<&'static str, u64>,
}

impl Case {
    /// A view of a case.
    #[must_use]
    pub fn of(case: &CaseRecord) -> Self {
        let micros = |duration: std::time::Duration| duration.as_micros().try_into();
        Self {
            case: case.start.case.0,
            parent: case.start.parent.map(|parent| parent.0),
            name: case.start.name.clone(),
            path: case.path.clone(),
            parameters: case.start.parameters.clone(),
            tags: case.start.tags.clone(),
            location: case.start.location.clone(),
            started: case.started.0,
            duration_us: case.duration().map(|duration| micros(duration).unwrap_or(u64::MAX)),
            carried: case.is_carried(),
            earlier_attempts: case.start.earlier_attempts,
            superseded: case.is_superseded,
            verdict: case.verdict(),
            reason: case.reason().map(str::to_owned),
            episode: EpisodeOfCase::of(case),
        }
    }
}

impl CaseCounts {
    /// `None` if there are no cases.
    #[must_use]
    pub fn of(cases: &AttemptCases) -> Option<Self> {
        let verdicts = Verdict::ALL.map(|verdict| (verdict.as_str(), cases.of(verdict)));
        let not_run = cases.not_run().len() as u64;
        (cases.total() > 0).then(|| Self {
            total: cases.total(),
            not_run,
            verdicts: verdicts.into_iter().collect(),
        })
    }
}
