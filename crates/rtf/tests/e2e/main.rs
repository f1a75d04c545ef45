//! End to end: suites and plug-ins in a temporary folder, the real runner and
//! the real hosts → exit code, output, journal.

mod support;

mod bad_input;
mod collapse;
mod conformance;
mod cpp_fixture;
mod killed;
mod predecessor;
mod process_fixture;
mod reports;
mod signals;
