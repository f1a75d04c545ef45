//! The results of a campaign for the page and the HTML report, from its directory only.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use rtf_campaign::analysis::{self, ByParameter, Cell, Sample};
use rtf_campaign::comparison::{Finding, VersionComparison, VersionRate};
use rtf_campaign::forecast::forecast_text;
use rtf_campaign::{EpisodeResult, Judge, Ledger, Verdict};
use rtf_model::{Episode, EpisodeOutcome, TestAttempt};
use rtf_report::format_p_value;
use rtf_web::{
    CampaignCell, CampaignMap, CampaignMapRow, CampaignParameter, CampaignProgress, CampaignReport,
    CampaignSource, CampaignVersionRate, CampaignVersions, EpisodeAttempt, EpisodeProblem,
    EpisodeRun,
};

use super::directory::{CampaignDir, DESCRIPTION};
use super::judged::Judged;
use super::ranking::Ranking;
use super::trials::{ComparedTrials, TrialVersions};
use crate::error::Failure;

/// The directory of campaigns in a results directory.
const CAMPAIGNS: &str = "campaigns";
/// The number of points of the progress.
const PROGRESS: usize = 60;
/// The number of parameters in maps.
const MAPPED: usize = 8;
/// The number of episodes that are listed.
const LISTED: usize = 500;

/// The campaigns of a results directory.
#[derive(Debug)]
pub struct ServedCampaigns {
    /// The results directory.
    pub results: PathBuf,
}

impl CampaignSource for ServedCampaigns {
    fn report(&self, directory: &str) -> Result<Option<CampaignReport>, String> {
        // Only a name: not a path to elsewhere.
        let is_name = Path::new(directory).file_name().is_some_and(|name| name == directory);
        let path = self.results.join(CAMPAIGNS).join(directory);
        if !is_name || !path.join(DESCRIPTION).is_file() {
            return Ok(None);
        }
        let report = CampaignDir::open(&path).and_then(|dir| report(&dir));
        report.map(Some).map_err(|failure| failure.text())
    }
}

/// Reads the results of a campaign.
pub fn report(dir: &CampaignDir) -> Result<CampaignReport, Failure> {
    let start = dir.description.start.as_ref().ok_or_else(|| {
        let error = format!("`{}` has no campaign with a claim", dir.path.display());
        Failure::input(error).hint("it is a search, or was run by an earlier version of rtf")
    })?;
    // Before the results: those of a worker that has ended are complete.
    let running = Judged::read(&dir.path).is_none() && dir.any_worker_runs();
    let episodes = dir.episodes()?.episodes;
    let mut ledger = Ledger::new(episodes.len(), dir.description.repeats);
    let (mut runs, mut ranking) = (HashMap::new(), Ranking::default());
    for (run, line) in dir.recorded_in_runs() {
        if let Some(outcome) = line.outcome {
            let run = episode_run(&dir.path, &run, line.problem.or(line.shown));
            runs.insert(line.episode, run.clone());
            ledger.record(line.episode, outcome, line.reason.clone());
            ranking.add(line, run);
        }
    }
    let is_hidden = dir.hides_versions(&ledger);
    let episodes = dir.shown_episodes(episodes, is_hidden);
    let judge = start.judge(episodes.len());
    let judge = judge.ok_or_else(|| Failure::input("the claim cannot be judged"))?;
    let results = ledger.results();
    let mut judgement = judge.judge(&results);
    let compared = ComparedTrials::judge(dir, &ledger, &mut judgement)?;
    let samples = analysis::samples(&episodes, &ledger);
    let parameters = analysis::by_parameters(&samples, start.seed);
    let mut problems = problems(dir, &episodes, (&ledger, &runs));
    let problem_count = problems.len();
    problems.truncate(LISTED);
    Ok(CampaignReport {
        directory: directory_name(&dir.path),
        name: dir.description.name.clone(),
        file: dir.description.file.display().to_string(),
        started: start.started_at,
        running,
        commit: start.revision.as_ref().map(|revision| revision.commit.clone()),
        claim: start.claim,
        versions: dir.versions().map(|it| versions(it, compared.as_ref())),
        rule: start.rule().to_owned(),
        confidence: start.interval_confidence(),
        verdict: verdict(judgement.verdict).to_owned(),
        planned: episodes.len(),
        passed: judgement.passed,
        failed: judgement.failed,
        without_result: judgement.without_result,
        rate: judgement.rate,
        more_episodes: start.claim.and_then(|_| judge.more_episodes(&judgement)),
        forecast: start.claim.and_then(|_| forecast_text(&judge, &judgement)),
        progress: progress(&judge, &results[..judgement.episodes.min(results.len())]),
        maps: maps(&samples, &parameters),
        parameters: parameters.into_iter().map(parameter).collect(),
        rankings: ranking.rankings(&episodes),
        problems,
        problem_count,
    })
}

/// `latest` leads to a directory with another name.
fn directory_name(path: &Path) -> String {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "passed",
        Verdict::Failed => "failed",
        Verdict::Undecided => "undecided",
    }
}

/// The rates and findings, unless the versions are hidden.
fn versions(versions: &TrialVersions, compared: Option<&ComparedTrials>) -> CampaignVersions {
    let rates =
        compared.into_iter().flat_map(|it| versions.values.iter().zip(&it.comparison.versions));
    let rate = |(version, found): (&String, &VersionRate)| CampaignVersionRate {
        version: version.clone(),
        episodes: found.passed + found.failed,
        passed: found.passed,
        rate: found.rate,
    };
    let findings = compared.into_iter().flat_map(|it| &it.comparison.comparisons);
    let name = |index: usize| versions.values.get(index).map_or("", String::as_str);
    let finding = |found: &VersionComparison| {
        let (version, baseline) = (name(found.version - 1), name(0));
        let p = format_p_value(found.results.significance.adjusted);
        match found.finding {
            Finding::Worse => format!("{version} is worse than {baseline} ({p})"),
            Finding::Better => format!("{version} is better than {baseline} ({p})"),
            Finding::Undecided => format!("{version} and {baseline}: undecided ({p})"),
        }
    };
    CampaignVersions {
        count: versions.values.len(),
        hidden: compared.is_none(),
        rates: rates.map(rate).collect(),
        findings: findings.map(finding).collect(),
    }
}

/// The rates after up to [`PROGRESS`] numbers of episodes, the last one after all.
fn progress(judge: &Judge, results: &[EpisodeResult]) -> Vec<CampaignProgress> {
    let steps = results.len().min(PROGRESS);
    let numbers = (1..=steps).map(|step| results.len() * step / steps);
    let after = |episodes: usize| {
        let rate = judge.judge(&results[..episodes]).rate?;
        Some(CampaignProgress { episodes, rate })
    };
    numbers.filter_map(after).collect()
}

fn parameter(found: ByParameter) -> CampaignParameter {
    let ByParameter { name, chi_square, p_value, cells } = found;
    CampaignParameter { name, chi_square, p_value, cells: cells.into_iter().map(cell).collect() }
}

fn cell(Cell { values, episodes, passed, rate }: Cell) -> CampaignCell {
    CampaignCell { values, episodes, passed, rate }
}

/// The maps of all pairs of the first parameters.
fn maps(samples: &[Sample<'_>], parameters: &[ByParameter]) -> Vec<CampaignMap> {
    let names: Vec<_> = parameters.iter().take(MAPPED).map(|it| it.name.as_str()).collect();
    let mut maps = Vec::new();
    for (index, x) in names.iter().enumerate() {
        for y in &names[index + 1..] {
            let Some(map) = analysis::failure_map(samples, x, y) else { continue };
            let row = |(values, cells): (String, Vec<Cell>)| CampaignMapRow {
                values,
                cells: cells.into_iter().map(cell).collect(),
            };
            let rows = map.rows.into_iter().map(row).collect();
            maps.push(CampaignMap { x: (*x).to_owned(), y: (*y).to_owned(), rows });
        }
    }
    maps
}

/// The last run of an episode, as the server names it: relative to the results directory.
fn episode_run(campaign: &Path, run: &Path, problem: Option<TestAttempt>) -> EpisodeRun {
    let inside = run.strip_prefix(campaign).unwrap_or(run);
    let run = Path::new(CAMPAIGNS).join(directory_name(campaign)).join(inside);
    EpisodeRun {
        run: run.to_string_lossy().into_owned(),
        test: problem.map(|problem| problem.test.0),
        attempt: problem.map(|TestAttempt { attempt, case, .. }| EpisodeAttempt {
            attempt,
            case: case.map(|case| case.0),
        }),
    }
}

fn problems(
    dir: &CampaignDir,
    episodes: &[Episode],
    (ledger, runs): (&Ledger, &HashMap<u64, EpisodeRun>),
) -> Vec<EpisodeProblem> {
    let path = dir.path.with_file_name(directory_name(&dir.path));
    let path = path.to_string_lossy();
    let problem = |(episode, executions): (&Episode, &rtf_campaign::ledger::Executions)| {
        let (outcome, reason) = executions.last.clone()?;
        let outcome = match outcome {
            EpisodeOutcome::Passed => return None,
            EpisodeOutcome::Failed => "failed",
            EpisodeOutcome::Error => "error",
            EpisodeOutcome::Collapsed => "collapsed",
        };
        let pair = |it: &rtf_model::Parameter| (it.name.clone(), it.value.clone());
        Some(EpisodeProblem {
            episode: episode.id,
            outcome: outcome.to_owned(),
            reason,
            parameters: episode.parameters.iter().map(pair).collect(),
            command: format!("rtf run --episode {} {}", episode.id, shell_words::quote(&path)),
            run: runs.get(&episode.id).cloned(),
        })
    };
    let with_results = episodes.iter().zip(ledger.episodes());
    with_results.filter_map(problem).collect()
}
