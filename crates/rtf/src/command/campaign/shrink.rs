//! `rtf campaign shrink`: the smallest change from nominal parameters with which an episode fails.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_campaign::ranges::meet_constraints;
use rtf_campaign::{Change, ParameterRange, Shrunk, ShrunkChange, shrink};
use rtf_coordinator::progress::parameters;
use rtf_coordinator::stream_pool::{Ended, StreamPool};
use rtf_engine::signal::SignalListener;
use rtf_model::{Episode, EpisodeOutcome, Parameter};
use rtf_report::escape;
use rtf_run::campaign::directory::{CampaignDir, Description};
use rtf_run::campaign::{self, LoadedCampaign};
use rtf_run::diagnostics::count;
use rtf_run::error::Failure;
use rtf_run::terminal;
use serde_json::json;
use tokio::runtime::Runtime;

use super::run::describe_search;
use crate::cli::{CampaignFormat, CampaignShrinkArgs};
use crate::command::VerbResult;
use crate::request::config;

/// Shrinks an episode.
pub fn run(mut args: CampaignShrinkArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let (loaded, description, episode) = find(&args)?;
    campaign::refuse_versions(&loaded)?;
    let changes = changes(&loaded.ranges, &episode)?;
    let dir = CampaignDir::create(&args.results.results.join("shrinks"), description, None)?;
    let mut pool = StreamPool::new(&dir, 1, args.shutdown_timeout)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(Failure::internal)?;
    let signals = runtime.block_on(async { SignalListener::install() });
    let signals = signals.map_err(Failure::internal)?;
    let is_text = args.format == CampaignFormat::Text;
    if is_text {
        let (id, name) = (episode.id, escape::line(&loaded.name));
        terminal::stdout(|out| writeln!(out, "episode {id} of {name}"))?;
    }
    let mut lab = Lab { loaded: &loaded, seed: episode.seed, is_text, runs: Vec::new() };
    let mut bench = (&mut pool, signals);
    let shrunk = shrink(&changes, |values| lab.fails(values, &runtime, &mut bench));
    let (pool, mut signals) = bench;
    let ended = runtime.block_on(pool.finish(shrunk.as_ref().err(), &mut signals));
    match (shrunk, ended?) {
        (_, Some(code)) => Ok(code),
        (Err(ended), None) => ended.into_result(),
        (Ok(Shrunk::NotReproduced), None) => {
            let error = format!("episode {} does not fail when it runs again", episode.id);
            let hint = "it may depend on chance or on the load of the machine";
            Err(Failure::input(error).hint(hint))
        }
        (Ok(Shrunk::Changes(found)), None) => {
            lab.print_result(&args, &dir, (episode.id, &changes, &found))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// The campaign, what to run, and the episode.
fn find(args: &CampaignShrinkArgs) -> Result<(LoadedCampaign, Description, Episode), Failure> {
    let newest = || args.results.results.join("campaigns").join("latest");
    let input = args.input.clone().unwrap_or_else(newest);
    let (_, episode) = campaign::find_episode(&input, args.episode)?;
    let (loaded, description) = if input.is_dir() {
        let stored = CampaignDir::open(&input)?.description;
        let loaded = campaign::load(&stored.file)?;
        let mut description = Description { is_search: true, jobs: None, start: None, ..stored };
        description.options.extend(args.profile.to_options());
        (loaded, description)
    } else {
        let loaded = campaign::load(&input)?;
        let description = describe_search(&loaded, &input, &args.profile)?;
        (loaded, description)
    };
    Ok((loaded, description, episode))
}

/// The parameters of the episode and their nominal values.
fn changes(ranges: &[ParameterRange], episode: &Episode) -> Result<Vec<Change>, Failure> {
    let names = episode.parameters.iter().map(|parameter| &parameter.name);
    if !names.eq(ranges.iter().map(|range| &range.name)) {
        let error = "the campaign has other parameters than the episode";
        return Err(Failure::input(error).hint("undo the changes of the campaign file"));
    }
    let change = |(range, parameter): (&ParameterRange, &Parameter)| Change {
        name: range.name.clone(),
        nominal: range.nominal.clone(),
        value: parameter.value.clone(),
        is_real: range.is_real(),
    };
    Ok(ranges.iter().zip(&episode.parameters).map(change).collect())
}

/// The workers, and the signals that end them.
type Bench<'a, 'p> = (&'a mut StreamPool<'p>, SignalListener);

/// Runs candidates.
struct Lab<'a> {
    loaded: &'a LoadedCampaign,
    seed: u32,
    is_text: bool,
    /// The candidates that ran, by their ids from 1.
    runs: Vec<Vec<String>>,
}

impl Lab<'_> {
    fn fails(
        &mut self,
        values: &[String],
        runtime: &Runtime,
        (pool, signals): &mut Bench<'_, '_>,
    ) -> Result<bool, Ended> {
        let parameters = self.parameters(values);
        if !meet_constraints(&self.loaded.campaign, &parameters) {
            return Ok(false);
        }
        self.runs.push(values.to_vec());
        let episode = Episode::new(self.runs.len() as u64, self.seed, parameters);
        let line = runtime.block_on(pool.run(episode.clone(), signals))?;
        let outcome = line.outcome.unwrap_or(EpisodeOutcome::Error);
        if self.is_text {
            let reason = line.reason.filter(|_| outcome.is_of_bench());
            terminal::stdout(|out| print_run(out, &episode, outcome, reason.as_deref()))?;
        }
        Ok(outcome == EpisodeOutcome::Failed)
    }

    fn parameters(&self, values: &[String]) -> Vec<Parameter> {
        let parameter = |(range, value): (&ParameterRange, &String)| Parameter {
            name: range.name.clone(),
            value: value.clone(),
        };
        self.loaded.ranges.iter().zip(values).map(parameter).collect()
    }

    fn print_result(
        &self,
        args: &CampaignShrinkArgs,
        dir: &CampaignDir,
        (episode, changes, found): (u64, &[Change], &[ShrunkChange]),
    ) -> Result<(), Failure> {
        let changed: BTreeMap<&str, &str> =
            found.iter().map(|it| (it.name.as_str(), it.value.as_str())).collect();
        let value = |it: &Change| {
            changed.get(it.name.as_str()).map_or_else(|| it.nominal.clone(), |it| (*it).to_owned())
        };
        let values: Vec<String> = changes.iter().map(value).collect();
        let id = self.runs.iter().position(|run| *run == values).map_or(1, |index| index + 1);
        if args.format == CampaignFormat::Json {
            let values = changes.iter().zip(&values).map(|(it, value)| (it.name.as_str(), value));
            let document = json!({
                "name": self.loaded.name,
                "episode": episode,
                "changes": found,
                "parameters": values.collect::<BTreeMap<_, _>>(),
                "runs": self.runs.len(),
                "directory": dir.path,
                "candidate": id,
            });
            let text = serde_json::to_string_pretty(&document).map_err(Failure::internal)?;
            return terminal::stdout(|out| writeln!(out, "{text}"));
        }
        let runs = count(self.runs.len(), "run");
        terminal::stdout(|out| print_changes(out, (found, &runs), (&dir.path, id)))
    }
}

fn print_run(
    out: &mut dyn Write,
    episode: &Episode,
    outcome: EpisodeOutcome,
    reason: Option<&str>,
) -> io::Result<()> {
    let (color, word) = match outcome {
        EpisodeOutcome::Passed => ("\u{1b}[32m", "passes"),
        EpisodeOutcome::Failed => ("\u{1b}[31m", "fails"),
        EpisodeOutcome::Error => ("\u{1b}[33m", "error"),
        EpisodeOutcome::Collapsed => ("\u{1b}[33m", "collapsed"),
    };
    writeln!(out, "  {color}{word:<9}\u{1b}[0m  {}", parameters(episode))?;
    let reason = reason.and_then(|reason| reason.lines().next()).map(escape::line);
    reason.map_or(Ok(()), |reason| writeln!(out, "             {reason}"))
}

fn print_changes(
    out: &mut dyn Write,
    (found, runs): (&[ShrunkChange], &str),
    (dir, id): (&Path, usize),
) -> io::Result<()> {
    if found.is_empty() {
        writeln!(out, "\nit fails with all parameters being nominal ({runs})")?;
    } else {
        writeln!(out, "\nthe smallest change from the nominal parameters that fails ({runs}):")?;
    }
    for ShrunkChange { name, nominal, value, passes } in found {
        let [name, nominal, value, passes] =
            [name, nominal, value, passes].map(|it| escape::line(it));
        write!(out, "  {name}={value}  nominal {nominal}")?;
        let is_nominal = passes == nominal;
        writeln!(out, "{}", if is_nominal { String::new() } else { format!(", {passes} passes") })?;
    }
    writeln!(out, "\nrepeat: rtf run --episode {id} {}", escape::line(&dir.to_string_lossy()))
}
