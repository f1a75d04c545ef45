//! Which runs and tests a question is about.

use rtf_history::RunSelection;
use rtf_run::error::Failure;
use rtf_run::history::TestFilter;
use rtf_run::history::time::parse_since;

use crate::cli::{ResultSelectArgs, RunSelectArgs};

/// Resolves the options that select runs.
pub fn runs(args: &RunSelectArgs) -> Result<RunSelection, Failure> {
    Ok(RunSelection {
        branch: args.branch.clone(),
        commit: args.commit.clone(),
        robot: None,
        profile: args.profile.clone(),
        host: args.host.clone(),
        since: args.since.as_deref().map(parse_since).transpose()?,
        last: args.last,
        ids: None,
    })
}

/// Resolves the options that select results.
pub fn results(args: &ResultSelectArgs) -> Result<(RunSelection, TestFilter), Failure> {
    let runs = RunSelection { robot: args.robot.clone(), ..runs(&args.runs)? };
    Ok((runs, TestFilter::parse(&args.filters)?))
}
