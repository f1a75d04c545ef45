//! Several claims at once: p values that bound the probability of any wrong one.

/// Adjusts p values for their number, in the same order: if all claims with an adjusted p value
/// of at most α are made, one of them is wrong with a probability of at most α, however the tests
/// depend on each other.
///
/// Source: S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian
/// Journal of Statistics 6 (1979), 65–70.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "numbers of claims are far below 2^53")]
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|a, b| p_values[*a].total_cmp(&p_values[*b]));
    let mut adjusted = vec![1.0; p_values.len()];
    let mut largest = 0.0_f64;
    for (rank, index) in order.into_iter().enumerate() {
        let remaining = (p_values.len() - rank) as f64;
        largest = largest.max((p_values[index] * remaining).min(1.0));
        adjusted[index] = largest;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_value_is_multiplied_by_the_number_of_larger_ones() {
        assert_eq!(holm(&[0.5, 0.0625, 0.25]), [0.5, 0.1875, 0.5]);
        assert_eq!(holm(&[0.03125]), [0.03125]);
        assert_eq!(holm(&[0.75, 0.75]), [1.0, 1.0]);
        assert!(holm(&[]).is_empty());
    }
}
