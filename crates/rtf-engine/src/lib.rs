//! Loads suites, plans runs, and runs them.
//!
//! [`suite`] turns text into what was written, [`plan`] turns that into what
//! will be done and finds every problem before a process starts, and [`run`]
//! does it: a state machine without I/O or clock, with one task around it.
//! [`host`] is how processes are started, spoken to, and ended.

pub mod host;
pub mod plan;
pub mod run;
pub mod signal;
pub mod suite;
