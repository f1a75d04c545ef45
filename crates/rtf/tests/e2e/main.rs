//! End to end: suites and plug-ins in a temporary folder, the real runner and
//! the real hosts → exit code, output, journal.

#![expect(clippy::expect_used, reason = "a helper that cannot go on fails its test")]
#![expect(clippy::print_stdout, reason = "a seed has to be seen")]

mod support;

mod bad_input;
mod bad_libraries;
mod bad_outputs;
mod bad_plugins;
mod bad_suites;
mod chaos;
mod collapse;
mod conformance;
mod cpp_fixture;
mod guard;
mod hooks;
mod inputs;
mod killed;
mod predecessor;
mod process_fixture;
mod reports;
mod signals;
mod verbs;
