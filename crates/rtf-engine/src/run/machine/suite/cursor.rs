//! Which attempt of which test is next.

/// The test that is next, or runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor {
    /// Its place in the plan.
    pub test: usize,
    /// From 1.
    pub repetition: u32,
    /// At this repetition, from 1.
    pub attempt: u32,
    /// How many attempts of this repetition came after a failure.
    pub retries: u32,
}

impl Cursor {
    /// The first attempt of a test.
    pub fn at(test: usize) -> Self {
        Self { test, repetition: 1, attempt: 1, retries: 0 }
    }

    /// What comes after an attempt.
    pub fn next(self, rerun: bool, repetitions: u32) -> Self {
        let Self { test, repetition, attempt, .. } = self;
        if rerun {
            Self { attempt: attempt + 1, ..self }
        } else if repetition < repetitions {
            Self { test, repetition: repetition + 1, attempt: 1, retries: 0 }
        } else {
            Self::at(test + 1)
        }
    }
}
