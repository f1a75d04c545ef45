//! What fixtures learn about tests.

use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::Request;
use crate::{FindingSeverity, Location, Measurement, Samples, TestId, Verdict};

/// The events of tests that a fixture can subscribe to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Subscription {
    /// An attempt is about to start: [`Request::TestStarted`].
    TestStarted,
    /// The process of an attempt has ended: [`Request::TestEnded`].
    TestEnded,
    /// An attempt was judged: [`Request::TestFinished`].
    TestFinished,
    /// A running test reports: [`Request::TestReported`].
    TestReported,
}

/// The attempt of a test that a fixture is notified of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestAttempt {
    /// The test, as in events.
    pub id: TestId,
    /// Its name in the suite.
    pub name: String,
    /// The repetition, from 1.
    pub repetition: u32,
    /// The attempt at this repetition, from 1.
    pub attempt: u32,
}

/// An attempt of a test is about to start.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestStartedParams {
    /// The attempt.
    pub test: TestAttempt,
}

/// The process of an attempt has ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestEndedParams {
    /// The attempt.
    pub test: TestAttempt,
    /// Whether the runner stopped it, which decides the verdict: it did not run to its end.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
}

/// A running test has reported something.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestReportedParams {
    /// The test, as in events.
    pub test: TestId,
    /// The report.
    pub report: TestReport,
}

/// What a test reports to fixtures that subscribe to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TestReport {
    /// The phase `setup` begins: times of samples count from now.
    SetupStarted {},
    /// Samples of a signal.
    Sampled(Samples),
    /// A measurement.
    Measured(Measurement),
    /// A monitor that judges the rest of the test.
    Monitor(MonitorDeclaration),
}

/// A monitor that a test declares.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MonitorDeclaration {
    /// The name, unique in the test and the suite.
    pub name: String,
    /// The formula (`spec/monitors.md`).
    pub formula: String,
    /// What a violation means.
    pub severity: FindingSeverity,
    /// The position in the plug-in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
}

impl MonitorDeclaration {
    /// A declaration as plug-ins write it. Without a name, it is the formula; without a severity,
    /// it is a failure.
    ///
    /// # Errors
    /// The severity is unknown.
    pub fn new(
        formula: &str,
        name: &str,
        severity: &str,
        location: Option<Location>,
    ) -> Result<Self, String> {
        let name = if name.is_empty() { formula } else { name };
        let mut all = FindingSeverity::ALL.into_iter();
        let known = all.find(|(known, _)| *known == severity).map(|(_, severity)| severity);
        let severity = known.or(severity.is_empty().then_some(FindingSeverity::Fail));
        let severity = severity.ok_or_else(|| {
            format!("the severity of the monitor `{name}` has to be fail, error, stop or critical")
        })?;
        let (name, formula) = (name.to_owned(), formula.to_owned());
        Ok(Self { name, formula, severity, location })
    }
}

/// An attempt of a test was judged.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestFinishedParams {
    /// The attempt.
    pub test: TestAttempt,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The directory for the fixture's attachments. The host creates it when it is needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attachments_dir: Option<String>,
}
