//! `rtf check`: reports every problem of suites and plug-ins.

use std::path::Path;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_plan::plan::TestPlan;
use rtf_plan::suite::is_campaign_file;
use rtf_run::diagnostics::count;
use rtf_run::{campaign, plan, terminal};

use super::VerbResult;
use crate::cli::InputArgs;
use crate::request::{self, config};

/// Checks a campaign and its suite.
fn check_campaign(file: &Path, args: &InputArgs) -> VerbResult {
    let loaded = campaign::load(file)?;
    loaded.print_warnings()?;
    let mut request = request::tests_of_suite(&loaded.suite, &args.profile)?;
    let episodes = loaded.episodes.episodes;
    let count = count(episodes.len(), "episode");
    request.set_episodes(loaded.suite, episodes);
    plan::plan(&request)?.print_warnings()?;
    terminal::stdout(|out| writeln!(out, "1 campaign, {count}: no errors"))?;
    Ok(ExitCode::SUCCESS)
}

/// Checks suites and plug-ins.
pub fn run(mut args: InputArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_results(&mut args, matches)?;
    if let [file] = args.inputs.as_slice()
        && is_campaign_file(file)
    {
        return check_campaign(file, &args);
    }
    let request = request::tests(&args)?;
    let planned = plan::plan(&request)?;
    planned.print_warnings()?;
    let plan = &planned.plan;
    let mut summary = format!(
        "{}, {}, {}",
        count(plan.suites.len(), "suite"),
        count(plan.fixtures as usize, "fixture"),
        count(plan.tests as usize, "test"),
    );
    let tests = plan.suites.iter().flat_map(|suite| &suite.tests);
    let cases: Vec<_> = tests.filter_map(TestPlan::known_cases).collect();
    if !cases.is_empty() {
        summary += &format!(", {}", count(cases.iter().map(Vec::len).sum(), "case"));
    }
    summary += ": no errors";
    if !planned.warnings.is_empty() {
        summary += &format!(", {}", count(planned.warnings.len(), "warning"));
    }
    terminal::stdout(|out| writeln!(out, "{summary}"))?;
    Ok(ExitCode::SUCCESS)
}
