//! Windows in which no split can pass the t-test: most of a series without changes.

use statrs::function::erf::erfc_inv;

/// A part of the variation of a window that is rounding errors if it is smaller, relative to the
/// largest value.
const RESOLUTION: f64 = 1e-9;

/// A condition that every window with a change fulfils. It takes O(n), the search for the best
/// split O(n²).
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    /// Below this t², no split passes.
    min_t_squared: f64,
}

impl Screen {
    /// The screen for t-tests with this limit.
    ///
    /// For the same value of t, the normal distribution has a smaller p value than Student's: his
    /// t is a normal number divided by the root of S = χ²/ν, whose mean is 1, and the normal tail
    /// is convex as a function of S (J. L. W. V. Jensen's inequality). The limit is doubled
    /// because sums are rounded.
    pub fn new(max_p: f64) -> Self {
        let z = std::f64::consts::SQRT_2 * erfc_inv((2.0 * max_p).min(1.0));
        Self { min_t_squared: z * z }
    }

    /// Whether a split of the window might pass. Never `false` for one that does.
    #[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
    pub fn may_split(&self, window: &[f64]) -> bool {
        let n = window.len() as f64;
        let mean = window.iter().sum::<f64>() / n;
        let (mut total, mut largest, mut sum, mut explained) = (0.0, 0.0_f64, 0.0, 0.0_f64);
        for (value, before) in window.iter().zip(1_u32..) {
            let (deviation, before) = (value - mean, f64::from(before));
            total += deviation * deviation;
            largest = largest.max(value.abs());
            sum += deviation;
            // The last one, with nothing after it, is infinite or NaN.
            if before < n {
                explained = explained.max(sum * sum * n / (before * (n - before)));
            }
        }
        if total <= n * (RESOLUTION * largest).powi(2) {
            return true;
        }
        // t² = (n − 2) · explained / (total − explained)
        (n - 2.0) * explained >= self.min_t_squared * (total - explained)
    }
}

#[cfg(test)]
mod tests {
    use super::super::t_test::{Segment, p_value};
    use super::*;
    use proptest::prelude::*;

    fn passes(window: &[f64], max_p: f64) -> bool {
        (1..window.len()).any(|split| {
            let (before, after) = window.split_at(split);
            p_value(&Segment::of(before), &Segment::of(after)) <= max_p
        })
    }

    #[test]
    fn noise_is_screened_out_and_a_step_is_not() {
        let screen = Screen::new(1e-5);
        let noise = [0.1, 0.9, 0.4, 0.6, 0.2, 0.8, 0.5, 0.3, 0.7, 0.5];
        assert!(!screen.may_split(&noise));
        let step: Vec<f64> =
            noise.iter().map(|v| v / 10.0).chain(noise.map(|v| v / 10.0 + 0.9)).collect();
        assert!(screen.may_split(&step));
        assert!(passes(&step, 1e-5) && !passes(&noise, 1e-5));
    }

    #[test]
    fn equal_values_are_not_screened_out() {
        assert!(Screen::new(1e-5).may_split(&[0.3; 20]));
        assert!(Screen::new(1e-5).may_split(&[]));
    }

    proptest! {
        #[test]
        fn no_window_with_a_change_is_screened_out(
            noise in prop::collection::vec(0.0..1.0_f64, 2..60),
            split in 0.0..1.0_f64,
            step in 0.0..2.0_f64,
            max_p in prop::sample::select(vec![1e-7, 1e-5, 1e-3, 0.01, 0.3, 1.0]),
        ) {
            let at = (split * noise.len() as f64) as usize;
            let mut window = noise;
            window[at..].iter_mut().for_each(|value| *value += step);
            prop_assert!(!passes(&window, max_p) || Screen::new(max_p).may_split(&window));
        }
    }
}
