//! `rtf campaign invariance`: whether results depend on how the episodes are run.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_campaign::comparison::ComparedEpisode;
use rtf_campaign::file::{Goal, StoppingRule};
use rtf_campaign::invariance::{Cause, Invariance, Variation, VariationResult, judge};
use rtf_campaign::{Campaign, Ledger};
use rtf_coordinator::coordinator::Coordinator;
use rtf_coordinator::pool::LocalPool;
use rtf_coordinator::summary::EarlyEnd;
use rtf_coordinator::worker::Answers;
use rtf_engine::signal::SignalListener;
use rtf_plan::suite::Spanned;
use rtf_report::{escape, format_p_value};
use rtf_run::campaign::directory::{CampaignDir, Description};
use rtf_run::campaign::version::LoadedVersion;
use rtf_run::campaign::{self, LoadedCampaign};
use rtf_run::diagnostics::count;
use rtf_run::error::Failure;
use rtf_run::{exit, terminal};
use serde_json::json;

use super::run::describe;
use crate::cli::{CampaignFormat, CampaignInvarianceArgs};
use crate::command::VerbResult;
use crate::request::config;

/// The variable by which the SDK's adapter for vector environments uses its other mode.
const MODE: &str = "RTF_VECTOR_MODE";
/// Enough confidence for a claim that no caller reads.
const CONFIDENCE: f64 = 0.95;

/// Runs the episodes in several ways, and compares the results.
pub fn run(mut args: CampaignInvarianceArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let mut loaded = campaign::load(&args.file)?;
    loaded.print_warnings()?;
    loaded.episodes.episodes.truncate(args.episodes as usize);
    let (description, plan) = describe(&loaded, &args.file, &args.profile, args.slots)?;
    let tests = plan.suites.iter().flat_map(|suite| &suite.tests);
    let has_slots = tests.into_iter().any(|test| test.slots.is_some());
    let all = complete(&loaded.campaign);
    let mut lab = Lab {
        args: &args,
        loaded: &loaded,
        campaign: &all,
        description,
        has_slots,
        runs: Vec::new(),
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let found = runtime.map_err(Failure::internal)?.block_on(lab.vary())?;
    let found = match found {
        Ok(found) => found,
        Err(signal) => return Ok(ExitCode::from(exit::of_signal(signal))),
    };
    if args.format == CampaignFormat::Json {
        let directories = lab.runs.iter().map(|(name, path)| json!({ "run": name, "path": path }));
        let document = json!({
            "name": loaded.name,
            "invariance": found,
            "directories": directories.collect::<Vec<_>>(),
        });
        let text = serde_json::to_string_pretty(&document).map_err(Failure::internal)?;
        terminal::stdout(|out| writeln!(out, "{text}"))?;
    } else {
        terminal::stdout(|out| print(out, &found))?;
    }
    Ok(ExitCode::from(if found.any_change() { exit::FAILED } else { exit::PASSED }))
}

/// The campaign without what could end it early.
fn complete(campaign: &Campaign) -> Campaign {
    let mut campaign = campaign.clone();
    (campaign.stop, campaign.budget) = (StoppingRule::Fixed, None);
    if let Goal::Claim(claim) = &mut campaign.goal {
        claim.confidence = Some(Spanned::new(CONFIDENCE, claim.span));
    }
    campaign
}

/// Runs the episodes.
struct Lab<'a> {
    args: &'a CampaignInvarianceArgs,
    loaded: &'a LoadedCampaign,
    campaign: &'a Campaign,
    description: Description,
    has_slots: bool,
    /// What has run, and where its results are.
    runs: Vec<(&'static str, PathBuf)>,
}

impl Lab<'_> {
    /// Runs all variations; the number of the signal that ended them.
    async fn vary(&mut self) -> Result<Result<Invariance, i32>, Failure> {
        let needs_slots = [Variation::ManySlots, Variation::OtherMode];
        let has_slots = self.has_slots;
        let wanted = Variation::ALL.into_iter().filter(|it| has_slots || !needs_slots.contains(it));
        let first = match self.run("first", None).await? {
            Ok(first) => first,
            Err(signal) => return Ok(Err(signal)),
        };
        let mut variations = Vec::new();
        for variation in wanted {
            match self.run(name(variation), Some(variation)).await? {
                Ok(results) => variations.push((variation, results)),
                Err(signal) => return Ok(Err(signal)),
            }
        }
        let found = judge(&first, &variations, None, self.args.alpha);
        if !found.is_exact || !found.variations.iter().any(|it| it.changes_results) {
            return Ok(Ok(found));
        }
        Ok(match self.run("confirmation", Some(Variation::Again)).await? {
            Ok(third) => Ok(judge(&first, &variations, Some(&third), self.args.alpha)),
            Err(signal) => Err(signal),
        })
    }

    /// Runs all episodes; the number of the signal that ended them.
    async fn run(
        &mut self,
        name: &'static str,
        variation: Option<Variation>,
    ) -> Result<Result<Vec<ComparedEpisode>, i32>, Failure> {
        if self.args.format == CampaignFormat::Text {
            let episodes = count(self.loaded.episodes.episodes.len(), "episode");
            terminal::stderr(|err| writeln!(err, "{name}: {episodes}"))?;
        }
        let mut description = self.description.clone();
        let has_many_slots = [Variation::ManySlots, Variation::OtherMode];
        if self.has_slots && !variation.is_some_and(|it| has_many_slots.contains(&it)) {
            description.options.retain(|option| !option.starts_with("--slots="));
            description.options.push("--slots=1".to_owned());
        }
        if variation == Some(Variation::OtherMode) {
            description.variables.push((MODE.to_owned(), "other".to_owned()));
        }
        let parent = self.args.results.results.join("invariance");
        let dir = CampaignDir::create(&parent, description, Some(&self.loaded.episodes))?;
        self.runs.push((name, dir.path.clone()));
        let _lock = dir.lock()?;
        let workers = if variation == Some(Variation::TwoWorkers) { 2 } else { 1 };
        let episodes = &self.loaded.episodes.episodes;
        let ledger = Ledger::new(episodes.len(), self.campaign.repeats);
        let pool =
            LocalPool::new(&dir, workers, (self.args.shutdown_timeout, Answers::Nobody)).checked();
        let is_reversed = variation == Some(Variation::OtherOrder);
        let coordinator = Coordinator::new(self.campaign, episodes, ledger, pool)?;
        let signals = SignalListener::install().map_err(Failure::internal)?;
        let end = coordinator.for_comparison(is_reversed).run(signals).await?;
        match end.early_end {
            None => {}
            Some(EarlyEnd::Signal(signal)) => return Ok(Err(signal)),
            Some(end) => {
                let error = format!("the episodes could not be run: {end:?}");
                let hint = format!("`{}` has the runs of the workers", dir.path.display());
                return Err(Failure::internal(error).hint(hint));
            }
        }
        Ok(Ok(LoadedVersion::read(&dir.path)?.episodes))
    }
}

fn name(variation: Variation) -> &'static str {
    match variation {
        Variation::Again => "again",
        Variation::OtherOrder => "other order",
        Variation::ManySlots => "many slots",
        Variation::TwoWorkers => "two workers",
        Variation::OtherMode => "other mode",
    }
}

fn print(out: &mut dyn Write, found: &Invariance) -> io::Result<()> {
    for result in &found.variations {
        writeln!(out, "  {:<12} {}", name(result.variation), text(result))?;
    }
    let kind = match found.is_exact {
        true => "results are exact: the same way twice gives the same results",
        false => {
            "results are not exact: the same way twice gives other results; outcomes are \
                  compared in pairs"
        }
    };
    writeln!(out, "  {kind}")?;
    for cause in &found.causes {
        writeln!(out, "\u{1b}[31mprobable cause\u{1b}[0m: {}", explain(*cause))?;
    }
    if !found.any_change() {
        writeln!(out, "\u{1b}[32mno variation changes results\u{1b}[0m")?;
    }
    Ok(())
}

/// What is different.
fn text(result: &VariationResult) -> String {
    let VariationResult { episodes, changed, begin_differently, measure_differently, .. } = *result;
    let mut parts = Vec::new();
    if changed > 0 {
        let examples: Vec<_> = result.examples.iter().map(ToString::to_string).collect();
        let more = if changed > examples.len() { ", …" } else { "" };
        let examples = examples.join(", ");
        parts.push(format!("{changed} of {episodes} outcomes change ({examples}{more})"));
    }
    if begin_differently > 0 {
        parts.push(format!("{} begin differently", count(begin_differently, "episode")));
    }
    if measure_differently > 0 {
        parts.push(format!("{} measure other values", count(measure_differently, "episode")));
    }
    if let Some(p_value) = result.p_value.filter(|_| changed > 0) {
        parts.push(format!("{} (McNemar)", format_p_value(p_value)));
    }
    if parts.is_empty() {
        return format!("the same results in {}", count(episodes, "episode"));
    }
    escape::line(&parts.join("; ")).into_owned()
}

fn explain(cause: Cause) -> &'static str {
    match cause {
        Cause::SeedIgnored => {
            "an environment ignores its seed: an episode begins with another observation"
        }
        Cause::BatchArithmetic => {
            "arithmetic depends on the number of slots: all values differ a little"
        }
        Cause::SharedBetweenSlots => {
            "an episode depends on those that run at the same time: slots share state"
        }
        Cause::StateOutlivesEpisodes => {
            "an episode depends on those before it: they leave state in an environment, in the policy, \
             or in what slots share"
        }
        Cause::SharedInProcess => {
            "environments depend on their process: they share state in it, or need what it has"
        }
        Cause::SharedBetweenWorkers => "workers share state, such as a file or a port",
        Cause::Chance => "results depend on chance, not only on the seed",
    }
}
