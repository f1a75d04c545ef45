//! `rtf campaign plan`: how many episodes a comparison needs.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use rtf_campaign::plan::{Assumption, PlannedEpisodes, Wanted, percent};
use rtf_run::campaign::version::LoadedVersion;
use rtf_run::error::Failure;
use rtf_run::terminal;
use rtf_statistics::sample_size::MAX_TRIALS;
use rtf_statistics::{CONFIDENCE, rate};
use serde_json::json;

use crate::cli::{CampaignFormat, CampaignPlanArgs};
use crate::command::VerbResult;

/// A rate for which episodes are planned, and where it comes from.
struct AssumedRate {
    rate: f64,
    origin: Option<String>,
}

/// Prints the plan for each rate.
pub fn run(args: &CampaignPlanArgs) -> VerbResult {
    let rates = match (args.rate, &args.results) {
        (Some(rate), _) => vec![AssumedRate { rate, origin: None }],
        (None, Some(results)) => rates_of(results)?,
        // The command line requires one of them.
        (None, None) => Vec::new(),
    };
    let plan = |assumed: AssumedRate| {
        let wanted = Wanted {
            rate: assumed.rate,
            detect: args.detect,
            power: args.power,
            alpha: args.alpha,
            versions: args.versions,
            discordant: args.discordant,
        };
        let planned = rtf_campaign::plan(&wanted).map_err(Failure::input)?;
        Ok::<_, Failure>((assumed, wanted, planned))
    };
    let plans = rates.into_iter().map(plan).collect::<Result<Vec<_>, _>>()?;
    if args.format == CampaignFormat::Json {
        let plan = |(assumed, wanted, planned): &(AssumedRate, Wanted, Vec<PlannedEpisodes>)| json!({ "wanted": wanted, "origin": assumed.origin, "numbers": planned });
        let document: Vec<_> = plans.iter().map(plan).collect();
        let text = serde_json::to_string_pretty(&document).map_err(Failure::internal)?;
        terminal::stdout(|out| writeln!(out, "{text}"))?;
    } else {
        terminal::stdout(|out| {
            plans
                .iter()
                .try_for_each(|(assumed, wanted, planned)| print(out, assumed, wanted, planned))
        })?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The rate of earlier results, and the end of its interval for which more episodes are necessary.
fn rates_of(results: &Path) -> Result<Vec<AssumedRate>, Failure> {
    let version = LoadedVersion::read(results)?;
    let known = version.episodes.iter().filter_map(|episode| episode.passed);
    let (passed, all) = known.fold((0, 0), |(passed, all), it| (passed + u64::from(it), all + 1));
    let Some(found) = rate(passed, all, CONFIDENCE) else {
        let error = format!("no episode of `{}` has a result", results.display());
        return Err(Failure::input(error).hint("assume a rate: `--rate 0.9`"));
    };
    let interval = format!("{:.1} to {:.1} %", found.low * 100.0, found.high * 100.0);
    // Rounded, so that the numbers are those of a rate that can be typed.
    let end = (0.5_f64.clamp(found.low, found.high) * 1000.0).round() / 1000.0;
    Ok(vec![
        AssumedRate { rate: found.value, origin: Some(format!("{passed} of {all} episodes")) },
        AssumedRate {
            rate: end,
            origin: Some(format!("of the 95 % interval {interval}, the rate nearest to 50 %")),
        },
    ])
}

fn print(
    out: &mut dyn Write,
    assumed: &AssumedRate,
    wanted: &Wanted,
    planned: &[PlannedEpisodes],
) -> io::Result<()> {
    let Wanted { rate, detect, power, alpha, versions, .. } = *wanted;
    let [rate, detect, power] = [rate, detect, power].map(percent);
    let origin = assumed.origin.as_ref().map(|it| format!(" ({it})")).unwrap_or_default();
    writeln!(out, "rate {rate} %{origin}")?;
    writeln!(
        out,
        "episodes of each of {versions} versions, to find a difference of {detect} % with a \
         probability of {power} %, alpha {alpha}:"
    )?;
    for it in planned {
        let episodes = match it.episodes {
            Some(episodes) => episodes.to_string(),
            None => format!("> {MAX_TRIALS}"),
        };
        let reached = it.power.map(|power| format!(" ({:.1} %)", power * 100.0));
        let (reached, text) = (reached.unwrap_or_default(), assumption_text(it, wanted));
        writeln!(out, "  {episodes:>8}{reached}  {text}")?;
    }
    Ok(())
}

fn assumption_text(planned: &PlannedEpisodes, wanted: &Wanted) -> String {
    match planned.assumption {
        Assumption::Nested => {
            "in pairs, if the better version passes all that the worse one passes".to_owned()
        }
        Assumption::IndependentResults => {
            "in pairs, if the results of an episode are independent".to_owned()
        }
        Assumption::Discordant => {
            let share = percent(wanted.discordant.unwrap_or_default());
            format!("in pairs, if only one version passes {share} % of the episodes")
        }
        Assumption::IndependentEpisodes => "different episodes, not in pairs".to_owned(),
    }
}
