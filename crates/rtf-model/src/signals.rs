//! The signals and monitors of a suite, as the planner passes them to `rtf-host-signals`.

use serde::{Deserialize, Serialize};

use crate::{FindingSeverity, Location};

/// The signals and monitors of a suite.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignalsConfig {
    /// The sources of the signals.
    pub sources: Vec<SignalSource>,
    /// The monitors.
    pub monitors: Vec<MonitorConfig>,
    /// Whether the suite has a simulated clock.
    #[serde(default)]
    pub has_clock: bool,
}

/// A source of signals.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SignalSource {
    /// A program that writes lines.
    Program(SignalProgram),
    /// The processes of a fixture.
    Fixture(MeasuredFixture),
    /// A recording, which a program reads before the first test.
    Recording(SignalRecording),
    /// What the test itself reports.
    Test(TestSignal),
}

/// A recording that is played while a test runs. Its program writes all samples, and ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignalRecording {
    /// How many arguments of the plug-in are the program and its arguments.
    pub words: usize,
    /// The signals, in the order of the values on a line.
    pub signals: Vec<SignalConfig>,
}

/// A value that tests report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TestSignal {
    /// The signal; the test uses the same name.
    pub signal: SignalConfig,
    /// The kind of report.
    pub quantity: TestQuantity,
}

/// The reports of a test that are samples of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TestQuantity {
    /// Samples, with their times.
    Sample,
    /// Measurements, at the time when they arrive.
    Measurement,
}

/// A program that writes a line for each sample.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignalProgram {
    /// How many arguments of the plug-in are the program and its arguments. Those of the first
    /// program come first.
    pub words: usize,
    /// The signals, in the order of the values on a line.
    pub signals: Vec<SignalConfig>,
    /// The clock of its times.
    pub time: SignalTime,
    /// Whether the first test waits for its first line.
    pub wait: bool,
    /// What helps if its times are those of another clock, as a clause.
    pub other_clock: String,
}

/// A signal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignalConfig {
    /// The name, unique in the suite.
    pub name: String,
    /// The unit, empty for a pure number.
    #[serde(default)]
    pub unit: String,
}

/// The clock of the times that a program writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SignalTime {
    /// The suite's clock, or seconds since 1970 UTC.
    #[default]
    Clock,
    /// Any origin, at about the rate of real time.
    Own,
    /// Lines have no time: that of their arrival counts.
    Arrival,
}

/// A quantity of the processes of a fixture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeasuredFixture {
    /// The signal.
    pub signal: SignalConfig,
    /// The name of the fixture in its suite.
    pub fixture: String,
    /// The quantity.
    pub quantity: ProcessQuantity,
    /// The interval in milliseconds, at least 1.
    pub every_ms: u64,
}

/// A quantity of processes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProcessQuantity {
    /// Processor time per time: 1 is one busy core.
    Cpu,
    /// Resident memory in MiB.
    Rss,
    /// The number of open file descriptors.
    Fds,
}

impl ProcessQuantity {
    /// The unit of the signal, empty for a pure number.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Rss => "MiB",
            Self::Cpu | Self::Fds => "",
        }
    }
}

/// A monitor.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MonitorConfig {
    /// The name.
    pub name: String,
    /// The formula.
    pub formula: String,
    /// What a violation means.
    pub severity: FindingSeverity,
    /// Its position in the suite, or of its limit in a file of limits.
    pub location: Location,
    /// The file, line and column of its limit, for messages.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<String>,
    /// The names of the tests that it judges; `None`: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tests: Option<Vec<String>>,
}

impl MonitorConfig {
    /// Whether it judges the test with this name.
    #[must_use]
    pub fn judges(&self, test: &str) -> bool {
        self.tests.as_ref().is_none_or(|tests| tests.iter().any(|name| name == test))
    }
}
