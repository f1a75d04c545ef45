//! Which attempt of a test is next.

/// An attempt of a test that has begun: the next one, or the one that runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cursor {
    /// From 1.
    pub repetition: u32,
    /// At this repetition, from 1.
    pub attempt: u32,
    /// How many attempts of this repetition came after a failure.
    pub retries: u32,
}

impl Cursor {
    /// The first attempt of a test.
    pub const FIRST: Self = Self { repetition: 1, attempt: 1, retries: 0 };

    /// What comes after an attempt; `None` when the test is over.
    pub fn next(self, rerun: bool, repetitions: u32) -> Option<Self> {
        let Self { repetition, attempt, .. } = self;
        if rerun {
            Some(Self { attempt: attempt + 1, ..self })
        } else if repetition < repetitions {
            Some(Self { repetition: repetition + 1, ..Self::FIRST })
        } else {
            None
        }
    }
}
