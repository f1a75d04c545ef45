//! Why runs cannot be merged.

use rtf_model::{Damage, OrderError};

use crate::journal::JournalError;

/// Why runs cannot be merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeProblem {
    /// A journal cannot be read.
    #[error(transparent)]
    Unreadable(#[from] JournalError),
    /// A journal is damaged.
    #[error("the journal of `{run}` is damaged: {damage}")]
    Damaged {
        /// Whose.
        run: String,
        /// The first damage.
        damage: Damage,
    },
    /// A run has not ended.
    #[error("`{run}` is still running")]
    Running {
        /// Which.
        run: String,
    },
    /// A journal does not begin with `run-started`.
    #[error("the journal of `{run}` has no beginning")]
    NoBeginning {
        /// Whose.
        run: String,
    },
    /// A journal breaks the order of events.
    #[error("the journal of `{run}` is not in order")]
    Order {
        /// Whose.
        run: String,
        /// Where, and which rule.
        #[source]
        source: OrderError,
    },
    /// Two runs have one test.
    #[error("test `{test}` is in `{first}` and in `{second}`")]
    Twice {
        /// The test, with its suite.
        test: String,
        /// The run that has it first.
        first: String,
        /// The other one.
        second: String,
    },
    /// A run of episodes is there twice.
    #[error("`{first}` and `{second}` are the same run")]
    SameRun {
        first: String,
        /// The other one.
        second: String,
    },
    /// Some parts of a division are not among the runs.
    #[error("not all of {of} parts are there: {} missing", list(parts, *of))]
    Missing {
        /// Their numbers.
        parts: Vec<u32>,
        /// Of how many.
        of: u32,
    },
}

fn list(parts: &[u32], of: u32) -> String {
    let words: Vec<_> = parts.iter().map(|part| format!("{part}/{of}")).collect();
    let verb = if words.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", words.join(", "))
}
