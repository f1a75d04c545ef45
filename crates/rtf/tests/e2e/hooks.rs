//! Hooks that park the robot, with real processes.

use rtf_model::{TestId, Trigger, Verdict};

use crate::support::{Folder, nothing_left};

const FAILS: &str =
    "TestCase = {}\nfunction TestCase.run() rtf.check(false, 'the arm is stuck') end\n";
const PASSES: &str = "TestCase = {}\nfunction TestCase.run() end\n";
const COMMAND: &str =
    "sh -c 'echo $RTF_HOOK_TRIGGER/$RTF_HOOK_TEST/$RTF_HOOK_REASON >> parked; echo at rest'";

fn suite(hooks: &str, tests: &str) -> String {
    format!("<suite name='s'>\n  {hooks}\n  {tests}\n</suite>\n")
}

fn parked(folder: &Folder) -> String {
    std::fs::read_to_string(folder.path().join("parked")).unwrap_or_default()
}

#[test]
fn a_command_is_told_why_and_for_which_test() {
    let folder = Folder::new();
    folder.file("Fails.lua", FAILS).file("Passes.lua", PASSES);
    let hook = format!("<hook name='park' on='failure end'><command>{COMMAND}</command></hook>");
    folder.file("s.xml", &suite(&hook, "<test>Fails.lua</test><test>Passes.lua</test>"));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(
        parked(&folder),
        "failure/Fails/`Fails` is failed: the arm is stuck\nend//the suite ends\n"
    );
    let record = folder.journal().record;
    assert_eq!(record.hooks[0].runs[0].output, "at rest\n");
    assert_eq!(record.hooks[0].runs[0].test, Some(TestId(0)));
    assert!(finished.stdout.contains("park"), "{}", finished.stdout);
}

#[test]
fn a_plug_in_of_any_language_can_be_a_hook() {
    let folder = Folder::new();
    folder.file("Fails.lua", FAILS);
    folder.file("Park.py", "import os, rtf\nclass Park(rtf.TestCase):\n    def run(self):\n        open('parked', 'w').write(os.environ['RTF_HOOK_TRIGGER'] + self.param)\n");
    folder.file(
        "s.xml",
        &suite(
            "<hook on='failure' type='python' param=' fast'>Park</hook>",
            "<test>Fails.lua</test>",
        ),
    );
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    assert_eq!(parked(&folder), "failure fast");
}

#[test]
fn a_hook_that_fails_has_an_exit_code_of_its_own_and_is_told_loudly() {
    let folder = Folder::new();
    folder.file("Passes.lua", PASSES);
    let hook = "<hook name='park' on='end'><command>sh -c 'echo no answer from the arm; exit 7'</command></hook>";
    folder.file("s.xml", &suite(hook, "<test>Passes.lua</test>"));
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=junit.xml"]);
    assert_eq!(finished.code, Some(4), "{}{}", finished.stdout, finished.stderr);
    for text in ["park", "it ended with exit code 7", "no answer from the arm"] {
        assert!(finished.stdout.contains(text), "{text}: {}", finished.stdout);
    }
    let junit = std::fs::read_to_string(folder.path().join("junit.xml")).expect("a file");
    assert!(junit.contains("it ended with exit code 7"), "{junit}");
}

#[test]
fn a_hook_that_hangs_is_ended_with_all_that_it_started() {
    let folder = Folder::new();
    folder.file("Passes.lua", PASSES);
    let hook = "<hook name='park' on='end' timeout='200ms'><command>sh -c 'trap \"\" TERM; setsid sleep 1000 &amp; sleep 1000'</command></hook>";
    folder.file("s.xml", &suite(hook, "<test>Passes.lua</test>"));
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(4));
    assert!(nothing_left(&folder));
}

#[test]
fn a_collapse_and_a_time_out_call_their_hooks() {
    let folder = Folder::new();
    folder.file("T.py", "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        open('go', 'w').close()\n        self.sleep(60)\n");
    folder.file("F.py", "import os, rtf, threading, time\nclass F(rtf.FixtureManager):\n    def setup(self, args):\n        threading.Thread(target=self.watch, daemon=True).start()\n    def watch(self):\n        while not os.path.exists('go'):\n            time.sleep(0.005)\n        self.collapsed('gone')\n");
    let hook = format!(
        "<hook name='park' on='collapse timeout fixture-broken'><command>{COMMAND}</command></hook>"
    );
    let fixture = "<fixture type='python' restarts='0'>F</fixture>";
    folder.file("a.xml", &suite(&format!("{fixture}{hook}"), "<test type='python'>T</test>"));
    folder.file(
        "b.xml",
        &suite(&hook, "<test type='python' timeout='200ms'>T</test>").replace("'s'", "'b'"),
    );
    assert_eq!(folder.rtf(&["run", "a.xml", "b.xml"]).code, Some(1));
    let record = folder.journal().record;
    let triggers = |hook: usize| -> Vec<Trigger> {
        record.hooks[hook].runs.iter().map(|run| run.trigger).collect()
    };
    assert_eq!(triggers(0), [Trigger::Collapse, Trigger::FixtureBroken]);
    assert_eq!(triggers(1), [Trigger::Timeout]);
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::TimedOut));
}

#[test]
fn a_test_that_leaves_a_process_behind_is_an_error_where_the_suite_says_so() {
    let folder = Folder::new();
    folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() os.execute('setsid sleep 1000 >/dev/null 2>&1 &') end\n");
    folder
        .file("s.xml", "<suite name='s'><test leaks='fail'>T.lua</test><test>T.lua</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    // It may be seen before it has become `sleep`, and then without arguments.
    let reason = record.tests[0].reason().expect("a reason");
    assert!(reason.starts_with("it left "), "{reason}");
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::Passed));
    assert!(nothing_left(&folder));
}

/// Known by its control group where there is one, at the end of the run elsewhere.
#[test]
fn a_daemon_without_a_trace_is_found() {
    let folder = Folder::new();
    folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() os.execute('setsid env -i sleep 1000 >/dev/null 2>&1 &') end\n");
    folder.file("s.xml", "<suite name='s'><test leaks='fail'>T.lua</test></suite>");
    let groups = rtf_process::cgroup::Cgroups::create();
    let finished = folder.rtf(&["run", "s.xml"]);
    let record = folder.journal().record;
    if groups.is_some() {
        assert_eq!(finished.code, Some(1), "{}", finished.stdout);
        let reason = record.tests[0].reason().expect("a reason");
        // It may be seen before it has become `sleep`.
        assert!(reason.starts_with("it left "), "{reason}");
    } else {
        let warned = record.warnings.iter().any(|warning| warning.code == "processes-leaked");
        assert!(warned, "{}", finished.stdout);
    }
    assert!(nothing_left(&folder));
}

/// What starts a hook must not be looked for where the suite says.
#[test]
fn an_absolute_command_needs_nothing_of_the_suites_path() {
    let folder = Folder::new();
    folder.file("Passes.lua", PASSES);
    let env = "<env name='PATH' value='/nowhere'/>";
    let hook =
        "<hook name='park' on='end'><command>/bin/sh -c 'echo here > parked'</command></hook>";
    folder.file("s.xml", &suite(&format!("{env}{hook}"), "<test>Passes.lua</test>"));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(parked(&folder), "here\n");
}

#[test]
fn a_command_that_cannot_be_executed_says_why() {
    let folder = Folder::new();
    let removes = "TestCase = {}\nfunction TestCase.run() os.remove('park') end\n";
    folder.file("Passes.lua", removes).file("park", "#!/bin/sh\n");
    let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    std::fs::set_permissions(folder.path().join("park"), executable).expect("the file");
    let hook = "<hook name='park' on='end'><command>./park</command></hook>";
    folder.file("s.xml", &suite(hook, "<test>Passes.lua</test>"));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(4), "{}{}", finished.stdout, finished.stderr);
    let ran = &folder.journal().record.hooks[0].runs[0];
    let (problem, output) = (ran.problem(), &ran.output);
    let problem = problem.unwrap_or_default();
    let start = "it ended with exit code 127: cannot execute `";
    assert!(problem.starts_with(start), "{problem}");
    assert!(problem.contains("/park`: No such file"), "{problem}");
    assert!(output.contains("/park`: No such file"), "{output}");
}
