//! `rtf init`: adds settings and CI jobs to an existing project. It adds files and lines, and
//! changes none, so that it can run repeatedly.

mod gitignore;

use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::terminal;

use super::VerbResult;
use crate::cli::InitArgs;

/// New files and their texts.
const FILES: [(&str, &str); 3] = [
    ("rtf.toml", include_str!("../../../templates/init/rtf.toml")),
    (".github/workflows/rtf.yml", include_str!("../../../templates/init/github.yml")),
    (GITLAB_JOB, include_str!("../../../templates/init/gitlab.yml")),
];
const GITLAB_JOB: &str = ".gitlab/rtf.yml";
/// GitLab reads only this file, which includes the job.
const GITLAB: (&str, &str) =
    (".gitlab-ci.yml", include_str!("../../../templates/init/gitlab-ci.yml"));
const GITIGNORE: (&str, &str) = (".gitignore", include_str!("../../../templates/init/gitignore"));

/// What happened to a file.
enum Change {
    Written,
    /// Lines were added to it.
    Extended(Vec<String>),
    Unchanged,
}

/// Adds the files.
pub fn run(args: &InitArgs) -> VerbResult {
    let dir = &args.directory;
    if !dir.is_dir() {
        return Err(Failure::input(format!("there is no directory `{}`", dir.display())));
    }
    let mut changes = Vec::new();
    for (name, text) in FILES.into_iter().chain([GITLAB]) {
        changes.push((name, create(dir, name, text)?));
    }
    changes.push((GITIGNORE.0, ignore(dir)?));
    print(&changes, includes_job(dir))?;
    Ok(ExitCode::SUCCESS)
}

fn create(dir: &Path, name: &str, text: &str) -> Result<Change, Failure> {
    let path = dir.join(name);
    if path.symlink_metadata().is_ok() {
        return Ok(Change::Unchanged);
    }
    let parent = path.parent().unwrap_or(dir);
    let written = std::fs::create_dir_all(parent)
        .and_then(|()| File::create_new(&path))
        .and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| cannot("written", name, &error))?;
    Ok(Change::Written)
}

/// Adds the missing lines to `.gitignore`.
fn ignore(dir: &Path) -> Result<Change, Failure> {
    let (name, wanted) = GITIGNORE;
    let change = create(dir, name, wanted)?;
    if !matches!(change, Change::Unchanged) {
        return Ok(change);
    }
    let path = dir.join(name);
    let text = std::fs::read_to_string(&path).map_err(|error| cannot("read", name, &error))?;
    let missing = gitignore::missing(&text, wanted);
    if missing.is_empty() {
        return Ok(Change::Unchanged);
    }
    let added = gitignore::added(&text, &missing);
    File::options()
        .append(true)
        .open(&path)
        .and_then(|mut file| file.write_all(added.as_bytes()))
        .map_err(|error| cannot("written", name, &error))?;
    Ok(Change::Extended(missing))
}

fn cannot(verb: &str, name: &str, error: &io::Error) -> Failure {
    Failure::input(format!("`{name}` cannot be {verb}: {error}"))
}

/// Whether `.gitlab-ci.yml` mentions the job's file.
fn includes_job(dir: &Path) -> bool {
    std::fs::read(dir.join(GITLAB.0))
        .is_ok_and(|text| String::from_utf8_lossy(&text).contains(GITLAB_JOB))
}

fn print(changes: &[(&str, Change)], includes_job: bool) -> Result<(), Failure> {
    terminal::stdout(|out| {
        for (name, change) in changes {
            match change {
                Change::Written => writeln!(out, "wrote {name}")?,
                Change::Extended(lines) => {
                    writeln!(out, "added to {name}: {}", escape::line(&lines.join(", ")))?;
                }
                Change::Unchanged => writeln!(out, "unchanged: {name}")?,
            }
        }
        if changes.iter().all(|(_, change)| matches!(change, Change::Unchanged)) {
            writeln!(out, "nothing to do: the project has all files and lines")?;
        }
        if !includes_job {
            writeln!(out, "\nhint: {} does not include the job; add:\n\n{}", GITLAB.0, GITLAB.1)?;
        }
        Ok(())
    })
}
