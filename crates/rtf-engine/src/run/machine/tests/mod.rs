//! The state machine with invented times: no processes, no sleeps.

mod attached;
mod carried_cases;
mod case_selection;
mod cases;
mod cases_in_programs;
mod chaos;
mod clock;
mod collapse;
mod dependencies;
mod episodes;
mod faults;
mod findings;
mod hooks;
mod limits;
mod parallel;
mod preparation;
mod questions;
mod retries;
mod sequence;
mod shared;
mod soak;
mod stop_and_skip;
mod stopped_trees;
mod subscriptions;
mod unkillable;
mod unresponsive;
pub(crate) mod world;
