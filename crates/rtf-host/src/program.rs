//! The program of a host: `--check`, a fork server, or one session with the runner.

use std::error::Error;
use std::ffi::{CStr, OsStr, OsString, c_char, c_int};
use std::io::Write;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use crate::fork_server::ForkServer;
use crate::{CheckedFile, Session, check, files_to_check, unix};

/// The exit code after an error of the host itself.
const EXIT_ERROR: c_int = 2;

/// The functions of a host's program.
#[derive(Clone, Copy, Debug)]
pub struct HostProgram<P> {
    /// Checks whether a file can be loaded.
    pub check: fn(&Path) -> CheckedFile,
    /// Prepares what most plug-ins need, before a server forks its first host.
    /// The process has one thread and must have one afterwards.
    pub prepare: fn() -> P,
    /// Serves a runner to the end of the session, with what `prepare` returned (or the
    /// default, if the process was not forked).
    pub serve: fn(&Session, P) -> std::io::Result<()>,
}

impl<P: Default> HostProgram<P> {
    /// Runs the program and returns its exit code.
    ///
    /// The program starts as a C program does, without Rust's start-up code,
    /// which would leave signal handlers and a second signal stack in a process
    /// that belongs to the plug-in.
    ///
    /// # Safety
    /// `argv` holds `argc` strings: what C's `main` was called with.
    #[expect(unsafe_code, reason = "the arguments are C's")]
    #[must_use]
    pub unsafe fn main(self, argc: c_int, argv: *const *const c_char) -> c_int {
        let count = usize::try_from(argc).unwrap_or(0);
        let args = (1..count).map(|index| {
            // SAFETY: the system passes `argc` strings.
            let arg = unsafe { CStr::from_ptr(*argv.add(index)) };
            OsStr::from_bytes(arg.to_bytes()).to_owned()
        });
        match self.run(args.collect()) {
            Ok(()) => 0,
            Err(error) => {
                print_error(&*error);
                EXIT_ERROR
            }
        }
    }

    fn run(self, args: Vec<OsString>) -> Result<(), Box<dyn Error>> {
        if let Some(files) = files_to_check(args.iter().cloned()) {
            return Ok(check(&files, self.check)?);
        }
        if let Some(arg) = args.first() {
            let arg = arg.to_string_lossy();
            return Err(
                format!("unexpected argument `{arg}`; only `--check FILE…` is known").into()
            );
        }
        unix::buffer_output_by_lines();
        let (session, prepared) = match ForkServer::open()? {
            Some(server) => {
                let prepared = (self.prepare)();
                (server.serve()?, prepared)
            }
            None => (Some(Session::open()?), P::default()),
        };
        session.map_or(Ok(()), |session| Ok((self.serve)(&session, prepared)?))
    }
}

/// Prints the error with its causes. The runner shows it as the host's output.
fn print_error(error: &dyn Error) {
    let mut text = format!("error: {error}\n");
    let mut cause = error.source();
    while let Some(error) = cause {
        text.push_str(&format!("caused by: {error}\n"));
        cause = error.source();
    }
    drop(std::io::stderr().write_all(text.as_bytes()));
}
