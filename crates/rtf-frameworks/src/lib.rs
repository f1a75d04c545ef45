//! The host of tests that were written for other frameworks: `rtf-host-framework TYPE`.
//!
//! A [`framework::Framework`] adapts one framework: it lists the cases of a program, starts
//! the program for some of them, and reads its report. The [`supervisor`] does everything
//! that all frameworks have in common: it runs the remaining cases after a crash, keeps the
//! limits, and compares the selected cases with the reported ones. `spec/frameworks.md`
//! documents both.

mod case;
mod case_reporter;
mod check;
mod elf;
mod framework;
mod frameworks;
mod host;
mod last_output;
mod listing;
mod own_child;
mod preload;
mod report_dir;
mod supervisor;
mod utf8_pieces;
mod wanted;
mod xml_report;
mod xml_stream;

pub use frameworks::foreign;

use std::ffi::OsString;

use rtf_host::Session;

/// Runs the host with its arguments.
///
/// # Errors
/// The arguments are wrong, or the runner cannot be reached.
pub fn run(args: Vec<OsString>) -> Result<(), Box<dyn std::error::Error>> {
    let Some((name, rest)) = args.split_first() else {
        return Err(frameworks::usage().into());
    };
    let Some((name, framework)) = frameworks::by_name(&name.to_string_lossy()) else {
        return Err(frameworks::usage().into());
    };
    if rest.first().is_some_and(|arg| arg == "--check") {
        return Ok(check::check(&*framework, &rest[1..])?);
    }
    let session = Session::open()?;
    // The supervisor kills what programs leave behind.
    rtf_process::adopt_orphans()?;
    let running = supervisor::RunningProgram::default();
    let host = host::FrameworkHost::new(name, framework, session.clone(), running.clone());
    let served = rtf_host::serve(&session, host);
    running.await_rest();
    Ok(served?)
}
