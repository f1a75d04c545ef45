//! The signals and monitors of the suite, as the runner passes them.

use std::sync::Arc;
use std::time::Duration;

use rtf_host::fixture_owner;
use rtf_model::protocol::{MonitorDeclaration, Plugin};
use rtf_model::{
    FindingSeverity, Location, MonitorConfig, ProcessQuantity, SignalConfig, SignalSource,
    SignalTime, SignalsConfig, TestQuantity,
};
use rtf_monitor::Formula;

/// A program that writes samples.
#[derive(Debug)]
pub(crate) struct ProgramSettings {
    /// The program and its arguments.
    pub words: Vec<String>,
    /// The index of its first signal; the others follow.
    pub first_signal: usize,
    /// The number of its signals.
    pub count: usize,
    /// The clock of its times.
    pub time: SignalTime,
    /// Whether set-up waits for its first line.
    pub wait: bool,
    /// What helps if its times are those of another clock.
    pub other_clock: String,
}

/// A quantity of a fixture's processes.
#[derive(Debug)]
pub(crate) struct ProcessSettings {
    /// The index of the signal.
    pub signal: usize,
    /// The value of `RTF_OWNER` of the fixture's processes.
    pub owner: String,
    pub quantity: ProcessQuantity,
    pub every: Duration,
}

#[derive(Debug)]
pub(crate) struct RecordingSettings {
    /// The program that reads it, and its arguments.
    pub words: Vec<String>,
    /// The index of its first signal; the others follow.
    pub first_signal: usize,
    /// The number of its signals.
    pub count: usize,
}

/// A monitor with its formula.
#[derive(Debug)]
pub(crate) struct MonitorSettings {
    pub name: String,
    pub severity: FindingSeverity,
    /// Its position in the suite or in the plug-in.
    pub location: Option<Location>,
    /// The file, line and column of its limit, for messages.
    pub origin: Option<String>,
    /// The names of the tests that it judges; `None`: all.
    pub tests: Option<Vec<String>>,
    /// The formula, with the units of the signals.
    pub formula: Formula,
    /// The indices of the formula's signals.
    pub signals: Vec<usize>,
}

/// Everything that the suite declares.
#[derive(Debug, Default)]
pub(crate) struct Settings {
    pub signals: Vec<SignalConfig>,
    pub programs: Vec<ProgramSettings>,
    pub processes: Vec<ProcessSettings>,
    pub recordings: Vec<RecordingSettings>,
    /// The signals that tests report themselves.
    pub of_tests: Vec<(usize, TestQuantity)>,
    pub monitors: Vec<Arc<MonitorSettings>>,
    pub has_clock: bool,
}

impl Settings {
    /// Reads the parameter string and the arguments of the fixture.
    pub fn read(plugin: &Plugin) -> Result<Self, String> {
        let config: SignalsConfig = serde_json::from_str(&plugin.param)
            .map_err(|error| format!("the fixture's parameters are invalid: {error}"))?;
        let mut settings = Self { has_clock: config.has_clock, ..Self::default() };
        let mut args = plugin.args.iter();
        for source in config.sources {
            let first_signal = settings.signals.len();
            match source {
                SignalSource::Program(program) => {
                    settings.programs.push(ProgramSettings {
                        words: args.by_ref().take(program.words).cloned().collect(),
                        first_signal,
                        count: program.signals.len(),
                        time: program.time,
                        wait: program.wait,
                        other_clock: program.other_clock,
                    });
                    settings.signals.extend(program.signals);
                }
                SignalSource::Fixture(measured) => {
                    settings.processes.push(ProcessSettings {
                        signal: first_signal,
                        owner: fixture_owner(&plugin.name, &measured.fixture)?,
                        quantity: measured.quantity,
                        every: Duration::from_millis(measured.every_ms),
                    });
                    settings.signals.push(measured.signal);
                }
                SignalSource::Recording(recording) => {
                    settings.recordings.push(RecordingSettings {
                        words: args.by_ref().take(recording.words).cloned().collect(),
                        first_signal,
                        count: recording.signals.len(),
                    });
                    settings.signals.extend(recording.signals);
                }
                SignalSource::Test(reported) => {
                    settings.of_tests.push((first_signal, reported.quantity));
                    settings.signals.push(reported.signal);
                }
            }
        }
        for monitor in config.monitors {
            let MonitorConfig { name, formula, severity, location, origin, tests } = monitor;
            let location = Some(location);
            let declared = MonitorDeclaration { name, formula, severity, location };
            let monitor = MonitorSettings { origin, tests, ..settings.monitor(declared)? };
            settings.monitors.push(Arc::new(monitor));
        }
        Ok(settings)
    }

    /// The number of the source of what a test reports; it follows the recordings.
    pub fn test_source(&self) -> usize {
        self.programs.len() + self.processes.len() + self.recordings.len()
    }

    /// A monitor of all tests.
    ///
    /// # Errors
    /// Why its formula is invalid.
    pub fn monitor(&self, declared: MonitorDeclaration) -> Result<MonitorSettings, String> {
        let MonitorDeclaration { name, formula, severity, location } = declared;
        let invalid = |why: String| format!("the monitor `{name}` is invalid: {why}");
        let formula = Formula::parse(&formula).map_err(|error| invalid(error.message))?;
        let unit_of = |name: &str| Some(self.signals[self.index_of(name)?].unit.clone());
        let formula = formula.check_units(&unit_of).map_err(|errors| {
            let messages: Vec<_> = errors.into_iter().map(|error| error.message).collect();
            invalid(messages.join("; "))
        })?;
        let signals = formula.signals().iter().map(|signal| {
            let index = self.index_of(&signal.name);
            index.ok_or_else(|| invalid(format!("there is no signal `{}`", signal.name)))
        });
        let signals = signals.collect::<Result<_, _>>()?;
        let (origin, tests) = (None, None);
        Ok(MonitorSettings { name, severity, location, origin, tests, formula, signals })
    }

    fn index_of(&self, signal: &str) -> Option<usize> {
        self.signals.iter().position(|known| known.name == signal)
    }
}

impl MonitorSettings {
    /// Whether it judges the test with this name.
    pub fn judges(&self, test: &str) -> bool {
        self.tests.as_ref().is_none_or(|tests| tests.iter().any(|name| name == test))
    }
}
