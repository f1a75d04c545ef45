use super::*;
use rtf_statistics::{RandomStream, random::unit};

fn episode(id: u64, passed: bool, x: f64) -> ComparedEpisode {
    let key = ("Walk".to_owned(), "x".to_owned(), "m".to_owned());
    ComparedEpisode {
        id,
        passed: Some(passed),
        first_observation: Some(format!("{id}")),
        values: BTreeMap::from([(key, x)]),
        ..ComparedEpisode::default()
    }
}

/// 200 episodes, of which every fifth fails.
#[expect(clippy::cast_precision_loss, reason = "small numbers")]
fn clean() -> Vec<ComparedEpisode> {
    (1..=200).map(|id| episode(id, id % 5 > 0, 1.0 + id as f64)).collect()
}

/// The causes if one variation has these results, and all others those of the first time.
fn causes_of(
    wrong: Variation,
    change: impl Fn(&mut ComparedEpisode),
    third: Option<&[ComparedEpisode]>,
) -> Vec<Cause> {
    let first = clean();
    let variations = Variation::ALL.map(|variation| {
        let mut results = clean();
        if variation == wrong {
            results.iter_mut().for_each(&change);
        }
        (variation, results)
    });
    judge(&first, &variations, third, 0.05).causes
}

fn flip(episode: &mut ComparedEpisode) {
    if episode.id == 17 {
        episode.passed = episode.passed.map(|passed| !passed);
        episode.values.values_mut().for_each(|x| *x += 10.0);
    }
}

#[test]
fn each_variation_has_its_cause() {
    use Cause::*;
    use Variation::*;
    assert_eq!(causes_of(Again, |_| {}, None), []);
    for (variation, cause) in [
        (OtherOrder, StateOutlivesEpisodes),
        (ManySlots, SharedBetweenSlots),
        (OtherMode, SharedInProcess),
        (TwoWorkers, SharedBetweenWorkers),
    ] {
        assert_eq!(causes_of(variation, flip, None), [cause], "{variation:?}");
        let begins = |episode: &mut ComparedEpisode| {
            if episode.id == 3 {
                episode.first_observation = Some("other".to_owned());
            }
        };
        assert_eq!(causes_of(variation, begins, None), [SeedIgnored], "{variation:?}");
    }
    let little = |episode: &mut ComparedEpisode| {
        episode.values.values_mut().for_each(|x| *x *= 1.0 + 1e-6);
        episode.passed = Some(!episode.id.is_multiple_of(5) || episode.id == 10);
    };
    assert_eq!(causes_of(ManySlots, little, None), [BatchArithmetic]);
}

/// The first two times agree by luck, and the third one does not.
#[test]
fn results_that_are_not_exact_need_more_than_one_change() {
    let mut third = clean();
    third.iter_mut().for_each(flip);
    assert_eq!(causes_of(Variation::ManySlots, flip, Some(&third)), []);
    let worse = |episode: &mut ComparedEpisode| episode.passed = Some(episode.id.is_multiple_of(2));
    let causes = causes_of(Variation::ManySlots, worse, Some(&third));
    assert_eq!(causes, [Cause::SharedBetweenSlots]);
}

/// Clean episodes whose results depend on chance: at most one campaign in twenty has a finding.
#[test]
fn chance_is_rarely_called_a_change() {
    let mut random = RandomStream::new(1, "invariance", "clean").sequence();
    let mut next = || unit(random.next().unwrap_or_default());
    let mut found = 0;
    for _ in 0..300 {
        let mut run = || -> Vec<ComparedEpisode> {
            (1..=200).map(|id| episode(id, next() < 0.7, next())).collect()
        };
        let first = run();
        let variations = Variation::ALL.map(|variation| (variation, run()));
        found += usize::from(judge(&first, &variations, None, 0.05).any_change());
    }
    assert!(found <= 15, "{found} of 300");
}
