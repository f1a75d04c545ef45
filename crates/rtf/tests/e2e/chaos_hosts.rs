//! Hosts die in every step and at random moments, in every mode: only the running test is blamed,
//! every passed test was complete, and each test ran once.
//!
//! `RTF_CHAOS_SUITES` scales the number of rounds (`make chaos` runs more), and `RTF_CHAOS_SEED`
//! repeats the random numbers of a run, which prints its seed.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rtf_model::{AttemptRecord, EventKind, ExitStatus, Phase, Verdict};

use crate::host_modes::{MODES, Mode, SHARED};
use crate::support::{Folder, Journal, Random, build_cpp, kill, nothing_left, number, root};

/// As the C++ plug-in `Chaos`, in the other languages.
const LUA: &str = r#"
TestCase = {}

local function tell(what)
  local file = io.open(rtf.name() .. "." .. what, "a")
  file:write(io.open("/proc/self/stat"):read("n"), "\n")
  file:close()
end

local function act(step)
  if rtf.param() == "kill " .. step then os.execute("kill -KILL $PPID") end
  if rtf.param() == "exit " .. step then os.exit(0) end
end

function TestCase.setup()
  tell("began")
  act("setup")
  return true
end

function TestCase.run()
  rtf.report(("x"):rep(rtf.param() == "wait" and 200000 or 10))
  if rtf.param() == "wait" then rtf.sleep(0.003) end
  act("run")
  rtf.check(rtf.param() ~= "fail", "it was not asked to fail")
end

function TestCase.tearDown()
  act("tear-down")
  tell("ended")
end
"#;

const PYTHON: &str = r#"
import os
import rtf


class Chaos(rtf.TestCase):
    def setup(self, args):
        self.tell("began")
        self.act("setup")

    def run(self):
        self.report("x" * (200000 if self.param == "wait" else 10))
        if self.param == "wait":
            self.sleep(0.003)
        self.act("run")
        self.check(self.param != "fail", "it was not asked to fail")

    def tearDown(self):
        self.act("tear-down")
        self.tell("ended")

    def tell(self, what):
        with open(f"{self.name}.{what}", "a") as stream:
            stream.write(f"{os.getpid()}\n")

    def act(self, step):
        if self.param == "kill " + step:
            os.kill(os.getpid(), 9)
        if self.param == "exit " + step:
            os._exit(0)
"#;

const RUBY: &str = r##"
require "rtf"

class Chaos < RTF::TestCase
  def setup(_args)
    tell("began")
    act("setup")
  end

  def run
    report("x" * (param == "wait" ? 200_000 : 10))
    sleep(0.003) if param == "wait"
    act("run")
    require(param != "fail", "it was not asked to fail")
  end

  def tear_down
    act("tear-down")
    tell("ended")
  end

  def tell(what)
    File.write("#{name}.#{what}", "#{Process.pid}\n", mode: "a")
  end

  def act(step)
    Process.kill(:KILL, Process.pid) if param == "kill #{step}"
    exit!(0) if param == "exit #{step}"
  end
end
"##;

const STEPS: [&str; 3] = ["setup", "run", "tear-down"];

/// What a test is asked to do, and what must be said of it.
fn draw(random: &mut Random) -> (String, Verdict, Phase) {
    let step = random.below(3) as usize;
    let phase = [Phase::Setup, Phase::Run, Phase::TearDown][step];
    match random.below(10) {
        0 | 1 => (format!("kill {}", STEPS[step]), Verdict::Crashed, phase),
        2 => (format!("exit {}", STEPS[step]), Verdict::Crashed, phase),
        3 => ("fail".to_owned(), Verdict::Failed, Phase::Run),
        _ => ("pass".to_owned(), Verdict::Passed, Phase::Exit),
    }
}

/// The plug-ins, in a folder: what stands in a suite for each language.
fn plugins(folder: &Folder) -> [(&'static str, String); 4] {
    folder.file("Chaos.lua", LUA).file("Chaos.py", PYTHON).file("Chaos.rb", RUBY);
    let cpp = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp").join("Chaos.so");
    let here = |extension: &str| format!("Chaos.{extension}");
    [
        ("cpp", cpp.display().to_string()),
        ("lua", here("lua")),
        ("python", here("py")),
        ("ruby", here("rb")),
    ]
}

/// A suite of tests with these parameters.
fn suite(folder: &Folder, name: &str, (mode, plugin): (Mode, &str), params: &[&str]) {
    let tests = params.iter().enumerate().map(|(n, param)| {
        let isolation = mode.isolation;
        format!(
            "  <test isolation='{isolation}' name='{name}{n}' param='{param}'>{plugin}</test>\n"
        )
    });
    let text = format!("<suite name='{name}'>\n{}</suite>\n", tests.collect::<String>());
    folder.file(&format!("{name}.xml"), &text);
}

/// The processes in which a test began, or came to its end.
fn told(folder: &Folder, test: &str, what: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.path().join(format!("{test}.{what}")));
    text.unwrap_or_default().lines().map(str::to_owned).collect()
}

fn only_attempt(journal: &Journal, test: usize) -> &AttemptRecord {
    let attempts = &journal.record.tests[test].attempts;
    assert_eq!(attempts.len(), 1, "{}", journal.record.tests[test].plan.name);
    &attempts[0]
}

#[test]
fn whoever_ends_its_host_is_to_blame_in_every_mode() {
    let mut random = Random::from_environment();
    let rounds = number("RTF_CHAOS_SUITES").unwrap_or(1).div_ceil(100);
    for _ in 0..rounds {
        for mode in MODES {
            blame(mode, &mut random);
        }
    }
}

fn blame(mode: Mode, random: &mut Random) {
    let folder = Folder::new();
    let mut expected = Vec::new();
    let mut names = Vec::new();
    for (language, plugin) in plugins(&folder) {
        // Those that start slowly have fewer.
        let tests = if ["cpp", "lua"].contains(&language) { 30 } else { 10 };
        let drawn: Vec<_> = (0..tests).map(|_| draw(random)).collect();
        let params: Vec<&str> = drawn.iter().map(|(param, ..)| param.as_str()).collect();
        suite(&folder, language, (mode, &plugin), &params);
        names.push(format!("{language}.xml"));
        expected.extend(drawn);
    }
    let mut args = vec!["run", "--fork", mode.fork];
    args.extend(names.iter().map(String::as_str));
    let finished = folder.rtf(&args);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder));
    let journal = folder.journal();
    let mut before: Option<(String, String)> = None;
    for (test, (param, verdict, phase)) in expected.iter().enumerate() {
        let name = &journal.record.tests[test].plan.name;
        let context = format!("{} {name} {param}", mode.name);
        let (_, end) = only_attempt(&journal, test).finished.as_ref().expect("an end");
        assert_eq!((end.verdict, end.phase), (*verdict, *phase), "{context}: {end:?}");
        let kills = param.starts_with("kill").then_some(ExitStatus::Signal(9));
        assert!(kills.is_none() || end.exit == kills, "{context}: {end:?}");
        let began = told(&folder, name, "began");
        let ends = usize::from(*verdict != Verdict::Crashed);
        assert_eq!((began.len(), told(&folder, name, "ended").len()), (1, ends), "{context}");
        // What stands before the number in a test's name is its suite.
        let suite = name.trim_end_matches(char::is_numeric);
        if let Some((of, process)) = before.filter(|(of, _)| of == suite) {
            assert_eq!(
                process == began[0],
                mode.shares(),
                "{context} after one of {of} that passed"
            );
        }
        let stays = *verdict == Verdict::Passed;
        before = stays.then(|| (suite.to_owned(), began[0].clone()));
    }
}

/// The hosts of this folder, and servers that fork them; not those that check plug-ins
/// before the run.
fn hosts(folder: &Path) -> Vec<u32> {
    let entries = std::fs::read_dir("/proc").expect("/proc").flatten();
    let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    pids.filter(|pid| {
        let of = |file: &str| PathBuf::from(format!("/proc/{pid}/{file}"));
        let line = std::fs::read(of("cmdline")).unwrap_or_default();
        let line = String::from_utf8_lossy(&line).replace("RTF::Host", "rtf.host");
        let is_host = line.contains("rtf-host-") || line.contains("rtf.host");
        let runs = is_host && !line.contains("--check");
        runs && std::fs::read_link(of("cwd")).is_ok_and(|cwd| cwd == folder)
    })
    .collect()
}

#[test]
fn hosts_that_are_killed_at_random_moments_take_one_test_along_in_every_mode() {
    let mut random = Random::from_environment();
    let rounds = number("RTF_CHAOS_SUITES").unwrap_or(1).div_ceil(100);
    for _ in 0..rounds {
        for mode in MODES {
            kill_hosts(mode, &mut random);
        }
    }
}

fn kill_hosts(mode: Mode, random: &mut Random) {
    let folder = Folder::new();
    let mut args = vec!["run".to_owned(), "--fork".to_owned(), mode.fork.to_owned()];
    for (language, plugin) in plugins(&folder) {
        let tests = if ["cpp", "lua"].contains(&language) { 60 } else { 12 };
        suite(&folder, language, (mode, &plugin), &vec!["wait"; tests]);
        args.push(format!("{language}.xml"));
        // With a fixture, a host that tests share has nothing to do between them.
        let path = folder.path().join(format!("{language}.xml"));
        let text = std::fs::read_to_string(path).expect("the suite");
        if random.below(2) == 0 {
            let fixture =
                "<fixture type='process' name='f'><command>sleep 1000</command></fixture>";
            let text = text.replacen('>', &format!(">\n  {fixture}"), 1);
            folder.file(&format!("{language}.xml"), &text);
        }
    }
    let path = folder.path().canonicalize().expect("a path");
    let over = AtomicBool::new(false);
    let (finished, kills) = std::thread::scope(|scope| {
        let killer = scope.spawn(|| {
            let mut kills = 0;
            while !over.load(Ordering::Relaxed) {
                // Not to wait for something: the moments are what is drawn.
                std::thread::sleep(Duration::from_micros(random.below(40_000)));
                let victims = hosts(&path);
                if !victims.is_empty() {
                    let victim = victims[random.below(victims.len() as u64) as usize];
                    kills += u32::from(kill(victim));
                }
            }
            kills
        });
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let finished = folder.rtf(&args);
        over.store(true, Ordering::Relaxed);
        (finished, killer.join().expect("the killer"))
    });
    assert!(nothing_left(&folder));
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    check(&folder, mode, &folder.journal(), kills);
}

fn check(folder: &Folder, mode: Mode, journal: &Journal, kills: u32) {
    let mut crashed = 0;
    for (test, record) in journal.record.tests.iter().enumerate() {
        let name = &record.plan.name;
        let (_, end) = only_attempt(journal, test).finished.as_ref().expect("an end");
        let context = format!("{} {name}: {end:?}", mode.name);
        let [began, ended] = ["began", "ended"].map(|what| told(folder, name, what).len());
        assert!(began <= 1, "{context}: began {began} times");
        match end.verdict {
            Verdict::Passed => assert_eq!((began, ended), (1, 1), "{context}"),
            Verdict::Crashed => {
                crashed += 1;
                // An interpreter may be a script's, as pyenv's are.
                let killed = [ExitStatus::Signal(9), ExitStatus::Code(137)].map(Some);
                assert!(killed.contains(&end.exit), "{context}");
            }
            _ => panic!("{context}"),
        }
    }
    let is_told = |kind: &EventKind| matches!(kind, EventKind::Warning { diagnostic } if diagnostic.code == "shared-host-ended");
    let between = journal.events.iter().filter(|event| is_told(&event.kind)).count();
    println!("{}: {kills} kills: {crashed} crashed, {between} between two tests", mode.name);
    assert!(crashed + between <= kills as usize, "more than were killed");
    assert!(crashed > 0, "no host was hit");
    assert!(between == 0 || mode.name == SHARED.name);
}

/// A host that dies while it says something has broken no protocol.
#[test]
fn a_host_that_is_killed_in_the_middle_of_a_line_has_crashed_in_every_mode() {
    let plugin = "import os, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        \
        for fd in range(3, 64):\n            \
        try:\n                \
        is_channel = os.readlink(f'/proc/self/fd/{fd}').startswith('socket:')\n            \
        except OSError:\n                \
        continue\n            \
        if is_channel:\n                \
        os.write(fd, b'{\"jsonrpc\":\"2.0\",\"method\":\"mess')\n        \
        os.kill(os.getpid(), 9)\n";
    for mode in MODES {
        let folder = Folder::new();
        let test = format!("  <test isolation='{}'>T.py</test>\n", mode.isolation);
        folder
            .file("T.py", plugin)
            .file("s.xml", &format!("<suite>\n{}</suite>\n", test.repeat(2)));
        let finished = folder.rtf(&["run", "--fork", mode.fork, "s.xml"]);
        assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
        let record = folder.journal().record;
        assert_eq!(record.totals().of(Verdict::Crashed), 2, "{}", finished.stdout);
        assert!(nothing_left(&folder));
    }
}
