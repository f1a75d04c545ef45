//! Descriptors and memory: the runner's reserve, and the limits of tests, fixtures and hooks.

use std::process::{Command, Stdio};

use rtf_model::{EventKind, Phase};
use rustix::process::{Pid, Resource, Rlimit, getrlimit, prlimit};

use crate::support::{Folder, Running, nothing_left, wait_until};

const PATIENT: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";
const ARM: &str = "<fixture type='process' name='arm'>\
    <command>sh -c 'ulimit -n > fixture; echo up; exec sleep 1000'</command><ready log='up'/></fixture>";

fn start(folder: &Folder, inside: &str, args: &[&str]) -> Running {
    folder.file("T.py", PATIENT);
    let test = "<test type='python' repetition='3'>T</test>";
    folder.file("s.xml", &format!("<suite>{ARM}{inside}{test}</suite>"));
    let running = folder.start(&[&["run", "s.xml"], args].concat());
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running
}

#[test]
fn the_runner_may_have_more_descriptors_than_what_it_starts() {
    let test = "import os, resource, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        open('test', 'a').write('%d\\n' % resource.getrlimit(resource.RLIMIT_NOFILE)[0])\n        for line in open('/proc/%d/limits' % os.getppid()):\n            if line.startswith('Max open files'):\n                open('runner', 'w').write(' '.join(line.split()[3:5]))\n";
    for fork in ["never", "always"] {
        let folder = Folder::new();
        let hook = "<hook name='park' on='end'><command>sh -c 'ulimit -n > hook'</command></hook>";
        let tests = "<test type='python' repetition='3'>T</test>";
        folder.file("T.py", test).file("s.xml", &format!("<suite>{ARM}{hook}{tests}</suite>"));
        let mut command = Command::new("sh");
        let script = "ulimit -S -n 256; exec \"$0\" run s.xml --fork $1";
        command.args(["-c", script, env!("CARGO_BIN_EXE_rtf"), fork]).current_dir(folder.path());
        let output = command.output().expect("sh");
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
        assert_eq!(folder.read("test"), "256\n".repeat(3), "{fork}");
        assert_eq!(folder.read("fixture"), "256\n");
        assert_eq!(folder.read("hook"), "256\n");
        let hard = getrlimit(Resource::Nofile).maximum.expect("a limit");
        assert_eq!(folder.read("runner"), format!("{hard} {hard}"));
    }
}

/// The smallest number that no descriptor of a process has.
fn first_free(pid: i32) -> u64 {
    let is_open = |fd: &u64| std::fs::read_link(format!("/proc/{pid}/fd/{fd}")).is_ok();
    (0..).find(|fd| !is_open(fd)).expect("a number")
}

#[test]
fn a_runner_that_has_no_descriptors_left_starts_its_hook() {
    let folder = Folder::new();
    let hook =
        "<hook name='park' on='interrupt'><command>sh -c 'echo parked > parked'</command></hook>";
    let running = start(&folder, hook, &["--fork", "never"]);
    let runner = running.runner();
    let limit = Some(first_free(runner));
    let limits = Rlimit { current: limit, maximum: limit };
    prlimit(Pid::from_raw(runner), Resource::Nofile, limits).expect("a limit");
    running.signal("INT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(130), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(folder.read("parked"), "parked\n");
    assert!(nothing_left(&folder));
}

fn score(pid: i32) -> i32 {
    let path = format!("/proc/{pid}/oom_score_adj");
    std::fs::read_to_string(path).expect("a process").trim().parse().expect("a number")
}

fn children(pid: i32) -> Vec<i32> {
    let tasks = std::fs::read_dir(format!("/proc/{pid}/task")).expect("a process").flatten();
    let lists = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
    let lists: Vec<String> = lists.collect();
    let pids = lists.iter().flat_map(|list| list.split_whitespace());
    pids.map(|pid| pid.parse().expect("a number")).collect()
}

#[test]
fn without_memory_the_kernel_chooses_tests_and_fixtures_before_runner_and_guard() {
    for fork in ["never", "always"] {
        let folder = Folder::new();
        let hook = "<hook name='park' on='interrupt'><command>sh -c 'read -r score &lt; /proc/self/oom_score_adj; echo $score > hook'</command></hook>";
        let running = start(&folder, hook, &["--fork", fork]);
        let (guard, runner) = (running.child.id().cast_signed(), running.runner());
        let own = score(std::process::id().cast_signed());
        assert_eq!([score(guard), score(runner)], [own, own]);
        let started = children(runner);
        assert!(started.len() >= 2, "a fixture and a host: {started:?}");
        let expendable = (own.max(0) + 500).min(1000);
        for pid in started {
            let name = std::fs::read_to_string(format!("/proc/{pid}/comm")).expect("a process");
            // A host that is just being started ahead.
            wait_until(&name, || (score(pid) == expendable).then_some(()));
        }
        running.signal("INT");
        assert_eq!(running.finish().code, Some(130));
        assert_eq!(folder.read("hook"), format!("{own}\n"), "a hook has to park the robot");
    }
}

/// A memory control group of so many bytes, where this process may make one.
fn memory_group(bytes: u64) -> Option<std::path::PathBuf> {
    let name = format!("rtf-e2e-{}", std::process::id());
    let made = [("memory", "memory.limit_in_bytes"), ("", "memory.max")];
    made.into_iter().find_map(|(hierarchy, limit)| {
        let group = std::path::Path::new("/sys/fs/cgroup").join(hierarchy).join(&name);
        std::fs::create_dir(&group).ok()?;
        if std::fs::write(group.join(limit), bytes.to_string()).is_ok() {
            return Some(group);
        }
        std::fs::remove_dir(&group).expect("an empty group");
        None
    })
}

/// Where no memory control group can be made (it takes root), only the scores are
/// checked, by the test above.
#[test]
fn a_test_that_takes_all_memory_crashes_and_the_robot_is_parked() {
    let Some(group) = memory_group(150 << 20) else {
        println!("not proved here: no memory control group can be made");
        return;
    };
    let folder = Folder::new();
    folder.file("T.py", "import os, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        for i in range(20):\n            if os.fork() == 0:\n                break\n        taken = []\n        while True:\n            taken.append(bytearray(1 << 20))\n");
    let hook =
        "<hook name='park' on='failure'><command>sh -c 'echo parked >> parked'</command></hook>";
    let suite = format!("<suite>{ARM}{hook}<test type='python' timeout='60s'>T</test></suite>");
    folder.file("s.xml", &suite);
    let mut command = Command::new("sh");
    let script = "echo $$ > \"$1/cgroup.procs\" && exec \"$0\" run s.xml";
    command.args(["-c", script, env!("CARGO_BIN_EXE_rtf")]).arg(&group);
    let output = command.current_dir(folder.path()).stdin(Stdio::null()).output().expect("sh");
    let shown = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(nothing_left(&folder), "{shown}");
    wait_until("the end of its group", || std::fs::remove_dir(&group).ok());
    // The fixture may be chosen, too: it is expendable.
    assert_eq!(output.status.code(), Some(1), "{shown}");
    assert!(folder.read("parked").starts_with("parked\n"), "{shown}");
}
