//! The reporters, fed with stored streams of events.

#![expect(clippy::unwrap_used, reason = "a helper that cannot go on fails its test")]

mod console;
mod fanout;
mod journal;
mod junit;
mod logs;
mod streams;
mod support;
