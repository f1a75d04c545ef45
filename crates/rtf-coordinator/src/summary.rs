//! What `rtf campaign run` prints at the end, and the exit code.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use rtf_campaign::file::{Claim, StoppingRule};
use rtf_campaign::forecast::forecast_text;
use rtf_campaign::{Campaign, EpisodeResult, Judge, Judgement, Ledger, Verdict};
use rtf_report::episode_results::EpisodeLine;
use rtf_run::diagnostics::count;
use rtf_run::error::Failure;
use rtf_run::{exit, terminal};

/// Why a campaign ended before its claim was decided and all episodes had run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EarlyEnd {
    Signal(i32),
    HookFailed,
    /// Only results that are the bench's.
    BenchBroken,
    /// The campaign's budget has passed.
    Budget,
}

/// Prints the results.
pub fn print(
    campaign: &Campaign,
    (ledger, judgement): (&Ledger, &Judgement),
    early_end: Option<&EarlyEnd>,
    dir: &Path,
) -> Result<(), Failure> {
    let numbers = [
        ("passed", ledger.count(EpisodeResult::Passed)),
        ("failed", ledger.count(EpisodeResult::Failed)),
        ("without a result", ledger.count(EpisodeResult::None)),
    ];
    let bench: u32 = ledger.episodes().iter().map(|episode| episode.bench).sum();
    let done: usize = numbers.iter().map(|(_, number)| number).sum();
    terminal::stdout(|out| {
        writeln!(out)?;
        let total = ledger.episodes().len();
        writeln!(out, "{done} of {}", count(total, campaign.noun()))?;
        for (name, number) in numbers.iter().filter(|(_, number)| *number > 0) {
            writeln!(out, "  {name:<18}{number}")?;
        }
        if bench > 0 {
            writeln!(out, "  errors and collapses of the bench: {bench}")?;
        }
        let lost: u32 = ledger.episodes().iter().map(|episode| episode.lost).sum();
        if lost > 0 {
            writeln!(out, "  lost with others in a process that ended, and repeated: {lost}")?;
        }
        if let (Some(rate), Some(claim)) = (&judgement.rate, campaign.claim()) {
            let (value, low, high) = (rate.value, rate.low, rate.high);
            let (interval, confidence) = interval(campaign, claim);
            writeln!(
                out,
                "  rate {value:.4}, between {low:.4} and {high:.4} ({interval}, {confidence})"
            )?;
        }
        write_end(out, campaign, (total, judgement), early_end, dir)?;
        let judge = campaign.claim().and_then(|_| Judge::new(campaign, total));
        if let Some(text) = judge.and_then(|judge| forecast_text(&judge, judgement)) {
            writeln!(out, "  {text}")?;
        }
        writeln!(out, "results: {}", dir.display())?;
        match campaign.claim() {
            Some(Claim { rate, .. }) => {
                let verdict = verdict_text(judgement.verdict);
                writeln!(out, "claim rate >= {rate}: {verdict}")
            }
            None => Ok(()),
        }
    })
}

/// In its colour.
pub fn verdict_text(verdict: Verdict) -> String {
    let (verdict, color) = match verdict {
        Verdict::Passed => ("passed", "\u{1b}[32m"),
        Verdict::Failed => ("failed", "\u{1b}[31m"),
        Verdict::Undecided => ("undecided", "\u{1b}[33m"),
    };
    format!("{color}{verdict}\u{1b}[0m")
}

/// Writes why a campaign ended before all of its episodes had run.
fn write_end(
    out: &mut dyn Write,
    campaign: &Campaign,
    (total, judgement): (usize, &Judgement),
    early_end: Option<&EarlyEnd>,
    dir: &Path,
) -> io::Result<()> {
    match early_end {
        Some(EarlyEnd::HookFailed) => {
            writeln!(out, "  a hook failed: the robot may not be in a safe state")?;
        }
        Some(EarlyEnd::BenchBroken) => writeln!(
            out,
            "  ended early: {} in succession were errors or collapses of the bench",
            count(rtf_campaign::ledger::MAX_BENCH_RESULTS as usize, "execution"),
        )?,
        Some(EarlyEnd::Budget) => {
            let budget = campaign.budget.unwrap_or_default();
            writeln!(out, "  ended early: the budget of {budget:?} has passed")?;
            writeln!(out, "  continue: rtf campaign run --resume {}", dir.display())?;
        }
        Some(EarlyEnd::Signal(_)) => {
            writeln!(out, "  continue: rtf campaign run --resume {}", dir.display())?;
        }
        None if judgement.episodes < total && judgement.verdict != Verdict::Undecided => {
            writeln!(out, "  decided after {}", count(judgement.episodes, "episode"))?;
        }
        None => {}
    }
    Ok(())
}

fn interval(campaign: &Campaign, claim: &Claim) -> (&'static str, String) {
    let percent = |confidence: f64| format!("{} % confidence", rounded(confidence * 100.0));
    let declared = claim.confidence.as_ref().map_or(0.0, |confidence| confidence.value);
    match campaign.stop {
        StoppingRule::Fixed => ("Clopper and Pearson", percent(declared)),
        StoppingRule::ConfidenceSequence => ("confidence sequence", percent(declared)),
        StoppingRule::Sprt { alpha, .. } => ("confidence sequence", percent(1.0 - alpha)),
    }
}

/// A number without the digits that binary fractions add.
fn rounded(number: f64) -> f64 {
    (number * 1e9).round() / 1e9
}

/// The exit code of a campaign.
pub fn exit_code(judgement: &Judgement, early_end: Option<&EarlyEnd>) -> u8 {
    match (early_end, judgement.verdict) {
        (Some(EarlyEnd::HookFailed), _) => exit::HOOK_FAILED,
        (Some(EarlyEnd::Signal(number)), _) => exit::of_signal(*number),
        (_, Verdict::Passed) => exit::PASSED,
        (_, Verdict::Failed) => exit::FAILED,
        (_, Verdict::Undecided) => exit::UNDECIDED,
    }
}

/// The result of each episode that has run, in the order of the list: `recorded` has the lines
/// of all workers.
pub fn result_lines(ledger: &Ledger, recorded: Vec<EpisodeLine>) -> Vec<EpisodeLine> {
    let mut lines: BTreeMap<u64, EpisodeLine> = BTreeMap::new();
    for (episode, executions) in (1..).zip(ledger.episodes()) {
        if let Some((outcome, reason)) = executions.last.clone() {
            let outcome = Some(outcome);
            lines.insert(episode, EpisodeLine { episode, outcome, reason, ..Default::default() });
        }
    }
    for line in recorded {
        if let Some(known) = lines.get_mut(&line.episode)
            && known.duration_us == 0
            && (&known.outcome, &known.reason) == (&line.outcome, &line.reason)
        {
            // Which run of a worker it was depends on the number of workers.
            *known = EpisodeLine { problem: None, shown: None, ..line };
        }
    }
    lines.into_values().collect()
}
