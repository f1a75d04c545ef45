//! End to end: suites and plug-ins in a temporary directory, the real runner and the real hosts →
//! exit code, output, journal.

#![expect(clippy::expect_used, reason = "a helper that cannot go on fails its test")]
#![expect(clippy::print_stdout, reason = "a seed has to be seen")]

mod support;

mod ada;
mod attached_fixtures;
mod attachments;
mod bad_command_lines;
mod bad_input;
mod bad_libraries;
mod bad_outputs;
mod bad_plugins;
mod bad_suites;
mod blocked_console;
mod campaign;
mod campaign_search;
mod case_selection;
mod cases;
mod chaos;
mod chaos_hosts;
mod ci_formats;
mod clock;
mod closed_terminal;
mod collapse;
mod collapse_at_test_end;
mod conformance;
mod cpp_fixture;
mod damaged_journals;
mod doctor;
mod documented;
mod faults;
mod fixture_values;
mod forked_children;
mod forked_hosts;
mod framework_programs;
mod golden;
mod guard;
mod history;
mod history_campaigns;
mod history_failures;
mod history_gate;
mod history_order;
mod hooks;
mod host_modes;
mod hostile_fixtures;
mod init;
mod isolation;
mod killed_runner;
mod known_failures;
mod learned_limits;
mod listed_cases;
mod locks;
mod lost_results;
mod matrix;
mod merge;
mod middleware;
#[path = "../../../rtf-report/tests/reports/mutate.rs"]
mod mutate;
mod new_projects;
mod output_before_crash;
mod parallel_suites;
mod parallel_tests;
mod predecessor_defects;
mod predecessor_scripts;
mod process_fixture;
mod profile_mistakes;
mod profiles;
mod python_exit;
mod remote;
mod repetition;
mod replay;
mod reports;
mod rerun;
mod resources;
mod run_inputs;
mod scarce_resources;
mod sdk_dirs;
mod security;
mod selection;
mod shared_hosts;
mod shown_parts;
mod signals;
mod stopped_runner;
mod test_notifications;
mod testrunner;
mod testrunner_defects;
mod unprivileged_isolation;
mod verbs;
mod watch;
mod watched_signals;
mod web;
#[path = "../../../rtf-web/tests/server/client.rs"]
mod web_client;
mod web_limits;
