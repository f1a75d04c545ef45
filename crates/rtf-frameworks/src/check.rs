//! `--check FILE… [-- ARGUMENT…]`: lists the cases of each file.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use rtf_host::CheckedFile;

use crate::case::ListedCase;
use crate::framework::{Framework, TestProgram};

/// The result for one file, with its cases.
#[derive(serde::Serialize)]
struct Listing {
    #[serde(flatten)]
    file: CheckedFile,
    #[serde(skip_serializing_if = "Option::is_none")]
    cases: Option<Vec<ListedCase>>,
}

/// Checks files, and prints a line for each.
///
/// # Errors
/// The standard output cannot be written.
pub fn check(framework: &dyn Framework, args: &[OsString]) -> std::io::Result<()> {
    let (files, args) = match args.iter().position(|arg| arg == "--") {
        Some(at) => (&args[..at], &args[at + 1..]),
        None => (args, &[][..]),
    };
    let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
    let args: Vec<String> = args.iter().map(|arg| arg.to_string_lossy().into_owned()).collect();
    rtf_host::check(&files, |file| list(framework, file, &args))
}

fn list(framework: &dyn Framework, file: &Path, args: &[String]) -> Listing {
    let test = TestProgram { file: file.to_path_buf(), args: args.to_vec() };
    match framework.list(&test) {
        Ok(cases) => {
            let kinds = Some(vec!["test".to_owned()]);
            Listing { file: CheckedFile::good(file, kinds), cases }
        }
        Err(error) => {
            let file = CheckedFile::bad(file, error.message, error.line);
            Listing { file, cases: None }
        }
    }
}
