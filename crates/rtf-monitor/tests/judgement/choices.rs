//! The section "Choices" of `spec/monitors.md`, one test for each.

use rtf_monitor::{Formula, Monitor, Verdict, judge};

use crate::{outcome, run};

const HOLDS: Verdict = Verdict::Holds;
const VIOLATED: Verdict = Verdict::Violated;
const NOT_ENOUGH_DATA: Verdict = Verdict::NotEnoughData;

#[test]
fn signals_are_linear_between_samples() {
    let samples = [("x", 0.0, 0.0), ("x", 1.0, 4.0), ("x", 2.0, 0.0)];
    assert_eq!(outcome("always(x < 5)", &samples, 2.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("always[0,0.25](x < 5)", &samples, 2.0), (HOLDS, Some(4.0)));
    assert_eq!(outcome("eventually[1.5,1.5](x > 1)", &samples, 2.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("eventually[1.5,1.5](hold(x) > 1)", &samples, 2.0), (HOLDS, Some(3.0)));
    assert_eq!(outcome("always(rate(x) < 5)", &samples, 2.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("always(abs(x - 2) > 0)", &samples, 2.0), (VIOLATED, Some(0.0)));
}

#[test]
fn comparisons_are_strict_or_not_at_robustness_0() {
    let samples = [("x", 0.0, 3.0), ("x", 1.0, 3.0)];
    for (text, verdict) in [
        ("always(x < 3)", VIOLATED),
        ("always(x <= 3)", HOLDS),
        ("always(x >= 3)", HOLDS),
        ("always(not x < 3)", HOLDS),
        ("always(x == 3)", HOLDS),
        ("always(x != 3)", VIOLATED),
        ("eventually(x > 3)", VIOLATED),
    ] {
        assert_eq!(outcome(text, &samples, 1.0), (verdict, Some(0.0)), "{text}");
    }
}

#[test]
fn a_mode_that_is_held_does_not_pass_other_modes() {
    let samples = [("mode", 0.0, 2.0), ("mode", 1.0, 4.0)];
    assert_eq!(outcome("always(hold(mode) != 3)", &samples, 2.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("always(mode != 3)", &samples, 2.0), (VIOLATED, Some(0.0)));
}

#[test]
fn a_signal_as_a_condition_has_no_size() {
    let samples = [("ready", 0.0, 0.0), ("q", 0.0, 9.0), ("ready", 1.0, 1.0), ("q", 2.0, 9.0)];
    let infinite = f64::INFINITY;
    assert_eq!(outcome("eventually ready", &samples, 2.0), (HOLDS, Some(infinite)));
    assert_eq!(outcome("always ready", &samples, 2.0), (VIOLATED, Some(-infinite)));
    assert_eq!(outcome("always[0,0.9](not ready)", &samples, 2.0), (HOLDS, Some(infinite)));
    assert_eq!(outcome("always(ready > 0.5)", &samples, 2.0), (VIOLATED, Some(-0.5)));
    // The robustness is that of the position.
    assert_eq!(outcome("always(ready -> q < 2)", &samples, 2.0), (VIOLATED, Some(-7.0)));
    assert_eq!(outcome("always(ready -> q < 20)", &samples, 2.0), (HOLDS, Some(11.0)));
}

#[test]
fn the_trace_starts_when_each_signal_has_a_sample() {
    let samples = [("x", 0.0, 9.0), ("x", 1.0, 9.0), ("y", 1.5, 0.0), ("x", 2.0, 1.0)];
    assert_eq!(outcome("x > 4 and y < 1", &samples, 2.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("always(x < 6 and y < 1)", &samples, 2.0), (HOLDS, Some(1.0)));
}

#[test]
fn windows_of_the_past_begin_at_the_start() {
    let samples = [("x", 0.0, 1.0), ("x", 3.0, 1.0)];
    assert_eq!(outcome("once[1,2](x > 0)", &samples, 3.0).0, VIOLATED);
    assert_eq!(outcome("historically[1,2](x > 5)", &samples, 3.0).0, HOLDS);
    assert_eq!(outcome("once[0,2](x > 0)", &samples, 3.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("eventually[1,1](once[1,2](x > 0))", &samples, 3.0), (HOLDS, Some(1.0)));
}

#[test]
fn incomplete_windows_are_not_judged() {
    let response = "always(p -> eventually[0,1](q > 0))";
    let samples = [("p", 0.0, 0.0), ("q", 0.0, -2.0), ("p", 5.0, 1.0), ("q", 5.0, -2.0)];
    assert_eq!(outcome(response, &samples, 5.5).0, HOLDS);
    assert_eq!(outcome(response, &samples, 6.5), (VIOLATED, Some(-2.0)));
    assert_eq!(outcome("always[0,10](q < 0)", &samples, 5.0), (NOT_ENOUGH_DATA, None));
    assert_eq!(outcome("always[0,10](q > 0)", &samples, 5.0), (VIOLATED, Some(-2.0)));
    assert_eq!(outcome("eventually[0,10](q < 0)", &samples, 5.0), (HOLDS, Some(2.0)));
    assert_eq!(outcome("always[9,inf](q < 0)", &samples, 5.0), (NOT_ENOUGH_DATA, None));
}

#[test]
fn unbounded_operators_end_with_the_trace() {
    let samples = [("x", 0.0, 0.0), ("x", 2.0, 2.0)];
    assert_eq!(outcome("eventually(x > 1)", &samples, 2.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("eventually(x > 3)", &samples, 2.0), (VIOLATED, Some(-1.0)));
    assert_eq!(outcome("x >= 0 until x > 1", &samples, 2.0), (HOLDS, Some(0.0)));
    assert_eq!(outcome("x < 1 until x > 1", &samples, 2.0).0, VIOLATED);
    assert_eq!(outcome("always(eventually(x >= 2))", &samples, 3.0), (HOLDS, Some(0.0)));
}

#[test]
fn the_last_value_is_held_up_to_the_end() {
    let samples = [("x", 0.0, 1.0), ("y", 0.0, 0.0), ("y", 3.0, 3.0)];
    assert_eq!(outcome("always[0,4](x < 2)", &samples, 4.0), (HOLDS, Some(1.0)));
    assert_eq!(outcome("eventually[4,4](y - x > 1)", &samples, 4.0), (HOLDS, Some(1.0)));
    // The end is not before the last sample.
    assert_eq!(outcome("eventually[3,3](y > 1)", &samples, 1.0), (HOLDS, Some(2.0)));
    assert_eq!(outcome("always(rate(y) >= 0)", &samples, 4.0), (HOLDS, Some(0.0)));
}

#[test]
fn values_that_are_not_finite_hold_in_no_comparison() {
    for value in [f64::NAN, f64::INFINITY] {
        let samples = [("x", 0.0, 1.0), ("x", 1.0, value), ("x", 2.0, 1.0), ("x", 3.0, 1.0)];
        let infinite = Some(f64::NEG_INFINITY);
        assert_eq!(outcome("always(x < 5)", &samples, 3.0), (VIOLATED, infinite));
        assert_eq!(outcome("always(not x > 5)", &samples, 3.0), (VIOLATED, infinite));
        assert_eq!(outcome("always(x != 7)", &samples, 3.0), (VIOLATED, infinite));
        assert_eq!(
            outcome("always(min(x, 0) < 5)", &samples, 3.0).0,
            if value.is_nan() { VIOLATED } else { HOLDS }
        );
        assert_eq!(outcome("always[0,0.9](x < 5)", &samples, 3.0), (HOLDS, Some(4.0)));
        assert_eq!(outcome("eventually[2,3](x < 5)", &samples, 3.0), (HOLDS, Some(4.0)));
    }
    let samples = [("x", 0.0, 0.0), ("x", 1.0, 1.0)];
    assert_eq!(outcome("1 / x < 5", &samples, 1.0).0, VIOLATED);
}

#[test]
fn a_signal_without_samples_is_not_enough_data() {
    let samples = [("x", 0.0, 9.0), ("x", 1.0, 9.0)];
    let (violation, outcome) = run("always(x < 5 and y < 5)", &samples, 2.0);
    assert_eq!((violation, outcome.verdict), (None, NOT_ENOUGH_DATA));
    assert_eq!(outcome.missing, [1]);
    assert_eq!(run("true", &[], 0.0).1.verdict, HOLDS);
    assert_eq!(run("always(1 < 0)", &[], 0.0).1.verdict, VIOLATED);
}

#[test]
fn times_that_do_not_increase_are_ignored() {
    let formula = Formula::parse("always(x < 5)").unwrap();
    let mut monitor = Monitor::new(&formula).unwrap();
    for (time, value) in [(0.0, 0.0), (1.0, 0.0), (1.0, 9.0), (0.5, 9.0), (f64::NAN, 9.0)] {
        assert_eq!(monitor.sample(0, time, value), None);
    }
    assert_eq!(monitor.sample(7, 2.0, 9.0), None);
    let outcome = monitor.finish(2.0);
    assert_eq!((outcome.verdict, outcome.ignored), (HOLDS, 4));
    assert_eq!(monitor.sample(0, 3.0, 9.0), None);
    assert_eq!(monitor.finish(4.0).robustness, Some(5.0));
}

#[test]
fn edges_are_changes_of_truth() {
    let samples =
        [("x", 0.0, 0.0), ("y", 0.0, 7.0), ("x", 1.0, 1.0), ("x", 2.0, 0.0), ("y", 2.0, 5.0)];
    // x crosses 0.25 at 0.25 s and at 1.75 s, y is 6.75 and 5.25 then.
    assert_eq!(outcome("always(rise(x > 0.25) -> y > 6)", &samples, 2.0), (HOLDS, Some(0.75)));
    assert_eq!(outcome("always(fall(x > 0.25) -> y > 6)", &samples, 2.0), (VIOLATED, Some(-0.75)));
    assert_eq!(outcome("eventually(rise(x < 5))", &samples, 2.0).0, VIOLATED);
}

#[test]
fn products_are_linear_between_samples() {
    let samples = [("x", 0.0, 0.0), ("x", 2.0, 2.0)];
    // x * x at 1 s is 2 and not 1: it is computed at 0 s and 2 s.
    assert_eq!(outcome("eventually[1,1](x * x >= 2)", &samples, 2.0), (HOLDS, Some(0.0)));
}

#[test]
fn the_reference_has_the_same_outcome() {
    let formula = Formula::parse("always(x < 5)").unwrap();
    let outcome = judge(&formula, &[vec![(0.0, 1.0), (1.0, 7.0)]], 1.0).unwrap();
    assert_eq!((outcome.verdict, outcome.robustness), (VIOLATED, Some(-2.0)));
    let violation = outcome.violation.unwrap();
    assert_eq!(violation.values[0].value, 7.0);
}
