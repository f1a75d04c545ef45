//! Fixtures.

use rtf_model::{
    FixtureLife, FixtureProvided, FixtureRecord, FixtureState, LeakedProcess, Message,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::model;

/// A fixture.
#[derive(Debug, Serialize, ToSchema)]
pub struct Fixture {
    /// Its id.
    pub id: u32,
    /// Its suite.
    pub suite: u32,
    /// Its name, unique in the suite.
    pub name: String,
    /// The plug-in's type.
    pub plugin_type: String,
    /// Where it is: `pending`, `starting`, `ready`, `collapsed`, `stopping`, `stopped`
    /// or `broken`.
    pub state: &'static str,
    /// Each of its starts, in order.
    pub starts: Vec<Start>,
    /// The values that it has provided since its last start.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<ProvidedValue>, required = false)]
    pub values: Vec<ProvidedValue>,
    /// The first cause, once it broke.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub broken: Option<String>,
    /// The last lines that it printed before something went wrong last.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub log_tail: Vec<String>,
    /// Its failures and errors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<model::Message>, required = false)]
    pub messages: Vec<Message>,
    /// Its processes that had to be killed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<model::LeakedProcess>, required = false)]
    pub leaked: Vec<LeakedProcess>,
}

/// A value that a fixture provides.
#[derive(Debug, Serialize, ToSchema)]
pub struct ProvidedValue {
    /// Its name, unique in the fixture.
    pub name: String,
    /// Any JSON value except `null`; a secret has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<serde_json::Value>,
    /// Whether the value is neither stored nor shown.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub secret: bool,
}

/// One life of a fixture.
#[derive(Debug, Serialize, ToSchema)]
pub struct Start {
    /// From 1.
    pub number: usize,
    /// When its set-up began.
    pub starting: u64,
    /// When its set-up succeeded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ready: Option<u64>,
    /// Its collapse.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collapsed: Option<Collapse>,
    /// When its tear-down began.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopping: Option<u64>,
    /// When its tear-down ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<u64>,
    /// What went wrong in its set-up or tear-down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
}

/// A collapse of a fixture.
#[derive(Debug, Serialize, ToSchema)]
pub struct Collapse {
    /// When.
    pub at: u64,
    /// Why.
    pub reason: String,
}

/// All fixtures of a run.
#[derive(Debug, Serialize, ToSchema)]
pub struct Fixtures {
    /// The fixtures, by their ids.
    pub fixtures: Vec<Fixture>,
}

impl Fixture {
    /// A view of a fixture.
    #[must_use]
    pub fn of(fixture: &FixtureRecord) -> Self {
        let plan = &fixture.plan;
        Self {
            id: plan.fixture.0,
            suite: plan.suite.0,
            name: plan.name.clone(),
            plugin_type: plan.plugin_type.clone(),
            state: match fixture.state {
                FixtureState::Pending => "pending",
                FixtureState::Starting => "starting",
                FixtureState::Ready => "ready",
                FixtureState::Collapsed => "collapsed",
                FixtureState::Stopping => "stopping",
                FixtureState::Stopped => "stopped",
                FixtureState::Broken => "broken",
            },
            starts: fixture.lives.iter().zip(1..).map(|(life, n)| Start::of(life, n)).collect(),
            values: fixture.values.iter().map(ProvidedValue::of).collect(),
            broken: fixture.broken.clone(),
            log_tail: fixture.log_tail.clone(),
            messages: fixture.messages.clone(),
            leaked: fixture.leaked.clone(),
        }
    }
}

impl ProvidedValue {
    fn of(provided: &FixtureProvided) -> Self {
        let FixtureProvided { name, value, secret, .. } = provided.clone();
        Self { name, value, secret }
    }
}

impl Start {
    fn of(life: &FixtureLife, number: usize) -> Self {
        let collapse = |(at, reason): &(rtf_model::Micros, String)| Collapse {
            at: at.0,
            reason: reason.clone(),
        };
        Self {
            number,
            starting: life.starting.0,
            ready: life.ready.map(|at| at.0),
            collapsed: life.collapsed.as_ref().map(collapse),
            stopping: life.stopping.map(|at| at.0),
            stopped: life.stopped.map(|at| at.0),
            problem: life.problem.clone(),
        }
    }
}
