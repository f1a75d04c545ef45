//! `host="user@machine"`: fixtures on another machine, for which a real sshd on this machine
//! stands in.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use rtf_model::{EventKind, Phase, TestId, Verdict};

use crate::support::{Folder, Running, free_port, nothing_left, wait_until};

/// An sshd on loopback with keys of its own, as the present user.
struct Sshd {
    server: Child,
    port: u16,
    folder: tempfile::TempDir,
}

impl Sshd {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = |name: &str| folder.path().join(name).display().to_string();
        for key in ["host", "user"] {
            let made = Command::new("ssh-keygen")
                .args(["-q", "-t", "ed25519", "-N", "", "-f", &path(key)])
                .status();
            assert!(made.expect("ssh-keygen, of the package openssh-client").success());
        }
        let copied = std::fs::copy(path("user.pub"), path("authorized"));
        copied.expect("the list of keys");
        let port = free_port();
        let config = format!(
            "ListenAddress 127.0.0.1\nPort {port}\nHostKey {}\nAuthorizedKeysFile {}\nUsePAM no\n\
             PidFile none\nStrictModes no\nPasswordAuthentication no\n",
            path("host"),
            path("authorized")
        );
        std::fs::write(path("config"), config).expect("a file");
        let public = std::fs::read_to_string(path("host.pub")).expect("a key");
        std::fs::write(path("known"), format!("[127.0.0.1]:{port} {public}")).expect("a file");
        // Where sshd locks itself in when root starts it. A service manager makes it.
        let _ = std::fs::create_dir_all("/run/sshd");
        let server = Command::new("/usr/sbin/sshd")
            .args(["-D", "-q", "-f", &path("config")])
            .stdin(Stdio::null())
            .spawn()
            .expect("sshd, of the package openssh-server");
        wait_until("sshd", || std::net::TcpStream::connect(("127.0.0.1", port)).ok());
        Self { server, port, folder }
    }

    /// For `RTF_SSH`.
    fn command(&self) -> String {
        let path = |name: &str| self.folder.path().join(name).display().to_string();
        format!(
            "ssh -F none -p {} -i {} -o IdentitiesOnly=yes -o UserKnownHostsFile={}",
            self.port,
            path("user"),
            path("known")
        )
    }
}

impl Drop for Sshd {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn me() -> String {
    let output = Command::new("id").arg("-un").output().expect("id");
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

/// The robot's program: tells its numbers and those of a child and a daemon.
const ROBOT: &str = "import os, signal, subprocess, sys, time\n\
folder, mode = sys.argv[1:]\n\
def stop(*_):\n    open(folder + '/stopped', 'w').write(os.environ['ROBOT'])\n    sys.exit(0)\n\
signal.signal(signal.SIGINT, signal.SIG_IGN if mode == 'stubborn' else stop)\n\
if mode == 'dies':\n    print('no motors', flush=True)\n    sys.exit(3)\n\
child = subprocess.Popen(['sleep', '1000'])\n\
daemon = subprocess.Popen(['sleep', '1000'], start_new_session=True)\n\
with open(folder + '/pids', 'a') as pids:\n    print(os.getpid(), child.pid, daemon.pid, file=pids)\n\
print('up', os.environ['ROBOT'], flush=True)\n\
while True:\n    time.sleep(1)\n";

const TEST: &str = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(float(self.param))\n";

struct Bench {
    sshd: Sshd,
    folder: Folder,
}

impl Bench {
    fn new(mode: &str, seconds: &str) -> Self {
        let (sshd, folder) = (Sshd::start(), Folder::new());
        let path = folder.path().display().to_string();
        folder.file("robot.py", ROBOT).file("T.py", TEST);
        let suite = format!(
            "<suite name='s'>\n  <env name='ROBOT' value=\"the 'arm'\"/>\n  \
             <fixture type='process' name='robot' host='{}@127.0.0.1' restart-delay='1ms'>\n    \
             <command>python3 {path}/robot.py {path} {mode}</command>\n    \
             <ready log=\"^up the 'arm'$\"/>\n    <stop signal='SIGINT' grace='1s'/>\n  </fixture>\n  \
             <hook name='park' on='interrupt'><command>sh -c 'kill -0 $(cut -d\" \" -f1 pids) &amp;&amp; echo parked > parked'</command></hook>\n  \
             <test type='python' param='{seconds}'>T</test>\n  <test type='python' param='0'>T</test>\n</suite>\n",
            me()
        );
        folder.file("s.xml", &suite);
        Self { sshd, folder }
    }

    fn start(&self) -> Running {
        let mut command = self.folder.command(&["run", "s.xml"]);
        command.env("RTF_SSH", self.sshd.command()).stdout(Stdio::piped()).stderr(Stdio::piped());
        self.folder.watch(command.spawn().expect("rtf starts"))
    }

    /// Starts it, and waits until the test runs.
    fn start_test(&self) -> Running {
        let running = self.start();
        running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
        running
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The processes of each start.
    fn pids(&self) -> Vec<Vec<i32>> {
        let text = std::fs::read_to_string(self.path("pids")).expect("what the robot wrote");
        let numbers = |line: &str| line.split(' ').map(|pid| pid.parse().expect("pid")).collect();
        text.lines().map(numbers).collect()
    }

    /// Waits until nothing lives that the robot's program was or started.
    fn wait_until_gone(&self) {
        let pids = self.pids().concat();
        wait_until("the end of the robot's processes", || {
            pids.iter().all(|pid| !lives(*pid)).then_some(())
        });
    }
}

fn lives(pid: i32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    stat.rsplit_once(") ").is_some_and(|(_, rest)| !rest.starts_with('Z'))
}

fn kill(signal: &str, pid: i32) {
    let status = Command::new("kill").args(["-s", signal, &pid.to_string()]).status();
    assert!(status.expect("kill").success());
}

/// The `ssh` below the runner.
fn ssh_of(running: &Running) -> i32 {
    let runner = running.runner();
    let tasks = std::fs::read_dir(format!("/proc/{runner}/task")).expect("threads").flatten();
    let children = tasks
        .filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok())
        .flat_map(|list| list.split_whitespace().map(str::to_owned).collect::<Vec<_>>());
    let is_ssh = |pid: &String| {
        let name = std::fs::read_to_string(Path::new("/proc").join(pid).join("comm"));
        name.is_ok_and(|name| name == "ssh\n")
    };
    let pid = children.into_iter().find(is_ssh).expect("an ssh");
    pid.parse().expect("a number")
}

#[test]
fn a_fixture_on_another_machine_is_ready_gets_its_environment_and_is_stopped() {
    let bench = Bench::new("well", "0");
    let finished = bench.start().finish();
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let stopped = std::fs::read_to_string(bench.path("stopped"));
    assert_eq!(stopped.expect("its signal reached it"), "the 'arm'");
    bench.wait_until_gone();
    assert!(nothing_left(&bench.folder));
}

#[test]
fn another_fixture_provides_the_name_of_the_machine() {
    let bench = Bench::new("well", "0");
    let suite = bench.folder.read("s.xml").replacen(
        "<fixture",
        "<fixture type='process' name='map'><command>sh -c 'echo robot at 127.0.0.1; exec sleep 1000'</command>\
         <provide name='address' log='robot at (.*)'/></fixture>\n  <fixture",
        1,
    );
    let suite = suite.replace("@127.0.0.1'", "@${fixture:map.address}'");
    bench.folder.file("s.xml", &suite);
    let finished = bench.start().finish();
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(bench.path("stopped").exists());
    bench.wait_until_gone();
}

#[test]
fn its_death_is_a_collapse_with_its_own_signal_and_it_is_started_again() {
    let bench = Bench::new("well", "1000");
    let running = bench.start_test();
    kill("KILL", bench.pids()[0][0]);
    let finished = running.finish();
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = bench.folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::Passed));
    let reason = &record.fixtures[0].collapses[0].1;
    let end = "its process ended with signal 9 (SIGKILL); its last line was: ";
    assert!(reason.starts_with(end), "{reason}");
    assert_eq!(record.fixtures[0].starts, 2);
    bench.wait_until_gone();
}

#[test]
fn a_lost_connection_is_a_collapse_and_ends_what_ran_there() {
    for mode in ["well", "stubborn"] {
        let bench = Bench::new(mode, "1000");
        let running = bench.start_test();
        kill("KILL", ssh_of(&running));
        assert_eq!(running.finish().code, Some(1));
        let record = bench.folder.journal().record;
        assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
        let (_, reason) = &record.fixtures[0].collapses[0];
        let lost = format!("the connection to `{}@127.0.0.1` was lost", me());
        assert!(reason.starts_with(&lost), "{reason}");
        bench.wait_until_gone();
    }
}

#[test]
fn ctrl_c_stops_it_in_order() {
    let bench = Bench::new("well", "1000");
    let running = bench.start_test();
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    let record = bench.folder.journal().record;
    assert!(record.fixtures[0].problems.is_empty(), "{:?}", record.fixtures[0].problems);
    assert!(bench.path("stopped").exists(), "its signal reached it");
    assert!(bench.path("parked").exists(), "it was there for the hook");
    bench.wait_until_gone();
    assert!(nothing_left(&bench.folder));
}

#[test]
fn one_that_ignores_its_signal_is_killed_there() {
    let bench = Bench::new("stubborn", "0");
    assert_eq!(bench.start().finish().code, Some(1));
    let record = bench.folder.journal().record;
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::Passed));
    let (_, problem) = &record.fixtures[0].problems[0];
    assert_eq!(problem, "it did not stop within 1s and was killed");
    bench.wait_until_gone();
}

#[test]
fn a_killed_runner_takes_it_along_after_the_robot_was_parked() {
    let bench = Bench::new("stubborn", "1000");
    let running = bench.start_test();
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    assert!(bench.path("parked").exists(), "it was there for the hook");
    bench.wait_until_gone();
    assert!(nothing_left(&bench.folder));
}

#[test]
fn runner_and_guard_killed_at_once_take_it_along() {
    let bench = Bench::new("stubborn", "1000");
    let running = bench.start_test();
    let runner = running.runner();
    kill("STOP", runner);
    running.signal("KILL");
    kill("KILL", runner);
    drop(running.finish());
    bench.wait_until_gone();
}

#[test]
fn a_death_before_ready_and_a_refused_connection_are_told_apart() {
    let bench = Bench::new("dies", "0");
    assert_eq!(bench.start().finish().code, Some(1));
    let fixture = &bench.folder.journal().record.fixtures[0];
    let broken = fixture.broken.as_deref().expect("broken");
    let reason = "it ended with exit code 3 before it was ready; its last line was: no motors";
    assert_eq!(broken, format!("set-up failed: {reason}"));
    assert_eq!(fixture.log_tail, ["no motors"]);
    std::fs::write(bench.sshd.folder.path().join("authorized"), "").expect("the list of keys");
    assert_eq!(bench.start().finish().code, Some(1));
    let fixture = &bench.folder.journal().record.fixtures[0];
    let broken = fixture.broken.as_deref().expect("broken");
    let start = format!("set-up failed: there is no connection to `{}@127.0.0.1`: ", me());
    assert!(broken.starts_with(&start) && broken.contains("Permission denied"), "{broken}");
    let said = fixture.log_tail.concat();
    assert!(said.contains("Permission denied"), "{said}");
}
