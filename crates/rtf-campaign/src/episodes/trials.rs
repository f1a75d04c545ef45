//! The trials of versions: each block of conditions is tried with every version, in a random and
//! balanced order.

use rtf_model::{Episode, Parameter};
use rtf_statistics::RandomStream;

use super::sampler::shuffle;
use super::{EpisodeList, MAX_COMBINATIONS, Resolution};
use crate::Campaign;
use crate::file::Versions;

/// The trials of all blocks. `None` if there are too many, which is reported.
pub(super) fn of_blocks(
    blocks: EpisodeList,
    versions: &Versions,
    (campaign, resolution): (&Campaign, &mut Resolution<'_>),
) -> Option<EpisodeList> {
    let count = versions.values.len();
    if blocks.episodes.len().saturating_mul(count) as u64 > MAX_COMBINATIONS {
        let blocks = blocks.episodes.len();
        let message =
            format!("{blocks} blocks of {count} versions are more than {MAX_COMBINATIONS} trials");
        let problem = resolution.source.error("too-many-trials", versions.span, message);
        resolution.report(problem.hint("choose fewer `episodes`, or fewer versions"));
        return None;
    }
    let mut order = TrialOrder::new(campaign.seed, &versions.parameter.value, count);
    let masked = versions.masked();
    let mut list = EpisodeList::default();
    for (block, condition) in (0..).zip(blocks.episodes) {
        for version in order.block(block) {
            let mut parameters = condition.parameters.clone();
            let value = versions.values.get(version).cloned().unwrap_or_default();
            parameters.push(Parameter { name: versions.parameter.value.clone(), value });
            let id = list.episodes.len() as u64 + 1;
            let (seed, masked) = (condition.seed, masked.clone());
            list.episodes.push(Episode { masked, ..Episode::new(id, seed, parameters) });
        }
    }
    Some(list)
}

/// The order of the versions in blocks.
///
/// Source: E. J. Williams, "Experimental designs balanced for the estimation of residual effects of
/// treatments", Australian Journal of Scientific Research A 2 (1949), 149–168, with random rows and
/// random names of the treatments.
#[derive(Debug)]
pub(super) struct TrialOrder {
    random: RandomStream,
    versions: usize,
    /// The square for which the names and rows are shuffled.
    square: Option<u64>,
    names: Vec<u32>,
    rows: Vec<u32>,
}

impl TrialOrder {
    /// The order for a campaign with this seed, whose parameter `name` has the version.
    pub fn new(seed: u64, name: &str, versions: usize) -> Self {
        let random = RandomStream::new(seed, "order", name);
        let zeros = vec![0; versions];
        Self { random, versions, square: None, names: zeros.clone(), rows: zeros }
    }

    /// The indices of the versions in a block, in the order of its trials. Blocks are numbered
    /// from 0.
    pub fn block(&mut self, block: u64) -> Vec<usize> {
        let count = self.versions as u64;
        let (square, row) = (block / count, block % count);
        let is_reversed = count % 2 == 1 && square % 2 == 1;
        if self.square != Some(square) {
            let first = square - u64::from(is_reversed);
            shuffle(&mut self.names, &mut self.random, 2 * count * first);
            shuffle(&mut self.rows, &mut self.random, 2 * count * square + count);
            self.square = Some(square);
        }
        let at = |list: &[u32], index: usize| list.get(index).map_or(0, |it| *it as usize);
        let shift = usize::try_from(row).map_or(0, |row| at(&self.rows, row));
        let version =
            |position| at(&self.names, (self.first_row(position) + shift) % self.versions);
        let mut order: Vec<_> = (0..self.versions).map(version).collect();
        if is_reversed {
            order.reverse();
        }
        order
    }

    /// 0, 1, *V* − 1, 2, *V* − 2, …
    fn first_row(&self, position: usize) -> usize {
        match position % 2 {
            1 => position.div_ceil(2),
            _ => (self.versions - position / 2) % self.versions,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orders(seed: u64, versions: usize, blocks: u64) -> Vec<Vec<usize>> {
        let mut order = TrialOrder::new(seed, "policy", versions);
        (0..blocks).map(|block| order.block(block)).collect()
    }

    /// How often each version is at each position.
    fn positions(orders: &[Vec<usize>]) -> Vec<Vec<usize>> {
        let versions = orders.first().map_or(0, Vec::len);
        let mut counts = vec![vec![0; versions]; versions];
        for (position, version) in orders.iter().flat_map(|order| order.iter().enumerate()) {
            counts[*version][position] += 1;
        }
        counts
    }

    #[test]
    fn each_version_is_at_each_position_equally_often() {
        for versions in 2..=6 {
            for (seed, blocks) in (0..20).flat_map(|seed| (1..=25).map(move |it| (seed, it))) {
                let orders = orders(seed, versions, blocks);
                for order in &orders {
                    let mut sorted = order.clone();
                    sorted.sort_unstable();
                    assert_eq!(sorted, (0..versions).collect::<Vec<_>>(), "a complete block");
                }
                let counts: Vec<_> = positions(&orders).into_iter().flatten().collect();
                let (least, most) = (counts.iter().min(), counts.iter().max());
                let spread = most.zip(least).map(|(most, least)| most - least);
                let expected = usize::from(blocks % versions as u64 != 0);
                assert_eq!(spread, Some(expected), "{versions} versions, {blocks} blocks");
            }
        }
    }

    #[test]
    fn each_version_follows_each_other_one_equally_often() {
        for versions in 2..=6 {
            let squares = if versions % 2 == 1 { 2 } else { 1 };
            let blocks = 3 * squares * versions as u64;
            let mut counts = vec![0; versions * versions];
            for order in orders(11, versions, blocks) {
                order.windows(2).for_each(|pair| counts[pair[0] * versions + pair[1]] += 1);
            }
            for (index, count) in counts.into_iter().enumerate() {
                let is_itself = index / versions == index % versions;
                let expected = if is_itself { 0 } else { 3 * squares };
                assert_eq!(count, expected, "{versions} versions, pair {index}");
            }
        }
    }

    /// Anderson's statistic of 1959 of a table of ranks, (V − 1)/V·X²: with random orders, it is
    /// above the quantile of 0.9999 in one of 10 000 sets of seeds.
    #[test]
    fn positions_do_not_depend_on_versions() {
        // χ² with (V − 1)² degrees of freedom: R, `qchisq(0.9999, (V-1)^2)`.
        for (versions, limit) in [(2_usize, 15.137), (3, 23.513), (4, 33.720), (5, 45.925)] {
            for block in [0, 1, 2, 6] {
                let seeds = 3000_u32;
                let chosen: Vec<_> = (0..seeds)
                    .map(|seed| TrialOrder::new(seed.into(), "policy", versions).block(block))
                    .collect();
                let expected = f64::from(seeds) / f64::from(u32::try_from(versions).unwrap());
                let square = |count: usize| {
                    let count = f64::from(u32::try_from(count).unwrap());
                    (count - expected).powi(2) / expected
                };
                let x2: f64 = positions(&chosen).into_iter().flatten().map(square).sum();
                let x2 = x2 * (1.0 - 1.0 / f64::from(u32::try_from(versions).unwrap()));
                assert!(x2 < limit, "{versions} versions, block {block}: {x2}");
                assert!(x2 > 0.0, "orders differ between seeds");
            }
        }
    }

    #[test]
    fn the_order_is_a_function_of_the_seed_and_the_name() {
        assert_eq!(orders(7, 3, 20), orders(7, 3, 20));
        assert_ne!(orders(7, 3, 20), orders(8, 3, 20));
        // Also if blocks are asked for in any order.
        let mut order = TrialOrder::new(7, "policy", 3);
        assert_eq!(order.block(9), orders(7, 3, 20)[9]);
        assert_eq!(order.block(2), orders(7, 3, 20)[2]);
    }
}
