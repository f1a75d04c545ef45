//! Whether a process is dying: from its kill on until it was waited for.

use std::fmt::Write as _;

/// The kernel's flags of a thread that is ending, writes the memory image of its
/// process, or was ended by a signal.
const EXITING: u64 = 0x4;
const DUMPING: u64 = 0x200;
const SIGNALLED: u64 = 0x400;
const SIGKILL: i32 = 9;

/// Whether a process is ending, or has ended and was not waited for. It may have
/// been killed just now: then the signal is still waiting for it.
#[must_use]
pub fn is_dying(pid: i32) -> bool {
    let mut place = format!("/proc/{pid}");
    if !is_thread_dying(&place) {
        return false;
    }
    // A process lives on when its first thread has ended and others have not.
    place += "/task";
    let Ok(threads) = std::fs::read_dir(&place) else { return true };
    let folder = place.len();
    threads.flatten().all(|thread| {
        place.truncate(folder);
        let _ = write!(place, "/{}", thread.file_name().to_string_lossy());
        is_thread_dying(&place)
    })
}

fn is_thread_dying(place: &str) -> bool {
    let Ok(stat) = std::fs::read_to_string(format!("{place}/stat")) else { return true };
    let Some((_, rest)) = stat.rsplit_once(") ") else { return true };
    let mut fields = rest.split(' ');
    let state = fields.next().unwrap_or("X");
    // Its parent, group, session, terminal, and that one's group are between.
    let flags = fields.nth(5).and_then(|flags| flags.parse::<u64>().ok()).unwrap_or_default();
    matches!(state, "Z" | "X" | "x")
        || flags & (EXITING | DUMPING | SIGNALLED) != 0
        || is_killed(place)
}

/// Whether SIGKILL waits for it.
fn is_killed(place: &str) -> bool {
    const KILL: u64 = 1 << (SIGKILL - 1);
    let status = std::fs::read_to_string(format!("{place}/status")).unwrap_or_default();
    let pending = status.lines().filter_map(|line| {
        let line = line.strip_prefix("SigPnd:").or_else(|| line.strip_prefix("ShdPnd:"))?;
        u64::from_str_radix(line.trim(), 16).ok()
    });
    pending.into_iter().any(|pending| pending & KILL != 0)
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead as _, BufReader};
    use std::process::{Child, Command, Stdio};

    use super::is_dying;
    use crate::host::unix::signal_process;

    fn pid(child: &Child) -> i32 {
        i32::try_from(child.id()).unwrap()
    }

    fn sleeper() -> Child {
        Command::new("sleep").arg("1000").spawn().unwrap()
    }

    #[test]
    fn a_process_is_dying_from_its_kill_on_until_it_is_reaped() {
        let mut sleeper = sleeper();
        let pid = pid(&sleeper);
        assert!(!is_dying(pid));
        sleeper.kill().unwrap();
        // Never alive again, in whichever instant it is looked at.
        (0..1000).for_each(|_| assert!(is_dying(pid)));
        sleeper.wait().unwrap();
        assert!(is_dying(pid));
    }

    #[test]
    fn a_stopped_process_lives() {
        let mut sleeper = sleeper();
        signal_process(pid(&sleeper), 19);
        assert!(!is_dying(pid(&sleeper)));
        sleeper.kill().unwrap();
        sleeper.wait().unwrap();
    }

    /// A daemon may leave its work to threads.
    #[test]
    fn a_process_whose_first_thread_has_ended_lives_as_long_as_another_one_does() {
        let program = "import ctypes, threading, time\n\
            def work():\n\
            \x20   while open('/proc/self/stat').read().rpartition(') ')[2][0] != 'Z': time.sleep(0.001)\n\
            \x20   print('works', flush=True)\n\
            \x20   time.sleep(1000)\n\
            threading.Thread(target=work).start()\n\
            ctypes.CDLL(None).pthread_exit(None)\n";
        let mut command = Command::new("python3");
        let mut daemon =
            command.args(["-c", program]).stdout(Stdio::piped()).spawn().expect("python3");
        let mut line = String::new();
        BufReader::new(daemon.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert_eq!(line, "works\n");
        assert!(!is_dying(pid(&daemon)));
        daemon.kill().unwrap();
        (0..100).for_each(|_| assert!(is_dying(pid(&daemon))));
        daemon.wait().unwrap();
    }
}
