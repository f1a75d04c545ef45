//! The native host with real plug-ins.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first surprise")]
#![expect(unsafe_code, reason = "a descriptor is handed over between fork and exec")]

mod driver;

use std::os::unix::process::ExitStatusExt;

use driver::{Host, build, build_text, check, dir, display, run_test, start_test};
use serde_json::{Value, json};

const SIGSEGV: i32 = 11;

#[test]
fn everything_that_the_cpp_sdk_offers_arrives_with_file_and_line() {
    let library = build("sdk/cpp/tests/every_macro.cpp");
    let params = json!({
        "param": "a \"b c\"", "args": ["a", "b c"], "environment": "--robot sim", "repetition": 2,
    });
    let ran = run_test(&library, params);
    let expected = [
        "report: <arm test>",
        "report: <a>",
        "report: <b c>",
        "check: argv ends with a null",
        "report: arm test|a \"b c\"|--robot sim|2",
        "report: zero \0 inside",
        "check: a helper function checks",
        "check: commas are no trouble",
        "check: safe",
        "failure: gain: got 1.25, expected 1 ± 0.1 (off by 0.25)",
        "failure: pose: got 3.5, expected 3 ± 0.1 (off by 0.5) at index 2",
        "failure: matrix: got 9, expected 4 ± 0.1 (off by 5) at index 3",
        "failure: lengths: got 2 values, expected 3",
        "failure: lost: got nan, expected 1 ± 0.1",
        "failure: lost in a vector: got nan, expected 2 ± 0.1 at index 1",
        "failure: yaw: got 0, expected 1 ± 0.1 (off by 1)",
        "failure: yaws: got 6.5, expected 0 ± 0.1 (off by 0.216815) at index 1",
        "check: exact",
        "check: heading",
        "check: waited",
        "check: not asked to stop",
        "check: within",
        "check: without limits",
        "report: from a thread",
    ];
    assert_eq!(ran.texts(), expected);
    assert_eq!(ran.result, json!({"outcome": "failed"}));
    assert!(ran.status.success());
    let messages = || ran.notifications.iter().filter(|(method, _)| method == "message");
    for (_, message) in messages() {
        let location = &message["location"];
        assert!(location["file"].as_str().unwrap().ends_with("every_macro.cpp"), "{message}");
        assert!(location["line"].as_u64().unwrap() > 10, "{message}");
    }
    let pose = messages().find(|(_, m)| m["text"].as_str().unwrap().starts_with("pose")).unwrap();
    let numbers = json!({
        "expected": [1.0, 2.0, 3.0], "got": [1.0, 2.0, 3.5], "tolerance": 0.1, "worst": 2,
    });
    assert_eq!(pose.1["comparison"], numbers);
}

/// The ways of `endings.cpp`: outcome, and the first problem.
#[test]
fn each_ending_has_its_problem_and_a_tear_down() {
    let library = build("sdk/cpp/tests/endings.cpp");
    let rows = [
        ("nothing", "passed", ""),
        ("standard", "error", "std::invalid_argument: joint 9"),
        ("odd", "error", "exception of type bench::Odd"),
        ("swallowed", "failed", "seen by the host"),
        ("setup-check", "failed", "the cable is in"),
        ("tolerance", "error", "the tolerance -1 is not a finite number from 0"),
        ("attach", "error", "there is no file `/nowhere/trace.csv` to attach"),
        ("until", "failed", "the motor to turn: not within 0.02 s (last value: 0)"),
        ("tear-down", "error", "exception of type double"),
    ];
    for (how, outcome, problem) in rows {
        let ran = run_test(&library, json!({"param": how}));
        assert_eq!(ran.result, json!({"outcome": outcome}), "{how}: {ran:?}");
        assert_eq!(ran.problem(), problem, "{how}");
        let texts = ran.texts();
        assert_eq!(texts.last().unwrap(), "report: destroyed", "{how}");
        let torn_down = texts.iter().any(|text| text == "report: torn down");
        assert_eq!(torn_down, how != "tear-down", "{how}");
        assert!(ran.status.success(), "{how}");
    }
    let ran = run_test(&library, json!({"param": "constructor"}));
    assert_eq!(ran.problem(), "std::runtime_error: no memory for a robot");
    assert_eq!(ran.result["outcome"], "error");
}

#[test]
fn a_stop_request_ends_a_sleep_and_a_loop_and_is_the_reason() {
    let library = build("sdk/cpp/tests/endings.cpp");
    for (how, sign) in [("sleep", "sleeping"), ("loop", "looping")] {
        let mut host = start_test(&library, json!({"param": how}));
        host.wait_for(sign);
        host.send(json!({"method": "interrupt", "params": {"reason": "the arm fell off"}}));
        let ran = host.finish();
        let expected = json!({"outcome": "interrupted", "reason": "the arm fell off"});
        assert_eq!(ran.result, expected);
        assert!(ran.texts().contains(&"report: torn down".to_owned()), "{ran:?}");
        assert!(!ran.texts().contains(&"report: never".to_owned()), "{ran:?}");
    }
}

#[test]
fn a_thread_of_a_fixture_reports_a_collapse() {
    let library = build("sdk/cpp/tests/fixture.cpp");
    let mut host = Host::start();
    let plugin = json!({"file": library, "name": "motor", "args": ["--hot"]});
    host.send(json!({"id": 1, "method": "set-up-fixture", "params": plugin}));
    let mut seen: Vec<Value> = vec![host.next().unwrap(), host.next().unwrap()];
    seen.sort_by_key(|message| message["id"].is_null());
    assert_eq!(seen[0]["result"]["outcome"], "passed");
    assert_eq!(seen[1]["method"], "collapsed");
    assert_eq!(seen[1]["params"]["reason"], "the motor is too hot");
    let checked = host.ask("check-fixture", json!({}));
    assert_eq!(checked, json!({"outcome": "failed", "reason": "check returned false"}));
    assert_eq!(host.ask("tear-down-fixture", json!({}))["outcome"], "passed");
    let again = host.ask("set-up-fixture", json!({"file": library, "name": "motor"}));
    assert_eq!(again["outcome"], "passed");
    assert_eq!(host.ask("check-fixture", json!({}))["outcome"], "passed");
}

#[test]
fn a_fixture_is_notified_of_each_test() {
    let library = build("sdk/cpp/tests/recorder.cpp");
    let mut host = Host::start();
    let ready = host.ask("set-up-fixture", json!({"file": library, "name": "recorder"}));
    let wanted = json!(["test-started", "test-finished"]);
    assert_eq!(ready, json!({"outcome": "passed", "subscriptions": wanted}));
    let test = json!({"id": 3, "name": "Move", "repetition": 2, "attempt": 1});
    let passed = json!({"outcome": "passed"});
    assert_eq!(host.ask("test-started", json!({"test": test})), passed);
    let keep = dir().join("kept-by-recorder");
    let ends = json!({"test": test, "verdict": "failed", "reason": "far", "attachments_dir": keep});
    host.send(json!({"id": 1, "method": "test-finished", "params": ends}));
    let said: Vec<Value> = (0..4).map(|_| host.next().unwrap()).collect();
    assert_eq!(said[0]["params"]["text"], "3 Move 2.1 failed: far");
    assert_eq!((&said[1]["method"], &said[2]["method"]), (&json!("measured"), &json!("attached")));
    assert_eq!(said[2]["params"]["path"], json!(keep.join("1-run.txt")));
    assert_eq!(said[3]["result"], passed);
    let refused = json!({"id": 3, "name": "refused", "repetition": 1, "attempt": 1});
    let reason = json!({"outcome": "failed", "reason": "testStarted returned false"});
    assert_eq!(host.ask("test-started", json!({"test": refused})), reason);
}

/// A plug-in of interface 1.0 has a shorter table: the host does not read beyond it.
#[test]
fn a_fixture_of_an_older_interface_gets_no_notifications() {
    let text = r#"
        #include <stddef.h>
        #include <stdlib.h>
        #include <rtf/plugin.h>
        static int here;
        static void *create(const rtf_host *host) { (void)host; return &here; }
        static int32_t never(void *self, const rtf_test *test)
        { (void)self; (void)test; abort(); }
        const rtf_plugin_table *rtf_plugin(void);
        const rtf_plugin_table *rtf_plugin(void)
        {
            static const rtf_plugin_table table = {
                .abi_major = 1, .abi_minor = 0,
                .size = offsetof(rtf_plugin_table, test_started),
                .kind = RTF_KIND_FIXTURE, .create = create,
                .test_started = never, .test_finished = never,
            };
            return &table;
        }
    "#;
    let library = build_text("older.c", text, &[]);
    let mut host = Host::start();
    let ready = host.ask("set-up-fixture", json!({"file": library, "name": "older"}));
    assert_eq!(ready, json!({"outcome": "passed"}));
    assert_eq!(host.ask("check-fixture", json!({}))["outcome"], "passed");
    assert_eq!(host.ask("tear-down-fixture", json!({}))["outcome"], "passed");
}

#[test]
fn the_host_ends_with_the_runner_while_a_plugin_is_loaded() {
    let library = build("sdk/cpp/tests/endings.cpp");
    let mut host = start_test(&library, json!({"param": "sleep"}));
    host.wait_for("sleeping");
    assert_eq!(host.abandon().code(), Some(1));
}

#[test]
fn texts_are_those_of_all_sdks() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../conformance/texts.json");
    let vectors: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let (mut args, mut expected) = (Vec::new(), Vec::new());
    for case in vectors["comparisons"].as_array().unwrap() {
        let tolerance = case["tolerance"].to_string();
        let kind = if case["angle"] == true { "angle" } else { "plain" };
        args.extend([kind.to_owned(), words(&case["got"]), words(&case["expected"]), tolerance]);
        expected.push(match case["problem"].as_str() {
            Some(problem) => format!("failure: x: {problem}"),
            None => "check: x".to_owned(),
        });
    }
    for case in vectors["numbers"].as_array().unwrap() {
        args.extend(["plain".to_owned(), words(&case[0]), "0.5".to_owned(), "0".to_owned()]);
        expected.push(format!("failure: x: got {}, expected 0.5 ± 0", case[1].as_str().unwrap()));
    }
    let ran = run_test(&build("sdk/cpp/tests/texts.cpp"), json!({"args": args}));
    let texts = ran.texts();
    assert_eq!(texts.len(), expected.len(), "{ran:?}");
    for (text, expected) in texts.iter().zip(&expected) {
        assert!(text.starts_with(expected.as_str()), "{text}, expected {expected}");
    }
}

/// A number of the vectors, or `[1,2]`.
fn words(value: &Value) -> String {
    value.to_string().replace('"', "")
}

#[test]
fn a_crash_is_a_signal_and_loses_no_message() {
    let library = build("conformance/scenarios/crash/plugin.cpp");
    let ran = run_test(&library, json!({}));
    assert_eq!(ran.texts(), ["report: before the crash"]);
    assert_eq!(ran.result, Value::Null);
    assert_eq!(ran.status.signal(), Some(SIGSEGV));
}

#[test]
fn plain_c_plugins_run_too() {
    let library = build("sdk/c/examples/counter.c");
    let ran = run_test(&library, json!({"args": ["500"]}));
    assert_eq!(ran.texts(), ["check: counted to the goal"]);
    assert_eq!(ran.result, json!({"outcome": "passed"}));
    let ran = run_test(&library, json!({"args": ["5000"]}));
    assert_eq!(ran.result, json!({"outcome": "failed"}));
    let ran = run_test(&library, json!({"args": ["-1"]}));
    assert_eq!(ran.result, json!({"outcome": "error", "reason": "setup returned false"}));
}

#[test]
fn static_objects_are_destroyed_and_children_do_not_have_the_channel() {
    let text = r#"
        #include <cstdlib>
        #include <rtf/TestCase.hpp>
        static struct Last { ~Last() { _Exit(std::getenv("RTF_CHANNEL") ? 3 : 4); } } last;
        class Plain : public rtf::TestCase
        {
            void run() override {
                RTF_CHECK(std::system("ls -l /proc/self/fd | grep -q socket") != 0, "no socket");
                RTF_CHECK(std::system("test -z \"$RTF_CHANNEL\"") == 0, "no variable");
            }
        };
        RTF_PLUGIN(Plain);
    "#;
    let ran = run_test(&build_text("ends.cpp", text, &[]), json!({}));
    assert_eq!(ran.result, json!({"outcome": "passed"}), "{ran:?}");
    assert_eq!(ran.status.code(), Some(4));
}

#[test]
fn a_fixture_cannot_be_run_as_a_test() {
    let library = build("sdk/cpp/tests/fixture.cpp");
    let ran = run_test(&library, json!({}));
    let reason = format!("`{}` is a fixture, not a test", display(&library));
    assert_eq!(ran.result, json!({"outcome": "error"}));
    assert_eq!(ran.problem(), reason);
}

#[test]
fn check_tells_what_is_wrong_with_a_file() {
    let good = build("sdk/cpp/tests/fixture.cpp");
    let test = build("sdk/c/examples/counter.c");
    let table = "#include <rtf/plugin.h>\n\
        const rtf_plugin_table *rtf_plugin(void) {\n\
            static const rtf_plugin_table t = { .abi_major = MAJOR, .size = SIZE, .kind = 1 };\n\
            return &t;\n}\n";
    let bad = |name: &str, text: &str, options: &[&str]| build_text(name, text, options);
    let rows = [
        (bad("empty.c", "int nothing;", &[]), "exports no `rtf_plugin`"),
        (
            bad(
                "undefined.c",
                "void gone(void); void use(void) { gone(); } /* longer than the head of an ELF file is */",
                &[],
            ),
            "cannot be loaded: undefined symbol: gone",
        ),
        (
            bad("version.c", table, &["-DMAJOR=2", "-DSIZE=sizeof(t)"]),
            "was built for version 2 of the plug-in interface, this host has version 1",
        ),
        (bad("size.c", table, &["-DMAJOR=1", "-DSIZE=16"]), "its table has 16 bytes instead of"),
        (bad("create.c", table, &["-DMAJOR=1", "-DSIZE=sizeof(t)"]), "no `create` function"),
        (
            bad("old.c", "void robottestingframework_dll_factory(void) {}", &[]),
            "was built for robot-testing-framework 2: build it again",
        ),
        (driver::dir().join("undefined.c"), "cannot be loaded: invalid ELF header"),
        (driver::dir().join("nowhere.so"), "No such file or directory"),
    ];
    let mut files = vec![good.as_path(), test.as_path()];
    files.extend(rows.iter().map(|(file, _)| file.as_path()));
    let found = check(&files);
    assert_eq!(found[0], json!({"file": good, "ok": true, "kinds": ["fixture"]}));
    assert_eq!(found[1], json!({"file": test, "ok": true, "kinds": ["test"]}));
    assert_eq!(found.len(), files.len());
    for ((file, words), found) in rows.iter().zip(&found[2..]) {
        assert_eq!((&found["file"], &found["ok"]), (&json!(file), &json!(false)));
        assert!(found["message"].as_str().unwrap().contains(words), "{found}");
    }
}

#[test]
fn what_a_plugin_prints_while_it_is_loaded_does_not_mix_with_the_check() {
    let text = "#include <cstdio>\n#include <rtf/TestCase.hpp>\n\
        static int loud = std::puts(\"{}\") + std::fflush(stdout);\n\
        class Loud : public rtf::TestCase { void run() override { static_cast<void>(loud); } };\n\
        RTF_PLUGIN(Loud);\n";
    let loud = build_text("loud.cpp", text, &[]);
    assert_eq!(check(&[&loud]), [json!({"file": loud, "ok": true, "kinds": ["test"]})]);
}

#[test]
fn the_c_header_is_also_cpp11_and_every_header_stands_alone() {
    let header = "#include <rtf/plugin.h>\n#include <rtf/plugin.h>\n";
    build_text("header_c99.c", &format!("{header}int used;\n"), &[]);
    build_text("header_cpp11.cpp", header, &["-std=c++11"]);
    let mut count = 0;
    for part in ["rtf", "rtf/internal"] {
        let dir = driver::root().join("sdk/cpp/include").join(part);
        for entry in std::fs::read_dir(dir).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            // CppUnit may be missing; tests/frameworks/cppunit compiles these.
            let needs_cppunit = ["cppunit.hpp", "CppUnitReporter.hpp"].contains(&name.as_str());
            if name.ends_with(".hpp") && !needs_cppunit {
                let text = format!("#include <{part}/{name}>\n");
                build_text(&format!("header_{name}.cpp"), &text, &["-fsyntax-only"]);
                count += 1;
            }
        }
    }
    assert!(count > 10, "{count} headers");
}

#[test]
fn the_header_for_programs_can_be_included_in_a_plug_in() {
    let text = r#"
        #include <rtf/session.hpp>
        #include <rtf/rtf.hpp>

        class Both : public rtf::TestCase
        {
            void run() override
            {
                RTF_CHECK(measure("of the plug-in", 1, "s", 0.0, 2.0), "a member");
                RTF_CHECK(rtf::measure("of no program", 1, "s", 0, 2), "a function");
                RTF_REPORT("a text");
            }
        };
        RTF_PLUGIN(Both);
    "#;
    let ran = run_test(&build_text("both_headers.cpp", text, &[]), json!({}));
    assert_eq!(ran.texts(), ["check: a member", "check: a function", "report: a text"]);
}
