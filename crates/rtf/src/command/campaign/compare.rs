//! `rtf campaign compare`: which versions differ from the first one.

use std::path::Path;
use std::process::ExitCode;

use rtf_campaign::comparison::{Comparison, Options, UnknownParameter, compare};
use rtf_run::campaign;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::campaign::trials::{self, Unblinded};
use rtf_run::campaign::version::LoadedVersion;
use rtf_run::error::Failure;
use rtf_run::{exit, terminal};
use serde_json::{Value, json};

use super::comparison_text;
use crate::cli::{CampaignCompareArgs, CampaignFormat};
use crate::command::VerbResult;

/// Compares the results of all versions with those of the first one.
pub fn run(args: &CampaignCompareArgs) -> VerbResult {
    let options = Options { alpha: args.alpha, by: args.by.as_deref(), seed: 0 };
    let (versions, compared, unblinded) = match args.next.as_slice() {
        [] => of_one_campaign(&args.first, &options)?,
        _ => of_several(args, &options)?,
    };
    let comparison = compared.map_err(|unknown| no_parameter(&unknown, &versions))?;
    if args.format == CampaignFormat::Json {
        let mut document = document(&comparison, &versions).map_err(Failure::internal)?;
        if let Some(unblinded) = &unblinded {
            document["unblinded"] = json!(unblinded);
        }
        let text = serde_json::to_string_pretty(&document).map_err(Failure::internal)?;
        terminal::stdout(|out| writeln!(out, "{text}"))?;
    } else {
        terminal::stdout(|out| {
            comparison_text::print(out, &comparison, &versions)?;
            comparison_text::print_unblinded(out, unblinded.as_ref())
        })?;
    }
    let is_worse = comparison.any_worse();
    Ok(ExitCode::from(if is_worse { exit::FAILED } else { exit::PASSED }))
}

/// The versions, their comparison, and who has seen them early.
type Compared = (Vec<LoadedVersion>, Result<Comparison, UnknownParameter>, Option<Unblinded>);

fn of_several(args: &CampaignCompareArgs, options: &Options<'_>) -> Result<Compared, Failure> {
    let paths = [&args.first].into_iter().chain(&args.next);
    let mut versions =
        paths.map(|path| LoadedVersion::read(path)).collect::<Result<Vec<_>, _>>()?;
    refuse_other_campaigns(&versions)?;
    let take = |version: &mut LoadedVersion| std::mem::take(&mut version.episodes);
    let episodes: Vec<_> = versions.iter_mut().map(take).collect();
    let compared = compare(&episodes, options);
    Ok((versions, compared, None))
}

fn of_one_campaign(path: &Path, options: &Options<'_>) -> Result<Compared, Failure> {
    if !path.is_dir() {
        let error = format!("`{}` has nothing to be compared with", path.display());
        return Err(Failure::input(error).hint("add the results of another version"));
    }
    let dir = CampaignDir::open_judged(path)?;
    let ledger = campaign::stored_ledger(&dir, dir.episodes()?.episodes.len());
    if dir.hides_versions(&ledger) {
        return Err(trials::hidden(&dir, &ledger));
    }
    let (versions, compared) = trials::compare_versions(&dir, options)?;
    Ok((versions, compared, dir.unblinded()))
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
    let path = versions.get(version - 1).map(|version| version.path.display().to_string());
    let path = path.unwrap_or_default();
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
        if let Some(name) = &version.name {
            shown["version"] = json!(name);
        }
        shown["source"] = json!(version.source);
        shown["sequential"] = json!(version.is_sequential);
    }
    Ok(document)
}
