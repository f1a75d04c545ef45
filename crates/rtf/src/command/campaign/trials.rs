//! What `rtf campaign run` and `show` print about the versions of a campaign.

use std::io::{self, Write};

use rtf_campaign::Verdict;
use rtf_coordinator::summary;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::campaign::trials::ComparedTrials;
use rtf_run::error::Failure;
use rtf_run::terminal;

use super::comparison_text;

/// Prints the comparison and the verdict, or that the versions are hidden.
pub fn print(
    dir: &CampaignDir,
    compared: Option<&ComparedTrials>,
    verdict: Verdict,
) -> Result<(), Failure> {
    let Some(versions) = dir.versions() else { return Ok(()) };
    terminal::stdout(|out| match compared {
        Some(compared) => print_comparison(out, compared, verdict),
        None => {
            let count = versions.values.len();
            writeln!(out, "{count} versions, which are hidden until all trials have results")
        }
    })
}

fn print_comparison(
    out: &mut dyn Write,
    compared: &ComparedTrials,
    verdict: Verdict,
) -> io::Result<()> {
    writeln!(out)?;
    comparison_text::print(out, &compared.comparison, &compared.versions)?;
    writeln!(out)?;
    comparison_text::print_unblinded(out, compared.unblinded.as_ref())?;
    let verdict_text = summary::verdict_text(verdict);
    let why = match verdict {
        Verdict::Passed => "no version is worse than 1",
        Verdict::Failed => "a version is worse than 1",
        Verdict::Undecided => "not all trials have results in pairs",
    };
    writeln!(out, "versions: {verdict_text}, {why}")
}
