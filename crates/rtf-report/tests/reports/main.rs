//! The reporters, fed with stored streams of events.

mod console;
mod fanout;
mod journal;
mod junit;
mod logs;
mod streams;
mod support;
