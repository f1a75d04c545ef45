//! Input paths → plans, in directories with shell scripts as hosts.

#![expect(clippy::unwrap_used, reason = "that is where a test ends")]

mod bench;
mod clock;
mod depends;
mod envelopes;
mod episode_tests;
mod faults;
mod fixture_values;
mod frameworks;
mod hints;
mod hooks;
mod inputs;
mod isolation;
mod known_failures;
mod listed_cases;
mod matrix;
mod named_cases;
mod plugins;
mod predecessor;
mod select;
mod signals;
mod suites;
