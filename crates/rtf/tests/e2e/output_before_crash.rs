//! The result of a crashed test has the output that the test printed before.

use rtf_model::Verdict;

use crate::host_modes::MODES;
use crate::support::{Folder, build_cpp, root};

#[test]
fn whole_lines_that_a_cpp_test_printed_before_it_crashed_or_was_killed_are_kept() {
    let plugins = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp");
    let plugin = plugins.join("Prints.so").display().to_string();
    let ends = ["crash", "kill", "exit", "hang"];
    for mode in MODES {
        let folder = Folder::new();
        let test = |what: &&str| {
            let isolation = mode.isolation;
            let timeout = if *what == "hang" { "timeout='1s'" } else { "" };
            format!("<test isolation='{isolation}' {timeout} param='{what}'>{plugin}</test>\n")
        };
        let tests: String = ends.iter().map(test).collect();
        folder.file("s.xml", &format!("<suite name='s'>\n{tests}</suite>\n"));
        let finished = folder.rtf(&["run", "--fork", mode.fork, "s.xml"]);
        assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
        let record = folder.journal().record;
        for (test, what) in record.tests.iter().zip(ends) {
            let attempt = &test.attempts[0];
            let context = format!("{} {what}: {:?}", mode.name, attempt.output);
            let verdict = attempt.finished.as_ref().expect("an end").1.verdict;
            let expected = if what == "hang" { Verdict::TimedOut } else { Verdict::Crashed };
            assert_eq!(verdict, expected, "{context}");
            for line in ["by printf\n", "by cout\n", "by cerr\n"] {
                assert!(attempt.output.contains(line), "{context}");
            }
        }
    }
}
