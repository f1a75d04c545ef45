//! `rtf merge` combines the parts of a run, made by real runs.

use std::collections::BTreeMap;

use insta::assert_snapshot;
use rtf_model::{EventKind, FixtureState, Manifest, Phase, Record, TestId, Verdict};

use crate::support::{Finished, Folder, Journal, nothing_left};

const PASSES: &str = "function TestCase.run()\n  rtf.measure('error', 0.5, 'rad')\n  \
                      print('printed by it')\nend\n";
const FAILS: &str = "function TestCase.run() rtf.fail('it is wrong') end\n";
const CRASHES: &str = "function TestCase.run() os.exit(0) end\n";
const WAITS: &str = "function TestCase.run() rtf.sleep(1000) end\n";
const ATTACHES: &str = "import os\nimport rtf\n\n\nclass Test(rtf.TestCase):\n    def run(self):\n        \
                        with open('plot.csv', 'w') as plot:\n            plot.write('1,2\\n')\n        \
                        self.attach('plot.csv')\n";
const FIXTURE: &str =
    "<fixture type='process' name='server'><command>sleep 1000</command></fixture>";
const PARK: &str = "<hook name='park' on='end'><command>true</command></hook>";

/// Two suites with a fixture and a hook each.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("P.lua", PASSES).file("F.lua", FAILS).file("C.lua", CRASHES);
    let test = |name: &str, file: &str| format!("<test name='{name}'>{file}</test>");
    let arm = [("A", "P.lua"), ("B", "F.lua"), ("C", "P.lua"), ("D", "C.lua"), ("E", "P.lua")];
    let leg = [("A", "P.lua"), ("B", "P.lua"), ("C", "F.lua"), ("D", "P.lua")];
    for (suite, tests) in [("arm", &arm[..]), ("leg", &leg[..])] {
        let tests: String = tests.iter().map(|(name, file)| test(name, file)).collect();
        let text = format!("<suite name='{suite}'>{FIXTURE}{PARK}{tests}</suite>");
        folder.file(&format!("suites/{suite}.xml"), &text);
    }
    for name in ["P.lua", "F.lua", "C.lua"] {
        folder.file(&format!("suites/{name}"), &folder.read(name));
    }
    folder
}

fn verdicts(record: &Record) -> BTreeMap<String, Verdict> {
    let ids = (0..record.tests.len()).map(|id| TestId(u32::try_from(id).expect("few tests")));
    ids.map(|id| (record.full_name(id), record.final_verdict(id))).collect()
}

/// The path of the newest run in a folder of results.
fn newest(folder: &Folder, results: &str) -> String {
    let name = std::fs::read_link(folder.path().join(results).join("latest")).expect("a run");
    format!("{results}/{}", name.display())
}

#[test]
fn three_parts_merged_are_the_whole() {
    let folder = folder();
    let whole = folder.rtf(&["run", "suites"]);
    let Journal { record, .. } = folder.journal();
    let mut args = vec!["merge".to_owned()];
    for part in ["1/3", "2/3", "3/3"] {
        // The second part has tests of both suites, at the same time.
        let run = ["run", "suites", "--jobs", "2", "--shard", part, "--shard-by", "count"];
        folder.rtf(&[&run[..], &["--results", "parts"]].concat());
        args.push(newest(&folder, "parts"));
    }
    args.extend(["--results".to_owned(), "merged".to_owned()]);
    let args: Vec<_> = args.iter().map(String::as_str).collect();
    let finished = folder.rtf(&args);
    assert_eq!(finished.code, whole.code, "{}{}", finished.stdout, finished.stderr);
    let merged = folder.journal_in("merged").record;
    assert_eq!(verdicts(&merged), verdicts(&record));
    assert_eq!(merged.totals(), record.totals());
    let starts: Vec<_> = merged.fixtures.iter().map(|fixture| fixture.starts).collect();
    assert_eq!(starts, [2, 2], "the second part has tests of both suites");
    assert!(merged.fixtures.iter().all(|fixture| fixture.state == FixtureState::Stopped));
    let manifest = |record: &Record| {
        let run = record.run.as_ref().expect("a run");
        Manifest { origin: None, parts: Vec::new(), ..(*run.manifest).clone() }
    };
    assert_eq!(manifest(&merged), manifest(&record), "it can be run again as the whole can");
    let shown = folder.rtf(&["show", "--results", "merged"]);
    assert_eq!((shown.code, &shown.stdout), (finished.code, &finished.stdout));
    let log = format!("{}/logs/leg.A.log", newest(&folder, "merged"));
    assert!(folder.read(&log).contains("printed by"), "logs are made of the journal");
    let junit = folder.rtf(&["report", "--results", "merged", "--format", "junit"]).stdout;
    assert_eq!(junit.matches("<testsuite ").count(), 2, "{junit}");
    assert!(junit.contains("failures=\"2\" errors=\"1\""), "{junit}");
    assert!(nothing_left(&folder));
}

/// The pattern `parts/*` names the history and the link to the newest run, too.
#[test]
fn all_of_a_results_directory_is_merged_and_not_counted_twice() {
    let folder = folder();
    let runs = |results: &str| -> u64 {
        let history = ["history", "doctor", "--results", results, "--format", "json"];
        let checks = serde_json::from_str(&folder.rtf(&history).stdout);
        let checks: serde_json::Value = checks.expect("JSON");
        checks["checks"]["runs"].as_u64().expect("a number")
    };
    for part in ["1/2", "2/2"] {
        let run = ["run", "suites", "--shard", part, "--shard-by", "count", "--results", "parts"];
        folder.rtf(&run);
    }
    let entries = std::fs::read_dir(folder.path().join("parts")).expect("results");
    let entry = |entry: std::io::Result<std::fs::DirEntry>| {
        format!("parts/{}", entry.expect("an entry").file_name().display())
    };
    let all: Vec<_> = entries.map(entry).collect();
    assert!(all.contains(&"parts/history.db".to_owned()), "{all:?}");
    assert!(all.contains(&"parts/latest".to_owned()), "{all:?}");
    let mut args = vec!["merge", "--results", "parts"];
    args.extend(all.iter().map(String::as_str));
    let finished = folder.rtf(&args);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let merged = folder.journal_in("parts").record;
    assert_eq!(merged.tests.len(), 9);
    assert_eq!(merged.run.expect("a run").manifest.parts.len(), 2);
    let imported = folder.rtf(&["history", "import", "--results", "parts"]);
    let text = "0 runs imported, 2 already there, 1 left out (merged from others)\n";
    assert_eq!((imported.code, imported.stdout.as_str()), (Some(0), text));
    assert_eq!(runs("parts"), 2);
}

#[test]
fn what_tests_attached_is_copied_and_nothing_else() {
    let folder = Folder::new();
    folder.file("one.py", ATTACHES).file("two.py", ATTACHES).file("secret", "mine\n");
    let mut runs = Vec::new();
    for file in ["one.py", "two.py"] {
        assert_eq!(folder.rtf(&["run", file]).code, Some(0));
        runs.push(newest(&folder, "rtf-results"));
    }
    let attached = |folder: &Folder| -> Vec<String> {
        let tests = folder.journal().record.tests;
        tests.iter().map(|test| test.attempts[0].attachments[0].path.clone()).collect()
    };
    // A run that came from elsewhere holds a link to a file of this machine.
    let link = folder.path().join(&runs[1]).join(&attached(&folder)[0]);
    std::fs::remove_file(&link).expect("the file");
    std::os::unix::fs::symlink(folder.path().join("secret"), &link).expect("a link");
    let finished = folder.rtf(&["merge", &runs[0], &runs[1]]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(finished.stderr.starts_with("warning: missing attachment: "));
    let merged = newest(&folder, "rtf-results");
    let [first, second] = attached(&folder).try_into().expect("two files");
    assert_eq!(folder.read(&format!("{merged}/{first}")), "1,2\n");
    assert!(!folder.path().join(&merged).join(second).exists());
}

/// The events of the other files stay, and say so.
#[test]
fn attachments_that_are_not_kept_are_reported_as_such() {
    let folder = Folder::new();
    let fails = "\n        raise RuntimeError('it is wrong')\n";
    folder.file("one.py", ATTACHES).file("two.py", &format!("{}{fails}", ATTACHES.trim_end()));
    let mut runs = Vec::new();
    for file in ["one.py", "two.py"] {
        folder.rtf(&["run", file]);
        runs.push(newest(&folder, "rtf-results"));
    }
    let finished = folder.rtf(&["merge", &runs[0], &runs[1], "--keep", "failed"]);
    assert_eq!((finished.code, finished.stderr.as_str()), (Some(1), ""), "{}", finished.stdout);
    let merged = newest(&folder, "rtf-results");
    let tests = folder.journal().record.tests;
    let files: Vec<_> = tests.iter().map(|test| &test.attempts[0].attachments[0]).collect();
    assert_eq!(files.iter().map(|file| file.omitted).collect::<Vec<_>>(), [true, false]);
    assert!(!folder.path().join(&merged).join(&files[0].path).exists());
    assert_eq!(folder.read(&format!("{merged}/{}", files[1].path)), "1,2\n");
    let text = folder.rtf(&["report", "--format", "text"]).stdout;
    assert!(text.contains("plot.csv: not kept by `rtf merge`"), "{text}");
    let junit = folder.rtf(&["report", "--format", "junit"]).stdout;
    assert_eq!(junit.matches("[[ATTACHMENT|").count(), 1, "{junit}");
    // What was omitted is not missed when the merged run is merged.
    let again = folder.rtf(&["merge", &merged, "--results", "again"]);
    assert_eq!((again.code, again.stderr.as_str()), (Some(1), ""), "{}", again.stdout);
    let wrong = folder.rtf(&["merge", &runs[0], "--keep", "passed"]);
    assert_eq!(wrong.code, Some(2));
    assert!(wrong.stderr.contains("expected `all`, `failed`, `sample:NUMBER`"), "{}", wrong.stderr);
}

#[test]
fn what_cannot_be_merged_is_told_and_makes_nothing() {
    let folder = folder();
    folder.rtf(&["run", "suites/leg.xml", "--shard", "2/2", "--shard-by", "count"]);
    let part = newest(&folder, "rtf-results");
    let run = |args: &[&str]| {
        let finished = folder.rtf(&[&["merge", "--results", "merged"], args].concat());
        let shown = folder.shown(&finished);
        assert!(!folder.path().join("merged").exists(), "nothing is made");
        shown
    };
    assert_snapshot!(run(&[&part]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: not all of 2 parts are there: 1/2 is missing
    hint: `--partial` merges without them
    ");
    assert_snapshot!(run(&[&part, &part]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: test `leg/C` is in `rtf-results/[RUN]` and in `rtf-results/[RUN]`
    error: test `leg/D` is in `rtf-results/[RUN]` and in `rtf-results/[RUN]`
    hint: merge runs of different tests, as those of `--shard` are
    ");
    assert_snapshot!(run(&["nowhere"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no run `nowhere`
    hint: looked for merged/nowhere/events.jsonl, nowhere/events.jsonl
    ");
    let journal = folder.read(&format!("{part}/events.jsonl"));
    let lines: Vec<_> = journal.lines().enumerate().collect();
    let damage =
        |(number, line): (usize, &str)| format!("{}\n", if number == 1 { "?" } else { line });
    let damaged: String = lines.into_iter().map(damage).collect();
    folder.file("damaged.jsonl", &damaged);
    folder.file("other.jsonl", "no journal\n");
    assert_snapshot!(run(&["damaged.jsonl", "other.jsonl", "--partial"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the journal of `damaged.jsonl` is damaged: line 2: this is not an event: expected value at line 1 column 1
    hint: `rtf show damaged.jsonl` shows the readable part
    error: `other.jsonl` is not a journal: line 1: this is not an event: expected ident at line 1 column 2
    ");
}

#[test]
fn a_part_that_was_killed_makes_the_run_incomplete() {
    let folder = Folder::new();
    folder.file("W.lua", WAITS).file("P.lua", PASSES);
    let tests = "<test name='first'>P.lua</test><test name='second'>W.lua</test>";
    folder.file("s.xml", &format!("<suite name='s'>{FIXTURE}{PARK}{tests}</suite>"));
    let part = |part| ["run", "s.xml", "--shard-by", "count", "--shard", part];
    assert_eq!(folder.rtf(&part("1/2")).code, Some(0));
    let first = newest(&folder, "rtf-results");
    let running = folder.start(&part("2/2"));
    let runs = |kind: &EventKind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. });
    // `latest` leads to the new run before anything is in its journal.
    crate::support::wait_until("the second run", || {
        (newest(&folder, "rtf-results") != first).then_some(())
    });
    running.wait_for(runs);
    let second = newest(&folder, "rtf-results");
    let early = folder.rtf(&["merge", &first, &second]);
    assert_eq!(early.code, Some(2));
    assert!(
        early.stderr.ends_with(" is still running\nhint: wait until it has finished\n"),
        "{}",
        early.stderr
    );
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    // The killed part comes first: its suite goes on with the other one.
    let finished = folder.rtf(&["merge", &second, &first]);
    assert_eq!(finished.code, Some(5), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    let wanted = [("s/first", Verdict::Passed), ("s/second", Verdict::Interrupted)];
    assert_eq!(verdicts(&record), wanted.map(|(name, verdict)| (name.to_owned(), verdict)).into());
    let died = record.runner_death().expect("a runner that died");
    assert_eq!(died, format!("signal 9 (SIGKILL) in {second}"));
    assert!(nothing_left(&folder));
}

#[test]
fn workers_of_a_campaign_are_one_run() {
    let folder = Folder::new();
    folder.file("P.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder.file("s.xml", "<suite name='s'><test name='A' param='${param:n}'>P.lua</test></suite>");
    let campaign = "<campaign suite='s.xml' episodes='5'>\
        <parameter name='n' distribution='choice' values='1 2 3'/>\
        <claim require='rate &gt;= 0.1' confidence='0.8'/></campaign>";
    folder.file("c.xml", campaign);
    let finished = folder.rtf(&["campaign", "run", "c.xml", "--workers", "2"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let runs: Vec<_> = ["1", "2"]
        .map(|worker| newest(&folder, &format!("rtf-results/campaigns/latest/workers/{worker}")))
        .into();
    let merged = folder.rtf(&["merge", &runs[0], &runs[1], "--results", "merged"]);
    assert_eq!(merged.code, Some(0), "{}{}", merged.stdout, merged.stderr);
    let record = folder.journal_in("merged").record;
    let mut ids: Vec<_> = record.suites[0].episodes.iter().map(|it| it.episode.id).collect();
    ids.sort_unstable();
    assert_eq!(ids, [1, 2, 3, 4, 5]);
    assert_eq!((record.tests.len(), record.tests[0].attempts.len()), (1, 5));
    let twice = folder.rtf(&["merge", &runs[0], &runs[0]]);
    assert_eq!(twice.code, Some(2));
    assert!(twice.stderr.ends_with(" are the same run\n"), "{}", twice.stderr);
}

/// A run of one test that reported `messages` short messages.
fn talkative_run(name: &str, messages: usize) -> String {
    let report = r#""type":"message","source":{"test":0},"message":{"kind":"report","text":"x"}"#;
    let head = [
        r#""type":"run-started","version":1,"run":"r","rtf":"0.1.0","started_at":"2026-11-21T07:30:12Z","command":[],"working_dir":"/","suites":1,"tests":1"#,
        r#""type":"suite-planned","suite":0,"name":"s","file":"s.xml""#,
        &format!(
            r#""type":"test-planned","test":0,"suite":0,"name":"{name}","plugin_type":"lua","plugin":"T.lua","repetitions":1"#
        ),
        r#""type":"suite-started","suite":0"#,
        r#""type":"test-started","test":0,"repetition":1,"attempt":1"#,
    ];
    let tail = [
        r#""type":"test-finished","test":0,"verdict":"passed","phase":"exit","exit":{"code":0}"#,
        r#""type":"suite-finished","suite":0"#,
        r#""type":"run-finished""#,
    ];
    let events = head.into_iter().chain(std::iter::repeat_n(report, messages)).chain(tail);
    let line = |(seq, event): (usize, &str)| format!("{{\"seq\":{seq},\"at\":{seq},{event}}}\n");
    events.enumerate().map(line).collect()
}

/// Events of 200 000 messages take more than 80 MB; the program itself takes less than 25 MB.
#[test]
fn memory_does_not_depend_on_the_size_of_journals() {
    let folder = Folder::new();
    for part in ["a", "b"] {
        folder.file(&format!("{part}.jsonl"), &talkative_run(part, 100_000));
    }
    let rtf = folder.command(&["merge", "a.jsonl", "b.jsonl"]);
    let mut command = std::process::Command::new("sh");
    command.args(["-c", "ulimit -d 60000 && ulimit -c 0 && exec \"$0\" \"$@\""]);
    command.arg(rtf.get_program()).args(rtf.get_args()).current_dir(folder.path());
    let finished = Finished::of(command.output().expect("a shell"));
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let journal = folder.journal();
    assert_eq!(journal.record.tests.len(), 2);
    let counts = journal.record.tests.iter().map(|test| test.attempts[0].counts.messages);
    assert_eq!(counts.sum::<u64>(), 200_000);
}
