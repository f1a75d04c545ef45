//! Streams of events: which are legal, and what is known after them.

mod cases;
mod concurrency;
mod episodes;
mod faults;
mod fixtures;
mod hooks;
mod order;
mod questions;
mod record;
mod reports;
mod samples;
mod shared_hosts;
mod support;
mod verdicts;
mod views;
