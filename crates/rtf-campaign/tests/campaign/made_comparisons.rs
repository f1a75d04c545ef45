//! Made comparisons of versions whose rates are known: how often claims are wrong, and how often
//! planned episodes find a difference. The tables of `docs/explanation/campaign-statistics.md`.

use rtf_campaign::comparison::{ComparedEpisode, Comparison, Finding, Options, compare};
use rtf_campaign::plan::{Assumption, Wanted};
use rtf_model::Parameter;
use rtf_statistics::RandomStream;
use rtf_statistics::random::{normal_quantile, unit};

use crate::comparisons::OPTIONS;

const COMPARISONS: u64 = 2000;

/// How made versions are related.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Relation {
    /// The better version passes all episodes that the worse one passes.
    Nested,
    /// The same episodes, half of them as `Nested`, the others with independent results.
    Half,
    /// The same episodes with independent results.
    Unrelated,
    /// Other episodes.
    OtherEpisodes,
}

impl Relation {
    fn name(self) -> &'static str {
        match self {
            Self::Nested => "in pairs, nested",
            Self::Half => "in pairs, half nested",
            Self::Unrelated => "in pairs, independent results",
            Self::OtherEpisodes => "independent",
        }
    }

    /// The share of episodes whose result depends on the same random number.
    fn common(self) -> f64 {
        match self {
            Self::Nested => 1.0,
            Self::Half => 0.5,
            Self::Unrelated | Self::OtherEpisodes => 0.0,
        }
    }
}

/// Versions with these rates.
fn made(
    rates: &[f64],
    episodes: u64,
    relation: Relation,
    number: u64,
) -> Vec<Vec<ComparedEpisode>> {
    let name = format!("{rates:?} {episodes} {relation:?}");
    let mut random = RandomStream::new(number, "made-comparison", &name).sequence().map(unit);
    let mut next = || random.next().expect("endless");
    let mut versions = vec![Vec::new(); rates.len()];
    for id in 1..=episodes {
        let (is_common, common) = (next() < relation.common(), next());
        for (version, rate) in versions.iter_mut().zip(rates) {
            let separate = next();
            let drawn = if is_common { common } else { separate };
            version.push(ComparedEpisode {
                id,
                seed: (relation != Relation::OtherEpisodes).then_some(id),
                passed: Some(drawn < *rate),
                ..ComparedEpisode::default()
            });
        }
    }
    versions
}

/// The share of comparisons with a property.
fn share(has_it: impl Fn(u64) -> bool) -> f64 {
    (0..COMPARISONS).filter(|number| has_it(*number)).count() as f64 / COMPARISONS as f64
}

/// The findings about the further versions in all comparisons of versions with these rates.
fn findings(rates: &[f64], episodes: u64, relation: Relation) -> Vec<Vec<Finding>> {
    let of = |number| {
        let found = compared(&made(rates, episodes, relation, number), &OPTIONS);
        found.comparisons.iter().map(|it| it.finding).collect()
    };
    (0..COMPARISONS).map(of).collect()
}

/// Three standard deviations of a share.
fn chance(probability: f64) -> f64 {
    3.0 * (probability * (1.0 - probability) / COMPARISONS as f64).sqrt()
}

fn compared(versions: &[Vec<ComparedEpisode>], options: &Options<'_>) -> Comparison {
    compare(versions, options).expect("a comparison")
}

#[track_caller]
fn assert_documented(table: &str) {
    let page = include_str!("../../../../docs/explanation/campaign-statistics.md");
    assert!(page.contains(table), "the page does not contain:\n{table}");
}

#[test]
fn claims_about_equal_versions_are_as_rare_as_alpha() {
    let mut table = String::from(
        "| versions | compared | episodes of each | rate | any claim | a version is worse |\n\
         | ---: | --- | ---: | ---: | ---: | ---: |\n",
    );
    for (versions, episodes, rate, relation) in [
        (2, 50, 0.9, Relation::Half),
        (2, 100, 0.6, Relation::Unrelated),
        (4, 100, 0.6, Relation::Half),
        (4, 100, 0.6, Relation::Unrelated),
        (2, 50, 0.9, Relation::OtherEpisodes),
        (2, 200, 0.6, Relation::OtherEpisodes),
        (4, 100, 0.6, Relation::OtherEpisodes),
    ] {
        let rates = vec![rate; versions];
        let findings = findings(&rates, episodes, relation);
        let of = |number| findings[number as usize].iter();
        let any = share(|number| of(number).any(|it| *it != Finding::Undecided));
        let worse = share(|number| of(number).any(|it| *it == Finding::Worse));
        assert!(any <= OPTIONS.alpha && worse <= any, "{relation:?}: {any}, {worse}");
        table += &format!(
            "| {versions} | {} | {episodes} | {rate} | {:.1} % | {:.1} % |\n",
            relation.name(),
            100.0 * any,
            100.0 * worse,
        );
    }
    assert_documented(&table);
}

#[test]
fn claims_about_conditions_without_a_difference_are_as_rare_as_alpha() {
    let by = Options { by: Some("surface"), ..OPTIONS };
    for relation in [Relation::Half, Relation::OtherEpisodes] {
        let any = share(|number| {
            let mut versions = made(&[0.6, 0.6], 160, relation, number);
            for episode in versions.iter_mut().flatten() {
                let (name, value) = ("surface".to_owned(), (episode.id % 5).to_string());
                episode.parameters.push(Parameter { name, value });
            }
            let conditions = compared(&versions, &by).by.expect("conditions").conditions;
            let mut comparisons = conditions.iter().flat_map(|it| &it.comparisons);
            comparisons.any(|it| it.significance.adjusted <= by.alpha)
        });
        assert!(any > 0.0 && any <= by.alpha, "{relation:?}: {any}");
    }
}

/// Adds normally distributed measurements, of which those of the second version are larger.
fn measure(versions: &mut [Vec<ComparedEpisode>], shift: f64, number: u64) {
    let stream = RandomStream::new(number, "made-measurements", &format!("{shift}"));
    let mut random = stream.sequence().map(|bits| normal_quantile(unit(bits)));
    for (index, version) in versions.iter_mut().enumerate() {
        for episode in version {
            for name in ["a", "b", "c"] {
                let value = random.next().expect("endless") + shift * index as f64;
                episode.values.insert((String::new(), name.to_owned(), String::new()), value);
            }
        }
    }
}

#[test]
fn measurements_without_a_difference_have_few_claims_and_intervals_contain_it() {
    for (relation, episodes) in [(Relation::Half, 8), (Relation::OtherEpisodes, 6)] {
        let of = |number, shift| {
            let mut versions = made(&[0.9, 0.9], episodes, relation, number);
            measure(&mut versions, shift, number);
            compared(&versions, &OPTIONS).comparisons.remove(0).measurements
        };
        let any = share(|number| {
            of(number, 0.0).iter().any(|it| it.significance.adjusted <= OPTIONS.alpha)
        });
        assert!(any > 0.0 && any <= OPTIONS.alpha, "{relation:?}: {any}");
        let inside = share(|number| {
            let difference = of(number, 0.5)[0].difference.expect("an interval");
            (difference.low..=difference.high).contains(&0.5)
        });
        assert!(inside >= 0.95 - chance(0.95), "{relation:?}: {inside}");
    }
}

#[test]
fn planned_episodes_find_the_difference() {
    let mut table = String::from(
        "| `--rate` | `--detect` | versions | compared | planned episodes | power, exactly | found | wrong claims |\n\
         | ---: | ---: | ---: | --- | ---: | ---: | ---: | ---: |\n",
    );
    let relations = [
        (Relation::Nested, Assumption::Nested),
        (Relation::Unrelated, Assumption::IndependentResults),
        (Relation::OtherEpisodes, Assumption::IndependentEpisodes),
    ];
    for (rate, detect, versions) in [(0.9, 0.1, 2), (0.7, 0.2, 2), (0.8, 0.2, 3)] {
        let wanted = Wanted { rate, detect, power: 0.8, alpha: 0.05, versions, discordant: None };
        let planned = rtf_campaign::plan(&wanted).expect("a plan");
        for (relation, assumption) in relations {
            let plan = planned.iter().find(|it| it.assumption == assumption).expect("a number");
            let (episodes, power) =
                (plan.episodes.expect("a number"), plan.power.expect("a power"));
            // All versions but the last one are equal.
            let mut rates = vec![rate; versions as usize - 1];
            rates.push(rate - detect);
            let findings = findings(&rates, episodes, relation);
            let of_last = |number| findings[number as usize].split_last().expect("a version");
            let found = share(|number| *of_last(number).0 == Finding::Worse);
            let wrong = share(|number| {
                let (last, equal) = of_last(number);
                *last == Finding::Better || equal.iter().any(|it| *it != Finding::Undecided)
            });
            let of = format!("{wanted:?}, {relation:?}: {found}, {power}, {wrong}");
            assert!(found >= 0.8 - chance(0.8) && power >= 0.8, "{of}");
            assert!(versions > 2 || (found - power).abs() <= chance(power), "{of}");
            assert!(wrong <= OPTIONS.alpha, "{of}");
            table += &format!(
                "| {rate} | {} % | {versions} | {} | {episodes} | {:.1} % | {:.1} % | {:.1} % |\n",
                100.0 * detect,
                relation.name(),
                100.0 * power,
                100.0 * found,
                100.0 * wrong,
            );
        }
    }
    assert_documented(&table);
}
