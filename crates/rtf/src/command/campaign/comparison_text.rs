//! What `rtf campaign compare` prints.

use std::io::{self, Write};

use rtf_campaign::comparison::{
    ByCondition, Comparison, ConditionComparison, Finding, MeasurementComparison, Pairing,
    ResultComparison, Significance, VersionComparison, VersionRate,
};
use rtf_report::{escape, format_p_value};
use rtf_run::campaign::trials::Unblinded;
use rtf_run::campaign::version::LoadedVersion;
use rtf_run::diagnostics::count;
use rtf_statistics::Difference;

/// Prints the versions by their numbers, and what distinguishes them from the first one.
pub fn print(
    out: &mut dyn Write,
    comparison: &Comparison,
    versions: &[LoadedVersion],
) -> io::Result<()> {
    for (number, (rate, version)) in comparison.versions.iter().zip(versions).enumerate() {
        let title = version.title();
        writeln!(out, "{}  {}  {}", number + 1, rate_text(rate), escape::line(&title))?;
    }
    for (number, _) in (1..).zip(versions).filter(|(_, version)| version.is_sequential) {
        writeln!(
            out,
            "note: the results of {number} have decided how many episodes ran: p is not exact"
        )?;
    }
    let claims = comparison.comparisons.len();
    for it in &comparison.comparisons {
        print_results(out, it, claims)?;
        print_finding(out, it, comparison.alpha)?;
    }
    let measurements = comparison.comparisons.iter().map(|it| it.measurements.len()).sum();
    for it in comparison.comparisons.iter().filter(|it| !it.measurements.is_empty()) {
        let exploratory = exploratory_text(measurements);
        writeln!(out, "\nmeasurements, means of 1 and {} ({exploratory})", it.version)?;
        it.measurements.iter().try_for_each(|it| print_measurement(out, it, measurements))?;
    }
    comparison.by.iter().try_for_each(|by| print_conditions(out, by))
}

/// Prints that blinded versions were shown early.
pub fn print_unblinded(out: &mut dyn Write, unblinded: Option<&Unblinded>) -> io::Result<()> {
    let Some(Unblinded { at, by, trials, of }) = unblinded else { return Ok(()) };
    let by = escape::line(by);
    writeln!(out, "note: {by} unblinded it early, after {trials} of {of} trials, at {at:.0}")
}

/// `27 of 30 passed   90.0 %  74.4 to 96.5`.
fn rate_text(rate: &VersionRate) -> String {
    let VersionRate { passed, failed, without_result, rate } = rate;
    let mut text = format!("{passed:>5} of {} passed", passed + failed);
    if let Some(rate) = rate {
        let [value, low, high] = [rate.value, rate.low, rate.high].map(percent);
        text += &format!("  {value:>5} %  {low:>5} to {high:>5}");
    }
    if *without_result > 0 {
        text += &format!(", {without_result} without a result");
    }
    text
}

fn print_results(out: &mut dyn Write, it: &VersionComparison, claims: usize) -> io::Result<()> {
    let (version, ResultComparison { pairs, without_pair, significance, .. }) =
        (it.version, &it.results);
    writeln!(out, "\n{version} against 1: {}", pairing_text(it.pairing))?;
    let test = match pairs {
        Some(pairs) => {
            let episodes = counted(pairs.pairs(), "episode");
            writeln!(out, "  {episodes} with a result in both")?;
            writeln!(out, "    passed in both  {}", pairs.both_passed)?;
            writeln!(out, "    only in 1       {}", pairs.only_first)?;
            writeln!(out, "    only in {version:<7} {}", pairs.only_second)?;
            writeln!(out, "    in neither      {}", pairs.none_passed)?;
            if *without_pair > 0 {
                writeln!(out, "    without a result in one of them: {without_pair}")?;
            }
            "McNemar"
        }
        None => "Fisher",
    };
    match &it.results.difference {
        Some(difference) => writeln!(out, "  difference {}", rates_text(difference))?,
        None => writeln!(out, "  no difference: a version has no result")?,
    }
    let holm = if claims > 1 { format!(", Holm for {claims} claims") } else { String::new() };
    writeln!(out, "  {} ({test}{holm})", significance_text(significance, claims))
}

fn pairing_text(pairing: Pairing) -> &'static str {
    match pairing {
        Pairing::Pairs => "the same episodes, in pairs",
        Pairing::WithoutSeeds => "independent, not in pairs: an episode has no seed",
        Pairing::OtherEpisodes => "independent, not in pairs: the ids or seeds of episodes differ",
    }
}

fn print_finding(out: &mut dyn Write, it: &VersionComparison, alpha: f64) -> io::Result<()> {
    let version = it.version;
    match it.finding {
        Finding::Worse => writeln!(out, "  {version} is worse than 1 (p <= {alpha})"),
        Finding::Better => writeln!(out, "  {version} is better than 1 (p <= {alpha})"),
        Finding::Undecided => writeln!(
            out,
            "  undecided: `rtf campaign plan` prints how many episodes a difference needs"
        ),
    }
}

fn print_measurement(
    out: &mut dyn Write,
    it: &MeasurementComparison,
    claims: usize,
) -> io::Result<()> {
    let name = [&*it.test, &*it.name].join(" ");
    let (name, unit) = (escape::line(name.trim_start()), escape::line(&it.unit));
    let with_unit = |text: String| match unit.is_empty() {
        true => text,
        false => format!("{text} {unit}"),
    };
    let means = with_unit(format!("{:.6} → {:.6}", it.first, it.second));
    let difference = match &it.difference {
        Some(Difference { value, low, high }) => {
            with_unit(format!("  {value:+.6} ({low:.6} to {high:.6})"))
        }
        None => String::new(),
    };
    let [first, second] = it.counts;
    let values = match first == second {
        true => counted(first, "value"),
        false => format!("{first} and {}", counted(second, "value")),
    };
    let significance = significance_text(&it.significance, claims);
    writeln!(out, "  {name}  {means}{difference}  {significance}  ({values})")
}

fn print_conditions(out: &mut dyn Write, by: &ByCondition) -> io::Result<()> {
    let ByCondition { parameter, conditions } = by;
    let compared = conditions.iter().flat_map(|it| &it.comparisons);
    let claims = compared.filter(|it| it.difference.is_some()).count();
    writeln!(out, "\nby {} ({})", escape::line(parameter), exploratory_text(claims))?;
    for condition in conditions {
        writeln!(out, "  {}", escape::line(&condition.values))?;
        if let Some(first) = condition.comparisons.first() {
            writeln!(out, "    1  {}", rate_text(&first.first))?;
        }
        for ConditionComparison { version, second, difference, significance, .. } in
            &condition.comparisons
        {
            write!(out, "    {version}  {}", rate_text(second))?;
            if let Some(difference) = difference {
                let significance = significance_text(significance, claims);
                write!(out, "  difference {}  {significance}", rates_text(difference))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// `p = 0.0020`, and if there are several claims, the adjusted one.
fn significance_text(significance: &Significance, claims: usize) -> String {
    let Significance { p_value, adjusted } = *significance;
    match claims {
        1 => format_p_value(p_value),
        _ => format!("{}, adjusted {}", format_p_value(p_value), format_p_value(adjusted)),
    }
}

fn exploratory_text(claims: usize) -> String {
    match claims {
        1 => "exploratory".to_owned(),
        _ => format!("exploratory, p adjusted for {claims}"),
    }
}

fn counted(number: u64, noun: &str) -> String {
    count(usize::try_from(number).unwrap_or(usize::MAX), noun)
}

/// `-33.3 % (-50.8 to -14.9)`.
fn rates_text(difference: &Difference) -> String {
    let Difference { value, low, high } = *difference;
    format!("{:+.1} % ({:+.1} to {:+.1})", value * 100.0, low * 100.0, high * 100.0)
}

fn percent(rate: f64) -> String {
    format!("{:.1}", rate * 100.0)
}
