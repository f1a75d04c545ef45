//! The state machine with invented times: no processes, no sleeps.

mod chaos;
mod collapse;
mod flow;
mod graph;
mod hooks;
mod limits;
mod world;
