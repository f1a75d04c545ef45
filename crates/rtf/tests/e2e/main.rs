//! End to end: suites and plug-ins in a temporary folder, the real runner and
//! the real hosts → exit code, output, journal.

#![expect(clippy::expect_used, reason = "a helper that cannot go on fails its test")]
#![expect(clippy::print_stdout, reason = "a seed has to be seen")]

mod support;

mod ada;
mod attached;
mod bad_input;
mod bad_libraries;
mod bad_outputs;
mod bad_plugins;
mod bad_suites;
mod chaos;
mod chaos_hosts;
mod choosing;
mod clock;
mod code_hosts;
mod collapse;
mod command_lines;
mod conformance;
mod cpp_fixture;
mod doctor;
mod documented;
mod forks;
mod guard;
mod hooks;
mod hostile_fixtures;
mod inputs;
mod isolation;
mod killed;
mod locks;
mod merge;
mod middleware;
mod modes;
mod notices;
mod parallel;
mod predecessor;
mod predecessor_scripts;
mod process_fixture;
mod profile_mistakes;
mod profiles;
mod python_ends;
mod remote;
mod repeating;
mod reports;
mod rerun;
mod shared;
mod side_by_side;
mod signals;
mod testrunner;
mod testrunner_truth;
mod unprivileged;
mod verbs;
mod watch;
mod web;
#[path = "../../../rtf-web/tests/server/client.rs"]
mod web_client;
