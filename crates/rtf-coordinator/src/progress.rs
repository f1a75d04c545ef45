//! What `rtf campaign run` prints while the episodes run.

use std::io::{self, IsTerminal as _};
use std::time::{Duration, Instant};

use rtf_campaign::{Campaign, EpisodeResult, Ledger};
use rtf_model::{Episode, EpisodeOutcome};
use rtf_report::episode_results::EpisodeLine;
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::terminal;

/// How many episodes that did not pass are printed.
const PRINTED: usize = 20;

/// The progress on standard output.
#[derive(Debug)]
pub struct Progress<'a> {
    campaign: &'a Campaign,
    is_terminal: bool,
    every: Duration,
    printed_at: Instant,
    printed: usize,
    is_silent: bool,
    /// The prompt for an answer, in place of the numbers.
    prompt: Option<String>,
}

impl<'a> Progress<'a> {
    /// Nothing is printed yet.
    pub fn new(campaign: &'a Campaign) -> Self {
        let is_terminal = io::stdout().is_terminal();
        let every = if is_terminal { Duration::from_millis(200) } else { Duration::from_secs(10) };
        Self {
            campaign,
            is_terminal,
            every,
            printed_at: Instant::now(),
            printed: 0,
            is_silent: false,
            prompt: None,
        }
    }

    /// Prints nothing.
    #[must_use]
    pub fn silent(self) -> Self {
        Self { is_silent: true, is_terminal: false, ..self }
    }

    /// Prints an episode of `total` that did not pass.
    pub fn result(
        &mut self,
        line: &EpisodeLine,
        episode: &Episode,
        total: usize,
    ) -> Result<(), Failure> {
        let Some(outcome) = line.outcome.filter(|outcome| *outcome != EpisodeOutcome::Passed)
        else {
            return Ok(());
        };
        self.printed += 1;
        if self.printed > PRINTED || self.is_silent {
            return Ok(());
        }
        let parameters = self.parameters(episode);
        let label = self.campaign.episode_label(episode.id, total);
        let reason = line.reason.as_deref().and_then(|reason| reason.lines().next());
        let reason = reason.map(escape::line).unwrap_or_default();
        let (clear, color) = (self.clear(), color(outcome));
        let prompt = self.prompt.as_deref().unwrap_or_default();
        terminal::stdout(|out| {
            let word = word(outcome);
            writeln!(out, "{clear}  {color}{word:<9}\u{1b}[0m {label}  {parameters}")?;
            if !reason.is_empty() {
                writeln!(out, "            {reason}")?;
            }
            if self.printed == PRINTED {
                writeln!(out, "  (further ones are only in the results)")?;
            }
            write!(out, "{prompt}")
        })
    }

    /// Prints lines.
    pub fn note(&self, lines: &str) -> Result<(), Failure> {
        let (clear, prompt) = (self.clear(), self.prompt.as_deref().unwrap_or_default());
        terminal::stdout(|out| write!(out, "{clear}{lines}\n{prompt}"))
    }

    /// Shows a prompt in place of the numbers, or the numbers again.
    pub fn set_prompt(&mut self, prompt: Option<String>) -> Result<(), Failure> {
        self.prompt = prompt;
        let (clear, prompt) = (self.clear(), self.prompt.as_deref().unwrap_or_default());
        terminal::stdout(|out| write!(out, "{clear}{prompt}"))
    }

    /// Prints the numbers, if it is time.
    pub fn numbers(&mut self, ledger: &Ledger) -> Result<(), Failure> {
        let is_hidden = self.is_silent || self.prompt.is_some();
        if is_hidden || self.printed_at.elapsed() < self.every {
            return Ok(());
        }
        self.printed_at = Instant::now();
        let count = |result| ledger.count(result);
        let (passed, failed) = (count(EpisodeResult::Passed), count(EpisodeResult::Failed));
        let none = count(EpisodeResult::None);
        let (clear, end) = (self.clear(), if self.is_terminal { "" } else { "\n" });
        let (done, all) = (passed + failed + none, ledger.episodes().len());
        let noun = self.campaign.noun();
        terminal::stdout(|out| {
            write!(out, "{clear}  {done} of {all} {noun}s: {passed} passed, {failed} failed")?;
            if none > 0 {
                write!(out, ", {none} without a result")?;
            }
            write!(out, "{end}")
        })
    }

    /// Removes the line of numbers.
    pub fn end(&self) -> Result<(), Failure> {
        let clear = self.clear();
        terminal::stdout(|out| write!(out, "{clear}"))
    }

    /// Those that may be shown, without a blinded version.
    fn parameters(&self, episode: &Episode) -> String {
        let hidden = self.campaign.versions().filter(|versions| versions.blinded);
        let mut episode = episode.clone();
        episode.parameters.retain(|it| hidden.is_none_or(|hide| hide.parameter.value != it.name));
        parameters(&episode)
    }

    fn clear(&self) -> &'static str {
        if self.is_terminal { "\r\u{1b}[K" } else { "" }
    }
}

/// `payload=0.5 surface=wood`.
pub fn parameters(episode: &Episode) -> String {
    let text = |parameter: &rtf_model::Parameter| format!("{}={}", parameter.name, parameter.value);
    escape::line(&episode.parameters.iter().map(text).collect::<Vec<_>>().join(" ")).into_owned()
}

fn word(outcome: EpisodeOutcome) -> &'static str {
    match outcome {
        EpisodeOutcome::Passed => "passed",
        EpisodeOutcome::Failed => "failed",
        EpisodeOutcome::Error => "error",
        EpisodeOutcome::Collapsed => "collapsed",
    }
}

fn color(outcome: EpisodeOutcome) -> &'static str {
    if outcome.is_of_bench() { "\u{1b}[33m" } else { "\u{1b}[31m" }
}
