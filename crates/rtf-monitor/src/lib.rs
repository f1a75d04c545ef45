//! Temporal logic over signals: a formula such as
//! `always(reached -> eventually[0,0.5s](abs(q - goal) < 0.02rad))` is judged while samples arrive,
//! or afterwards. Pure: no I/O, no threads, no clock.
//!
//! - [`Formula`]: the parsed text, its signals, and the check of units.
//! - [`Monitor`]: takes samples and reports the first moment when the formula cannot hold any more.
//! - [`judge`]: the same for complete traces, the reference.
//!
//! `spec/monitors.md` defines the language and its semantics, and names the sources.

mod atom;
mod comparison;
mod component;
mod evaluate;
mod explain;
mod expression;
mod formula;
mod function;
mod judgement;
mod monitor;
mod node;
mod offline;
mod samples;
mod shape;
mod syntax;
mod unit;

pub use formula::{Formula, SignalReference};
pub use judgement::{Outcome, SignalValue, Verdict, Violation};
pub use monitor::{Monitor, MonitorError};
pub use offline::judge;
pub use syntax::ParseError;
pub use unit::UnitError;

#[cfg(test)]
mod random_tests;
