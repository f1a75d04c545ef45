//! Random formulas and traces: the monitor agrees with the reference, and the algebra holds.

use crate::atom::Kind;
use crate::component::Component;
use crate::evaluate::Mode;
use crate::{Formula, Monitor, Outcome, Verdict, judge};

const TOLERANCE: f64 = 1e-9;

/// Pseudo-random numbers (Knuth's MMIX generator).
struct Random(u64);

impl Random {
    fn next(&mut self, below: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }

    fn pick<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[usize::try_from(self.next(choices.len() as u64)).unwrap()]
    }

    fn real(&mut self) -> f64 {
        self.next(1 << 20) as f64 / f64::from(1 << 20)
    }

    fn number(&mut self, depth: u32) -> String {
        match self.next(if depth == 0 { 3 } else { 8 }) {
            0 | 1 => self.pick(&["x", "y", "z"]).to_owned(),
            2 => format!("hold({})", self.pick(&["x", "y", "z"])),
            3 => format!("abs({})", self.number(depth - 1)),
            4 => format!("rate({})", self.pick(&["x", "y", "x - y", "abs(z)"])),
            5 => format!("max({}, {})", self.number(depth - 1), self.number(depth - 1)),
            6 => format!("({} * {})", self.number(depth - 1), self.number(0)),
            _ => format!("({} - {})", self.number(depth - 1), self.number(depth - 1)),
        }
    }

    fn comparison(&mut self) -> String {
        match self.next(10) {
            0 => self.pick(&["x", "y", "z"]).to_owned(),
            1 => format!("hold(x) {} {}", self.pick(&["==", "!="]), self.next(3)),
            _ => {
                let constant = (self.real() * 4.0) - 2.0;
                format!("{} {} {constant:.2}", self.number(2), self.pick(&["<", "<=", ">", ">="]))
            }
        }
    }

    fn interval(&mut self) -> String {
        let from = self.next(3) * self.next(40);
        match self.next(8) {
            0 => String::new(),
            1 => format!("[{from}ms,inf]"),
            _ => format!("[{from}ms,{}ms]", from + self.next(60)),
        }
    }

    fn formula(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.comparison();
        }
        let depth = depth - 1;
        match self.next(20) {
            0 => format!("not ({})", self.formula(depth)),
            1..=6 => {
                let operator = self.pick(&["and", "or", "->"]);
                format!("({} {operator} {})", self.formula(depth), self.formula(depth))
            }
            7 => format!("{}({})", self.pick(&["rise", "fall"]), self.comparison()),
            8..=15 => {
                let operator = self.pick(&["always", "eventually", "historically", "once"]);
                format!("{operator}{} ({})", self.interval(), self.formula(depth))
            }
            _ => {
                let operator = self.pick(&["until", "since"]);
                let (left, right) = (self.formula(depth), self.formula(depth));
                format!("(({left}) {operator}{} ({right}))", self.interval())
            }
        }
    }

    /// Samples of one signal: about `count`, at irregular times.
    fn trace(&mut self, count: u64, period: f64) -> Vec<(f64, f64)> {
        let mut time = self.real() * period;
        let mut value = 0.0;
        let steps = self.next(2) == 0;
        (0..=self.next(count + 1))
            .map(|_| {
                time += period * (0.2 + self.real());
                value = if steps { self.next(3) as f64 } else { value + self.real() - 0.5 };
                let is_number = self.next(200) != 0;
                (time, if is_number { value } else { f64::NAN })
            })
            .collect()
    }

    /// Traces of the signals of a formula.
    fn traces(&mut self, formula: &Formula, count: u64) -> Vec<Vec<(f64, f64)>> {
        let periods = [0.002, 0.005, 0.02];
        let signals = formula.signals().len();
        (0..signals)
            .map(|_| {
                let period = periods[usize::try_from(self.next(3)).unwrap()];
                self.trace(count, period)
            })
            .collect()
    }
}

fn in_order(traces: &[Vec<(f64, f64)>]) -> Vec<(f64, usize, f64)> {
    let samples = traces.iter().enumerate().flat_map(|(signal, samples)| {
        samples.iter().map(move |(time, value)| (*time, signal, *value))
    });
    let mut samples: Vec<_> = samples.collect();
    samples.sort_by(|left, right| left.0.total_cmp(&right.0));
    samples
}

fn is_close(left: Option<f64>, right: Option<f64>) -> bool {
    match (left, right) {
        (Some(left), Some(right)) => {
            left == right || (left - right).abs() <= TOLERANCE * left.abs().max(1.0)
        }
        (left, right) => left == right,
    }
}

/// The outcomes are equal, apart from rounding.
fn assert_equal(text: &str, left: &Outcome, right: &Outcome) {
    let is_near_zero = left.robustness.is_some_and(|robustness| robustness.abs() < TOLERANCE);
    assert!(is_near_zero || left.verdict == right.verdict, "{text}: {left:?} {right:?}");
    assert!(is_close(left.robustness, right.robustness), "{text}: {left:?} {right:?}");
}

/// The first sample after which the formula cannot hold, found by judging all samples after each.
fn first_violation(formula: &Formula, samples: &[(f64, usize, f64)]) -> Option<f64> {
    let mut whole = Component::whole(&formula.condition);
    let mut early: Vec<Vec<(f64, f64)>> = vec![Vec::new(); formula.signals().len()];
    let mut start = None;
    let mut now = f64::NEG_INFINITY;
    for (time, signal, value) in samples {
        now = now.max(*time);
        if start.is_some() {
            whole.sample(*signal, (*time, *value));
        } else {
            early[*signal].push((*time, *value));
            if early.iter().any(Vec::is_empty) {
                continue;
            }
            let first = early.iter().map(|samples| samples[0].0).fold(f64::NEG_INFINITY, f64::max);
            start = Some(first);
            let last =
                |signal: usize| *early[signal].iter().rfind(|sample| sample.0 <= first).unwrap();
            whole.begin(first, &last);
            for (signal, samples) in early.iter().enumerate() {
                for sample in samples.iter().filter(|sample| sample.0 > first) {
                    whole.sample(signal, *sample);
                }
            }
        }
        if whole.value(Kind::Truth, Mode::Online { now }, now) < 0.0 {
            return Some(now);
        }
    }
    None
}

/// Judges a formula with a monitor.
fn monitor(formula: &Formula, samples: &[(f64, usize, f64)], end: f64) -> (Outcome, Option<f64>) {
    let mut monitor = Monitor::new(formula).unwrap();
    let mut violated = None;
    for (time, signal, value) in samples {
        if let Some(violation) = monitor.sample(*signal, *time, *value) {
            assert!(violated.is_none(), "a violation is reported once");
            assert!(violation.robustness <= 0.0, "{violation:?}");
            assert!(violation.interval.0 <= violation.interval.1, "{violation:?}");
            violated = Some(violation.time);
        }
    }
    (monitor.finish(end), violated)
}

#[test]
fn the_monitor_agrees_with_the_reference() {
    let mut random = Random(1);
    let mut verdicts = [0; 3];
    for index in 0..10_000 {
        let text = random.formula(1 + index % 3);
        let formula = Formula::parse(&text).unwrap();
        // Long traces, so that parts of them are judged and forgotten.
        let count = if index % 10 == 0 { 400 } else { 30 };
        let traces = random.traces(&formula, count);
        let samples = in_order(&traces);
        let end = samples.last().map_or(0.0, |last| last.0) + random.real() * 0.02;
        let reference = judge(&formula, &traces, end).unwrap();
        let (outcome, violated) = monitor(&formula, &samples, end);
        assert_equal(&text, &reference, &outcome);
        verdicts[outcome.verdict as usize] += 1;
        assert!(outcome.verdict != Verdict::Violated || outcome.violation.is_some());
        if violated.is_some() {
            assert_eq!(
                outcome.verdict,
                Verdict::Violated,
                "{text} {violated:?} {end} {samples:?} {outcome:?}"
            );
        }
    }
    assert!(verdicts.iter().all(|count| *count > 300), "{verdicts:?}");
}

#[test]
fn a_violation_is_reported_with_the_first_sample_that_determines_it() {
    let mut random = Random(2);
    let mut early = 0;
    for index in 0..2000 {
        let text = random.formula(1 + index % 3);
        let formula = Formula::parse(&text).unwrap();
        let traces = random.traces(&formula, if index % 20 == 0 { 150 } else { 20 });
        let samples = in_order(&traces);
        let (_, violated) = monitor(&formula, &samples, 0.0);
        assert_eq!(violated, first_violation(&formula, &samples), "{text} {samples:?}");
        early += usize::from(violated.is_some_and(|time| time > samples[samples.len() / 4].0));
    }
    assert!(early > 200, "{early} violations after the first quarter");
}

#[test]
fn any_sample_is_judged() {
    const VALUES: [f64; 12] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::MAX,
        f64::MIN,
        f64::MIN_POSITIVE,
        5e-324,
        1e17,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    let mut random = Random(3);
    let mut value = move || VALUES[usize::try_from(random.next(VALUES.len() as u64)).unwrap()];
    let mut random = Random(4);
    for index in 0..3000 {
        let text = random.formula(1 + index % 4);
        let formula = Formula::parse(&text).unwrap();
        let mut monitor = Monitor::new(&formula).unwrap();
        let mut time = -0.1;
        for _ in 0..60 {
            time += random.real() * 0.01;
            let time = if random.next(10) == 0 { value() } else { time };
            let signal = usize::try_from(random.next(4)).unwrap();
            monitor.sample(signal, time, if random.next(2) == 0 { value() } else { time * 9.0 });
            if random.next(20) == 0 {
                monitor.advance(signal, value());
            }
        }
        let outcome = monitor.finish(value());
        assert!(!outcome.robustness.is_some_and(f64::is_nan), "{text}: {outcome:?}");
    }
}
