//! Comparisons of versions: pairing, claims, conditions.

use rtf_campaign::comparison::{
    ComparedEpisode, Comparison, Finding, MeasurementKey, Options, Pairing, compare,
};
use rtf_campaign::results_file::read_csv;
use rtf_model::Parameter;

pub const OPTIONS: Options<'static> = Options { alpha: 0.05, by: None, seed: 1 };

fn key() -> MeasurementKey {
    ("Carry".to_owned(), "error".to_owned(), "rad".to_owned())
}

/// Episodes with these results, whose parameter alternates between two words.
fn version(passed: impl IntoIterator<Item = bool>) -> Vec<ComparedEpisode> {
    let episode = |(passed, id): (bool, u64)| ComparedEpisode {
        id,
        seed: Some(id + 100),
        parameters: vec![Parameter {
            name: "surface".to_owned(),
            value: ["wood", "ice"][id as usize % 2].to_owned(),
        }],
        passed: Some(passed),
        first_observation: None,
        values: [(key(), id as f64)].into(),
    };
    passed.into_iter().zip(1..).map(episode).collect()
}

fn without_seeds(mut episodes: Vec<ComparedEpisode>) -> Vec<ComparedEpisode> {
    episodes.iter_mut().for_each(|episode| episode.seed = None);
    episodes
}

#[track_caller]
fn compared(versions: &[Vec<ComparedEpisode>]) -> Comparison {
    compare(versions, &OPTIONS).expect("a comparison")
}

#[test]
fn the_same_episodes_are_compared_in_pairs() {
    let first = version([true; 20]);
    let mut second = version((0..20).map(|id| id >= 8));
    second[19].passed = None;
    second.iter_mut().for_each(|it| it.values = [(key(), it.id as f64 + 0.5)].into());
    // The order of the episodes has no effect.
    second.reverse();
    let found = compared(&[first.clone(), second.clone()]);
    let it = &found.comparisons[0];
    let pairs = it.results.pairs.expect("pairs");
    let counts = (it.pairing, pairs.both_passed, pairs.only_first, pairs.only_second);
    assert_eq!((counts, it.results.without_pair), ((Pairing::Pairs, 11, 8, 0), 1));
    // Eight of eight pairs that differ: 2 · 0.5⁸.
    assert!((it.results.significance.p_value - 2.0 * 0.5_f64.powi(8)).abs() < 1e-12);
    assert_eq!((it.finding, found.any_worse()), (Finding::Worse, true));
    let strict = compare(&[first.clone(), second.clone()], &Options { alpha: 0.001, ..OPTIONS });
    assert!(!strict.expect("a comparison").any_worse());
    let error = &it.measurements[0];
    assert_eq!((error.counts, error.second - error.first), ([20, 20], 0.5));
    assert_eq!(error.difference.map(|it| (it.low, it.high)), Some((0.5, 0.5)));
    assert!(error.significance.p_value < 0.001, "{error:?}");
    let turned = compared(&[second, first]);
    assert_eq!((turned.comparisons[0].finding, turned.any_worse()), (Finding::Better, false));
}

#[test]
fn equal_versions_are_undecided() {
    let all = version((0..10).map(|id| id > 5));
    let found = compared(&[all.clone(), all]);
    assert_eq!(found.comparisons[0].finding, Finding::Undecided);
    assert_eq!(found.comparisons[0].results.significance.p_value, 1.0);
    assert_eq!(found.comparisons[0].measurements[0].significance.p_value, 1.0);
    assert!(compared(&[]).comparisons.is_empty());
}

#[test]
fn other_episodes_are_independent() {
    let (first, second) = (version([true; 20]), version((0..20).map(|id| id >= 8)));
    let longer = version([true; 21]);
    let mut reseeded = second.clone();
    reseeded[3].seed = Some(1);
    let mut repeated = second.clone();
    repeated[3] = repeated[4].clone();
    let versions = [first, without_seeds(second), longer, reseeded, repeated];
    let found = compared(&versions);
    let pairing: Vec<_> = found.comparisons.iter().map(|it| it.pairing).collect();
    let other = Pairing::OtherEpisodes;
    assert_eq!(pairing, [Pairing::WithoutSeeds, other, other, other]);
    let worse = &found.comparisons[0];
    assert_eq!((worse.results.pairs, worse.finding), (None, Finding::Worse));
    // As scipy.stats.fisher_exact([[20, 0], [12, 8]]).
    assert!((worse.results.significance.p_value - 0.003_276_9).abs() < 1e-6, "{worse:?}");
    assert_eq!(worse.measurements[0].counts, [20, 20]);
}

#[test]
fn claims_and_measurements_are_adjusted_apart() {
    // 6 of 6 pairs: p = 0.03125, which two claims do not allow.
    let worse = version((0..20).map(|id| id >= 6));
    let found = compared(&[version([true; 20]), worse.clone()]);
    assert_eq!(found.comparisons[0].finding, Finding::Worse);
    let found = compared(&[version([true; 20]), worse, version([true; 20])]);
    let significance = found.comparisons[0].results.significance;
    assert_eq!(significance.adjusted, 2.0 * significance.p_value);
    assert!((significance.p_value - 0.03125).abs() < 1e-12, "{significance:?}");
    assert!(!found.any_worse());
    assert_eq!(found.comparisons[0].measurements[0].significance.adjusted, 1.0);
}

#[test]
fn conditions_have_their_rates() {
    let by = Options { by: Some("surface"), ..OPTIONS };
    let first = version([true; 40]);
    // It fails on ice: the odd ids.
    let second = version((1..=40).map(|id| id % 2 == 0));
    let found = compare(&[first.clone(), second.clone()], &by).expect("a comparison");
    let by_surface = found.by.expect("conditions");
    let rows: Vec<_> = by_surface
        .conditions
        .iter()
        .map(|it| (&*it.values, it.comparisons[0].first.passed, it.comparisons[0].second.passed))
        .collect();
    assert_eq!(rows, [("ice", 20, 0), ("wood", 20, 20)]);
    let [ice, wood] = [0, 1].map(|at| by_surface.conditions[at].comparisons[0].significance);
    assert!(ice.adjusted == 2.0 * ice.p_value && ice.adjusted < 0.001, "{ice:?}");
    assert_eq!(wood.adjusted, 1.0);
    // In pairs, the parameters of the first version are enough.
    let rows = second.iter().map(|it| format!("{},{},1\n", it.id, it.id + 100));
    let csv = format!("episode,seed,success\n{}", rows.collect::<String>());
    let csv = read_csv(&csv).expect("results");
    let found = compare(&[first.clone(), csv.clone()], &by).expect("a comparison");
    assert_eq!(found.by.expect("conditions").conditions.len(), 2);
    let unknown = compare(&[first, without_seeds(csv)], &by).expect_err("no parameter");
    assert_eq!(unknown.to_string(), "version 2 has no parameter `surface`");
    assert!(unknown.known.is_empty());
}
