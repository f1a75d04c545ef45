//! Results over time: `spec/history.md`.

pub mod statistics;
