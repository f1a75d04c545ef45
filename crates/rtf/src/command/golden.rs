//! `rtf golden accept`: trajectories of a run become the references of later runs.
//!
//! Each check of a trajectory attaches what would be stored; `spec/golden.md` describes it.

use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_golden::{MEDIA_TYPE, Reference, by_time, by_warp};
use rtf_model::{Record, TestRecord};
use rtf_report::{escape, format_count, output_file};

use super::VerbResult;
use crate::cli::{GoldenAcceptArgs, GoldenVerb};
use crate::error::Failure;
use crate::request::{config, past_run};
use crate::terminal;

/// The prefix of a required resource that names a robot.
const ROBOT: &str = "robot:";

/// Carries out the verb.
pub fn run(verb: GoldenVerb, matches: &ArgMatches) -> VerbResult {
    let matches = matches.subcommand().map_or(matches, |(_, matches)| matches);
    match verb {
        GoldenVerb::Accept(args) => accept(args, matches),
    }
}

fn accept(mut args: GoldenAcceptArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let journal = past_run::find_journal(&args.results.results, &args.run)?;
    let record = past_run::read(&args.results.results, &args.run)?;
    let run_dir = journal.parent().unwrap_or(Path::new("."));
    let tests = select(&record, args.test.as_deref())?;
    let mut candidates = Vec::new();
    for test in tests {
        candidates.extend(Candidate::of_test(&record, test, run_dir)?);
    }
    if candidates.is_empty() {
        let error = format!("no selected test of `{}` has checked a trajectory", args.run);
        let hint = "`check_trajectory` of a test attaches what can be accepted";
        return Err(Failure::input(error).hint(hint));
    }
    refuse_two_of_one_file(&candidates)?;
    let mut stored = 0;
    let mut lines = Vec::new();
    for candidate in &candidates {
        let what = match candidate.is_within() {
            true if !args.all => "is within its tube",
            _ if args.dry_run => "would be stored",
            _ => {
                candidate.store(&record)?;
                "is stored"
            }
        };
        stored += u64::from(what != "is within its tube");
        let target = candidate.target.display();
        lines.push(format!("{target}: `{}` of {} {what}", candidate.signal(), candidate.test));
    }
    terminal::stdout(|out| {
        for line in &lines {
            writeln!(out, "{}", escape::line(line))?;
        }
        let verb = if args.dry_run { "would be accepted" } else { "accepted" };
        let count = match stored {
            1 => "1 trajectory".to_owned(),
            count => format_count(count, "trajectorie"),
        };
        writeln!(out, "{count} {verb}")
    })?;
    Ok(ExitCode::SUCCESS)
}

/// The tests with this name, or all.
fn select<'r>(record: &'r Record, name: Option<&str>) -> Result<Vec<&'r TestRecord>, Failure> {
    let is_selected = |test: &&TestRecord| {
        name.is_none_or(|name| test.plan.name == name || record.full_name(test.plan.test) == name)
    };
    let tests: Vec<_> = record.tests.iter().filter(is_selected).collect();
    match (name, tests.is_empty()) {
        (Some(name), true) => Err(Failure::input(format!("the run has no test `{name}`"))
            .hint("`rtf show` lists the tests of the run")),
        _ => Ok(tests),
    }
}

fn refuse_two_of_one_file(candidates: &[Candidate]) -> Result<(), Failure> {
    for (index, candidate) in candidates.iter().enumerate() {
        let earlier = candidates[..index].iter().find(|other| other.target == candidate.target);
        if let Some(earlier) = earlier {
            let error = format!(
                "`{}` is the reference of {} and of {}",
                candidate.target.display(),
                earlier.test,
                candidate.test
            );
            let hint = "name the test that is accepted, or give each of them another reference";
            return Err(Failure::input(error).hint(hint));
        }
    }
    Ok(())
}

/// A trajectory that can be stored.
struct Candidate {
    test: String,
    requires: Vec<String>,
    reference: Reference,
    target: PathBuf,
}

impl Candidate {
    /// The trajectories of the last attempt of a test.
    fn of_test(record: &Record, test: &TestRecord, run_dir: &Path) -> Result<Vec<Self>, Failure> {
        let name = record.full_name(test.plan.test);
        let suite = record.suites.get(test.plan.suite.index()).map(|suite| &suite.plan);
        let attempts = test.attempts.last().into_iter();
        let attachments = attempts.flat_map(|attempt| &attempt.attachments);
        let mut candidates: Vec<Self> = Vec::new();
        for attachment in attachments.filter(|it| it.media_type == MEDIA_TYPE && !it.omitted) {
            let path = run_dir.join(&attachment.path);
            let unreadable =
                |why: String| Failure::input(format!("cannot read `{}`: {why}", path.display()));
            let text = fs::read_to_string(&path).map_err(|error| unreadable(error.to_string()))?;
            let reference =
                Reference::parse(&text).map_err(|error| unreadable(error.to_string()))?;
            let file = reference.field("reference").unwrap_or_default();
            let is_below =
                Path::new(file).components().all(|it| matches!(it, Component::Normal(_)));
            if file.is_empty() || !is_below {
                return Err(unreadable(format!("`{file}` is not below the directory of a suite")));
            }
            let target = suite_dir(record, suite.map_or("", |suite| &suite.file)).join(file);
            let candidate = Self {
                test: name.clone(),
                requires: suite.map(|suite| suite.requires.clone()).unwrap_or_default(),
                reference,
                target,
            };
            // Of several checks of one test with the same file, the last one counts.
            candidates.retain(|earlier| earlier.target != candidate.target);
            candidates.push(candidate);
        }
        Ok(candidates)
    }

    fn signal(&self) -> &str {
        self.reference.field("signal").unwrap_or_default()
    }

    /// Whether the stored trajectory accepts it.
    fn is_within(&self) -> bool {
        let stored = fs::read_to_string(&self.target).ok();
        let Some(stored) = stored.and_then(|text| Reference::parse(&text).ok()) else {
            return false;
        };
        let number = |name| self.reference.field(name).and_then(|text| text.parse::<f64>().ok());
        let (got, expected) = (&self.reference.trajectory, &stored.trajectory);
        let compared = match (self.reference.field("align"), number("band")) {
            (Some("dtw"), Some(band)) => by_warp(got, expected, band),
            _ => Some(by_time(got, expected)),
        };
        let (Some(compared), Some(tolerance)) = (compared, number("tolerance")) else {
            return false;
        };
        compared.worst.size() <= tolerance && stored.field("unit") == self.reference.field("unit")
    }

    /// Writes the reference with its provenance.
    fn store(&self, record: &Record) -> Result<(), Failure> {
        let kept = ["signal", "unit", "tolerance"].into_iter();
        let kept = kept.filter_map(|name| Some((name, self.reference.field(name)?.to_owned())));
        let mut fields: Vec<(&str, String)> = kept.collect();
        fields.push(("test", self.test.clone()));
        let robots: Vec<_> =
            self.requires.iter().filter_map(|name| name.strip_prefix(ROBOT)).collect();
        if !robots.is_empty() {
            fields.push(("robot", robots.join(", ")));
        }
        if let Some(run) = &record.run {
            let manifest = &run.manifest;
            fields.extend(manifest.profile.iter().map(|profile| ("profile", profile.clone())));
            fields.push(("date", run.started_at.clone()));
            fields.push(("run", run.id()));
            fields.extend(manifest.revision.iter().map(|revision| {
                let dirty = if revision.dirty == Some(true) { ", with changes" } else { "" };
                ("commit", format!("{}{dirty}", revision.commit))
            }));
        }
        let mut reference = self.reference.clone();
        reference.fields = fields.into_iter().map(|(name, text)| (name.to_owned(), text)).collect();
        output_file::write("the reference", &self.target, |out| {
            out.write_all(reference.to_string().as_bytes())
        })
        .map_err(Failure::internal)
    }
}

/// The directory of a suite: that of the run, or below the present one if the run is from another
/// machine.
fn suite_dir(record: &Record, file: &str) -> PathBuf {
    let file = Path::new(file);
    let working_dir = record.run.as_ref().map(|run| Path::new(&run.working_dir).join(file));
    let found = working_dir.filter(|path| path.is_file());
    let path = found.unwrap_or_else(|| file.to_path_buf());
    let current = std::env::current_dir().unwrap_or_default();
    let dir = path.parent().unwrap_or(Path::new(""));
    dir.strip_prefix(&current).unwrap_or(dir).to_path_buf()
}
