//! The state machine with invented times: no processes, no sleeps.

mod abandoned;
mod attached;
mod chaos;
mod clock;
mod collapse;
mod control;
mod flow;
mod graph;
mod hooks;
mod limits;
mod notices;
mod parallel;
mod prepared;
mod retries;
mod rounds;
mod shared;
mod silence;
pub(crate) mod world;
