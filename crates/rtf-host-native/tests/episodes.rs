//! Episode tests in C++ and C, in the native host.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first surprise")]
#![expect(unsafe_code, reason = "a descriptor is handed over between fork and exec")]

#[expect(dead_code, reason = "shared with the tests of other plug-ins")]
mod driver;

use driver::{Host, Ran, build_text, run_test, start_test};
use serde_json::{Value, json};

/// Builds a C++ test from the members of its class.
fn build(name: &str, members: &str) -> std::path::PathBuf {
    let text = format!(
        "#include <cstdlib>\n#include <stdexcept>\n#include <thread>\n#include <sys/wait.h>\n\
         #include <unistd.h>\n#include <rtf/EpisodeTest.hpp>\n\
         using namespace std::chrono_literals;\n\
         class T : public rtf::EpisodeTest {{\n{members}\n}};\nRTF_PLUGIN(T)\n"
    );
    build_text(name, &text, &[])
}

/// Starts a test with slots, and returns when its `run` has begun.
fn start(library: &std::path::Path, settings: Value) -> Host {
    let mut host = start_test(library, json!({"episodes": settings}));
    while host.next().unwrap()["params"]["phase"] != "run" {}
    host
}

fn episodes(ids: &[u64]) -> Value {
    let parameters = json!({"payload": "1.2", "side": "left"});
    let episodes: Vec<Value> = ids
        .iter()
        .map(|id| json!({"id": id, "seed": id + 100, "parameters": parameters}))
        .collect();
    json!({"method": "episodes", "params": {"episodes": episodes}})
}

/// Runs a test with these episodes to its end.
fn run(library: &std::path::Path, settings: Value, ids: &[u64]) -> Ran {
    let mut host = start(library, settings);
    host.send_all(&[episodes(ids), json!({"method": "end-of-episodes", "params": {}})]);
    host.finish()
}

/// The parameters of all notifications of a kind.
fn all<'a>(ran: &'a Ran, method: &str) -> Vec<&'a Value> {
    let of_kind = ran.notifications.iter().filter(|(name, _)| name == method);
    of_kind.map(|(_, params)| params).collect()
}

/// The ends of all episodes: case, outcome and reason.
fn ends(ran: &Ran) -> Vec<String> {
    let end = |end: &&Value| {
        let text = |name: &str| end[name].as_str().unwrap_or_default().to_owned();
        format!("{} {} {}", end["case"], text("outcome"), text("reason")).trim_end().to_owned()
    };
    all(ran, "case-finished").iter().map(end).collect()
}

#[test]
fn one_episode_after_the_other_is_judged_by_its_checks() {
    let members = r#"
        void episode(rtf::Episode &own) override
        {
            switch (own.id()) {
            case 1:
                RTF_CHECK(own.seed() == 101 && own.parameter("payload") == "1.2", "its values");
                measure("distance", 0.02, "m");
                return;
            case 2: RTF_REQUIRE(false, "it moves"); return;
            case 3: throw std::out_of_range("joint 9");
            case 4: throw 42;
            case 5: skip("no gripper");
            case 6: RTF_CASE("grasp") { RTF_FAIL("slipped"); }; return;
            case 7: own.finish(false, "dropped"); report("after the episode"); return;
            case 8: own.finish(true); throw std::runtime_error("after the episode");
            default: own.parameter("speed");
            }
        }
    "#;
    let settings = json!({"slots": 4});
    let ran = run(&build("simple.cpp", members), settings, &[1, 2, 3, 4, 5, 6, 7, 8, 9]);
    let expected = [
        "1 passed",
        "2 passed",
        "3 passed",
        "4 passed",
        "5 skipped no gripper",
        "7",
        "6 passed",
        "8 failed dropped",
        "9 passed",
        "10 passed",
    ];
    assert_eq!(ends(&ran), expected);
    let cases: Vec<_> = all(&ran, "message")
        .iter()
        .map(|message| (message["text"].as_str().unwrap(), message["case"].as_u64()))
        .collect();
    let unknown = "there is no parameter \"speed\"; episode 9 has payload, side";
    let expected = [
        ("its values", Some(1)),
        ("it moves", Some(2)),
        ("std::out_of_range: joint 9", Some(3)),
        ("exception of type int", Some(4)),
        ("slipped", Some(7)),
        ("after the episode", None),
        ("std::runtime_error: after the episode", None),
        (unknown, Some(10)),
    ];
    assert_eq!(cases, expected);
    assert_eq!(all(&ran, "measured")[0]["case"], 1);
    assert_eq!(ran.result, json!({"outcome": "failed"}));
}

#[test]
fn limits_end_an_episode_that_is_not_done() {
    let members = r#"
        void episode(rtf::Episode &own) override
        {
            const auto needed = std::stoul(own.parameter("needed", "3")) + own.id() - 1;
            for (std::size_t done = 0; own.step(0.1s);) {
                if (++done == needed) {
                    return;
                }
            }
            RTF_CHECK(false, "not reached");
        }
    "#;
    let library = build("limits.cpp", members);
    let ran = run(&library, json!({"slots": 1, "max_steps": 3}), &[1, 2]);
    assert_eq!(ends(&ran), ["1 passed", "2 timed-out not done after 3 steps"]);
    let counted = json!({"steps": 3, "time_us": 300_000});
    let episodes = all(&ran, "case-finished");
    assert_eq!((&episodes[0]["episode"], &episodes[1]["episode"]), (&counted, &counted));
    assert_eq!(ran.texts(), ["failure: not reached"]);
    let ran = run(&library, json!({"slots": 1, "max_time_us": 1_000_000}), &[8, 9]);
    let expected = ["1 passed", "2 timed-out not done after 1 s of simulated time"];
    assert_eq!(ends(&ran), expected);
    let counted = json!({"steps": 10, "time_us": 1_000_000});
    assert_eq!(all(&ran, "case-finished")[1]["episode"], counted);
    let ran = run(&library, json!({"slots": 1}), &[500]);
    assert_eq!(ends(&ran), ["1 passed"]);
    let silent = build("uncounted.cpp", "void episode(rtf::Episode &) override {}");
    let ran = run(&silent, json!({"slots": 1, "max_steps": 3}), &[1]);
    let unknown = "its number of steps is unknown, but the suite has `max-steps`";
    assert_eq!(ends(&ran), [format!("1 error {unknown}")]);
}

#[test]
fn several_episodes_are_open_at_a_time() {
    let members = r#"
        void run() override
        {
            std::vector<rtf::Episode> open;
            for (;;) {
                for (rtf::Episode &next : take(0, open.empty())) {
                    open.push_back(std::move(next));
                }
                if (open.empty()) {
                    return;
                }
                report(std::to_string(open.size()) + " of " + std::to_string(slots()));
                rtf::Episode last = std::move(open.back());
                open.pop_back();
                {
                    const rtf::Episode::Scope scope(last);
                    measure("distance", double(last.id()), "m");
                    sample("q", 1, "rad");
                    RTF_CASE("grasp") { report("closing"); };
                }
                last.within([&] { RTF_REQUIRE(last.id() != 2, "id 2"); });
                if (!last.finished()) {
                    last.finish(last.id() != 3, "slipped", {last.id(), 0.5s, "9f86"});
                }
            }
        }
    "#;
    let library = build("several.cpp", members);
    let ran = run(&library, json!({"slots": 2}), &[1, 2, 3]);
    let starts: Vec<_> =
        all(&ran, "case-started").iter().map(|start| start["name"].as_str().unwrap()).collect();
    assert_eq!(starts, ["1", "2", "grasp", "3", "grasp", "grasp"]);
    assert_eq!(ends(&ran), ["3", "2 passed", "5", "4 failed slipped", "6", "1 passed"]);
    let end = json!({"steps": 3, "time_us": 500_000, "first_observation": "9f86"});
    assert_eq!(all(&ran, "case-finished")[3]["episode"], end);
    let cases = |method: &str| -> Vec<_> {
        all(&ran, method).iter().map(|line| line["case"].clone()).collect()
    };
    assert_eq!(
        (cases("measured"), cases("sampled")),
        (vec![2.into(), 4.into(), 1.into()], cases("measured"))
    );
    assert!(ran.texts().starts_with(&["report: 2 of 2".to_owned(), "report: closing".to_owned()]));
    assert_eq!(ran.result, json!({"outcome": "failed"}));
}

#[test]
fn what_a_test_must_not_do_is_an_error_with_the_line() {
    let members = r#"
        void run() override
        {
            auto taken = take();
            taken[0].finish();
            try { taken[0].finish(); } catch (const std::exception &) {}
        }
    "#;
    let ran = run(&build("twice.cpp", members), json!({"slots": 1}), &[1]);
    let error =
        "error: episode 1 is not open: it has finished already, or the test has not taken it";
    assert_eq!(ran.texts(), [error]);
    assert_eq!(all(&ran, "message")[0]["location"]["line"], 14);
    assert_eq!(ran.result, json!({"outcome": "error"}));
    let early = build("early.cpp", "void run() override { take(1); }");
    let ran = run(&early, json!({"slots": 1}), &[1]);
    assert_eq!(ran.texts(), ["error: `run` returned before it finished episode 1"]);
    let neither = run(&build("neither.cpp", ""), json!({"slots": 1}), &[1]);
    assert_eq!(neither.texts(), ["error: override `episode` or `run` of rtf::EpisodeTest"]);
    let ran = run_test(&early, json!({}));
    let error = "error: the test has no `slots` in its suite, so it gets no episodes";
    assert_eq!(ran.texts(), [error]);
}

#[test]
fn a_critical_assertion_ends_the_test() {
    let members = r#"
        void episode(rtf::Episode &) override { RTF_REQUIRE_CRITICAL(false, "the arm is free"); }
    "#;
    let ran = run(&build("critical-episode.cpp", members), json!({"slots": 1}), &[1, 2]);
    assert_eq!(all(&ran, "case-started").len(), 1);
    assert_eq!(
        (ends(&ran), ran.texts()),
        (vec!["1 passed".to_owned()], vec!["failure: the arm is free".to_owned()])
    );
}

#[test]
fn a_stop_request_ends_a_step_and_a_wait() {
    for (name, members, leaves) in [
        (
            "stopped-step.cpp",
            r#"
            void episode(rtf::Episode &own) override
            {
                report("stepping");
                while (own.step()) {
                }
            }
            "#,
            1,
        ),
        (
            "stopped-wait.cpp",
            r#"
            void run() override
            {
                take(1)[0].finish();
                report("stepping");
                take();
                report("never");
            }
            "#,
            0,
        ),
    ] {
        let mut host = start(&build(name, members), json!({"slots": 1}));
        host.send(episodes(&[1]));
        host.wait_for("stepping");
        host.send(json!({"method": "interrupt", "params": {"reason": "Ctrl-C"}}));
        let ran = host.finish();
        assert!(ran.texts().is_empty() && ends(&ran).is_empty(), "{leaves}: {ran:?}");
        assert_eq!(ran.result, json!({"outcome": "interrupted", "reason": "Ctrl-C"}), "{name}");
    }
}

#[test]
fn a_forked_child_finishes_no_episode() {
    let members = r#"
        void episode(rtf::Episode &own) override
        {
            const pid_t child = fork();
            if (child == 0) {
                report("child");
                own.finish(false);
                _exit(0);
            }
            waitpid(child, nullptr, 0);
        }
    "#;
    let ran = run(&build("forked-episode.cpp", members), json!({"slots": 1}), &[1]);
    assert_eq!(all(&ran, "message")[0]["case"], 1);
    assert_eq!(ends(&ran), ["1 passed"]);
}

#[test]
fn equal_first_observations_have_equal_hashes() {
    let members = r#"
        void episode(rtf::Episode &own) override
        {
            const std::vector<std::vector<float>> rows{{1, 2}, {own.id() == 3 ? 3.5F : 3.F}};
            own.observe(rows);
            own.observe("later");
            if (own.id() == 4) {
                own.finish(true, "", {{}, {}, "own"});
            }
        }
    "#;
    let ran = run(&build("observe.cpp", members), json!({"slots": 1}), &[1, 2, 3, 4]);
    let observed: Vec<_> = all(&ran, "case-finished")
        .iter()
        .map(|end| end["episode"]["first_observation"].as_str().unwrap())
        .collect();
    assert!(observed[0].len() == 16 && observed[0] == observed[1], "{observed:?}");
    assert!(observed[2].len() == 16 && observed[2] != observed[1], "{observed:?}");
    assert_eq!(observed[3], "own");
}

#[test]
fn several_threads_run_episodes() {
    let members = r#"
        void run() override
        {
            std::vector<std::thread> threads;
            for (std::size_t index = 0; index < slots(); ++index) {
                threads.emplace_back([this] {
                    for (auto own = take(1); !own.empty(); own = take(1)) {
                        own[0].within([&] { RTF_CHECK(own[0].id() % 2 == 0, "even"); });
                        own[0].finish();
                    }
                });
            }
            for (std::thread &thread : threads) {
                thread.join();
            }
        }
    "#;
    let ids: Vec<u64> = (1..=100).collect();
    let ran = run(&build("threads.cpp", members), json!({"slots": 4}), &ids);
    for message in all(&ran, "message") {
        let kind = if message["case"].as_u64().unwrap() % 2 == 0 { "check" } else { "failure" };
        assert_eq!(message["kind"], kind);
    }
    assert_eq!((ends(&ran).len(), all(&ran, "message").len()), (100, 100));
}

/// The plug-in sees its host's table as one of version 1.4 would be.
#[test]
fn a_host_without_episodes_is_an_error_with_its_version() {
    let members = r#"
        void run() override
        {
            static rtf_host old = rtf::internal::host();
            old.abi_minor = 4;
            old.size = offsetof(rtf_host, slots);
            rtf::internal::current_host = &old;
            take();
        }
    "#;
    let settings = json!({"episodes": {"slots": 1}});
    let ran = run_test(&build("old-episodes.cpp", members), settings);
    let error = "error: this rtf is too old for episodes: its plug-in interface is 1.4";
    assert_eq!(ran.texts(), [error]);
}

/// Its structure for slots is that of a version without limits.
#[test]
fn plain_c_has_episodes_too() {
    let text = r#"
        #include <stddef.h>
        #include <rtf/plugin.h>
        static const rtf_host *host;
        static int here;
        static void *create(const rtf_host *own) { host = own; return &here; }
        static int32_t run(void *self)
        {
            rtf_slots slots = {offsetof(rtf_slots, max_steps), 0, 0, 7, 8};
            rtf_episode episode = {sizeof episode, 0, 0, 0, NULL, 0};
            rtf_episode_end end = {sizeof end, RTF_EPISODE_ERROR, 0, rtf_string("no camera"), 7,
                                   -1, rtf_string("9f86"), __FILE__, __LINE__};
            (void)self;
            if (host->slots(host->context, &slots) != RTF_DONE || slots.slots != 2 ||
                slots.max_steps != 7) {
                return RTF_REFUSED;
            }
            while (host->take_episode(host->context, 1, &episode) == RTF_DONE) {
                rtf_message message = {sizeof message, RTF_MESSAGE_REPORT, 0,
                                       episode.parameters[1].value, NULL, 0, NULL};
                host->enter_episode(host->context, episode.id);
                host->message(host->context, &message);
                host->leave_episode(host->context, episode.id);
                end.outcome = episode.id == 1 ? RTF_EPISODE_ERROR : 9;
                host->finish_episode(host->context, episode.id, &end);
            }
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
    let settings = json!({"slots": 2, "max_steps": 500});
    let ran = run(&build_text("episodes-in-c.c", text, &[]), settings, &[1, 2]);
    let texts = ["report: left", "report: left", "error: episode 2 has the unknown outcome 9"];
    assert_eq!(ran.texts(), texts);
    let end = json!({"steps": 7, "first_observation": "9f86"});
    let finished = json!({"case": 1, "outcome": "error", "reason": "no camera", "episode": end});
    assert_eq!(all(&ran, "case-finished"), [&finished]);
}
