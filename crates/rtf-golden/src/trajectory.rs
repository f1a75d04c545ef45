//! A trajectory: a function of time, linear between its points.

/// Times start at 0 and increase; values are finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    points: Vec<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TrajectoryError {
    #[error("it has no samples")]
    Empty,
    #[error("the value at {0} s is not finite")]
    NotFinite(f64),
    #[error("the time {0} s is not after the one before")]
    NotIncreasing(f64),
}

/// The difference from a reference at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The time since the start of the trajectory, in seconds.
    pub time: f64,
    pub got: f64,
    pub expected: f64,
}

impl Deviation {
    /// The distance of both values.
    #[must_use]
    pub fn size(&self) -> f64 {
        (self.got - self.expected).abs()
    }
}

/// The values of the reference that are aligned with a time of the trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aligned {
    /// The time since the start of the trajectory, in seconds.
    pub time: f64,
    pub low: f64,
    pub high: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The root of the mean squared difference.
    pub rms: f64,
    /// The largest difference; the first of several.
    pub worst: Deviation,
    pub aligned: Vec<Aligned>,
}

impl Comparison {
    /// Keeps the larger of two deviations.
    pub(crate) fn worse(worst: Option<Deviation>, other: Deviation) -> Option<Deviation> {
        match worst {
            Some(worst) if worst.size() >= other.size() => Some(worst),
            _ => Some(other),
        }
    }
}

impl Trajectory {
    /// Creates a trajectory from times and values. It starts at its first point.
    ///
    /// # Errors
    /// There is no point, one is not finite, or the times do not increase.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, TrajectoryError> {
        let Some((origin, _)) = points.first().copied() else { return Err(TrajectoryError::Empty) };
        let mut shifted: Vec<(f64, f64)> = Vec::with_capacity(points.len());
        for (time, value) in points {
            if !time.is_finite() || !value.is_finite() {
                return Err(TrajectoryError::NotFinite(*time));
            }
            let since = time - origin;
            if shifted.last().is_some_and(|(last, _)| since <= *last) {
                return Err(TrajectoryError::NotIncreasing(*time));
            }
            shifted.push((since, *value));
        }
        Ok(Self { points: shifted })
    }

    #[must_use]
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// The time of the last point.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.points.last().map_or(0.0, |(time, _)| *time)
    }

    /// The value at a time; before the start and after the end that of the nearest point.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        let next = self.points.partition_point(|(at, _)| *at < time);
        let after = self.points.get(next);
        let before = next.checked_sub(1).and_then(|index| self.points.get(index));
        match (before, after) {
            (Some((from, low)), Some((to, high))) => {
                let part = (time - from) / (to - from);
                // Exact at both ends.
                low * (1.0 - part) + high * part
            }
            (Some((_, value)), None) | (None, Some((_, value))) => *value,
            (None, None) => 0.0,
        }
    }

    /// The values at `count` times with this distance.
    #[must_use]
    pub fn resampled(&self, step: f64, count: usize) -> Vec<f64> {
        (0..count).map(|index| self.at(step * index as f64)).collect()
    }
}
