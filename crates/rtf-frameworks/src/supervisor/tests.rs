//! Tests with processes of the type `program`.

use std::os::unix::net::UnixStream;

use rtf_host::Session;
use rtf_model::protocol::Plugin;

use super::{RunningProgram, run};
use crate::frameworks;

/// The processor time of this thread, in ticks of 10 ms: fields 14 and 15 of its `stat`.
fn ticks() -> u64 {
    let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    fields[11..13].iter().map(|field| field.parse::<u64>().unwrap()).sum()
}

#[test]
fn a_program_that_closes_its_session_leaves_the_host_idle() {
    let (_, framework) = frameworks::by_name("program").unwrap();
    let script = "eval \"exec ${RTF_SESSION#fd:}>&-\"; sleep 1";
    let args = ["-c", script].map(str::to_owned).to_vec();
    let plugin = Plugin { file: "/bin/bash".to_owned(), args, ..Plugin::default() };
    let (_runner, ours) = UnixStream::pair().unwrap();
    let (session, running) = (Session::over(ours), RunningProgram::default());
    let scratch = tempfile::tempdir().unwrap();
    let before = ticks();
    run(&*framework, &plugin, &session, &running, scratch.path());
    let used = ticks() - before;
    assert!(used <= 5, "waiting for a second took {used} ticks of the processor");
}
