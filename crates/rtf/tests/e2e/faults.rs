//! Injected faults: each one is felt by real processes, and none is left however a run ends.

use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rtf_model::{EventKind, FaultKind, FaultRecord, Phase, TestId, Verdict};

use crate::support::{Finished, Folder, Journal, Random, nothing_left, number, wait_until};

/// Replaces the file `tick` all the time, with a count; a child does the same with `child`.
const CAMERA: &str = "import itertools, os, sys, time\n\
name = sys.argv[1]\n\
if name == 'tick' and os.fork() == 0:\n    name = 'child'\n\
for number in itertools.count(1):\n    \
with open(name + '.new', 'w') as file: file.write(str(number))\n    \
os.rename(name + '.new', name)\n    \
time.sleep(0.002)\n";

/// Waits for a file with a text, which the test under a fault writes or reads.
const SUPPORT: &str = "function ticks(name) local f = io.open(name); if not f then return 0 end\n\
local n = tonumber(f:read('a')) or 0; f:close(); return n end\n\
function runs(name) local from = ticks(name); return rtf.wait_until(function() return ticks(name) > from end, 30, name .. ' runs') end\n\
function stands(name) local from = ticks(name); rtf.sleep(0.15); return ticks(name) == from end\n";

const FIXTURE: &str = "<fixture type='process' name='camera'>\
    <command>python3 camera.py tick</command><ready command='test -e tick -a -e child'/></fixture>";

fn folder(inside: &str, test: &str) -> Folder {
    let folder = Folder::new();
    folder.file("camera.py", CAMERA).file("T.lua", &format!("{SUPPORT}{test}"));
    folder.file("s.xml", &format!("<suite name='arm'>\n{FIXTURE}\n{inside}\n</suite>"));
    folder
}

fn run(inside: &str, test: &str) -> (Finished, Journal, Folder) {
    let folder = folder(inside, test);
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=junit.xml"]);
    let journal = folder.journal();
    assert!(nothing_left(&folder));
    (finished, journal, folder)
}

fn faults(journal: &Journal) -> &[FaultRecord] {
    &journal.record.tests[0].attempts.last().expect("an attempt").faults
}

fn passes(finished: &Finished) {
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
}

/// Waits for the fault in the test: the camera runs, stands, and runs again.
const STANDS_BETWEEN: &str = "function TestCase.run()\n\
    rtf.require(runs('tick')); rtf.require(runs('child'))\n\
    rtf.wait_until(function() return stands('tick') and stands('child') end, 30, 'the camera stands')\n\
    rtf.require(runs('tick')); rtf.require(runs('child')) end\n";

#[test]
fn a_stopped_fixture_stands_for_the_declared_time() {
    let (finished, journal, folder) = run(
        "<fault name='drop' kind='stop' fixture='camera' at='300ms' for='1s'/>\n<test> T.lua </test>",
        STANDS_BETWEEN,
    );
    passes(&finished);
    let [fault] = faults(&journal) else { panic!("{:?}", faults(&journal)) };
    assert_eq!((fault.fault.kind, &*fault.fault.name), (FaultKind::Stop, "drop"));
    assert_eq!(fault.fault.effect, "stopped 2 processes of `camera`");
    let lasted = fault.removed.expect("it was removed").since(fault.injected).as_secs_f64();
    assert!((0.99..5.0).contains(&lasted), "{lasted}");
    assert!(finished.stdout.contains("arm/T, drop: stopped 2 processes"), "{}", finished.stdout);
    let junit = folder.read("junit.xml");
    assert!(junit.contains("<property name=\"fault.drop\" value=\"stop from "), "{junit}");
}

#[test]
fn a_fault_of_one_process_leaves_the_others_alone() {
    let (finished, journal, _folder) = run(
        "<fixture type='process' name='other'><command>python3 camera.py other</command><ready file='other'/></fixture>
         <test> T.lua <fault name='drop' kind='stop' fixture='other' process='camera.py' at='0'/></test>",
        "function TestCase.run() rtf.wait_until(function() return stands('other') end, 30, 'it stands')\n\
         rtf.require(runs('tick')) end\n",
    );
    passes(&finished);
    // It lasted until the end of the test.
    assert!(faults(&journal)[0].removed.is_some());
}

/// It stands for 19 of 20 ms: a program that sleeps for 2 ms runs at most a few times in each.
#[test]
fn a_slowed_fixture_runs_for_its_share() {
    let (finished, journal, _folder) = run(
        "<fault name='busy' kind='slow' fixture='camera' cpu='5%' at='1s' for='1s'/>\n<test> T.lua </test>",
        "function rate() local from = ticks('tick'); rtf.sleep(0.4); return (ticks('tick') - from) / 0.4 end\n\
         function TestCase.run() local fast = rate(); rtf.sleep(0.8); local slow = rate()\n\
         rtf.measure('fast', fast); rtf.measure('slow', slow)\n\
         rtf.require(slow > 0, 'it runs'); rtf.require(slow < fast / 2, 'it is slow')\n\
         rtf.wait_until(function() return rate() > 1.5 * slow end, 30, 'it is fast again') end\n",
    );
    passes(&finished);
    assert!(faults(&journal)[0].fault.effect.starts_with("slowed to 5 %: 2 processes of `camera`"));
    assert!(faults(&journal)[0].removed.is_some());
}

#[test]
fn a_killed_process_is_a_collapse_of_its_fixture() {
    let (finished, journal, _folder) = run(
        "<test after-collapse='fail'> T.lua <fault name='crash' kind='kill' fixture='camera' at='100ms'/></test>",
        "function TestCase.run() rtf.sleep(60) end\n",
    );
    assert_ne!(finished.code, Some(0));
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let [fault] = faults(&journal) else { panic!("{:?}", faults(&journal)) };
    assert_eq!((fault.fault.kind, fault.removed), (FaultKind::Kill, None));
}

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
fn small_file_system() -> Option<tempfile::TempDir> {
    let dir = tempfile::tempdir_in("/dev/shm").ok()?;
    let is_other =
        std::fs::metadata(dir.path()).ok()?.dev() != std::fs::metadata("/tmp").ok()?.dev();
    is_other.then_some(dir)
}

/// Half of what the tests fill.
const MARGIN: u64 = 32 * 1024 * 1024;

fn free_space(dir: &Path) -> u64 {
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

const FROM_TEST: &str = "import rtf\n\
def ticks():\n    with open('tick') as file: return int(file.read())\n\
class T(rtf.TestCase):\n    \
def stands(self):\n        before = ticks(); self.sleep(0.15); return ticks() == before\n    \
def run(self):\n        \
with self.fault('drop'):\n            self.require(self.stands(), 'it stands')\n        \
before = ticks(); self.wait_until(lambda: ticks() > before, 30, 'it runs')\n        \
lost = self.fault('drop'); self.require(self.stands(), 'it stands again')\n        \
if self.param == 'leave': return\n        \
lost.remove(); lost.remove()\n        \
self.fault('drop'); self.fault('drop')\n";

#[test]
fn a_test_injects_a_fault_and_removes_it_early() {
    let folder = folder(
        "<fault name='drop' kind='stop' fixture='camera'/>
         <test param='leave'> T.py </test><test> T.py </test>",
        "",
    );
    folder.file("T.py", FROM_TEST);
    let finished = folder.rtf(&["run", "s.xml"]);
    let journal = folder.journal();
    assert!(nothing_left(&folder));
    let verdict = |test| journal.record.verdict(TestId(test));
    assert_eq!((verdict(0), verdict(1)), (Some(Verdict::Passed), Some(Verdict::Error)));
    let reason = journal.record.tests[1].reason().unwrap();
    assert_eq!(reason, "the fault \"drop\" was not injected: it lasts already");
    for (test, count) in [(0, 2), (1, 3)] {
        let faults = &journal.record.tests[test].attempts[0].faults;
        assert_eq!(faults.len(), count, "{}", finished.stdout);
        assert!(faults.iter().all(|fault| fault.removed.is_some()), "{faults:?}");
    }
}

/// Sends the request of a test to the fixture, as another user.
const STRANGER: &str = r##"import rtf, subprocess
REQUEST = """import socket, sys
with socket.socket(socket.AF_UNIX) as connection:
    connection.connect(chr(0) + sys.argv[1])
    connection.sendall(bytes("inject#drop#T#".replace("#", chr(10)), "ascii"))
    try:
        print(connection.recv(1000))
    except ConnectionResetError:
        print(b"")
"""
OTHER = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "/usr/bin/python3", "-c"]

class T(rtf.TestCase):
    def run(self):
        command = [*OTHER, REQUEST, self.fixture_value("faults.socket")]
        done = subprocess.run(command, capture_output=True, text=True)
        self.check(done.stdout == "b''\n", done.stdout + done.stderr)
"##;

#[test]
fn another_user_injects_no_fault() {
    assert!(rustix::process::geteuid().is_root(), "this test acts as another user, as root");
    let folder = folder(
        "<fault name='drop' kind='stop' fixture='camera'/>\n<test type='python'> T.py </test>",
        "",
    );
    folder.file("T.py", STRANGER);
    passes(&folder.rtf(&["run", "s.xml"]));
    assert!(faults(&folder.journal()).is_empty(), "a fault was injected");
}

#[test]
fn a_fault_that_is_not_declared_is_an_error_of_the_test() {
    for (inside, problem) in [
        ("", "the suite declares no `<fault>` without `at`"),
        (
            "<fault name='other' kind='stop' fixture='camera'/>",
            "the suite declares no such fault; this test can inject `other`",
        ),
        (
            "<fault name='other' kind='stop' fixture='camera'/>
             <fault name='drop' kind='stop' fixture='camera' at='1h'/>",
            "it has a time, `at`, at which the suite injects it",
        ),
    ] {
        let folder = folder(&format!("{inside}<test> T.py </test>"), "");
        folder.file("T.py", FROM_TEST);
        folder.rtf(&["run", "s.xml"]);
        let journal = folder.journal();
        let reason = journal.record.tests[0].reason().unwrap_or_default();
        assert_eq!(reason, format!("the fault \"drop\" was not injected: {problem}"));
    }
}

#[test]
fn a_fault_without_its_process_is_an_error_at_its_place() {
    let (_, journal, _folder) = run(
        "<test> T.lua
         <fault name='drop' kind='stop' fixture='camera' process='driver' at='0'/></test>",
        "function TestCase.run() rtf.sleep(0.5) end\n",
    );
    let attempt = &journal.record.tests[0].attempts[0];
    let failure = attempt.failures().next().expect("an error");
    assert_eq!(
        failure.text,
        "fault `drop` was not injected: the fixture `camera` has no process `driver`; it has \
         `camera.py`"
    );
    assert_eq!(failure.location.as_ref().unwrap().to_string(), "s.xml:4");
}

/// A program that is killed cannot continue what it has stopped; its successor does.
#[test]
fn a_killed_host_of_faults_leaves_no_process_stopped() {
    let folder = folder(
        "<test after-collapse='skip'> T.lua <fault name='drop' kind='stop' fixture='camera' at='0'/></test>
         <test param='next'> T.lua </test>",
        "function TestCase.setup(args) first = args[1] == nil; return true end\n\
         function TestCase.run() if first then rtf.sleep(60) end\n\
         rtf.require(runs('tick')); rtf.require(runs('child')) end\n",
    );
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultInjected(_)));
    let host = wait_until("the host", || process_below(running.runner(), "rtf-host-faults"));
    crate::support::send(host, "KILL");
    let finished = running.finish();
    let journal = folder.journal();
    let verdict = journal.record.verdict(TestId(1));
    assert_eq!(verdict, Some(Verdict::Passed), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder));
}

fn process_below(parent: i32, name: &str) -> Option<i32> {
    let entries = std::fs::read_dir("/proc").ok()?.flatten();
    let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok());
    let mut found = pids.filter(|pid| {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let fields = stat
            .rsplit_once(") ")
            .map(|(_, rest)| rest.split(' ').nth(1) == Some(&*parent.to_string()));
        stat.contains(&format!("({name})")) && fields == Some(true)
    });
    found.next()
}

/// Answers what it gets, over TCP at the first port, and over UDP at both.
const ECHO: &str = "import socket, sys, threading\n\
def tcp(port):\n    \
server = socket.create_server(('127.0.0.1', port)); print('up', flush=True)\n    \
while True:\n        connection, _ = server.accept()\n        \
while data := connection.recv(65536): connection.sendall(data[:1])\n\
def udp(port):\n    \
socket_ = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); socket_.bind(('127.0.0.1', port))\n    \
while True:\n        data, sender = socket_.recvfrom(65536); socket_.sendto(data, sender)\n\
ports = [int(port) for port in sys.argv[1:]]\n\
for port in ports: threading.Thread(target=udp, args=(port,)).start()\n\
tcp(ports[0])\n";

const NETWORK_TEST: &str = "import socket, time, rtf\n\
class T(rtf.TestCase):\n    \
def setup(self, args):\n        \
self.ports = [int(port) for port in args]\n        \
self.tcp = socket.create_connection(('127.0.0.1', self.ports[0]))\n        \
self.udp = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in self.ports]\n        \
for udp, port in zip(self.udp, self.ports): udp.connect(('127.0.0.1', port))\n    \
def trip(self, size=1):\n        \
start = time.monotonic(); self.tcp.sendall(b'x' * size); self.tcp.recv(1); return time.monotonic() - start\n    \
def answers(self, which, count):\n        \
udp = self.udp[which]; udp.settimeout(0.5)\n        \
for number in range(count): udp.send(b'%d' % number)\n        \
received = []\n        \
try:\n            while True: received.append(int(udp.recv(100)))\n        \
except TimeoutError: return received\n    \
def run(self):\n        \
self.require(self.trip() < 0.08, 'fast before')\n        \
with self.fault('late'):\n            \
self.require(self.trip() >= 0.1, 'late'); self.require(self.answers(0, 10) == list(range(10)), 'none lost')\n        \
self.wait_until(lambda: self.trip() < 0.08, 30, 'fast afterwards')\n        \
with self.fault('lossy'): lossy = self.answers(0, 200)\n        \
self.require(5 < len(lossy) < 150, f'lossy: {len(lossy)}')\n        \
with self.fault('double'): double = self.answers(0, 10)\n        \
self.require(sorted(double) == sorted(list(range(10)) * 4), f'double: {double}')\n        \
with self.fault('mixed'): mixed = self.answers(0, 50)\n        \
self.require(sorted(mixed) == list(range(50)) != mixed, f'mixed: {mixed}')\n        \
with self.fault('cut'):\n            \
self.require(self.answers(1, 5) == [], 'cut'); self.require(self.answers(0, 5) == list(range(5)), 'other')\n        \
self.require(self.answers(1, 5) == list(range(5)), 'joined')\n        \
with self.fault('narrow'): narrow = self.trip(30000)\n        \
self.require(0.2 < narrow < 30, f'narrow: {narrow}')\n";

#[test]
fn packets_of_a_private_network_are_impaired() {
    let folder = Folder::new();
    folder.file("echo.py", ECHO).file("T.py", NETWORK_TEST);
    folder.file(
        "s.xml",
        "<suite name='net' isolate='network'>
         <fixture type='process' name='echo'>
           <command>python3 echo.py ${port:a} ${port:b}</command><ready log='up'/></fixture>
         <fault name='late' kind='network' delay='50ms'/>
         <fault name='lossy' kind='network' loss='50%' seed='1'/>
         <fault name='double' kind='network' duplicate='100%'/>
         <fault name='mixed' kind='network' delay='20ms' jitter='20ms'/>
         <fault name='cut' kind='network' loss='100%' port='${port:b}'/>
         <fault name='narrow' kind='network' rate='1Mbit'/>
         <test param='${port:a} ${port:b}'> T.py </test></suite>",
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    passes(&finished);
    let journal = folder.journal();
    let effects = faults(&journal).iter().map(|fault| &*fault.fault.effect);
    assert_eq!(effects.clone().next(), Some("impaired the packets: delay 50 ms"));
    assert!(effects.clone().any(|effect| effect.ends_with("loss 100 %")), "{effects:?}");
    assert!(faults(&journal).iter().all(|fault| fault.removed.is_some()));
    assert!(nothing_left(&folder));
}

/// The hook runs while the camera is alive: it has been continued.
const PARK: &str = "<hook name='park' on='interrupt'><command>sh -c 'exec python3 park.py 2>park.log'</command></hook>";
const PARK_PROGRAM: &str = "import time\n\
def ticks(name):\n    with open(name) as file: return int(file.read())\n\
for name in ('tick', 'child'):\n    \
before, end = ticks(name), time.monotonic() + 20\n    \
while ticks(name) <= before and time.monotonic() < end: time.sleep(0.001)\n    \
assert ticks(name) > before, name\n\
open('parked', 'a').write('parked')\n";

/// The runner is killed at random moments of a run in which faults begin and end all the time.
#[test]
fn after_the_death_of_the_runner_no_fault_is_left() {
    let dir = small_file_system().expect("`/dev/shm` is a file system of its own");
    let path = dir.path().display();
    let before = free_space(dir.path());
    let folder = folder(
        &format!(
            "{PARK}<test repetition='1000'> T.lua
             <fault name='drop' kind='stop' fixture='camera' at='0s..40ms' for='30ms..60ms'/>
             <fault name='busy' kind='slow' fixture='camera' cpu='20%' at='0s..40ms'/>
             <fault name='full' kind='disk' dir='{path}' size='64MiB' at='0s..40ms' for='20ms..60ms'/>
             <fault name='net' kind='network' delay='10ms' at='0s..40ms' for='20ms..60ms'/>
             <fault name='memory' kind='memory' size='64MiB' at='0s..40ms' for='20ms..60ms'/></test>"
        ),
        "function TestCase.run() rtf.sleep(0.08) end\n",
    );
    folder.file("park.py", PARK_PROGRAM);
    let suite = folder.read("s.xml").replace("name='arm'", "name='arm' isolate='network'");
    folder.file("s.xml", &suite);
    let before_rules = rules();
    let mut random = Random::from_environment();
    for kill in 0..number("RTF_CHAOS_RUNS").unwrap_or(100).div_ceil(2) {
        let _ = std::fs::remove_file(folder.path().join("parked"));
        let _ = std::fs::remove_dir_all(folder.path().join("rtf-results"));
        let running = folder.start(&["run", "s.xml"]);
        running.wait_for(|kind| matches!(kind, EventKind::TestStarted { .. }));
        let moment = std::time::Duration::from_millis(random.below(1000));
        std::thread::sleep(moment);
        let was_killed = running.try_kill_runner();
        let finished = running.finish();
        assert!(was_killed, "{}{}", finished.stdout, finished.stderr);
        let log = std::fs::read_to_string(folder.path().join("park.log")).unwrap_or_default();
        let error = &finished.stderr;
        assert_eq!(finished.code, Some(5), "kill {kill} after {moment:?}: {error}{log}");
        assert!(nothing_left(&folder), "kill {kill} after {moment:?}");
        assert_eq!(rules(), before_rules, "kill {kill} after {moment:?}");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
        let free = free_space(dir.path());
        assert!(free + MARGIN > before, "kill {kill} after {moment:?}: {free} of {before}");
        let was_in_test = finished.stderr.contains("hook park");
        if was_in_test {
            let parked = folder.path().join("parked").exists();
            assert!(parked, "kill {kill} after {moment:?}: {}", finished.stderr);
        }
        for file in ["tick", "child"] {
            std::fs::remove_file(folder.path().join(file)).expect("the camera ran");
        }
    }
}

/// The routing rules of this network, which no suite has changed.
fn rules() -> String {
    let output = std::process::Command::new("ip").args(["rule"]).output().expect("ip");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A test during which the camera is stopped, and a hook that parks.
fn stopped_camera() -> Folder {
    let folder = folder(
        &format!(
            "{PARK}<test> T.lua <fault name='drop' kind='stop' fixture='camera' at='0'/></test>"
        ),
        "function TestCase.run() rtf.sleep(60) end\n",
    );
    folder.file("park.py", PARK_PROGRAM);
    folder
}

/// The hooks need the fixtures.
#[test]
fn a_fixture_that_a_fault_stopped_is_continued_before_the_hooks_of_the_guard() {
    let folder = stopped_camera();
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultInjected(_)));
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    assert!(finished.stderr.contains("hook park: parked"), "{}", finished.stderr);
    assert!(folder.path().join("parked").exists());
    assert!(nothing_left(&folder));
}

/// Ctrl-C during a fault.
#[test]
fn an_interrupted_run_leaves_no_fault() {
    let folder = stopped_camera();
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultInjected(_)));
    running.signal("INT");
    let finished = running.finish();
    assert!(folder.path().join("parked").exists(), "{}{}", finished.stdout, finished.stderr);
    let journal = folder.journal();
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert!(faults(&journal)[0].removed.is_some());
    assert!(nothing_left(&folder));
}
