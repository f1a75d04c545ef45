//! Signals over time: what is counted of them, and the curve that is kept.

use proptest::prelude::*;
use rtf_model::{EventKind, Phase, Record, Samples, SignalOutline, SignalSummary};

use crate::support::{SUITE, TEST, run_started, stream, suite, test};

fn elbow(high: Option<f64>, points: &[(f64, Option<f64>)]) -> Samples {
    Samples {
        name: "elbow".to_owned(),
        unit: "rad".to_owned(),
        low: None,
        high,
        location: None,
        points: points.to_vec(),
        case: None,
        since: None,
    }
}

#[test]
fn the_first_sample_outside_is_told_with_its_time() {
    let samples = elbow(Some(1.5), &[(0.5, Some(1.5)), (1.0, Some(1.75)), (1.5, None)]);
    let told = samples.problem();
    assert_eq!(told.as_deref(), Some("`elbow` is 1.75 rad at 1 s, its limits are ≤ 1.5"));
    assert_eq!(samples.outside().count(), 2);
    let told = elbow(None, &[(0.25, None)]).problem();
    assert_eq!(told.as_deref(), Some("`elbow` is not a finite number at 0.25 s"));
    assert_eq!(elbow(None, &[(0.0, Some(f64::MAX))]).problem(), None);
}

#[test]
fn the_duration_of_a_signal_begins_with_its_first_sample() {
    let (mut record, points) = (Record::default(), [(2.0, Some(0.5)), (4.5, Some(1.5))]);
    let sampled = EventKind::Sampled { test: TEST, samples: elbow(None, &points) };
    let started = EventKind::TestStarted { test: TEST, repetition: 1, attempt: 1 };
    let kinds = [run_started(), suite(0), test(0, 0, 1), started, sampled];
    stream(kinds).iter().for_each(|event| record.apply(event));
    let summary = record.tests[0].attempts[0].series[0].summary();
    assert_eq!(summary, "2 samples in 2.5 s, 0.5 … 1.5 rad, mean 1 rad");
}

#[test]
fn a_record_keeps_a_signal_in_numbers() {
    let started = EventKind::TestStarted { test: TEST, repetition: 1, attempt: 1 };
    let sampled = |points| EventKind::Sampled { test: TEST, samples: elbow(Some(1.0), points) };
    let kinds = [
        run_started(),
        suite(0),
        test(0, 0, 1),
        EventKind::SuiteStarted { suite: SUITE },
        started,
        EventKind::TestPhase { test: TEST, phase: Phase::Setup },
        sampled(&[(0.0, Some(0.5)), (0.5, Some(1.5))]),
        sampled(&[(1.0, None), (2.0, Some(-0.5))]),
    ];
    let (mut whole, mut lean) = (Record::default(), Record::lean());
    for event in stream(kinds) {
        whole.apply(&event);
        lean.apply(&event);
    }
    let attempt = &whole.tests[0].attempts[0];
    let [series] = attempt.series.as_slice() else { panic!("{:?}", attempt.series) };
    assert_eq!((series.count, series.outside, series.span), (4, 2, (0.0, 2.0)));
    assert_eq!((series.min, series.mean, series.max), (Some(-0.5), Some(0.5), Some(1.5)));
    assert_eq!(series.last, Some(-0.5));
    assert_eq!(series.summary(), "4 samples in 2 s, -0.5 … 1.5 rad, mean 0.5 rad");
    let problem = series.problem.as_deref();
    assert_eq!(problem, Some("`elbow` is 1.5 rad at 0.5 s, its limits are ≤ 1"));
    assert_eq!((attempt.counts.samples, attempt.counts.violations), (4, 2));
    let lean = &lean.tests[0].attempts[0];
    assert_eq!((lean.counts, lean.series.len()), (attempt.counts, 0));
}

proptest! {
    /// Whatever the batches: what is counted is that of all samples at once, and the
    /// curve is bounded, in order, and has the lowest and the highest of them.
    #[test]
    fn batches_do_not_matter_and_no_peak_is_lost(
        values in proptest::collection::vec(-1e3..1e3_f64, 1..5000),
        size in 1..700_usize,
    ) {
        let points: Vec<_> =
            values.iter().enumerate().map(|(n, value)| (n as f64, Some(*value))).collect();
        let all = elbow(Some(900.0), &points);
        let (mut curve, mut at_once) = (SignalOutline::default(), SignalOutline::default());
        at_once.extend(&all);
        let mut batches = points.chunks(size).map(|part| elbow(Some(900.0), part));
        let first = batches.next().unwrap();
        let mut series = SignalSummary::new(&first);
        curve.extend(&first);
        for batch in batches {
            series.extend(&batch);
            curve.extend(&batch);
        }
        prop_assert_eq!(&series, &SignalSummary::new(&all));
        let drawn = curve.points();
        prop_assert_eq!(&drawn, &at_once.points());
        prop_assert!(drawn.len() <= 2 * SignalOutline::STRETCHES);
        prop_assert!(drawn.windows(2).all(|pair| pair[0].0 < pair[1].0));
        for extreme in [series.min, series.max] {
            prop_assert!(drawn.iter().any(|(_, value)| Some(*value) == extreme));
        }
        if values.len() <= SignalOutline::STRETCHES {
            prop_assert_eq!(drawn.len(), values.len());
        }
    }
}
