//! When a violation is reported, and what it contains.

use rtf_monitor::{Formula, Monitor, SignalValue, Verdict};

use crate::run;

const RESPONSE: &str = "always(reached -> eventually[0,0.5s](abs(q - goal) < 0.02))";

/// `reached` rises at 1 s; `q` is at 0.5 and never comes closer to the goal 1 than 0.25.
fn response() -> Vec<(&'static str, f64, f64)> {
    let mut samples = vec![("goal", 0.0, 1.0), ("reached", 0.0, 0.0)];
    for step in 0..40 {
        let time = f64::from(step) * 0.0625;
        samples.push(("q", time, if time < 1.25 { 0.5 } else { 0.75 }));
        samples.push(("goal", time + 0.001, 1.0));
        samples.push(("reached", time + 0.002, f64::from(u8::from(time >= 1.0))));
    }
    samples
}

#[test]
fn a_deadline_that_passed_is_reported_with_the_first_sample_after_it() {
    let samples = response();
    let (violation, outcome) = run(RESPONSE, &samples, 2.5);
    let violation = violation.unwrap();
    // `reached` is 1 from 1.002 s on. The goal is known up to the sample that follows 1.502 s.
    assert_eq!(violation.time, 1.5635);
    assert_eq!(&RESPONSE[violation.responsible.clone()], "abs(q - goal) < 0.02");
    assert!((violation.robustness + 0.23).abs() < 1e-9, "{violation:?}");
    assert_eq!(violation.interval.0, 1.002);
    let value = |signal: usize| violation.values.iter().find(|value| value.signal == signal);
    assert_eq!(value(1).map(|value| value.value), Some(0.75));
    assert_eq!(value(2).map(|value| value.value), Some(1.0));
    assert_eq!(outcome.verdict, Verdict::Violated);
    assert_eq!(outcome.violation, Some(violation));
}

#[test]
fn a_limit_is_reported_with_the_sample_that_exceeds_it() {
    let samples = [("x", 0.0, 0.0), ("x", 1.0, 1.0), ("x", 2.0, 5.0), ("x", 3.0, 9.0)];
    let (violation, outcome) = run("always(x < 3)", &samples, 3.0);
    let violation = violation.unwrap();
    assert_eq!((violation.time, violation.robustness), (2.0, -2.0));
    assert_eq!(violation.interval, (1.5, 2.0));
    assert_eq!(violation.values, [SignalValue { signal: 0, time: 2.0, value: 5.0 }]);
    assert_eq!(violation.responsible, 7..12);
    // Later samples are worse.
    assert_eq!(outcome.robustness, Some(-6.0));
}

#[test]
fn a_first_sample_may_violate() {
    let (violation, _) = run("always(x < 3)", &[("x", 1.0, 4.0)], 1.0);
    assert_eq!(violation.unwrap().time, 1.0);
    let (violation, _) = run("ready", &[("ready", 1.0, 0.0)], 1.0);
    assert_eq!(violation.unwrap().interval, (1.0, 1.0));
}

#[test]
fn the_slower_signal_does_not_delay_a_comparison_without_it() {
    let samples = [("x", 0.0, 0.0), ("y", 0.0, 0.0), ("x", 1.0, 9.0)];
    assert_eq!(run("always(x < 5 and y < 5)", &samples, 1.0).0.unwrap().time, 1.0);
    assert_eq!(run("always(x + y < 5)", &samples, 1.0).0, None);
}

#[test]
fn a_stated_time_without_samples_replaces_them() {
    let formula = Formula::parse("always(x + y < 5)").unwrap();
    let mut monitor = Monitor::new(&formula).unwrap();
    assert_eq!(monitor.advance(0, 1.0), None);
    for (signal, time, value) in [(0, 0.0, 0.0), (1, 0.0, 0.0), (0, 1.0, 9.0)] {
        assert_eq!(monitor.sample(signal, time, value), None);
    }
    // The sum is 4.5 at 0.5 s, and exceeds 5 before 0.75 s.
    assert_eq!(monitor.advance(1, 0.5), None);
    let violation = monitor.advance(1, 0.75).unwrap();
    assert!((violation.robustness + 1.75).abs() < 1e-9, "{violation:?}");
    assert!((violation.interval.0 - 5.0 / 9.0).abs() < 1e-9, "{violation:?}");
    // A sample at the stated time may follow.
    assert_eq!(monitor.sample(1, 0.75, -9.0), None);
    assert_eq!(monitor.finish(1.0).ignored, 0);
}

#[test]
fn what_a_later_sample_may_change_is_not_reported() {
    let samples = [("x", 0.0, 0.0), ("x", 1.0, 0.0)];
    for text in ["eventually(x > 1)", "always(eventually(x > 1))", "x < 1 until x > 1"] {
        let (violation, outcome) = run(text, &samples, 1.0);
        assert_eq!((violation, outcome.verdict), (None, Verdict::Violated), "{text}");
        let violation = outcome.violation.unwrap();
        assert_eq!(violation.time, 1.0, "{text}");
        assert_eq!(&text[violation.responsible], "x > 1", "{text}");
    }
}

#[test]
fn memory_is_bounded() {
    for text in [
        "always(x < 5 -> eventually[0,0.5s](y < 5))",
        "always(x < 5 since y < 3 or historically[0,1s](x > -5))",
        "eventually(always[0,0.2s](x > 5))",
        "always[0,1s](x < 5)",
    ] {
        let formula = Formula::parse(text).unwrap();
        let mut monitor = Monitor::new(&formula).unwrap();
        assert!(monitor.is_bounded());
        let mut most = 0;
        for step in 0..30_000_u32 {
            let time = f64::from(step) / 1000.0;
            for signal in 0..formula.signals().len() {
                monitor.sample(signal, time, (time * 7.0).sin());
            }
            most = most.max(monitor.kept_samples());
        }
        assert!(most < 20_000, "{text}: {most} of 60000");
        assert_ne!(monitor.finish(30.0).verdict, Verdict::NotEnoughData);
    }
}

#[test]
fn a_silent_signal_does_not_fill_the_memory() {
    let formula = Formula::parse("always(x + y < 5)").unwrap();
    let mut monitor = Monitor::new(&formula).unwrap();
    for step in 0..200_000 {
        monitor.sample(0, f64::from(step), 0.0);
    }
    assert!(monitor.kept_samples() < 100_000);
    monitor.sample(1, 0.0, 0.0);
    for step in 200_000..500_000 {
        monitor.sample(0, f64::from(step), f64::from(step % 2));
    }
    assert!(monitor.kept_samples() < 250_000, "{}", monitor.kept_samples());
}

#[test]
fn formulas_that_keep_all_samples() {
    for text in ["always(p -> eventually q)", "p until q", "once(always p)"] {
        let monitor = Monitor::new(&Formula::parse(text).unwrap()).unwrap();
        assert!(!monitor.is_bounded(), "{text}");
    }
}

#[test]
fn the_largest_formulas_are_judged() {
    let deep = |prefix: &str| format!("{}x < 9", prefix.repeat(60));
    let long = |separator: &str| vec!["x < 9"; 240].join(separator);
    for text in [
        deep("not "),
        deep("always[0,1ms] "),
        "not once[0,1ms] ".repeat(30) + "x < 9",
        long(" and "),
        format!("{} < 9000", vec!["x"; 490].join(" + ")),
        format!("{} < 9", vec!["abs("; 60].join("") + "x" + &")".repeat(60)),
    ] {
        let formula = Formula::parse(&text).unwrap();
        let mut monitor = Monitor::new(&formula).unwrap();
        for step in 0..300_u32 {
            assert_eq!(monitor.sample(0, f64::from(step) / 1000.0, f64::from(step % 5)), None);
        }
        assert_eq!(monitor.finish(0.3).verdict, Verdict::Holds, "{text}");
    }
}
