//! Laws of the logic, on random signals.

use proptest::prelude::*;
use rtf_monitor::{Formula, Verdict, judge};

type Trace = Vec<(f64, f64)>;

/// Samples at irregular times from 0 to at least 10 s.
fn trace() -> impl Strategy<Value = Trace> {
    prop::collection::vec((0.1_f64..1.5, -3.0_f64..3.0), 12..40).prop_map(|steps| {
        let mut time = 0.0;
        let mut samples = vec![(0.0, steps[0].1)];
        for (step, value) in steps {
            time += step;
            samples.push((time, value));
        }
        samples.push((time.max(10.0) + 1.0, 0.0));
        samples
    })
}

/// Conditions of `x` and `y`.
fn condition() -> impl Strategy<Value = String> {
    let comparison = prop_oneof![
        (-2.0_f64..2.0).prop_map(|limit| format!("x < {limit:.3}")),
        (-2.0_f64..2.0).prop_map(|limit| format!("y >= {limit:.3}")),
        (-2.0_f64..2.0).prop_map(|limit| format!("abs(x - y) > {limit:.3}")),
    ];
    comparison.prop_recursive(2, 6, 2, |inner| {
        prop_oneof![
            (inner.clone(), inner.clone()).prop_map(|(p, q)| format!("({p} and {q})")),
            inner.clone().prop_map(|p| format!("(not {p})")),
            (inner.clone(), 0.0_f64..1.0).prop_map(|(p, to)| format!("(always[0,{to:.3}] ({p}))")),
            (inner.clone(), 0.0_f64..1.0).prop_map(|(p, to)| format!("(once[0,{to:.3}] ({p}))")),
            (inner.clone(), inner, 0.0_f64..1.0)
                .prop_map(|(p, q, to)| format!("(({p}) until[0,{to:.3}] ({q}))")),
        ]
    })
}

/// The robustness and whether the formula holds. Both signals are in each formula, so that the
/// traces start at the same time.
fn robustness(text: &str, [x, y]: &[Trace; 2]) -> (f64, bool) {
    let formula = Formula::parse(&format!("({text}) and abs(x) + abs(y) < 1000")).unwrap();
    let traces: Vec<Trace> = formula
        .signals()
        .iter()
        .map(|signal| if signal.name == "x" { x.clone() } else { y.clone() })
        .collect();
    let outcome = judge(&formula, &traces, 0.0).unwrap();
    (outcome.robustness.unwrap(), outcome.verdict == Verdict::Holds)
}

/// Asserts that formulas have the same robustness and verdict.
fn assert_same(left: &str, right: &str, traces: &[Trace; 2]) {
    let (left, right) = (robustness(left, traces), robustness(right, traces));
    let is_close = (left.0 - right.0).abs() < 1e-9;
    assert!(is_close && (left.1 == right.1 || left.0.abs() < 1e-9), "{left:?} {right:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn de_morgan(p in condition(), q in condition(), x in trace(), y in trace()) {
        let traces = [x, y];
        assert_same(&format!("not ({p} and {q})"), &format!("not {p} or not {q}"), &traces);
        assert_same(&format!("{p} -> {q}"), &format!("not ({p} and not {q})"), &traces);
    }

    #[test]
    fn dual_operators(p in condition(), x in trace(), y in trace(), a in 0.0_f64..1.0, b in 0.0_f64..2.0) {
        let traces = [x, y];
        let window = format!("[{a:.3},{:.3}]", a + b);
        for (all, some) in [("always", "eventually"), ("historically", "once")] {
            for window in ["", window.as_str()] {
                let negated = format!("not {some}{window} (not {p})");
                assert_same(&format!("{all}{window} ({p})"), &negated, &traces);
                let later = |inner: &str| format!("eventually[2,2] ({inner})");
                assert_same(&later(&format!("{all}{window} ({p})")), &later(&negated), &traces);
            }
        }
    }

    #[test]
    fn windows_add_up(p in condition(), x in trace(), y in trace(), a in 0_u32..64, b in 0_u32..64) {
        // Sums of multiples of 1/64 are exact.
        let traces = [x, y];
        let (a, b) = (f64::from(a) / 64.0, f64::from(b) / 64.0);
        let nested = format!("always[0,{a}] always[0,{b}] ({p})");
        assert_same(&nested, &format!("always[0,{}] ({p})", a + b), &traces);
        let shifted = format!("eventually[{a},{a}] eventually[{b},{b}] ({p})");
        assert_same(&shifted, &format!("always[{0},{0}] ({p})", a + b), &traces);
    }

    #[test]
    fn until_and_since_unfold(p in condition(), q in condition(), x in trace(), y in trace(), b in 0.0_f64..2.0) {
        let traces = [x, y];
        assert_same(&format!("true until[0,{b:.3}] ({q})"), &format!("eventually[0,{b:.3}] ({q})"), &traces);
        let later = |inner: &str| format!("eventually[1,1] ({inner})");
        assert_same(
            &later(&format!("true since[0,{b:.3}] ({q})")),
            &later(&format!("once[0,{b:.3}] ({q})")),
            &traces,
        );
        assert_same(&format!("({p}) until[0,0] ({q})"), &format!("{p} and {q}"), &traces);
    }

    #[test]
    fn operators_are_monotonic(p in condition(), q in condition(), x in trace(), y in trace(), b in 0.0_f64..2.0) {
        let traces = [x, y];
        for operator in ["always", "eventually", "once", "historically"] {
            let value = |inner: &str| {
                robustness(&format!("eventually[2,2] {operator}[0,{b:.3}] ({inner})"), &traces).0
            };
            let (both, either) = (format!("{p} and {q}"), format!("{p} or {q}"));
            prop_assert!(value(&both) <= value(&p) + 1e-9);
            prop_assert!(value(&either) >= value(&p) - 1e-9);
        }
        let always = |to: f64| robustness(&format!("always[0,{to:.3}] ({p})"), &traces).0;
        prop_assert!(always(b + 1.0) <= always(b) + 1e-9);
    }

    #[test]
    fn a_later_clock_changes_nothing(p in condition(), x in trace(), y in trace(), shift in -64_i32..64) {
        let shift = f64::from(shift);
        let later = |trace: &Trace| -> Trace {
            trace.iter().map(|(time, value)| (time + shift, *value)).collect()
        };
        let text = format!("always[0,3] ({p})");
        let shifted = [later(&x), later(&y)];
        let (before, after) = (robustness(&text, &[x, y]), robustness(&text, &shifted));
        prop_assert!((before.0 - after.0).abs() < 1e-9);
    }

    #[test]
    fn the_sign_of_the_robustness_is_the_verdict(p in condition(), x in trace(), y in trace()) {
        let (value, holds) = robustness(&format!("always({p})"), &[x, y]);
        prop_assert!(value == 0.0 || (value > 0.0) == holds);
    }
}
