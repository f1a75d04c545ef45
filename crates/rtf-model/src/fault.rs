//! Injected faults: as the planner passes them to `rtf-host-faults`, and as a record keeps them.

use serde::{Deserialize, Serialize};

use crate::{Location, Micros, TestId};

/// The faults of a suite.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultsConfig {
    /// The faults.
    pub faults: Vec<FaultConfig>,
    /// Whether the suite has a simulated clock.
    #[serde(default)]
    pub has_clock: bool,
}

/// A fault.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultConfig {
    /// The name.
    pub name: String,
    /// What is done.
    pub action: FaultAction,
    /// When it is injected, since the start of the test; `None`: when a test does it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<FaultTime>,
    /// How long it lasts; `None`: until the end of the test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration: Option<FaultTime>,
    /// The seed for random times.
    #[serde(default)]
    pub seed: u32,
    /// Its position in the suite.
    pub location: Location,
    /// The names of the tests that it belongs to; `None`: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tests: Option<Vec<String>>,
}

impl FaultConfig {
    /// Whether it belongs to the test with this name.
    #[must_use]
    pub fn belongs_to(&self, test: &str) -> bool {
        self.tests.as_ref().is_none_or(|tests| tests.iter().any(|name| name == test))
    }
}

/// A time, or a range from which one is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultTime {
    /// The earliest time, in microseconds.
    pub from_us: u64,
    /// The latest time, in microseconds; not before the earliest.
    pub to_us: u64,
}

/// What a fault does.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultAction {
    /// Kills processes.
    Kill(FaultTarget),
    /// Stops processes.
    Stop(FaultTarget),
    /// Stops processes for a part of the time.
    Slow {
        /// The processes.
        target: FaultTarget,
        /// The share of the time in which they may run, from 1 to 99.
        percent: u32,
    },
    /// Allocates memory.
    Memory(FaultAmount),
    /// Allocates space of a file system. The next argument of the plug-in is the directory.
    Disk(FaultAmount),
    /// Impairs the packets of the suite's private network.
    Network(NetworkFault),
    /// Changes the messages that a proxy passes on.
    Values {
        /// The name of the fixture, a proxy.
        fixture: String,
        /// What happens to the messages.
        fault: ValuesFault,
    },
}

impl FaultAction {
    /// Its kind.
    #[must_use]
    pub fn kind(&self) -> FaultKind {
        match self {
            Self::Kill(_) => FaultKind::Kill,
            Self::Stop(_) => FaultKind::Stop,
            Self::Slow { .. } => FaultKind::Slow,
            Self::Memory(_) => FaultKind::Memory,
            Self::Disk(_) => FaultKind::Disk,
            Self::Network(_) => FaultKind::Network,
            Self::Values { .. } => FaultKind::Values,
        }
    }
}

/// Processes of a fixture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultTarget {
    /// The name of the fixture in its suite.
    pub fixture: String,
    /// Only the processes with this name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub process: Option<String>,
}

/// How much is filled, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultAmount {
    /// This much.
    Size(u64),
    /// All but this much.
    Leave(u64),
}

/// What happens to the packets of a network. Probabilities are in parts per million.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct NetworkFault {
    /// Whether only the packets from and to a port are affected. The next argument of the
    /// plug-in is the port.
    #[serde(default)]
    pub has_port: bool,
    /// The delay in microseconds.
    #[serde(default)]
    pub delay_us: u64,
    /// The most by which the delay differs.
    #[serde(default)]
    pub jitter_us: u64,
    /// How many packets are lost.
    #[serde(default)]
    pub loss_ppm: u32,
    /// How many packets arrive twice.
    #[serde(default)]
    pub duplicate_ppm: u32,
    /// How many packets have no delay, and overtake others.
    #[serde(default)]
    pub reorder_ppm: u32,
    /// The bandwidth in bits per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_bits: Option<u64>,
    /// TCP and UDP are refused, as if no process had the port.
    #[serde(default)]
    pub refuses: bool,
}

impl std::fmt::Display for NetworkFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let times = [("delay", self.delay_us), ("jitter", self.jitter_us)];
        let times = times.into_iter().filter(|(_, us)| *us > 0);
        let times = times.map(|(name, us)| format!("{name} {} ms", us as f64 / 1e3));
        let shares = [
            ("loss", self.loss_ppm),
            ("duplicate", self.duplicate_ppm),
            ("reorder", self.reorder_ppm),
        ];
        let shares = shares.into_iter().filter(|(_, ppm)| *ppm > 0);
        let shares = shares.map(|(name, ppm)| format!("{name} {} %", f64::from(ppm) / 1e4));
        let rate = self.rate_bits.map(|bits| format!("rate {} kbit/s", bits as f64 / 1e3));
        let refused = self.refuses.then(|| "refused".to_owned());
        let all: Vec<String> = times.chain(shares).chain(rate).chain(refused).collect();
        f.write_str(&all.join(", "))
    }
}

/// What happens to the messages of a proxy, and its request to the proxy. Numbers are texts,
/// because JSON has none that is not finite.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ValuesFault {
    /// The numbers that are changed; `None`: none.
    pub field: Option<String>,
    /// What they are.
    pub set: Option<String>,
    /// By what they are multiplied afterwards.
    pub scale: Option<String>,
    /// What is added afterwards.
    pub offset: Option<String>,
    /// The standard deviation of noise, which is added at the end.
    pub noise: Option<String>,
    /// They stay what they were before the fault.
    pub freezes: bool,
    /// How many messages are lost, in parts per million.
    pub loss_ppm: u32,
    /// How much later messages come, in microseconds.
    pub delay_us: u64,
    /// The seed for noise and loss.
    pub seed: u32,
}

impl std::fmt::Display for ValuesFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers = [
            ("set", &self.set),
            ("scale", &self.scale),
            ("offset", &self.offset),
            ("noise", &self.noise),
        ];
        let numbers = numbers
            .into_iter()
            .filter_map(|(name, number)| number.as_ref().map(|number| format!("{name} {number}")));
        let frozen = self.freezes.then(|| "frozen".to_owned());
        let loss =
            (self.loss_ppm > 0).then(|| format!("loss {} %", f64::from(self.loss_ppm) / 1e4));
        let delay = (self.delay_us > 0).then(|| format!("delay {} ms", self.delay_us as f64 / 1e3));
        let all: Vec<String> = numbers.chain(frozen).chain(loss).chain(delay).collect();
        f.write_str(&all.join(", "))
    }
}

/// The kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// Processes are killed. It lasts for a moment, and is not removed.
    Kill,
    /// Processes are stopped.
    Stop,
    /// Processes may run for a part of the time.
    Slow,
    /// Memory is allocated.
    Memory,
    /// A file system is filled.
    Disk,
    /// Packets of the suite's private network are delayed, lost, doubled, reordered or refused.
    Network,
    /// Messages that pass a proxy have other numbers, are lost or late.
    Values,
}

impl FaultKind {
    /// Every kind, with its word in suites.
    pub const ALL: [(&'static str, Self); 7] = [
        ("kill", Self::Kill),
        ("stop", Self::Stop),
        ("slow", Self::Slow),
        ("memory", Self::Memory),
        ("disk", Self::Disk),
        ("network", Self::Network),
        ("values", Self::Values),
    ];

    /// Its word.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        Self::ALL.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }

    /// Whether it is removed after a time.
    #[must_use]
    pub fn lasts(self) -> bool {
        self != Self::Kill
    }
}

/// A fault that was injected while a test runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FaultInjected {
    /// The test.
    pub test: TestId,
    /// The name of the fault.
    pub name: String,
    /// Its kind.
    pub kind: FaultKind,
    /// What was done, as text: `stopped camera.py (process 4711)`.
    pub effect: String,
}

/// A fault of an attempt of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultRecord {
    /// The fault.
    pub fault: FaultInjected,
    /// When it was injected.
    pub injected: Micros,
    /// When it was removed. A fault that lasts and was not removed ended with the processes of
    /// the run.
    pub removed: Option<Micros>,
}
