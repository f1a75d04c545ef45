//! The signals and monitors of the suite, as the runner passes them.

use std::time::Duration;

use rtf_host::fixture_owner;
use rtf_model::protocol::Plugin;
use rtf_model::{
    MonitorConfig, ProcessQuantity, SignalConfig, SignalSource, SignalTime, SignalsConfig,
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
}

/// A quantity of a fixture's processes.
#[derive(Debug)]
pub(crate) struct ProcessSettings {
    /// The index of the signal.
    pub signal: usize,
    /// The value of `RTF_OWNER` of the fixture's processes.
    pub owner: String,
    /// The quantity.
    pub quantity: ProcessQuantity,
    /// The interval.
    pub every: Duration,
}

/// A monitor with its formula.
#[derive(Debug)]
pub(crate) struct MonitorSettings {
    /// As the suite declares it.
    pub config: MonitorConfig,
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
    pub monitors: Vec<MonitorSettings>,
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
            }
        }
        for monitor in config.monitors {
            let monitor = settings.monitor(monitor)?;
            settings.monitors.push(monitor);
        }
        Ok(settings)
    }

    fn monitor(&self, config: MonitorConfig) -> Result<MonitorSettings, String> {
        let invalid = |why: String| format!("the monitor `{}` is invalid: {why}", config.name);
        let formula = Formula::parse(&config.formula).map_err(|error| invalid(error.message))?;
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
        Ok(MonitorSettings { config, formula, signals })
    }

    fn index_of(&self, signal: &str) -> Option<usize> {
        self.signals.iter().position(|known| known.name == signal)
    }
}
