//! What the lists of all seeds have in common.

use proptest::prelude::*;

use crate::{episodes, numbers};

fn parts(numbers: &[f64], count: usize) -> Vec<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
    let part = |number: &f64| (number * count as f64) as usize;
    let mut parts: Vec<usize> = numbers.iter().map(part).collect();
    parts.sort_unstable();
    parts
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_latin_hypercube_has_one_point_in_each_part_of_each_dimension(
        seed in 0_u32..1000, count in 1_usize..200,
    ) {
        let list = episodes(
            &format!("seed=\"{seed}\" episodes=\"{count}\""),
            r#"<parameter name="a" distribution="latin-hypercube" low="0" high="1"/>
               <parameter name="b" distribution="latin-hypercube" low="0" high="1"/>"#,
        );
        let (a, b) = (numbers(&list, "a"), numbers(&list, "b"));
        prop_assert!(parts(&a, count).into_iter().eq(0..count));
        prop_assert!(parts(&b, count).into_iter().eq(0..count));
        prop_assert!(count < 10 || a != b);
    }

    #[test]
    fn a_sobol_sequence_has_one_point_in_each_part_for_all_seeds(seed in 0_u32..1000) {
        let list = episodes(
            &format!("seed=\"{seed}\" episodes=\"64\""),
            r#"<parameter name="a" distribution="sobol" low="0" high="1"/>
               <parameter name="b" distribution="sobol" low="0" high="1"/>"#,
        );
        prop_assert!(parts(&numbers(&list, "a"), 64).into_iter().eq(0..64));
        prop_assert!(parts(&numbers(&list, "b"), 64).into_iter().eq(0..64));
    }

    #[test]
    fn episodes_meet_the_constraints_and_the_ids_have_no_gaps(seed in 0_u32..1000) {
        let list = episodes(
            &format!("seed=\"{seed}\" episodes=\"50\""),
            r#"<parameter name="a" distribution="uniform" low="-1" high="1"/>
               <parameter name="b" distribution="normal" mean="0" deviation="1"/>
               <constraint require="2 * a - b > -(0.5)"/><constraint require="b &lt;= a + 1"/>"#,
        );
        let (a, b) = (numbers(&list, "a"), numbers(&list, "b"));
        for (a, b) in a.into_iter().zip(b) {
            prop_assert!(2.0 * a - b > -0.5 && b <= a + 1.0, "{a}, {b}");
        }
        prop_assert!(list.episodes.iter().map(|episode| episode.id).eq(1..=50));
    }

    #[test]
    fn a_further_parameter_and_more_episodes_change_no_independent_value(seed in 0_u32..1000) {
        let one = r#"<parameter name="a" distribution="uniform" low="0" high="1"/>"#;
        let two = format!(r#"<parameter name="b" distribution="choice" values="x y"/>{one}"#);
        let few = episodes(&format!("seed=\"{seed}\" episodes=\"5\""), one);
        let many = episodes(&format!("seed=\"{seed}\" episodes=\"20\""), &two);
        prop_assert_eq!(&numbers(&few, "a")[..], &numbers(&many, "a")[..5]);
        let seeds = |list: &rtf_campaign::EpisodeList| {
            list.episodes.iter().take(5).map(|episode| episode.seed).collect::<Vec<_>>()
        };
        prop_assert_eq!(seeds(&few), seeds(&many));
    }
}

#[test]
fn normal_values_have_the_mean_and_the_deviation() {
    let list = episodes(
        r#"episodes="4000""#,
        r#"<parameter name="a" distribution="normal" mean="3" deviation="0.5"/>"#,
    );
    let values = numbers(&list, "a");
    let mean = values.iter().sum::<f64>() / 4000.0;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 4000.0;
    // Four standard errors.
    assert!((mean - 3.0).abs() < 4.0 * 0.5 / 63.2, "{mean}");
    assert!((variance - 0.25).abs() < 4.0 * 0.25 * 0.0224, "{variance}");
}

#[test]
fn a_grid_has_each_combination_once_and_repeats_if_there_are_more_episodes() {
    let grid = r#"<parameter name="a" distribution="grid" values="1 2 3"/>
                  <parameter name="b" distribution="grid" values="10 20"/>"#;
    let sums = |list: &rtf_campaign::EpisodeList| -> Vec<f64> {
        numbers(list, "a").into_iter().zip(numbers(list, "b")).map(|(a, b)| a + b).collect()
    };
    let once = sums(&episodes("", grid));
    assert_eq!(once, [11.0, 21.0, 12.0, 22.0, 13.0, 23.0]);
    let twice = episodes("episodes=\"12\"", grid);
    assert_eq!(sums(&twice), [once.clone(), once].concat());
    let seeds: std::collections::HashSet<u32> =
        twice.episodes.iter().map(|episode| episode.seed).collect();
    assert_eq!(seeds.len(), 12);
    let without_one = format!("{grid}<constraint require=\"a + b != 22\"/>");
    assert_eq!(sums(&episodes("", &without_one)), [11.0, 21.0, 12.0, 13.0, 23.0]);
}
