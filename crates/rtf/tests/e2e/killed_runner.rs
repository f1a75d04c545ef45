//! The runner is killed with SIGKILL: `rtf show` can show the run until then.

use rtf_model::{EventKind, Verdict};

use crate::support::{Folder, read_journal, wait_until};

const TEST: &str = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        for i in range(100):\n            self.report(f'step {i}')\n            self.sleep(0.002)\n";

#[test]
fn a_killed_run_can_still_be_shown_and_reported() {
    // The moments are spread over the run by counting events, not by a clock.
    for moment in [1, 7, 60, 150, 220] {
        let folder = Folder::new();
        folder.file("T.py", TEST);
        let tests = "<test type='python'>T</test>".repeat(5);
        folder.file("s.xml", &format!("<suite name='s'>{tests}</suite>"));
        let running = folder.start(&["run", "s.xml"]);
        let seen = running.wait_for(|_| true);
        assert!(matches!(seen.kind, EventKind::RunStarted(_)));
        let journal = folder.path().join("rtf-results/latest/events.jsonl");
        wait_until("events", || (read_journal(&journal).events.len() >= moment).then_some(()));
        running.kill_runner();
        assert_eq!(running.finish().code, Some(5));
        let before = read_journal(&journal);
        let shown = folder.rtf(&["show", "latest"]);
        assert_eq!(shown.code, Some(5), "{}{}", shown.stdout, shown.stderr);
        assert!(shown.stdout.contains("INCOMPLETE"), "{}", shown.stdout);
        let passed = before.record.totals().of(Verdict::Passed);
        assert_eq!(shown.stdout.matches("  passed  ").count(), passed as usize, "{}", shown.stdout);
        let report =
            folder.rtf(&["report", "latest", "--format", "junit", "--output", "junit.xml"]);
        assert_eq!(report.code, Some(0), "{}", report.stderr);
        let file = std::fs::File::open(folder.path().join("junit.xml")).expect("a file");
        let junit = junit_parser::from_reader(std::io::BufReader::new(file)).expect("valid JUnit");
        let cases: usize = junit.suites.iter().map(|suite| suite.cases.len()).sum();
        assert!(cases >= before.record.tests.len(), "{cases} cases");
    }
}
