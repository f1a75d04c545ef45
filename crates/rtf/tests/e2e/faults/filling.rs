//! Faults that fill memory and file systems.

use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rtf_model::{EventKind, TestId, Verdict};

use super::{faults, folder, passes, run};

/// The resident memory of the host grows, and shrinks again.
#[test]
fn memory_is_filled_and_freed() {
    let (finished, journal, _folder) = run(
        "<fault name='full' kind='memory' size='300MiB' at='200ms' for='1s'/>
         <signal name='memory' fixture='faults' of='rss' every='20ms'/>
         <monitor name='filled' severity='fail'>eventually(memory > 300MiB)</monitor>
         <monitor name='freed' severity='fail'>eventually(memory > 300MiB and eventually(memory &lt; 100MiB))</monitor>
         <test> T.lua </test>",
        "function TestCase.run() rtf.sleep(4) end\n",
    );
    passes(&finished);
    assert_eq!(faults(&journal)[0].fault.effect, "filled 300 MiB of memory");
}

#[test]
fn more_memory_than_there_is_is_an_error() {
    let (finished, journal, _folder) = run(
        "<test> T.lua <fault name='full' kind='memory' size='9000000GiB' at='0'/></test>",
        "function TestCase.run() rtf.sleep(0.5) end\n",
    );
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Error));
    let reason = journal.record.tests[0].reason().unwrap();
    assert!(reason.starts_with("fault `full` was not injected: only "), "{reason}");
}

/// A directory on a file system in memory, which is not that of the results.
pub fn small_file_system() -> Option<tempfile::TempDir> {
    let dir = tempfile::tempdir_in("/dev/shm").ok()?;
    let is_other =
        std::fs::metadata(dir.path()).ok()?.dev() != std::fs::metadata("/tmp").ok()?.dev();
    is_other.then_some(dir)
}

/// Half of what the tests fill.
pub const MARGIN: u64 = 32 * 1024 * 1024;

pub fn free_space(dir: &Path) -> u64 {
    let space = rustix::fs::statvfs(dir).expect("the space of a file system");
    space.f_bavail * space.f_frsize
}

#[test]
fn a_file_system_is_filled_and_freed() {
    let dir = small_file_system().expect("`/dev/shm` is a file system of its own");
    let path = dir.path().display();
    let before = free_space(dir.path());
    let folder = folder(
        &format!(
            "<test> T.lua <fault name='full' kind='disk' dir='{path}' size='64MiB' at='0'/></test>"
        ),
        "function TestCase.run() rtf.wait_until(function() return io.open('go') end, 60, 'go') end\n",
    );
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultInjected(_)));
    let filled = free_space(dir.path());
    folder.file("go", "");
    passes(&running.finish());
    let after = free_space(dir.path());
    // Other programs use this file system, too.
    assert!(filled + MARGIN < before, "{filled} of {before}");
    assert!(after + MARGIN > before, "{after} of {before}");
    let journal = folder.journal();
    let effect = &faults(&journal)[0].fault.effect;
    assert_eq!(*effect, format!("filled 64 MiB of `{path}`"));
    assert!(faults(&journal)[0].removed.is_some());
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn the_file_system_of_the_results_is_not_filled_completely() {
    let (finished, journal, _folder) = run(
        "<test> T.lua <fault name='full' kind='disk' dir='.' leave='0' at='0'/></test>",
        "function TestCase.run() rtf.sleep(0.5) end\n",
    );
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let reason = journal.record.tests[0].reason().unwrap();
    assert!(reason.contains("would stay free on the file system of the results"), "{reason}");
}
