//! Report files are written atomically.
//!
//! A report is written to a temporary file and then renamed, so that a
//! reader never sees half of it and an earlier report survives a failure. What
//! is no regular file (`/dev/stdout`, a named pipe) is written directly.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::ReportError;

/// Checks before a run that a report can be written to `path` after it: makes
/// the directory if it is missing, and creates and removes a temporary file next to the report.
///
/// # Errors
/// What would prevent the report.
pub fn probe(what: &'static str, path: &Path) -> Result<(), ReportError> {
    probe_io(path).map_err(ReportError::at(what, path))
}

/// Writes a report: `fill` writes its content.
///
/// # Errors
/// The file cannot be written; an earlier report at `path` is then unchanged.
pub fn write(
    what: &'static str,
    path: &Path,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<(), ReportError> {
    write_io(path, fill).map_err(ReportError::at(what, path))
}

fn probe_io(path: &Path) -> io::Result<()> {
    match target(path)? {
        WriteTarget::Direct => OpenOptions::new().write(true).open(path).map(drop),
        WriteTarget::Replace { path, beside } => {
            create_folder_of(&path)?;
            File::create_new(&beside)?;
            fs::remove_file(&beside)
        }
    }
}

fn write_io(
    path: &Path,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> io::Result<()> {
    match target(path)? {
        WriteTarget::Direct => {
            fill_file(OpenOptions::new().write(true).open(path)?, fill).map(drop)
        }
        WriteTarget::Replace { path, beside } => {
            create_folder_of(&path)?;
            let written = File::create_new(&beside)
                .and_then(|file| fill_file(file, fill))
                .and_then(|file| file.sync_all())
                .and_then(|()| fs::rename(&beside, &path));
            if written.is_err() {
                // The first error is the one to tell; the leftover may not even exist.
                drop(fs::remove_file(&beside));
            }
            written
        }
    }
}

fn fill_file(
    file: File,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> io::Result<File> {
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    writer.into_inner().map_err(io::IntoInnerError::into_error)
}

enum WriteTarget {
    /// Written where it is.
    Direct,
    /// Written to `beside`, then renamed to `path`.
    Replace { path: PathBuf, beside: PathBuf },
}

fn target(path: &Path) -> io::Result<WriteTarget> {
    let path = match fs::metadata(path) {
        Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => return Ok(WriteTarget::Direct),
        // A link stays a link: the file that it leads to is replaced.
        Ok(_) => fs::canonicalize(path)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => path.to_owned(),
        Err(error) => return Err(error),
    };
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.tmp", std::process::id()));
    let beside = path.with_file_name(temporary);
    Ok(WriteTarget::Replace { path, beside })
}

fn create_folder_of(path: &Path) -> io::Result<()> {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => fs::create_dir_all(parent),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_probe_makes_the_folder_and_leaves_nothing_in_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/junit.xml");
        probe("a report", &path).unwrap();
        assert!(names(path.parent().unwrap()).is_empty());
    }

    #[test]
    fn a_probe_finds_what_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let below_a_file = probe("a report", &file.join("junit.xml")).unwrap_err();
        assert_eq!(below_a_file.source.kind(), io::ErrorKind::NotADirectory);
        let a_folder = probe("a report", folder.path()).unwrap_err();
        assert_eq!(a_folder.source.kind(), io::ErrorKind::IsADirectory);
    }

    #[test]
    fn an_earlier_report_survives_a_failure() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.txt");
        write("a report", &path, |out| out.write_all(b"old")).unwrap();
        let failing = |out: &mut (dyn Write + Send)| {
            out.write_all(b"new")?;
            Err(io::ErrorKind::StorageFull.into())
        };
        assert!(write("a report", &path, failing).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["report.txt"]);
    }
}
