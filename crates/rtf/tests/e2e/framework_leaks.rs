//! Processes that tests of other frameworks leave behind: named and counted as those of plug-ins,
//! in the case where only one can have left them. `tests/frameworks/promises.json` has every
//! type.

use rtf_model::{AttemptRecord, Verdict};

use crate::support::{Finished, Folder, nothing_left};

/// Leaves `sleep 1000`, in the group of the program, in a new session just before the end, or
/// without any trace of the test.
const LEAVES: [(&str, &str); 3] = [
    ("group", "sleep 1000 >/dev/null 2>&1 &"),
    ("session", "setsid sleep 1000 >/dev/null 2>&1 & exit 0"),
    ("trace", "setsid env -i /bin/sleep 1000 >/dev/null 2>&1 & exit 0"),
];

const CASES: &str = r#"
import os, subprocess, unittest
from multiprocessing import shared_memory

SLEEP = ["sleep", "1000"]


class Arm(unittest.TestCase):
    def test_1_passes(self):
        pass

    def test_2_leaves_one(self):
        subprocess.Popen(SLEEP)

    def test_3_leaves_two(self):
        subprocess.Popen(SLEEP, start_new_session=True)
        subprocess.Popen(SLEEP)

    def test_4_passes(self):
        pass

    def test_5_fails_and_leaves(self):
        subprocess.Popen(SLEEP)
        self.fail("the gripper is open")

    def test_6_crashes_and_leaves(self):
        subprocess.Popen(SLEEP)
        os.abort()

    def test_7_waits_for_its_child(self):
        subprocess.run(["sleep", "0.01"])

    def test_8_has_a_helper_that_ends_after_it(self):
        memory = shared_memory.SharedMemory(create=True, size=100)
        memory.close()
        memory.unlink()
"#;

fn run(folder: &Folder, tests: &str) -> Finished {
    folder.file("s.xml", &format!("<suite name='s'>{tests}</suite>"));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert!(nothing_left(folder), "{}", finished.stdout);
    finished
}

/// A process may be seen before it has become `sleep`.
fn assert_left(attempt: &AttemptRecord, count: usize, what: &str) {
    assert_eq!(attempt.leaked.len(), count, "{what}: {:?}", attempt.leaked);
}

fn has_message(attempt: &AttemptRecord, case: &str, start: &str) -> bool {
    let id = attempt.cases.kept().iter().find(|kept| kept.path == case).expect("a case").start.case;
    let mut messages = attempt.messages.iter();
    messages.any(|message| message.case == Some(id) && message.text.starts_with(start))
}

#[test]
fn what_a_program_leaves_is_an_error_where_the_suite_says_so() {
    for (name, script) in LEAVES {
        let folder = Folder::new();
        folder.file("leaves.sh", &format!("echo 1..1\necho 'ok 1 - moves'\n{script}\n"));
        let program = "type='program' param='leaves.sh'>sh</test>";
        let tap = "type='tap' param='leaves.sh'>sh</test>";
        let test = |kind: &str, leaks: &str| format!("<test leaks='{leaks}' {kind}");
        let tests = [test(program, "fail"), test(tap, "fail"), test(program, "report")].concat();
        let finished = run(&folder, &tests);
        assert_eq!(finished.code, Some(1), "{name}: {}", finished.stdout);
        let record = folder.journal().record;
        for (index, expected) in
            [Verdict::Error, Verdict::Error, Verdict::Passed].iter().enumerate()
        {
            let test = &record.tests[index];
            assert_eq!(test.verdict(), Some(*expected), "{name} {index}: {:?}", test.reason());
            assert_left(&test.attempts[0], 1, name);
            if *expected == Verdict::Error {
                let reason = test.reason().expect("a reason");
                assert!(reason.starts_with("it left a process behind: "), "{name}: {reason}");
            }
        }
        assert!(
            finished.stdout.contains("1 process left behind and killed"),
            "{}",
            finished.stdout
        );
    }
}

#[test]
fn what_a_case_leaves_is_in_its_result_where_it_has_its_own_process() {
    let folder = Folder::new();
    folder.file("arm.py", CASES);
    let test = |leaks: &str| {
        format!("<test leaks='{leaks}' isolation='case' type='unittest'>arm.py</test>")
    };
    run(&folder, &[test("fail"), test("report")].concat());
    let record = folder.journal().record;
    let [fails, reports] = [0, 1].map(|index| &record.tests[index].attempts[0]);
    let verdicts = |attempt: &AttemptRecord| -> Vec<Verdict> {
        attempt.cases.kept().iter().filter_map(|case| case.verdict()).collect()
    };
    use Verdict::{Crashed, Error, Failed, Passed};
    let cases = &fails.cases;
    let reasons: Vec<_> = cases.kept().iter().map(|case| case.reason().unwrap_or("")).collect();
    let expected = [Passed, Error, Error, Passed, Failed, Crashed, Passed, Passed];
    assert_eq!(verdicts(fails), expected, "{reasons:?}");
    assert!(reasons[1].starts_with("it left a process behind: "), "{reasons:?}");
    assert!(reasons[2].starts_with("it left 2 processes behind, first: "), "{reasons:?}");
    assert_eq!(reasons[4], "AssertionError: the gripper is open");
    let expected = [Passed, Passed, Passed, Passed, Failed, Crashed, Passed, Passed];
    assert_eq!(verdicts(reports), expected);
    for attempt in [fails, reports] {
        assert_left(attempt, 5, "all cases");
        for case in ["arm.Arm.test_2_leaves_one", "arm.Arm.test_5_fails_and_leaves"] {
            assert!(has_message(attempt, case, "it left a process behind: "), "{case}");
        }
    }
}

#[test]
fn what_one_of_several_cases_leaves_is_in_the_result_of_the_test() {
    let folder = Folder::new();
    folder.file("arm.py", CASES);
    let selected = "cases='*1_passes *2_leaves_one *4_passes'";
    run(&folder, &format!("<test leaks='fail' {selected} type='unittest'>arm.py</test>"));
    let record = folder.journal().record;
    let test = &record.tests[0];
    assert_eq!(test.verdict(), Some(Verdict::Error));
    let reason = test.reason().expect("a reason");
    assert!(reason.starts_with("it left a process behind: "), "{reason}");
    assert_eq!(test.attempts[0].cases.of(Verdict::Passed), 3);
    assert_left(&test.attempts[0], 1, "the test");
}

/// The children of a case that hangs are killed with it: it had no time to end them.
#[test]
fn what_is_killed_with_a_case_at_its_limit_was_not_left() {
    let folder = Folder::new();
    let hangs = "import subprocess, unittest\nclass Arm(unittest.TestCase):\n    def test_a(self):\n        subprocess.run(['sleep', '1000'])\n    def test_b(self):\n        pass\n";
    folder.file("hangs.py", hangs);
    run(&folder, "<test leaks='fail' case-timeout='2s' type='unittest'>hangs.py</test>");
    let record = folder.journal().record;
    let attempt = &record.tests[0].attempts[0];
    assert_eq!(record.tests[0].verdict(), Some(Verdict::TimedOut));
    assert_eq!(attempt.cases.of(Verdict::Passed), 1);
    assert_left(attempt, 0, "the test");
}
