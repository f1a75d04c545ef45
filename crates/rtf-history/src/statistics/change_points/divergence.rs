//! The split of a series with the highest energy divergence.
//!
//! Source: D. S. Matteson, N. A. James, "A nonparametric approach for multiple change point
//! analysis of multivariate data", Journal of the American Statistical Association 109 (2014),
//! 334–345, equations 5 to 7 with the exponent α = 1.

/// A place where a series can be split in two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    /// The first value after the split, counted from the start of the slice.
    pub index: usize,
    /// The divergence of the values on both sides, in the unit of the values.
    pub divergence: f64,
}

/// The split with the highest divergence between the values before it and a run of values after
/// it. The run may end before the series does, so that a later change does not hide this one. Of
/// equal divergences, the earliest split is taken. `None` for fewer than two values.
///
/// For n values before τ and m in `τ..κ`, the divergence is
/// `2/(n+m)·Σ|before−after| − 2m/((n+m)(n−1))·Σ|before| − 2n/((n+m)(m−1))·Σ|after|`,
/// where the last two are sums of pairs of values on one side.
///
/// Time: O(n²). Memory: O(n).
pub(super) fn best_split(values: &[f64]) -> Option<Split> {
    let end = values.len();
    let pairs = pairs_of_prefixes(values);
    // to_column[k]: the distances of value k to those in `split..k`.
    let mut to_column = vec![0.0; end];
    let mut best: Option<Split> = None;
    // From the end, so that sums only grow: subtraction would lose digits.
    for split in (1..end).rev() {
        let mut pairs_after = 0.0;
        let mut highest = f64::NEG_INFINITY;
        for k in split..end {
            to_column[k] += (values[split] - values[k]).abs();
            pairs_after += to_column[k];
            let across = pairs[k + 1] - pairs[split] - pairs_after;
            let sums = [across, pairs[split], pairs_after];
            highest = highest.max(divergence(sums, split, k + 1 - split));
        }
        if best.is_none_or(|best| highest >= best.divergence) {
            best = Some(Split { index: split, divergence: highest });
        }
    }
    best
}

/// For each length of a prefix, the sum of the distances of all pairs in it.
fn pairs_of_prefixes(values: &[f64]) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for (k, value) in values.iter().enumerate() {
        sum += values[..k].iter().map(|other| (other - value).abs()).sum::<f64>();
        sums.push(sum);
    }
    sums
}

/// The divergence of `before` and `after` values with these sums of distances: across both sides,
/// among the values before, among the values after.
#[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
fn divergence([across, among_before, among_after]: [f64; 3], before: usize, after: usize) -> f64 {
    let (n, m) = (before as f64, after as f64);
    let mut result = across;
    if before > 1 {
        result -= m / (n - 1.0) * among_before;
    }
    if after > 1 {
        result -= n / (m - 1.0) * among_after;
    }
    2.0 / (n + m) * result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition, pair by pair.
    fn by_definition(before: &[f64], after: &[f64]) -> f64 {
        let among = |side: &[f64]| {
            let mut sum = 0.0;
            for (i, a) in side.iter().enumerate() {
                sum += side[..i].iter().map(|b| (a - b).abs()).sum::<f64>();
            }
            sum
        };
        let across =
            before.iter().flat_map(|a| after.iter().map(move |b| (a - b).abs())).sum::<f64>();
        let sums = [across, among(before), among(after)];
        divergence(sums, before.len(), after.len())
    }

    #[test]
    fn sums_equal_the_definition() {
        let values = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0, 5.0, 3.0];
        let mut best = (0, f64::NEG_INFINITY);
        for split in 1..values.len() {
            for end in split + 1..=values.len() {
                let divergence = by_definition(&values[..split], &values[split..end]);
                if divergence > best.1 + 1e-12 {
                    best = (split, divergence);
                }
            }
        }
        let found = best_split(&values).expect("there is a split");
        assert_eq!(found.index, best.0);
        assert!((found.divergence - best.1).abs() < 1e-12);
    }

    #[test]
    fn later_step_does_not_hide_an_earlier_one() {
        let values = [[0.0; 6], [1.0; 6], [0.0; 6]].concat();
        assert_eq!(best_split(&values).expect("a split").index, 6);
    }

    #[test]
    fn one_value_has_no_split() {
        assert_eq!(best_split(&[]), None);
        assert_eq!(best_split(&[1.0]), None);
        assert_eq!(best_split(&[1.0, 1.0]).map(|split| split.index), Some(1));
    }
}
