//! Results → verdicts.

use rtf_campaign::{EpisodeResult, Judge, Judgement, Verdict};

use crate::campaign;

const FIXED: &str = r#"<claim require="rate >= 0.9" confidence="0.95"/>"#;
const SEQUENCE: &str =
    r#"<claim require="rate >= 0.9" confidence="0.95"/><stop rule="confidence-sequence"/>"#;
const SPRT: &str = r#"<claim require="rate >= 0.9"/>
    <stop rule="sprt" low="0.9" high="0.97" alpha="0.05" beta="0.05"/>"#;

/// The judgement of results, each with a number of repetitions.
fn judge(rule: &str, planned: usize, results: &[(usize, EpisodeResult)]) -> Judgement {
    let campaign = campaign(&format!("episodes=\"{planned}\""), rule);
    let results: Vec<EpisodeResult> =
        results.iter().flat_map(|(count, result)| vec![*result; *count]).collect();
    Judge::new(&campaign, planned).unwrap().judge(&results)
}

use EpisodeResult::{Failed, None, Passed};

#[test]
fn a_fixed_number_is_judged_at_the_end_only() {
    let early = judge(FIXED, 100, &[(99, Passed)]);
    assert_eq!((early.verdict, early.is_final), (Verdict::Undecided, false));
    let end = judge(FIXED, 100, &[(100, Passed)]);
    assert_eq!((end.verdict, end.is_final), (Verdict::Passed, true));
    assert_eq!(judge(FIXED, 100, &[(20, Failed), (80, Passed)]).verdict, Verdict::Failed);
    let between = judge(FIXED, 100, &[(7, Failed), (93, Passed)]);
    assert_eq!((between.verdict, between.is_final), (Verdict::Undecided, true));
    let rate = between.rate.unwrap();
    assert!(rate.low < 0.9 && rate.value == 0.93 && rate.high > 0.9);
}

#[test]
fn sequential_rules_end_early_and_ignore_later_results() {
    for rule in [SEQUENCE, SPRT] {
        let all = judge(rule, 500, &[(500, Passed)]);
        assert_eq!((all.verdict, all.is_final), (Verdict::Passed, true), "{rule}");
        assert!(all.episodes < 80, "{rule}: {all:?}");
        // The same verdict and number, although all later episodes fail.
        let later = judge(rule, 500, &[(all.episodes, Passed), (500 - all.episodes, Failed)]);
        assert_eq!(later, all);
        let one_less = judge(rule, 500, &[(all.episodes - 1, Passed)]);
        assert_eq!((one_less.verdict, one_less.is_final), (Verdict::Undecided, false));
        let bad = judge(rule, 500, &[(30, Failed)]);
        assert!(bad.verdict == Verdict::Failed && bad.episodes < 10, "{rule}: {bad:?}");
    }
}

#[test]
fn sequential_rules_are_undecided_after_all_episodes() {
    for rule in [SEQUENCE, SPRT] {
        let end = judge(rule, 20, &[(1, Failed), (19, Passed)]);
        assert_eq!((end.verdict, end.is_final), (Verdict::Undecided, true), "{rule}");
    }
}

/// A robot that breaks the bench whenever it fails does not pass.
#[test]
fn episodes_without_a_result_count_in_the_worst_way() {
    for rule in [FIXED, SEQUENCE, SPRT] {
        let hidden = judge(rule, 300, &[(40, None), (260, Passed)]);
        assert_eq!(hidden.verdict, Verdict::Undecided, "{rule}");
        assert_eq!((hidden.without_result, hidden.passed), (40, 260));
        let rate = hidden.rate.unwrap();
        assert!(rate.low < 0.9 && rate.high > 0.98, "{rate:?}");
        // A few of them change nothing.
        let few = judge(rule, 300, &[(1, None), (299, Passed)]);
        assert_eq!(few.verdict, Verdict::Passed, "{rule}");
        let bad = judge(rule, 300, &[(5, None), (295, Failed)]);
        assert_eq!(bad.verdict, Verdict::Failed, "{rule}");
    }
}

#[test]
fn no_results() {
    let none = judge(SEQUENCE, 3, &[]);
    assert_eq!((none.verdict, none.is_final, none.rate), (Verdict::Undecided, false, Option::None));
    let bench = judge(FIXED, 3, &[(3, None)]);
    assert_eq!((bench.verdict, bench.is_final), (Verdict::Undecided, true));
    assert_eq!(bench.rate, Option::None);
}
