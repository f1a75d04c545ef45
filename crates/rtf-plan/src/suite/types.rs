//! The declarations of a suite file, before any name is resolved.

use std::time::Duration;

use jiff::Timestamp;
use jiff::civil::Date;
use rtf_model::Verdict;
use rtf_model::protocol::EpisodeSlots;

use super::{
    Combination, DeclaredEnvelope, DeclaredFault, DeclaredFixture, DeclaredHook, DeclaredMatrix,
    DeclaredMonitor, DeclaredPlugin, DeclaredSource, FixtureReferences, Span, Spanned,
};

/// The contents of a suite file.
#[derive(Clone, Debug)]
pub struct DeclaredSuite {
    /// The position of the `<suite>` tag.
    pub span: Span,
    pub name: Option<Spanned<String>>,
    /// Environment variables of all its processes, in order.
    pub env: Vec<(String, String)>,
    /// Tags of all its tests.
    pub tags: Vec<String>,
    pub isolate: DeclaredIsolation,
    pub settings: SuiteSettings,
    /// The simulated clock; `None` for the wall clock.
    pub clock: Option<DeclaredClock>,
    /// The fixtures, in order.
    pub fixtures: Vec<DeclaredFixture>,
    /// The hooks, in order.
    pub hooks: Vec<DeclaredHook>,
    /// The sources of signals, in order.
    pub signals: Vec<DeclaredSource>,
    /// The monitors of all tests.
    pub monitors: Vec<DeclaredMonitor>,
    /// The files of limits, in order.
    pub envelopes: Vec<DeclaredEnvelope>,
    /// The faults of all tests.
    pub faults: Vec<DeclaredFault>,
    /// The tests, in order.
    pub tests: Vec<DeclaredTest>,
    pub fixture_references: FixtureReferences,
}

/// The settings of a suite in which no name has to be resolved.
#[derive(Clone, Debug)]
pub struct SuiteSettings {
    /// The description, white space folded.
    pub description: String,
    pub environment: String,
    /// The limit for the whole suite, including set-up and tear-down of fixtures.
    pub timeout: Option<Duration>,
    /// Exclusive resources, sorted by name.
    pub requires: Vec<RequiredResource>,
    /// Whether the suite stays green when a fixture collapses.
    pub tolerates_collapse: bool,
    /// Whether a failed critical test or assertion ends the whole run, not only the suite.
    pub critical_stops_run: bool,
    /// Whether a test or a case that skips itself makes the run red.
    pub skips_fail: bool,
    /// The maximum number of tests that run at the same time.
    pub parallel: u32,
}

impl Default for SuiteSettings {
    fn default() -> Self {
        Self {
            description: String::new(),
            environment: String::new(),
            timeout: None,
            requires: Vec::new(),
            tolerates_collapse: false,
            critical_stops_run: false,
            skips_fail: false,
            parallel: 1,
        }
    }
}

/// A resource that a limited number of suites can use at the same time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RequiredResource {
    /// The name: `robot:icub`.
    pub name: String,
    /// The number of suites that can use it at the same time.
    pub slots: u32,
}

/// The private resources that a suite requests.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeclaredIsolation {
    /// Whether it gets a private network.
    pub network: bool,
    pub middleware: Option<DeclaredMiddleware>,
    /// The names of its ports, sorted.
    pub ports: Vec<String>,
}

/// A simulated clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeclaredClock {
    pub source: ClockSource,
    /// The limit in wall time, as a multiple of a test's limit.
    pub backstop: Option<u32>,
    /// The position of the attribute.
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockSource {
    /// The ROS 1 topic `/clock`.
    Ros,
    /// The ROS 2 topic `/clock`.
    Ros2,
    /// YARP's network clock.
    Yarp,
    /// A file that a fixture writes.
    File,
}

impl ClockSource {
    /// Returns the word for it in suites.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Ros => "ros",
            Self::Ros2 => "ros2",
            Self::Yarp => "yarp",
            Self::File => "file",
        }
    }
}

/// The middleware that the processes of a suite use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclaredMiddleware {
    /// Private middleware of the suite.
    Own,
    /// Middleware that is already running.
    Shared,
}

#[derive(Clone, Debug)]
pub struct DeclaredTest {
    /// The position of the tag.
    pub span: Span,
    pub name: Option<Spanned<String>>,
    /// Its former name.
    pub was: Option<String>,
    pub plugin: DeclaredPlugin,
    /// The limits, including those of the suite.
    pub limits: DeclaredLimits,
    pub settings: TestSettings,
    /// Of a test that runs many episodes: how.
    pub slots: Option<Spanned<EpisodeSlots>>,
    /// The attributes about its cases; `None` if it has none of them.
    pub cases: Option<Box<DeclaredCases>>,
    /// The tags of the test itself.
    pub tags: Vec<String>,
    /// Environment variables in addition to the suite's.
    pub env: Vec<(String, String)>,
    pub learn: Vec<LearnPlan>,
    pub monitors: Vec<DeclaredMonitor>,
    pub faults: Vec<DeclaredFault>,
    pub known_failure: Option<Box<DeclaredKnownFailure>>,
    /// The values with which it runs; `None` for a test without a matrix.
    pub matrix: Option<Box<DeclaredMatrix>>,
    /// The combination of the matrix, once the planner has expanded it.
    pub combination: Option<Combination>,
}

/// A `<learn>`: limits of a measurement that are learned from earlier runs.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnPlan {
    /// The position of the tag.
    pub span: Span,
    pub measurement: String,
    /// The fewest runs from which limits are learned.
    pub min_runs: u32,
    /// The distance of the limits from the median, in robust standard deviations.
    pub sigma: f64,
    pub limits: LearnedSides,
    /// Runs before this time do not count: the change at it is accepted.
    pub since: Option<Timestamp>,
}

/// Which limits are learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LearnedSides {
    /// Only the smallest accepted value.
    Low,
    /// Only the largest accepted value.
    High,
    Both,
}

/// The attributes of a test that depend on whether another framework runs it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeclaredCases {
    /// The patterns of `cases`.
    pub patterns: Option<Spanned<String>>,
    /// The position of `case-timeout`; [`DeclaredLimits::case`] is its value.
    pub case_timeout: Option<Span>,
    /// The `isolation`, unless it is `process`.
    pub isolation: Option<Spanned<TestIsolation>>,
    pub fork: Option<Spanned<ForkPoint>>,
}

/// Where a program with a process for each case is forked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForkPoint {
    /// Before its own constructors.
    Start,
    /// After them.
    Main,
}

/// The processes of a test, unless it has a separate one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestIsolation {
    /// It may share a process with other tests.
    Shared,
    /// Each of its cases has a separate process.
    Case,
}

/// A known failure: in a suite `expect`, in an `rtf.toml` `[[quarantine]]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeclaredKnownFailure {
    pub verdicts: Vec<Verdict>,
    /// The issue: a URL or a text.
    pub issue: Option<String>,
    pub reason: Option<String>,
    /// The last day on which it applies.
    pub until: Option<Spanned<Date>>,
}

/// The settings of a test in which no name has to be resolved.
#[derive(Clone, Copy, Debug)]
pub struct TestSettings {
    /// The number of repetitions, at least 1.
    pub repetitions: u32,
    pub after_collapse: AfterCollapse,
    pub leaks: Leaks,
    pub retries: Retries,
    /// Whether the rest of the suite is skipped unless the test passes.
    pub critical: bool,
    /// Whether no other test of the suite runs at the same time.
    pub exclusive: bool,
    /// Whether it may share a host with other tests.
    pub shared: bool,
    /// Whether it has a private ROS 2 domain, which is not that of the suite.
    pub own_domain: bool,
}

impl Default for TestSettings {
    fn default() -> Self {
        Self {
            repetitions: 1,
            after_collapse: AfterCollapse::default(),
            leaks: Leaks::default(),
            retries: Retries::default(),
            critical: false,
            exclusive: false,
            shared: false,
            own_domain: false,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Retries {
    /// The maximum number of retries of each repetition.
    pub count: u32,
    /// The delay before each retry.
    pub delay: Duration,
}

/// The limits of tests; `None` for the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct DeclaredLimits {
    pub load: Option<Duration>,
    pub setup: Option<Duration>,
    pub run: Option<Duration>,
    pub teardown: Option<Duration>,
    /// The time in `run` after which the test is reported as slow.
    pub slow: Option<Duration>,
    /// The time between the request to stop and the kill.
    pub grace: Option<Duration>,
    /// For each case of a test of another framework.
    pub case: Option<Duration>,
}

/// The reaction of a test to a fixture that collapses while it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AfterCollapse {
    /// The test is `collapsed`; the suite continues with the next test.
    #[default]
    Fail,
    /// The test is rerun once the fixture is ready.
    Rerun,
    /// The test is `skipped`.
    Skip,
}

/// The reaction to a test that leaves processes running.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Leaks {
    /// The processes are killed and reported.
    #[default]
    Report,
    /// In addition, a test that passed becomes an error.
    Fail,
}
