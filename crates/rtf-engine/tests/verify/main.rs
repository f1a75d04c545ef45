//! Hosts that check plug-ins before a run. The hosts here are shell scripts
//! that answer as the protocol says, or break it.

#![expect(clippy::unwrap_used, reason = "that is where a test ends")]

#[path = "../../../rtf-plan/tests/plan/bench.rs"]
#[expect(dead_code, reason = "the planner's tests use all of it")]
mod bench;
mod frameworks;

use std::ops::Deref;
use std::time::Duration;

use rtf_engine::verify::verify;
use rtf_model::Diagnostic;
use rtf_plan::plan::{Plan, PlanOutcome};

use bench::{Bench, names};

/// A bench whose plug-ins are checked.
struct Checked {
    bench: Bench,
    limit: Duration,
}

impl Deref for Checked {
    type Target = Bench;

    fn deref(&self) -> &Bench {
        &self.bench
    }
}

impl Checked {
    fn build(&self, paths: &[&str]) -> PlanOutcome {
        verify(self.bench.draft(paths), self.limit)
    }

    fn plan(&self, paths: &[&str]) -> Plan {
        let outcome = self.build(paths);
        outcome.plan.unwrap_or_else(|| panic!("{:#?}", outcome.diagnostics))
    }

    fn problems(&self, paths: &[&str]) -> Vec<(String, String)> {
        let outcome = self.build(paths);
        outcome.diagnostics.into_iter().map(|found| (found.code, found.message)).collect()
    }
}

/// A bench whose Lua host runs `script` for `--check FILE…`.
fn bench(script: &str) -> Checked {
    let bench = Bench::new();
    bench.program("bin/rtf-host-lua", &format!("test \"$1\" = --check || exit 9\nshift\n{script}"));
    for name in ["A", "B", "C"] {
        bench.file(&format!("cell/{name}.lua"), "one\ntwo\n  three\n");
    }
    bench.file(
        "cell/s.xml",
        "<suite>\n<test>A.lua</test>\n<test>B.lua</test>\n<test>C.lua</test>\n<test>B.lua</test>\n</suite>",
    );
    Checked { bench, limit: Duration::from_secs(20) }
}

/// Says `fields` of B and `"ok":true` of all others.
fn answer_b(fields: &str) -> String {
    format!(
        "for f; do case $f in\n*/B.lua) printf '%s\\n' '{{\"file\":\"'$f'\",{fields}}}';;\n\
         *) echo '{{\"file\":\"'$f'\",\"ok\":true,\"kinds\":[\"test\"]}}';;\nesac; done"
    )
}

fn only(outcome: &PlanOutcome) -> &Diagnostic {
    assert!(outcome.plan.is_none());
    assert_eq!(outcome.diagnostics.len(), 1, "{:#?}", outcome.diagnostics);
    &outcome.diagnostics[0]
}

#[test]
fn plugins_that_load_are_fine() {
    let bench = bench(&answer_b("\"ok\":true"));
    assert_eq!(bench.plan(&["s.xml"]).tests, 4);
}

#[test]
fn a_syntax_error_is_shown_in_the_suite_and_in_the_plugin() {
    let bench =
        bench(&answer_b("\"ok\":false,\"message\":\"unexpected symbol near x\",\"line\":3"));
    let outcome = bench.build(&["s.xml"]);
    let found = only(&outcome);
    assert_eq!(found.code, "plugin-not-loadable");
    assert_eq!(found.message, "the plug-in `B.lua` cannot be loaded: unexpected symbol near x");
    let places: Vec<_> =
        found.labels.iter().map(|label| (label.file.as_str(), label.line, label.column)).collect();
    let plugin = bench.path("cell/B.lua");
    assert_eq!(places, [("s.xml", 3, 7), ("s.xml", 5, 7), (plugin.as_str(), 3, 3)]);
    assert!(outcome.sources.text(&plugin).is_some());
}

#[test]
fn the_loaders_text_is_kept() {
    let text = "cannot be loaded: libarm.so: undefined symbol: arm_open\\nneeded by libarm.so";
    let bench = bench(&answer_b(&format!("\"ok\":false,\"message\":\"{text}\"")));
    let outcome = bench.build(&["s.xml"]);
    let found = only(&outcome);
    let message = "the plug-in `B.lua` cannot be loaded: libarm.so: undefined symbol: arm_open";
    assert_eq!(found.message, message);
    assert_eq!(found.notes[0], "needed by libarm.so");
}

#[test]
fn a_fixture_is_no_test_and_the_other_way_round() {
    let bench = bench(&answer_b("\"ok\":true,\"kinds\":[\"fixture\"]"));
    let outcome = bench.build(&["s.xml"]);
    assert_eq!(only(&outcome).message, "the plug-in `B.lua` is a fixture, not a test");
    assert_eq!(only(&outcome).hint.as_deref(), Some("in a suite it is written as `<fixture>`"));
    bench.file("cell/s.xml", "<suite><fixture>A.lua</fixture><test>A.lua</test></suite>");
    let outcome = bench.build(&["s.xml"]);
    assert_eq!(only(&outcome).message, "the plug-in `A.lua` is a test, not a fixture");
}

#[test]
fn a_hook_is_a_test_plugin() {
    let bench = bench(&answer_b("\"ok\":true,\"kinds\":[\"fixture\"]"));
    bench.file("cell/s.xml", "<suite><hook on='end'>B.lua</hook><test>A.lua</test></suite>");
    let outcome = bench.build(&["s.xml"]);
    assert_eq!(only(&outcome).message, "the plug-in `B.lua` is a fixture, not a test");
    let hint = "a hook is a test plug-in that succeeds by passing";
    assert_eq!(only(&outcome).hint.as_deref(), Some(hint));
}

#[test]
fn a_host_that_dies_at_one_plugin_still_checks_the_others() {
    let script = "for f; do case $f in\n*/B.lua) echo boom >&2; kill -SEGV $$;;\n\
                  *) echo '{\"file\":\"'$f'\",\"ok\":true,\"kinds\":[\"fixture\"]}';;\nesac; done";
    let bench = bench(script);
    let messages: Vec<_> = bench.problems(&["s.xml"]).into_iter().map(|(_, m)| m).collect();
    assert_eq!(
        messages,
        [
            "the plug-in `A.lua` is a fixture, not a test",
            "loading `B.lua` ended its host: a segmentation fault (signal 11)",
            "the plug-in `C.lua` is a fixture, not a test",
        ]
    );
    let outcome = bench.build(&["s.xml"]);
    assert_eq!(outcome.diagnostics[1].notes, ["it printed\nboom"]);
}

#[test]
fn a_plugin_that_hangs_is_blamed_and_its_host_killed() {
    let script = "for f; do case $f in\n*/B.lua) echo $$ > pid; sleep 1000;;\n\
                  *) echo '{\"file\":\"'$f'\",\"ok\":true}';;\nesac; done";
    let mut bench = bench(script);
    bench.limit = Duration::from_millis(500);
    let outcome = bench.build(&["s.xml"]);
    assert_eq!(only(&outcome).message, "loading `B.lua` takes longer than 500ms");
    let pid = std::fs::read_to_string(bench.root.join("cell/pid")).unwrap();
    assert!(!std::path::Path::new("/proc").join(pid.trim()).exists());
}

#[test]
fn a_host_that_does_not_work_is_reported_once() {
    let bench = bench("echo 'No module named rtf' >&2\nexit 1");
    let outcome = bench.build(&["s.xml"]);
    let found = only(&outcome);
    assert_eq!(found.code, "host-failed");
    assert!(found.message.ends_with("does not work: exit code 1"), "{}", found.message);
    assert_eq!(found.notes[0], "it printed\nNo module named rtf");
}

#[test]
fn what_plugins_print_while_they_are_loaded_is_no_answer() {
    let script = "echo hello; echo '{\"file\":\"/other\",\"ok\":false}'; echo '{broken'\n";
    let bench = bench(&format!("{script}{}", answer_b("\"ok\":true")));
    assert_eq!(bench.plan(&["s.xml"]).tests, 4);
}

#[test]
fn plugins_of_a_folder_that_hold_no_test_are_left_out() {
    let bench = bench(&answer_b("\"ok\":true,\"kinds\":[\"fixture\"]"));
    std::fs::remove_file(bench.root.join("cell/s.xml")).unwrap();
    let plan = bench.plan(&["."]);
    assert_eq!(names(&plan, 0), ["A", "C"]);
    // One that is named is not.
    let problems = bench.problems(&["B.lua"]);
    assert_eq!(problems[0].1, "the plug-in `B.lua` is a fixture, not a test");
    // A folder of helpers only has nothing to run.
    bench.file("cell/only/B.lua", "");
    assert_eq!(bench.problems(&["only"])[0].0, "no-tests");
}

#[test]
fn hosts_check_with_the_folder_and_the_variables_of_the_suite() {
    let script = "test \"$MODE\" = fast && test -f here || exit 3\n";
    let bench = bench(&format!("{script}{}", answer_b("\"ok\":true")));
    bench.file("cell/sub/here", "");
    bench.file(
        "cell/sub/s.xml",
        "<suite><env name='MODE' value='fast'/><test>../A.lua</test></suite>",
    );
    assert_eq!(bench.plan(&["sub/s.xml"]).tests, 1);
    assert_eq!(bench.problems(&["s.xml"])[0].0, "host-failed");
}

#[test]
fn each_file_is_checked_once() {
    let bench = bench(&format!("for f; do echo $f >> checked; done\n{}", answer_b("\"ok\":true")));
    let tests: String = (0..500)
        .map(|n| format!("<test param='{n}'>{}.lua</test>", ["A", "B", "C"][n % 3]))
        .collect();
    bench.file("cell/s.xml", &format!("<suite>{tests}</suite>"));
    assert_eq!(bench.plan(&["s.xml"]).tests, 500);
    let checked = std::fs::read_to_string(bench.root.join("cell/checked")).unwrap();
    assert_eq!(checked.lines().count(), 3);
}
