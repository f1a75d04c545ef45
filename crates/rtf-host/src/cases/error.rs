//! Calls about cases and episodes that are not allowed.

/// Why a call has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum CaseError {
    #[error("cases are allowed in `run` only")]
    OutsideRun,
    #[error("cases are planned in `setup` and `run` only")]
    PlannedElsewhere,
    #[error("`skip` is allowed in `setup` and `run` only")]
    SkippedElsewhere,
    #[error("the names or parameters of cases are longer than a line of the protocol")]
    TooLong,
    #[error("a case was finished on a thread that has no open case")]
    NotOpen,
    #[error("in a test with slots, a case is part of an episode: enter one before it")]
    OutsideEpisode,
    #[error("the test has no `slots` in its suite, so it gets no episodes")]
    NoSlots,
    #[error("no slot is free: all {0} have an open episode. Finish one before you take another")]
    NoFreeSlot(u32),
    #[error("episodes are taken and finished in `run` only")]
    EpisodeOutsideRun,
    #[error("a process that the plug-in forked cannot take episodes")]
    ForkedEpisode,
    #[error("episode {0} is not open: it has finished already, or the test has not taken it")]
    EpisodeNotOpen(u64),
    #[error("episode {0} is not the innermost one of the thread that leaves it")]
    EpisodeNotInnermost(u64),
    #[error("episode {0} cannot finish: another thread has entered it")]
    EpisodeEntered(u64),
    #[error("episode {0} cannot finish: a case in it is open")]
    EpisodeHasCase(u64),
    #[error("the first observation of episode {0} has {1} characters, expected at most 64: a hash")]
    LongObservation(u64, usize),
}
