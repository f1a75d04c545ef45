//! Why runs cannot be merged.

use rtf_model::{Damage, OrderError};

use crate::journal::JournalError;

/// Why runs cannot be merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeProblem {
    #[error(transparent)]
    Unreadable(#[from] JournalError),
    #[error("the journal of `{run}` is damaged: {damage}")]
    Damaged {
        run: String,
        /// The first damage.
        damage: Damage,
    },
    #[error("`{run}` is still running")]
    Running { run: String },
    /// A journal does not begin with `run-started`.
    #[error("the journal of `{run}` has no beginning")]
    NoBeginning { run: String },
    #[error("the journal of `{run}` is not in order")]
    Order {
        run: String,
        /// Where, and which rule.
        #[source]
        source: OrderError,
    },
    #[error("test `{test}` is in `{first}` and in `{second}`")]
    Twice {
        /// The test, with its suite.
        test: String,
        first: String,
        second: String,
    },
    /// A run of episodes is there twice.
    #[error("`{first}` and `{second}` are the same run")]
    SameRun { first: String, second: String },
    /// Some parts of a division are not among the runs.
    #[error("not all of {of} parts are there: {} missing", list(parts, *of))]
    Missing { parts: Vec<u32>, of: u32 },
}

fn list(parts: &[u32], of: u32) -> String {
    let words: Vec<_> = parts.iter().map(|part| format!("{part}/{of}")).collect();
    let verb = if words.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", words.join(", "))
}
