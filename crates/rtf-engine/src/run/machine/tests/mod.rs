//! The state machine with invented times: no processes, no sleeps.

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
pub(crate) mod world;
