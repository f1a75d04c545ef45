//! End to end: suites and plug-ins in a temporary folder, the real runner and
//! the real hosts → exit code, output, journal.

#![expect(clippy::expect_used, reason = "a helper that cannot go on fails its test")]
#![expect(clippy::print_stdout, reason = "a seed has to be seen")]

mod support;

mod ada;
mod attached;
mod attachments;
mod bad_input;
mod bad_libraries;
mod bad_outputs;
mod bad_plugins;
mod bad_suites;
mod blocked_console;
mod chaos;
mod chaos_hosts;
mod choosing;
mod clock;
mod closed_terminal;
mod code_hosts;
mod collapse;
mod command_lines;
mod conformance;
mod cpp_fixture;
mod damaged;
mod doctor;
mod documented;
mod everything_at_once;
mod forked_children;
mod forks;
mod guard;
mod hooks;
mod hostile_fixtures;
mod inputs;
mod isolation;
mod killed;
mod last_moment;
mod locks;
mod merge;
mod middleware;
mod modes;
#[path = "../../../rtf-report/tests/reports/mutate.rs"]
mod mutate;
mod notices;
mod output_before_crash;
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
mod resources;
mod shared;
mod side_by_side;
mod signals;
mod stopped;
mod testrunner;
mod testrunner_truth;
mod unprivileged;
mod vanished;
mod verbs;
mod watch;
mod web;
#[path = "../../../rtf-web/tests/server/client.rs"]
mod web_client;
mod web_limits;
