//! `rtf campaign compare`: which versions differ from the first one.

use std::process::ExitCode;

use rtf_campaign::comparison::{Comparison, Options, UnknownParameter, compare};
use rtf_run::campaign::version::LoadedVersion;
use rtf_run::error::Failure;
use rtf_run::{exit, terminal};
use serde_json::{Value, json};

use super::comparison_text;
use crate::cli::{CampaignCompareArgs, CampaignFormat};
use crate::command::VerbResult;

/// Compares the results of all versions with those of the first one.
pub fn run(args: &CampaignCompareArgs) -> VerbResult {
    let paths = [&args.first].into_iter().chain(&args.next);
    let mut versions =
        paths.map(|path| LoadedVersion::read(path)).collect::<Result<Vec<_>, _>>()?;
    refuse_other_campaigns(&versions)?;
    let take = |version: &mut LoadedVersion| std::mem::take(&mut version.episodes);
    let episodes: Vec<_> = versions.iter_mut().map(take).collect();
    let options = Options { alpha: args.alpha, by: args.by.as_deref(), seed: 0 };
    let comparison =
        compare(&episodes, &options).map_err(|unknown| no_parameter(&unknown, &versions))?;
    if args.format == CampaignFormat::Json {
        let document = document(&comparison, &versions).map_err(Failure::internal)?;
        let text = serde_json::to_string_pretty(&document).map_err(Failure::internal)?;
        terminal::stdout(|out| writeln!(out, "{text}"))?;
    } else {
        terminal::stdout(|out| comparison_text::print(out, &comparison, &versions))?;
    }
    let is_worse = comparison.any_worse();
    Ok(ExitCode::from(if is_worse { exit::FAILED } else { exit::PASSED }))
}

/// The episodes of another campaign may be easier.
fn refuse_other_campaigns(versions: &[LoadedVersion]) -> Result<(), Failure> {
    let Some((first, next)) = versions.split_first() else { return Ok(()) };
    let Some(other) = next.iter().find(|it| it.is_other_campaign(first)) else { return Ok(()) };
    let (first, other) = (first.path.display(), other.path.display());
    let error = format!("`{first}` and `{other}` have different episodes");
    Err(Failure::input(error).hint("compare runs of one campaign file, with the same seed"))
}

fn no_parameter(unknown: &UnknownParameter, versions: &[LoadedVersion]) -> Failure {
    let UnknownParameter { version, name, known } = unknown;
    let path = versions.get(version - 1).map(|version| version.path.display());
    let path = path.map(|path| path.to_string()).unwrap_or_default();
    let failure = Failure::input(format!("`{path}` has no parameter `{name}`"));
    let known: Vec<_> = known.iter().map(|name| format!("`{name}`")).collect();
    match known.is_empty() {
        true => failure.hint("it has no parameters"),
        false => failure.hint(format!("its parameters are {}", known.join(", "))),
    }
}

/// The comparison, and what each version is.
fn document(
    comparison: &Comparison,
    versions: &[LoadedVersion],
) -> Result<Value, serde_json::Error> {
    let mut document = serde_json::to_value(comparison)?;
    let shown = document.get_mut("versions").and_then(Value::as_array_mut);
    for (shown, version) in shown.into_iter().flatten().zip(versions) {
        shown["path"] = json!(version.path);
        shown["source"] = json!(version.source);
        shown["sequential"] = json!(version.is_sequential);
    }
    Ok(document)
}
