//! `rtf golden accept`: trajectories and pictures of a run become the references of later runs.
//!
//! Each check of a trajectory or picture attaches what would be stored; `spec/golden.md` describes it.

use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_golden::{MEDIA_TYPE, Reference, by_time, by_warp};
use rtf_model::{Attachment, Record, TestRecord};
use rtf_report::{escape, format_count, output_file};
use rtf_run::error::Failure;
use rtf_run::request::past_run;
use rtf_run::terminal;

use super::VerbResult;
use super::golden_picture::PictureFile;
use crate::cli::{GoldenAcceptArgs, GoldenVerb};
use crate::request::config;

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
        let error =
            format!("no selected test of `{}` has checked a trajectory or a picture", args.run);
        let hint = "`check_trajectory` or `check_picture` of a test attaches what can be accepted";
        return Err(Failure::input(error).hint(hint));
    }
    refuse_two_of_one_file(&candidates)?;
    let mut stored = Vec::new();
    let mut lines = Vec::new();
    for candidate in &candidates {
        let is_kept = !args.all && candidate.is_within();
        let what = match is_kept {
            true => candidate.content.unchanged(),
            false if args.dry_run => "would be stored",
            false => {
                candidate.store(&record)?;
                "is stored"
            }
        };
        stored.extend((!is_kept).then_some(&candidate.content));
        let target = candidate.target.display();
        lines.push(format!("{target}: `{}` of {} {what}", candidate.name(), candidate.test));
    }
    terminal::stdout(|out| {
        for line in &lines {
            writeln!(out, "{}", escape::line(line))?;
        }
        let verb = if args.dry_run { "would be accepted" } else { "accepted" };
        writeln!(out, "{} {verb}", count(&stored))
    })?;
    Ok(ExitCode::SUCCESS)
}

/// What is stored: `2 trajectories and 1 picture`, `nothing`.
fn count(stored: &[&Content]) -> String {
    let pictures = stored.iter().filter(|it| matches!(it, Content::Picture(_))).count();
    let trajectories = match stored.len() - pictures {
        1 => "1 trajectory".to_owned(),
        count => format_count(count as u64, "trajectorie"),
    };
    match (stored.len() - pictures, pictures) {
        (0, 0) => "nothing".to_owned(),
        (_, 0) => trajectories,
        (0, pictures) => format_count(pictures as u64, "picture"),
        (_, pictures) => format!("{trajectories} and {}", format_count(pictures as u64, "picture")),
    }
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

/// A trajectory or picture that can be stored.
struct Candidate {
    test: String,
    requires: Vec<String>,
    content: Content,
    target: PathBuf,
}

enum Content {
    Trajectory(Reference),
    Picture(PictureFile),
}

impl Content {
    /// The content of an attachment, and the path of its reference; `None` if it is neither.
    fn of(attachment: &Attachment, run_dir: &Path) -> Option<Result<(Self, String), String>> {
        let path = run_dir.join(&attachment.path);
        if let Some(check) = &attachment.picture {
            let picture = PictureFile::read(&attachment.name, &path, check.tolerance);
            return Some(picture.map(|it| (Self::Picture(it), check.reference.clone())));
        }
        (attachment.media_type == MEDIA_TYPE).then(|| {
            let text = fs::read_to_string(&path).map_err(|error| error.to_string())?;
            let reference = Reference::parse(&text).map_err(|error| error.to_string())?;
            let file = reference.field("reference").unwrap_or_default().to_owned();
            Ok((Self::Trajectory(reference), file))
        })
    }

    fn unchanged(&self) -> &'static str {
        match self {
            Self::Trajectory(_) => "is within its tube",
            Self::Picture(_) => "is within its tolerance",
        }
    }
}

impl Candidate {
    /// The trajectories and pictures of the last attempt of a test.
    fn of_test(record: &Record, test: &TestRecord, run_dir: &Path) -> Result<Vec<Self>, Failure> {
        let name = record.full_name(test.plan.test);
        let suite = record.suites.get(test.plan.suite.index()).map(|suite| &suite.plan);
        let attempts = test.attempts.last().into_iter();
        let attachments = attempts.flat_map(|attempt| &attempt.attachments);
        let mut candidates: Vec<Self> = Vec::new();
        for attachment in attachments.filter(|it| !it.omitted) {
            let path = run_dir.join(&attachment.path);
            let unreadable =
                |why: String| Failure::input(format!("cannot read `{}`: {why}", path.display()));
            let Some(content) = Content::of(attachment, run_dir) else { continue };
            let (content, file) = content.map_err(unreadable)?;
            let is_below =
                Path::new(&file).components().all(|it| matches!(it, Component::Normal(_)));
            if file.is_empty() || !is_below {
                return Err(unreadable(format!("`{file}` is not below the directory of a suite")));
            }
            let target = suite_dir(record, suite.map_or("", |suite| &suite.file)).join(file);
            let candidate = Self {
                test: name.clone(),
                requires: suite.map(|suite| suite.requires.clone()).unwrap_or_default(),
                content,
                target,
            };
            // Of several checks of one test with the same file, the last one counts.
            candidates.retain(|earlier| earlier.target != candidate.target);
            candidates.push(candidate);
        }
        Ok(candidates)
    }

    /// The name of the signal or of the picture.
    fn name(&self) -> &str {
        match &self.content {
            Content::Trajectory(reference) => reference.field("signal").unwrap_or_default(),
            Content::Picture(picture) => &picture.name,
        }
    }

    /// Whether the stored reference accepts it.
    fn is_within(&self) -> bool {
        match &self.content {
            Content::Trajectory(reference) => is_within_tube(reference, &self.target),
            Content::Picture(picture) => picture.resembles(&self.target),
        }
    }

    fn store(&self, record: &Record) -> Result<(), Failure> {
        let bytes = match &self.content {
            Content::Trajectory(reference) => {
                self.with_provenance(reference, record).to_string().into_bytes()
            }
            Content::Picture(picture) => picture.bytes.clone(),
        };
        output_file::write("the reference", &self.target, |out| out.write_all(&bytes))
            .map_err(Failure::internal)
    }

    fn with_provenance(&self, reference: &Reference, record: &Record) -> Reference {
        let kept = ["signal", "unit", "tolerance"].into_iter();
        let kept = kept.filter_map(|name| Some((name, reference.field(name)?.to_owned())));
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
        let mut reference = reference.clone();
        reference.fields = fields.into_iter().map(|(name, text)| (name.to_owned(), text)).collect();
        reference
    }
}

/// Whether the stored trajectory accepts another one.
fn is_within_tube(got: &Reference, target: &Path) -> bool {
    let stored = fs::read_to_string(target).ok();
    let Some(stored) = stored.and_then(|text| Reference::parse(&text).ok()) else {
        return false;
    };
    let number = |name| got.field(name).and_then(|text| text.parse::<f64>().ok());
    let compared = match (got.field("align"), number("band")) {
        (Some("dtw"), Some(band)) => by_warp(&got.trajectory, &stored.trajectory, band),
        _ => Some(by_time(&got.trajectory, &stored.trajectory)),
    };
    let (Some(compared), Some(tolerance)) = (compared, number("tolerance")) else {
        return false;
    };
    compared.worst.size() <= tolerance && stored.field("unit") == got.field("unit")
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
