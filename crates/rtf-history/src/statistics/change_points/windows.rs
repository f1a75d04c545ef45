//! Weak points: splits of windows that move over the series.

use std::ops::Range;

use super::divergence::best_split;
use super::screen::Screen;
use super::t_test::{Segment, p_value};
use super::{Options, position_of_max};

/// The factor of the limit for weak points.
const WEAK: f64 = 10.0;

/// Where a change is possible, in order and without duplicates: a window starts at the last point
/// of the previous one or after it.
pub(super) fn weak_points(values: &[f64], options: &Options) -> Vec<usize> {
    let length = options.window.max(2);
    let max_p = (WEAK * options.max_p(values.len())).min(1.0);
    let windows = Windows { values, scaled: scaled(values), max_p, screen: Screen::new(max_p) };
    let mut points = Vec::new();
    let mut start = 0;
    while start < values.len() {
        let window = start..values.len().min(start.saturating_add(length));
        let may_change = windows.screen.may_split(&windows.scaled[window.clone()]);
        let found = if may_change { windows.split(window) } else { Vec::new() };
        start = (start + length / 2).max(found.last().copied().unwrap_or(0));
        points.extend(found);
    }
    points
}

/// The values between 0 and 1, so that distances of large values do not overflow.
fn scaled(values: &[f64]) -> Vec<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let range = high - low;
    let scale = |value: &f64| {
        if range.is_finite() {
            (value - low) / range
        } else {
            (value / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0)
        }
    };
    if range > 0.0 { values.iter().map(scale).collect() } else { vec![0.0; values.len()] }
}

struct Windows<'a> {
    values: &'a [f64],
    scaled: Vec<f64>,
    max_p: f64,
    screen: Screen,
}

/// The best split of a part of a window.
#[derive(Clone, Debug)]
struct Candidate {
    part: Range<usize>,
    index: usize,
    divergence: f64,
}

impl Windows<'_> {
    /// Splits a window as long as the split with the highest divergence passes the t-test.
    fn split(&self, window: Range<usize>) -> Vec<usize> {
        let mut candidates: Vec<Candidate> = self.candidate(window).into_iter().collect();
        let mut points = Vec::new();
        // The first of equals: the candidates are in the order of the series.
        while let Some(best) = position_of_max(&candidates, |c| c.divergence) {
            let Candidate { part, index, .. } = candidates[best].clone();
            let before = Segment::of(&self.values[part.start..index]);
            let after = Segment::of(&self.values[index..part.end]);
            if p_value(&before, &after) > self.max_p {
                break;
            }
            points.push(index);
            let parts = [part.start..index, index..part.end];
            let parts = parts.into_iter().filter_map(|part| self.candidate(part));
            candidates.splice(best..=best, parts);
        }
        points.sort_unstable();
        points
    }

    fn candidate(&self, part: Range<usize>) -> Option<Candidate> {
        let split = best_split(&self.scaled[part.clone()])?;
        Some(Candidate { index: part.start + split.index, divergence: split.divergence, part })
    }
}
