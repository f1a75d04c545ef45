//! Cases, skips and parameters of real plug-ins in the native host.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first surprise")]
#![expect(unsafe_code, reason = "a descriptor is handed over between fork and exec")]

#[expect(dead_code, reason = "shared with the tests of other plug-ins")]
mod driver;

use driver::{Ran, build_text, run_test, start_test};
use serde_json::{Value, json};

/// Runs the body of `run` of a C++ test.
fn run_body(name: &str, body: &str, params: Value) -> Ran {
    let text = format!(
        "#include <stdexcept>\n#include <thread>\n#include <rtf/TestCase.hpp>\n\
         class T : public rtf::TestCase {{ void run() override {{\n{body}\n}} }};\nRTF_PLUGIN(T);\n"
    );
    run_test(&build_text(name, &text, &[]), params)
}

/// The parameters of all notifications of a kind.
fn all<'a>(ran: &'a Ran, method: &str) -> Vec<&'a Value> {
    let of_kind = ran.notifications.iter().filter(|(name, _)| name == method);
    of_kind.map(|(_, params)| params).collect()
}

fn started(ran: &Ran) -> Vec<&str> {
    all(ran, "case-started").iter().map(|start| start["name"].as_str().unwrap()).collect()
}

#[test]
fn a_case_has_parameters_of_all_types_and_a_location() {
    let body = r#"
        const std::string side = "left";
        RTF_CASE("pose " + side, {{"joint", 3}, {"speed", 0.5}, {"dry", true}, {"side", side}})
        {
            report("moving");
        };
        RTF_CASE("other") { return; };
    "#;
    let ran = run_body("parameters.cpp", body, json!({}));
    let started = all(&ran, "case-started");
    let parameters = json!([
        {"name": "joint", "value": "3"}, {"name": "speed", "value": "0.5"},
        {"name": "dry", "value": "true"}, {"name": "side", "value": "left"},
    ]);
    assert_eq!(started[0]["parameters"], parameters);
    assert_eq!((&started[0]["name"], &started[0]["case"]), (&json!("pose left"), &json!(1)));
    assert_eq!(started[0]["location"]["line"], 7);
    assert!(started[0]["location"]["file"].as_str().unwrap().ends_with("parameters.cpp"));
    assert_eq!((&started[1]["name"], &started[1]["parameters"]), (&json!("other"), &Value::Null));
    assert_eq!(all(&ran, "message")[0]["case"], 1);
    assert_eq!(ran.result, json!({"outcome": "passed"}));
}

#[test]
fn assertions_exceptions_and_skips_end_a_case_on_any_thread() {
    let body = r#"
        std::thread([this] {
            RTF_CASE("assertion") { RTF_REQUIRE(false, "it moves"); report("never"); };
            RTF_CASE("exception") { throw std::out_of_range("joint 9"); };
            RTF_CASE("foreign") { throw 42; };
            RTF_CASE("skip") { skip("not mounted"); };
        }).join();
        report("after");
    "#;
    let ran = run_body("ends-in-thread.cpp", body, json!({}));
    let expected = [
        "failure: it moves",
        "error: std::out_of_range: joint 9",
        "error: exception of type int",
        "report: after",
    ];
    assert_eq!(ran.texts(), expected);
    let ends = all(&ran, "case-finished");
    assert_eq!(ends[3], &json!({"case": 4, "outcome": "skipped", "reason": "not mounted"}));
    assert_eq!(ran.result, json!({"outcome": "failed"}));
}

#[test]
fn a_critical_assertion_ends_its_cases_and_the_test() {
    let body = r#"
        RTF_CASE("arm")
        {
            RTF_CASE("dangerous") { RTF_REQUIRE_CRITICAL(false, "the arm is free"); };
            report("never");
        };
        report("never");
    "#;
    let ran = run_body("critical-case.cpp", body, json!({}));
    assert_eq!(ran.texts(), ["failure: the arm is free"]);
    let ends = [&json!({"case": 2}), &json!({"case": 1})];
    assert_eq!(all(&ran, "case-finished"), ends);
}

#[test]
fn a_stop_request_leaves_cases_open_and_starts_no_other() {
    let text = r#"
        #include <rtf/TestCase.hpp>
        class T : public rtf::TestCase
        {
            void run() override
            {
                RTF_CASE("loop")
                {
                    report("looping");
                    while (!interrupted()) {
                    }
                };
                RTF_CASE("next") { report("never"); };
            }
        };
        RTF_PLUGIN(T);
    "#;
    let mut host = start_test(&build_text("stopped-case.cpp", text, &[]), json!({}));
    host.wait_for("looping");
    host.send(json!({"method": "interrupt", "params": {"reason": "Ctrl-C"}}));
    let ran = host.finish();
    assert!(all(&ran, "case-started").is_empty() && all(&ran, "case-finished").is_empty());
    assert!(ran.texts().is_empty(), "{ran:?}");
    assert_eq!(ran.result, json!({"outcome": "interrupted", "reason": "Ctrl-C"}));
}

#[test]
fn only_selected_cases_run() {
    let body = r#"
        plan_cases({"arm", "hand"});
        RTF_CASE("arm") { RTF_CASE("moves") {}; RTF_CASE("stops") {}; };
        RTF_CASE("hand") { report("never"); };
    "#;
    let ran = run_body("selected.cpp", body, json!({"cases": [{"equals": "arm/moves"}]}));
    assert_eq!(started(&ran), ["arm", "moves"]);
    assert_eq!(all(&ran, "cases-planned"), [&json!({"names": ["arm"]})]);
    assert!(ran.texts().is_empty());
}

#[test]
fn a_test_reads_its_values_of_a_matrix() {
    let body = r#"
        report(parameter("joint") + " " + parameters().at("side"));
        RTF_CASE("unknown") { parameter("speed"); };
    "#;
    let matrix = json!([{"name": "joint", "value": "3"}, {"name": "side", "value": "left"}]);
    let ran = run_body("matrix.cpp", body, json!({"parameters": matrix}));
    let error = "error: there is no parameter \"speed\"; this test has joint, side";
    assert_eq!(ran.texts(), ["report: 3 left", error]);
    let ran = run_body("no-matrix.cpp", r#"parameter("speed");"#, json!({}));
    let error = "error: there is no parameter \"speed\"; this test has none";
    assert_eq!(ran.texts(), [error]);
}

/// The plug-in sees its host's table as one of version 1.2 would be.
#[test]
fn a_host_without_cases_is_an_error_with_its_version() {
    for (name, call) in [
        ("old-case.cpp", r#"RTF_CASE("a") { report("never"); };"#),
        ("old-skip.cpp", r#"RTF_SKIP("no camera");"#),
        ("old-plan.cpp", r#"plan_cases({"a"});"#),
        ("old-parameter.cpp", r#"parameter("a");"#),
    ] {
        let body = format!(
            "static rtf_host old = rtf::internal::host();\n\
             old.abi_minor = 2;\n\
             old.size = offsetof(rtf_host, case_begin);\n\
             rtf::internal::current_host = &old;\n{call}"
        );
        let ran = run_body(name, &body, json!({}));
        let error = "error: this rtf is too old for cases: its plug-in interface is 1.2";
        assert_eq!(ran.texts(), [error], "{name}");
        assert_eq!(ran.result, json!({"outcome": "error"}), "{name}");
    }
}

#[test]
fn plain_c_has_cases_too() {
    let text = r#"
        #include <stddef.h>
        #include <rtf/plugin.h>
        static const rtf_host *host;
        static int here;
        static void *create(const rtf_host *own) { host = own; return &here; }
        static int32_t run(void *self)
        {
            rtf_parameter joint = {rtf_string("joint"), rtf_string("3")};
            rtf_case pose = {sizeof pose, rtf_string("pose"), &joint, 1, __FILE__, __LINE__};
            (void)self;
            if (host->case_begin(host->context, &pose)) {
                host->skip(host->context, rtf_string("no arm"));
                host->case_end(host->context, RTF_STOPPED);
            }
            host->skip(host->context, rtf_string("no robot"));
            return RTF_STOPPED;
        }
        const rtf_plugin_table *rtf_plugin(void);
        const rtf_plugin_table *rtf_plugin(void)
        {
            static const rtf_plugin_table table = {
                .abi_major = RTF_ABI_MAJOR, .abi_minor = RTF_ABI_MINOR, .size = sizeof table,
                .kind = RTF_KIND_TEST, .create = create, .run = run,
            };
            return &table;
        }
    "#;
    let ran = run_test(&build_text("cases-in-c.c", text, &[]), json!({}));
    let expected = json!({"case": 1, "outcome": "skipped", "reason": "no arm"});
    assert_eq!(all(&ran, "case-finished"), [&expected]);
    assert_eq!(ran.result, json!({"outcome": "skipped", "reason": "no robot"}));
}
