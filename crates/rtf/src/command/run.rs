//! `rtf run`.

use clap::ArgMatches;
use rtf_run::pipeline;

use super::{VerbResult, list};
use crate::cli::{ListFormat, RunVerbArgs};
use crate::request::local_run::LocalRun;
use crate::request::run::{self, RunVerbRequest};

/// Runs tests, here or in a cluster.
pub fn run(args: RunVerbArgs, matches: &ArgMatches) -> VerbResult {
    match run::resolve(args, matches)? {
        RunVerbRequest::Local(run) => {
            let LocalRun { invocation, is_dry_run, source } = *run;
            let show: Option<fn(&_) -> _> =
                is_dry_run.then_some(|planned| list::print(planned, ListFormat::Text, false));
            pipeline::run(invocation, || source.resolve(), show)
        }
        RunVerbRequest::Submission(new) => rtf_executor::run(new.options, new.tests, &new.collect),
        RunVerbRequest::Resumed(submission, collect) => {
            rtf_executor::supervise(&submission, &collect)
        }
    }
}
