//! A running test and the times of its faults.

use rtf_model::protocol::TestAttempt;
use rtf_model::{FaultConfig, FaultTime, TestId};
use rtf_statistics::RandomStream;

use crate::settings::Settings;

#[derive(Debug)]
pub(crate) struct RunningTest {
    pub id: TestId,
    pub name: String,
    /// The time of its start on the suite's clock.
    pub start: f64,
    /// The faults that have not been injected yet: the time since the start, and the index.
    pub pending: Vec<(f64, usize)>,
    /// How long each fault lasts.
    pub durations: Vec<Option<f64>>,
}

impl RunningTest {
    pub fn new(test: &TestAttempt, start: f64, settings: &Settings) -> Self {
        let all = settings.faults.iter().map(|fault| &fault.config);
        let own = all.clone().enumerate().filter(|(_, fault)| fault.belongs_to(&test.name));
        let pending = own.filter_map(|(index, it)| Some((draw(it, test, it.at?, 0), index)));
        let pending = pending.collect();
        let duration = |fault: &FaultConfig| Some(draw(fault, test, fault.duration?, 1));
        let durations = all.map(duration).collect();
        Self { id: test.id, name: test.name.clone(), start, pending, durations }
    }

    /// When the next of its faults is due, on the suite's clock.
    pub fn next(&self) -> Option<f64> {
        let times = self.pending.iter().map(|(at, _)| self.start + at);
        times.min_by(f64::total_cmp)
    }

    /// Removes and returns the faults that are due.
    pub fn take_due(&mut self, now: f64) -> Vec<usize> {
        let start = self.start;
        self.pending.extract_if(.., |(at, _)| start + *at <= now).map(|(_, fault)| fault).collect()
    }
}

/// A time of a fault, in seconds.
fn draw(fault: &FaultConfig, test: &TestAttempt, time: FaultTime, index: u64) -> f64 {
    let [from, to] = [time.from_us, time.to_us].map(|micros| micros as f64 / 1e6);
    if from >= to {
        return from;
    }
    let TestAttempt { name, repetition, attempt, .. } = test;
    let name = format!("{}/{name}/{repetition}/{attempt}", fault.name);
    let unit = RandomStream::new(u64::from(fault.seed), "fault", &name).unit(index);
    from + unit * (to - from)
}

#[cfg(test)]
mod tests {
    use rtf_model::{FaultAction, FaultAmount, FaultsConfig, Location};

    use super::*;
    use crate::settings::{EffectSettings, FaultSettings};

    fn settings(seed: u32) -> Settings {
        let amount = FaultAmount::Size(1);
        let config = FaultConfig {
            name: "busy".to_owned(),
            action: FaultAction::Memory(amount),
            at: Some(FaultTime { from_us: 1_000_000, to_us: 3_000_000 }),
            duration: Some(FaultTime { from_us: 500_000, to_us: 500_000 }),
            seed,
            location: Location { file: "a.xml".to_owned(), line: 1 },
            tests: Some(vec!["Grasp".to_owned()]),
        };
        let FaultsConfig { has_clock, .. } = FaultsConfig::default();
        let effect = EffectSettings::Memory(amount);
        Settings { faults: vec![FaultSettings { config, effect }], has_clock }
    }

    fn test(name: &str, repetition: u32) -> TestAttempt {
        TestAttempt { id: TestId(0), name: name.to_owned(), repetition, attempt: 1 }
    }

    #[test]
    fn random_times_are_in_their_range_and_reproducible() {
        let time = |seed, repetition| {
            let run = RunningTest::new(&test("Grasp", repetition), 10.0, &settings(seed));
            run.next().expect("a fault")
        };
        let times: Vec<f64> = (1..=50).map(|repetition| time(7, repetition)).collect();
        assert!(times.iter().all(|time| (11.0..13.0).contains(time)), "{times:?}");
        let early = times.iter().filter(|time| **time < 12.0).count();
        assert!((10..=40).contains(&early), "{times:?}");
        assert_eq!(times, (1..=50).map(|repetition| time(7, repetition)).collect::<Vec<_>>());
        assert_ne!(times, (1..=50).map(|repetition| time(8, repetition)).collect::<Vec<_>>());
    }

    #[test]
    fn a_fault_belongs_to_its_tests_and_is_due_once() {
        assert_eq!(RunningTest::new(&test("Look", 1), 10.0, &settings(0)).next(), None);
        let mut run = RunningTest::new(&test("Grasp", 1), 10.0, &settings(0));
        let due = run.next().expect("a fault");
        assert!(run.take_due(due - 0.001).is_empty());
        assert_eq!(run.take_due(due), [0]);
        assert!(run.take_due(due + 1.0).is_empty());
        assert_eq!(run.durations, [Some(0.5)]);
    }
}
