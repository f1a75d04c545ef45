//! The reporters, fed with stored streams of events.

#![expect(clippy::unwrap_used, reason = "a helper that cannot go on fails its test")]

mod background_writer;
mod console;
mod fanout;
mod golden;
mod hosts;
mod journal;
mod junit;
mod logs;
mod markdown;
mod merge;
mod mutate;
mod mutations;
mod otlp;
mod predecessor;
mod streams;
mod support;
