//! C++ plug-ins for robot-testing-framework 1.x and 2.x in the native host:
//! sources that projects have, in forms that only their headers allow.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first surprise")]
#![expect(unsafe_code, reason = "a descriptor is handed over between fork and exec")]

#[expect(dead_code, reason = "shared with the tests of other plug-ins")]
mod driver;

use std::path::PathBuf;

use driver::{Host, build_text, dir, root, run_test};
use serde_json::{Value, json};

/// A plug-in for generation 1, which needs only the include path of 1.x.
fn build_first_generation(name: &str, text: &str) -> PathBuf {
    let include = format!("-I{}/sdk/cpp/include/rtf1", root().display());
    build_text(name, text, &[&include])
}

/// Sends a request; what the host says until it answers, then the answer.
fn request(host: &mut Host, method: &str, params: Value) -> (Vec<String>, Value) {
    host.send(json!({"id": 1, "method": method, "params": params}));
    let mut said = Vec::new();
    loop {
        let message = host.next().expect("the host has ended");
        if message["id"] == 1 {
            return (said, message["result"].clone());
        }
        said.push(text_of(&message));
    }
}

/// A notification: its method, and the text in it.
fn text_of(message: &Value) -> String {
    let params = &message["params"];
    let text = params["text"].as_str().or(params["reason"].as_str());
    format!("{}: {}", message["method"].as_str().unwrap(), text.unwrap_or_default())
}

#[test]
fn a_fixture_reports_to_the_suite_that_its_dispatcher_is() {
    let library = build_text(
        "SuiteRig.cpp",
        r#"
        #include <robottestingframework/Asserter.h>
        #include <robottestingframework/FixtureManager.h>
        #include <robottestingframework/TestAssert.h>
        #include <robottestingframework/dll/Plugin.h>

        using namespace robottestingframework;

        class SuiteRig : public FixtureManager
        {
        public:
            bool setup(int, char **) override
            {
                ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(suite() != nullptr, "no suite");
                report("standing by");
                return suite()->getName() == "rig" && suite()->size() == 0;
            }

            void tearDown() override
            {
                report("parked");
                suite()->getResult()->addError(suite(), "the brake is worn");
            }

            ~SuiteRig() override { report("gone"); }

        private:
            TestSuite *suite() { return dynamic_cast<TestSuite *>(getDispatcher()); }
            void report(const char *text)
            {
                Asserter::report(TestMessage(text, __FILE__, __LINE__), suite());
            }
        };

        ROBOTTESTINGFRAMEWORK_PREPARE_FIXTURE_PLUGIN(SuiteRig)
        "#,
        &[],
    );
    let mut host = Host::start();
    let plugin = json!({"file": library, "name": "rig"});
    let (said, set_up) = request(&mut host, "set-up-fixture", plugin);
    assert_eq!(set_up["outcome"], "passed", "{set_up}");
    assert_eq!(said, ["message: standing by"]);
    let (said, torn_down) = request(&mut host, "tear-down-fixture", json!({}));
    assert_eq!(said[..2], ["message: parked", "message: the brake is worn"]);
    assert_eq!(torn_down["outcome"], "error");
    let again = json!({"file": library, "name": "rig"});
    assert_eq!(host.ask("set-up-fixture", again)["outcome"], "passed");
}

#[test]
fn a_problem_that_a_fixture_has_between_its_steps_is_a_collapse() {
    let library = build_text(
        "ThreadedRig.cpp",
        r#"
        #include <robottestingframework/TestAssert.h>
        #include <robottestingframework/dll/Plugin.h>

        #include <chrono>
        #include <fstream>
        #include <string>
        #include <thread>

        using namespace robottestingframework;

        class ThreadedRig : public FixtureManager
        {
        public:
            bool setup(int, char **argv) override
            {
                sign = argv[0];
                watchdog = std::thread([this] { watch(); });
                return true;
            }

            void tearDown() override { watchdog.join(); }

        private:
            void watch()
            {
                while (!std::ifstream(sign)) {
                    std::this_thread::sleep_for(std::chrono::milliseconds(2));
                }
                auto *const suite = dynamic_cast<TestSuite *>(getDispatcher());
                suite->getResult()->addFailure(suite, "the arm sags");
                suite->interrupt();
            }

            std::string sign;
            std::thread watchdog;
        };

        ROBOTTESTINGFRAMEWORK_PREPARE_FIXTURE_PLUGIN(ThreadedRig)
        "#,
        &[],
    );
    let sign = dir().join("ThreadedRig.sign");
    let _ = std::fs::remove_file(&sign);
    let mut host = Host::start();
    let plugin = json!({"file": library, "name": "rig", "args": [sign]});
    let (said, set_up) = request(&mut host, "set-up-fixture", plugin);
    assert_eq!((said, &set_up["outcome"]), (vec![], &json!("passed")));
    std::fs::write(&sign, "").unwrap();
    let told: Vec<Value> = (0..3).map(|_| host.next().expect("nothing came")).collect();
    let texts = told.iter().map(text_of);
    let expected = [
        "message: the arm sags",
        "collapsed: the arm sags",
        "collapsed: the fixture interrupted the suite",
    ];
    assert_eq!(texts.collect::<Vec<_>>(), expected);
    let (_, torn_down) = request(&mut host, "tear-down-fixture", json!({}));
    assert_eq!(torn_down["outcome"], "passed");
}

#[test]
fn a_test_of_generation_1_needs_one_header_and_may_be_prepared_before_its_class() {
    let library = build_first_generation(
        "GripperTest.cpp",
        r#"
        #include <TestCase.h>

        PREPARE_PLUGIN(GripperTest)

        namespace middleware {
        class Network
        {
        public:
            Network() : up(true) {}
            virtual ~Network() {}
            virtual bool setup() { return up; }
            virtual void run() {}
            virtual void interrupt() {}
            virtual bool check() { return up; }

        private:
            bool up;
        };
        } // namespace middleware

        class GripperTest : public RTF::TestCase, middleware::Network
        {
        public:
            virtual bool setup(int argc, char **argv)
            {
                RTF_TEST_REPORT(argv[0]);
                RTF_ASSERT_ERROR_IF(argc == 2, "tell the parameter");
                return Network::setup();
            }
            virtual void run()
            {
                Network::run();
                RTF_TEST_CHECK(getName() == "arm test", "it has the plug-in's name");
                RTF_TEST_FAIL_IF(getParam() == "--well", "the gripper is open");
            }
            virtual void tearDown() { RTF_TEST_REPORT("torn down"); }
        };
        "#,
    );
    let ran = run_test(&library, json!({"param": "--well", "args": ["--well"]}));
    // A check that holds was a report.
    let expected = ["report: arm test", "check: it has the plug-in's name", "report: torn down"];
    assert_eq!(ran.texts(), expected);
    assert_eq!(ran.result["outcome"], "passed", "{ran:?}");
    let ran = run_test(&library, json!({"param": "--ill", "args": ["--ill"]}));
    assert_eq!(ran.problem(), "the gripper is open");
}

#[test]
fn a_fixture_of_generation_1_may_be_a_middleware_manager_in_private() {
    let library = build_first_generation(
        "PrivateRig.cpp",
        r#"
        #include <FixtureManager.h>

        #include <string>

        PREPARE_FIXTURE_PLUGIN(PrivateRig)

        namespace middleware {
        class Manager
        {
        public:
            bool run(const std::string &module)
            {
                onExecutableDied(module);
                return true;
            }
            bool setup() { return false; }
            bool check() { return false; }

        protected:
            virtual ~Manager() {}
            virtual void onExecutableDied(const std::string &module) = 0;
        };
        } // namespace middleware

        class PrivateRig : middleware::Manager, public RTF::FixtureManager
        {
        public:
            virtual bool setup(int, char **argv)
            {
                RTF::Asserter::report("standing by",
                                      dynamic_cast<RTF::TestSuite *>(getDispatcher()));
                RTF_ASSERT_ERROR_IF(argv != 0, "no arguments");
                return run(argv[0]);
            }
            virtual bool check() { return true; }
            virtual void tearDown() {}

        private:
            virtual void onExecutableDied(const std::string &module)
            {
                getDispatcher()->fixtureCollapsed(module + " died");
            }
        };
        "#,
    );
    let mut host = Host::start();
    let plugin = json!({"file": library, "name": "rig", "args": ["simulator"]});
    let (said, set_up) = request(&mut host, "set-up-fixture", plugin);
    assert_eq!(said, ["message: standing by", "collapsed: simulator died"], "{set_up}");
    assert_eq!(set_up["outcome"], "passed");
    let (_, torn_down) = request(&mut host, "tear-down-fixture", json!({}));
    assert_eq!(torn_down["outcome"], "passed");
}

#[test]
fn what_is_prepared_behind_its_class_may_live_in_a_namespace() {
    let library = build_first_generation(
        "NamedTest.cpp",
        r#"
        #include <TestCase.h>

        namespace lab {
        struct NamedTest : public RTF::TestCase
        {
            NamedTest() : TestCase("own name") {}
            virtual void run() { RTF_TEST_REPORT(getName()); }
        };
        } // namespace lab

        using namespace lab;
        PREPARE_PLUGIN(NamedTest);
        "#,
    );
    let ran = run_test(&library, json!({}));
    assert_eq!(ran.texts(), ["report: test name: own name", "report: own name"]);
    for derived in ["own name", "own name#2", "own name[joint=1]"] {
        let ran = run_test(&library, json!({"name": derived}));
        assert_eq!(ran.texts(), ["report: own name"], "{derived}");
    }
    assert_eq!(ran.result["outcome"], "passed");
}
