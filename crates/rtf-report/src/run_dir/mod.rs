//! The directory with the results of one run, which no other run
//! shares or overwrites.

mod resolve;

use std::fs;
use std::io;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use jiff::Zoned;
use jiff::tz::TimeZone;

use crate::local_time;

pub use resolve::{ResolveError, resolve};

/// The journal's name in the directory of a run.
pub const JOURNAL: &str = "events.jsonl";

/// The link to the newest run in the results directory.
pub const LATEST: &str = "latest";

/// Maximum number of attempts to find an unused name.
const TRIES: u32 = 100;

/// After this time the name is another one: a step of its last digits.
const NEXT_NAME: Duration = Duration::from_micros(16);

#[derive(Clone, Debug)]
pub struct RunDir {
    /// Its path, below the results directory as the user named it.
    pub path: PathBuf,
    /// Its name, which is the run's: `2026-11-21T06-30-12Z-1f3a`.
    pub name: String,
    /// The time in its name as RFC 3339 with the local offset, for `run-started`.
    pub started_at: String,
}

impl RunDir {
    #[must_use]
    pub fn journal(&self) -> PathBuf {
        self.path.join(JOURNAL)
    }

    /// The directory for attachments; it is created on demand.
    ///
    /// # Errors
    /// The directory cannot be created.
    pub fn attachments(&self) -> Result<PathBuf, RunDirError> {
        let path = self.path.join("attachments");
        match fs::create_dir_all(&path) {
            Ok(()) => Ok(path),
            Err(source) => Err(RunDirError::Create { path, source }),
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum RunDirError {
    /// A directory cannot be created or written.
    #[error("cannot create the results directory `{}`", path.display())]
    Create {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    /// A link to the run cannot be replaced.
    #[error("cannot make `{}` lead to this run", path.display())]
    Latest {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
}

/// Creates the directory of a new run in `results` (which is created, too, if necessary)
/// and points `latest` to it.
///
/// # Errors
/// Nothing can be written there. Nothing was started yet.
pub fn create(results: &Path) -> Result<RunDir, RunDirError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        |source| RunDirError::Create { path, source }
    };
    fs::create_dir_all(results).map_err(failed(results))?;
    let mut tried = 0;
    let (now, name, path) = loop {
        let now = local_time::now();
        let name = name(&now);
        let path = results.join(&name);
        match fs::create_dir(&path) {
            Ok(()) => break (now, name, path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && tried < TRIES => {
                tried += 1;
                thread::sleep(NEXT_NAME);
            }
            Err(error) => return Err(failed(&path)(error)),
        }
    };
    if let Err(error) = point_latest(results, &name) {
        // Nothing will run: remove the empty directory.
        drop(fs::remove_dir(&path));
        return Err(error);
    }
    let started_at = now.strftime("%Y-%m-%dT%H:%M:%S%.3f%:z").to_string();
    Ok(RunDir { path, name, started_at })
}

/// Makes `link` lead to the directory of a run, in place of an earlier link.
///
/// # Errors
/// Something else is there, or it cannot be written.
pub fn link(dir: &RunDir, link: &Path) -> Result<(), RunDirError> {
    let failed = |source| RunDirError::Latest { path: link.to_owned(), source };
    if link.symlink_metadata().is_ok_and(|found| !found.is_symlink()) {
        return Err(failed(io::ErrorKind::AlreadyExists.into()));
    }
    let target = std::path::absolute(&dir.path).map_err(failed)?;
    let mut beside = link.as_os_str().to_owned();
    beside.push(format!("-{}", dir.name));
    let beside = PathBuf::from(beside);
    symlink(&target, &beside).and_then(|()| fs::rename(&beside, link)).map_err(failed)
}

/// Names sort by time: the last four digits are the fraction of the second, in
/// steps of 1/65536 s. They also keep runs of one second apart.
fn name(now: &Zoned) -> String {
    let time = now.with_time_zone(TimeZone::UTC).strftime("%Y-%m-%dT%H-%M-%SZ").to_string();
    let fraction = (i64::from(now.subsec_nanosecond()) << 16) / 1_000_000_000;
    format!("{time}-{fraction:04x}")
}

/// Replaces the link atomically, so that it is always valid.
fn point_latest(results: &Path, name: &str) -> Result<(), RunDirError> {
    let link = results.join(LATEST);
    let beside = results.join(format!(".{LATEST}-{name}"));
    let replaced = match symlink(name, &beside) {
        // File systems of USB sticks and some shares have no links; `latest`
        // is then found by the names, which sort by time.
        Err(error) if cannot_link(&error) => return Ok(()),
        made => made.and_then(|()| fs::rename(&beside, &link)),
    };
    replaced.map_err(|source| {
        // The first error is the one to tell; the leftover may not even exist.
        drop(fs::remove_file(&beside));
        RunDirError::Latest { path: link, source }
    })
}

fn cannot_link(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::Unsupported | io::ErrorKind::PermissionDenied)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_moment_get_folders_of_their_own() {
        let results = tempfile::tempdir().unwrap();
        let threads: Vec<_> = (0..8)
            .map(|_| {
                let results = results.path().to_owned();
                std::thread::spawn(move || {
                    (0..20).map(|_| create(&results).unwrap().name).collect::<Vec<_>>()
                })
            })
            .collect();
        let mut names: Vec<_> = threads.into_iter().flat_map(|t| t.join().unwrap()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), 160);
        let latest = fs::read_link(results.path().join(LATEST)).unwrap();
        assert!(names.contains(&latest.to_str().unwrap().to_owned()));
    }

    #[test]
    fn runs_of_one_second_sort_by_time() {
        let results = tempfile::tempdir().unwrap();
        let names: Vec<_> = (0..200).map(|_| create(results.path()).unwrap().name).collect();
        assert!(names.is_sorted(), "{names:#?}");
    }

    #[test]
    fn the_name_is_the_time_in_utc() {
        let name_at = |time: &str| name(&time.parse().unwrap());
        assert_eq!(name_at("2026-11-21T08:30:12+02:00[+02:00]"), "2026-11-21T06-30-12Z-0000");
        assert_eq!(name_at("2026-11-21T08:30:12.5+02:00[+02:00]"), "2026-11-21T06-30-12Z-8000");
        assert_eq!(name_at("2026-11-21T06:30:12.999999999Z[UTC]"), "2026-11-21T06-30-12Z-ffff");
    }

    #[test]
    fn a_results_folder_that_is_a_file_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("results");
        fs::write(&file, "").unwrap();
        let error = create(&file).unwrap_err();
        assert!(matches!(error, RunDirError::Create { .. }), "{error}");
    }

    #[test]
    fn a_link_leads_to_the_run_that_was_linked_last() {
        let results = tempfile::tempdir().unwrap();
        let path = results.path().join("run");
        for _ in 0..2 {
            let dir = create(results.path()).unwrap();
            link(&dir, &path).unwrap();
            assert_eq!(fs::read_link(&path).unwrap(), dir.path);
        }
        let file = results.path().join("notes.txt");
        fs::write(&file, "mine").unwrap();
        link(&create(results.path()).unwrap(), &file).unwrap_err();
        assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    }

    #[test]
    fn a_folder_named_latest_is_not_taken_away() {
        let results = tempfile::tempdir().unwrap();
        fs::create_dir_all(results.path().join("latest/mine")).unwrap();
        let error = create(results.path()).unwrap_err();
        assert!(matches!(error, RunDirError::Latest { .. }), "{error}");
        assert!(results.path().join("latest/mine").is_dir());
        assert_eq!(fs::read_dir(results.path()).unwrap().count(), 1, "nothing else is left");
    }
}
