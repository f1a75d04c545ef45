//! `rtf cmake-dir`, `rtf ament-dir` and `rtf ada-dir`: where builds find CMake packages, the
//! package for ament, and the Ada SDK.

use std::path::PathBuf;
use std::process::ExitCode;

use rtf_plan::plan::{self, RunnerEnvironment};
use rtf_run::error::Failure;
use rtf_run::terminal;

use super::VerbResult;

/// Prints the directory of the CMake packages.
pub fn cmake() -> VerbResult {
    print("CMake packages", plan::cmake_dir)
}

/// Prints the directory of the packages for ament.
pub fn ament() -> VerbResult {
    print("package for ament", plan::ament_dir)
}

/// Prints the directory of the Ada SDK.
pub fn ada() -> VerbResult {
    print("Ada SDK", plan::ada_dir)
}

fn print(sdk: &str, find: fn(&RunnerEnvironment) -> Option<PathBuf>) -> VerbResult {
    let runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let dir = find(&runner).ok_or_else(|| {
        let program = runner.executable.display();
        Failure::input(format!("`{program}` has no {sdk}"))
            .hint("`make install` and the package `rtf-dev` install them")
    })?;
    terminal::raw_stdout(|out| {
        out.write_all(dir.as_os_str().as_encoded_bytes())?;
        out.write_all(b"\n")
    })?;
    Ok(ExitCode::SUCCESS)
}
