//! Results of episodes that another program ran: `spec/campaign.md` has both formats.

mod csv;
mod lerobot;

use thiserror::Error;

pub use self::csv::read as read_csv;
pub use lerobot::read as read_lerobot;

/// Why a file has no results.
#[derive(Debug, Error)]
#[error("{kind}")]
pub struct ResultsProblem {
    /// The line, from 1.
    pub line: u64,
    pub kind: ResultsProblemKind,
}

#[derive(Debug, Error)]
pub enum ResultsProblemKind {
    #[error("not a CSV file: {0}")]
    NotCsv(String),
    #[error("the header has no column {0}")]
    MissingColumn(&'static str),
    #[error("the header has the column `{0}` twice")]
    RepeatedColumn(String),
    #[error("the header has both `outcome` and `success`")]
    BothResults,
    #[error("the row has {found} of {expected} columns")]
    Ragged { found: usize, expected: usize },
    #[error("`{found}` in the column `{column}`, expected {expected}")]
    InvalidValue { column: &'static str, found: String, expected: &'static str },
    #[error("episode {0} occurs twice")]
    RepeatedEpisode(u64),
    #[error("there are no episodes")]
    NoEpisodes,
    #[error("not the results of LeRobot: {0}")]
    NotLeRobot(String),
    #[error("expected `per_episode` or `per_task`, which LeRobot writes")]
    NoEvaluation,
}

impl ResultsProblemKind {
    /// What to do.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        match self {
            Self::NotLeRobot(_) | Self::NoEvaluation => {
                "`lerobot-eval` writes `eval_info.json`; other results can be a CSV file"
            }
            Self::RepeatedEpisode(_) => "each row is one episode, with a separate number",
            Self::NoEpisodes => "each episode is a row below the header",
            _ => {
                "the header has `episode`, `outcome` or `success`, and optionally `seed`: \
                 episode,seed,outcome"
            }
        }
    }

    fn at(self, line: u64) -> ResultsProblem {
        ResultsProblem { line, kind: self }
    }
}
