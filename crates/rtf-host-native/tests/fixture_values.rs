//! Values of fixtures, provided and read by real plug-ins in the native host.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first surprise")]
#![expect(unsafe_code, reason = "a descriptor is handed over between fork and exec")]

#[expect(dead_code, reason = "shared with the tests of other plug-ins")]
mod driver;

use driver::{Host, Ran, build_text, run_test};
use serde_json::{Value, json};

/// Sets up a C++ fixture whose `setup` has this body, then ends its host.
fn set_up(name: &str, body: &str, mut params: Value) -> (Value, Vec<(String, Value)>) {
    let text = format!(
        "#include <clocale>\n#include <limits>\n#include <sys/wait.h>\n#include <unistd.h>\n\
         #include <rtf/FixtureManager.hpp>\n\
         class F : public rtf::FixtureManager {{ bool setup(int, char **) override {{\n{body}\n\
         return true; }} }};\nRTF_PLUGIN(F);\n"
    );
    params["file"] = json!(build_text(name, &text, &[]));
    params["name"] = json!("simulator");
    let mut host = Host::start();
    host.send(json!({"id": 1, "method": "set-up-fixture", "params": params}));
    let mut notifications = Vec::new();
    let result = loop {
        let mut message = host.next().unwrap();
        if message["id"] == 1 {
            break message["result"].take();
        }
        let method = message["method"].as_str().unwrap().to_owned();
        notifications.push((method, message["params"].take()));
    };
    host.ask("tear-down-fixture", json!({}));
    host.abandon();
    (result, notifications)
}

fn provided(name: &str, value: &Value) -> (String, Value) {
    ("provided".to_owned(), json!({"name": name, "value": value}))
}

fn error(text: &str) -> (String, Value) {
    ("message".to_owned(), json!({"kind": "error", "text": text}))
}

fn values() -> Value {
    json!({"fixture_values": [
        {"name": "simulator.port", "value": 40123},
        {"name": "simulator.model", "value": "two\nlines \"quoted\""},
        {"name": "simulator.ready", "value": true},
        {"name": "simulator.limits", "value": [-1.5, 1.5]},
    ]})
}

#[test]
fn a_fixture_provides_values_of_all_types() {
    let body = r#"
        const std::string model = "arm";
        provide("port", 40123);
        provide("mask", std::numeric_limits<unsigned long long>::max());
        provide("model", model);
        provide("view", std::string_view("7"));
        provide("literal", "7");
        provide("rate", 0.1);
        provide("gain", 40.0);
        provide("single", 0.5f);
        provide("small", 1e-300);
        provide("ready", false);
        provide("limits", rtf::Json{"[-1.5, 1.5]"});
        provide("nothing", rtf::Json{"null"});
    "#;
    let (result, notifications) = set_up("provides.cpp", body, json!({}));
    let expected = [
        provided("port", &json!(40123)),
        provided("mask", &json!(u64::MAX)),
        provided("model", &json!("arm")),
        provided("view", &json!("7")),
        provided("literal", &json!("7")),
        provided("rate", &json!(0.1)),
        provided("gain", &json!(40.0)),
        provided("single", &json!(0.5)),
        provided("small", &json!(1e-300)),
        provided("ready", &json!(false)),
        provided("limits", &json!([-1.5, 1.5])),
        provided("nothing", &Value::Null),
    ];
    assert_eq!(notifications, expected);
    assert_eq!(result, json!({"outcome": "passed"}));
}

#[test]
fn a_value_that_json_does_not_have_is_an_error() {
    let body = r#"provide("limits", rtf::Json{"[1, 2"}); provide("empty", rtf::Json{});"#;
    let (result, notifications) = set_up("no-json.cpp", body, json!({}));
    let expected = [
        "the value of `limits` is not JSON: EOF while parsing a list at line 1 column 5",
        "the value of `empty` is not JSON: EOF while parsing a value at line 1 column 0",
    ];
    assert_eq!(notifications, expected.map(error));
    assert_eq!(result, json!({"outcome": "error"}));
    let body = r#"provide("gain", std::numeric_limits<double>::quiet_NaN()); report("never");"#;
    let (result, notifications) = set_up("no-number.cpp", body, json!({}));
    let [(_, message)] = &notifications[..] else { panic!("{notifications:?}") };
    assert_eq!(message["text"], "the value of `gain` is not a finite number");
    assert_eq!(message["location"]["line"], 7);
    assert_eq!(result, json!({"outcome": "error"}));
}

#[test]
fn a_forked_child_provides_nothing() {
    let body = r#"
        const pid_t child = fork();
        if (child == 0) {
            provide("port", 1);
            report("in the child");
            _exit(0);
        }
        waitpid(child, nullptr, 0);
        provide("port", 2);
    "#;
    let (_, notifications) = set_up("forks.cpp", body, json!({}));
    let report = json!({"kind": "report", "text": "in the child"});
    assert_eq!(notifications[0].1["text"], report["text"]);
    assert_eq!(notifications[1..], [provided("port", &json!(2))]);
}

#[test]
fn a_plugin_reads_values_as_texts() {
    let read = r#"
        report(fixtureValue("simulator.port") + "," + fixtureValue("simulator.model") + "," +
               fixtureValue("simulator.ready") + "," + fixtureValue("simulator.limits"));
        fixtureValue("simulator.speed");
        report("never");
    "#;
    let known = "simulator.port, simulator.model, simulator.ready, simulator.limits";
    let unknown = format!("there is no fixture value \"simulator.speed\"; there are {known}");
    let texts = ["40123,two\nlines \"quoted\",true,[-1.5,1.5]", &unknown];
    let ran = run_body("reads.cpp", read, values());
    assert_eq!(ran.texts(), [format!("report: {}", texts[0]), format!("error: {unknown}")]);
    assert_eq!(ran.result, json!({"outcome": "error"}));
    let (result, notifications) = set_up("depends.cpp", read, values());
    let found: Vec<&Value> = notifications.iter().map(|(_, message)| &message["text"]).collect();
    assert_eq!(found, texts);
    assert_eq!(result, json!({"outcome": "error"}));
    let ran = run_body("no-values.cpp", r#"fixtureValue("simulator.port");"#, json!({}));
    let error = "error: there is no fixture value \"simulator.port\"; there are none";
    assert_eq!(ran.texts(), [error]);
}

/// Runs the body of `run` of a C++ test.
fn run_body(name: &str, body: &str, params: Value) -> Ran {
    let text = format!(
        "#include <rtf/TestCase.hpp>\nclass T : public rtf::TestCase {{ void run() override {{\n\
         {body}\n}} }};\nRTF_PLUGIN(T);\n"
    );
    run_test(&build_text(name, &text, &[]), params)
}

/// The plug-in sees its host's table as one with cases, but without values, would be.
#[test]
fn a_host_without_values_is_an_error_with_its_version() {
    let old = r"
        static rtf_host old = rtf::internal::host();
        old.abi_minor = 2;
        old.size = offsetof(rtf_host, provide);
        rtf::internal::current_host = &old;
    ";
    let text = "this rtf is too old for values of fixtures: its plug-in interface is 1.2";
    let ran = run_body("old-value.cpp", &format!("{old}fixtureValue(\"a.b\");"), json!({}));
    assert_eq!(ran.texts(), [format!("error: {text}")]);
    let body = format!("{old}provide(\"port\", 1);");
    let (_, notifications) = set_up("old-provide.cpp", &body, json!({}));
    let [(_, message)] = &notifications[..] else { panic!("{notifications:?}") };
    assert_eq!(message["text"], text);
}

#[test]
fn plain_c_provides_and_reads_values_too() {
    let text = r#"
        #include <stddef.h>
        #include <rtf/plugin.h>
        static const rtf_host *host;
        static int here;
        static void *create(const rtf_host *own) { host = own; return &here; }
        static int32_t setup(void *self, int argc, char **argv)
        {
            size_t count = 0;
            const rtf_parameter *values = host->fixture_values(host->context, &count);
            size_t index;
            (void)self, (void)argc, (void)argv;
            host->provide(host->context, rtf_string("port"), RTF_VALUE_JSON, rtf_string("40123"));
            host->provide(host->context, rtf_string("gain"), 7, rtf_string("1"));
            for (index = 0; index < count; ++index) {
                host->provide(host->context, values[index].name, RTF_VALUE_TEXT,
                              values[index].value);
            }
            return RTF_DONE;
        }
        const rtf_plugin_table *rtf_plugin(void);
        const rtf_plugin_table *rtf_plugin(void)
        {
            static const rtf_plugin_table table = {
                .abi_major = RTF_ABI_MAJOR, .abi_minor = RTF_ABI_MINOR, .size = sizeof table,
                .kind = RTF_KIND_FIXTURE, .create = create, .setup = setup,
            };
            return &table;
        }
    "#;
    let file = build_text("values-in-c.c", text, &[]);
    let mut params = values();
    params["file"] = json!(file);
    params["name"] = json!("driver");
    let mut host = Host::start();
    host.send(json!({"id": 1, "method": "set-up-fixture", "params": params}));
    let texts = ["40123", "two\nlines \"quoted\"", "true", "[-1.5,1.5]"];
    let names = ["port", "model", "ready", "limits"].map(|name| format!("simulator.{name}"));
    let mut expected =
        vec![provided("port", &json!(40123)), error("the value of `gain` has the unknown kind 7")];
    expected.extend(names.iter().zip(texts).map(|(name, text)| provided(name, &json!(text))));
    for (method, params) in expected {
        let message = host.next().unwrap();
        assert_eq!((message["method"].as_str().unwrap(), &message["params"]), (&*method, &params));
    }
    assert_eq!(host.next().unwrap()["result"], json!({"outcome": "error"}));
    host.abandon();
}
