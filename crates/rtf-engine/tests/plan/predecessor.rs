//! What is asked for in the manner of robot-testing-framework 2.x.

use rtf_engine::plan::{Manner, Plan, Request};

use crate::bench::{Bench, names};

fn bench() -> Bench {
    let mut bench = Bench::new();
    bench.options.manner = Manner::Predecessor;
    for file in ["A.lua", "sub/A.lua", "sub/B.lua", "sub/deep/C.lua", "lib/libD.so"] {
        bench.file(&format!("cell/{file}"), "");
    }
    let suite = "<suite name='s'><test>A.lua</test><test>B.lua</test></suite>";
    bench.file("cell/sub/s.xml", suite);
    bench.file("cell/sub/other.xml", "<robot/>");
    bench
}

fn files(bench: &Bench, plan: &Plan) -> Vec<String> {
    let tests = plan.suites.iter().flat_map(|suite| &suite.tests);
    tests.map(|test| bench.relative(&test.plugin.file)).collect()
}

#[test]
fn names_of_a_suite_start_in_the_current_folder() {
    let mut bench = bench();
    let plan = bench.plan_requests(&[Request::Suite("sub/s.xml".into())]);
    assert_eq!(files(&bench, &plan), ["cell/A.lua", "cell/sub/B.lua"]);
    assert_eq!(bench.relative(&plan.suites[0].folder), "cell");
    bench.options.manner = Manner::Own;
    let plan = bench.plan_requests(&[Request::Suite("sub/s.xml".into())]);
    assert_eq!(files(&bench, &plan), ["cell/sub/A.lua", "cell/sub/B.lua"]);
    assert_eq!(bench.relative(&plan.suites[0].folder), "cell/sub");
}

#[test]
fn a_folder_holds_what_it_was_asked_for() {
    let mut bench = bench();
    let plugins = [Request::Plugins("sub".into())];
    assert_eq!(names(&bench.plan_requests(&plugins), 0), ["A", "B"]);
    bench.options.recursive = true;
    assert_eq!(names(&bench.plan_requests(&plugins), 0), ["A", "B", "C"]);
    let plan = bench.plan_requests(&[Request::Suites(".".into())]);
    assert_eq!(plan.suites.iter().map(|suite| &suite.file).collect::<Vec<_>>(), ["./sub/s.xml"]);
    bench.options.recursive = false;
    for nothing in [Request::Suites(".".into()), Request::Plugins("lib/none".into())] {
        assert!(!bench.request_problems(&[nothing]).is_empty());
    }
    assert_eq!(bench.request_problems(&[Request::Suites("sub/deep".into())]), ["no-tests"]);
    assert_eq!(bench.request_problems(&[Request::Suite("sub/other.xml".into())]), ["not-a-suite"]);
    assert_eq!(bench.request_problems(&[Request::Suite("none.xml".into())]), ["no-such-file"]);
    // A plug-in where a suite belongs is not run.
    assert!(!bench.request_problems(&[Request::Suite("A.lua".into())]).is_empty());
}

#[test]
fn a_plug_in_is_named_as_in_a_suite() {
    let mut bench = bench();
    bench.set("LD_LIBRARY_PATH", "lib");
    for name in ["libD.so", "D", "lib/libD.so", "./lib/libD"] {
        let plan = bench.plan_requests(&[Request::Plugin(name.into())]);
        assert_eq!(files(&bench, &plan), ["cell/lib/libD.so"], "{name}");
    }
    assert_eq!(bench.request_problems(&[Request::Plugin("E.so".into())]), ["no-such-plugin"]);
}

#[test]
fn plug_ins_come_first_and_options_are_for_those_that_were_named() {
    let mut bench = bench();
    bench.options.param = "--n 3".to_owned();
    bench.options.environment = "--robot r".to_owned();
    bench.options.repetitions = 4;
    let requests = [
        Request::Plugin("A.lua".into()),
        Request::Plugins("sub".into()),
        Request::Suite("sub/s.xml".into()),
    ];
    let plan = bench.plan_requests(&requests);
    let told: Vec<_> = plan
        .suites
        .iter()
        .map(|suite| {
            let test = &suite.tests[0];
            (suite.file.as_str(), suite.environment.as_str(), test.repetitions, &*test.plugin.param)
        })
        .collect();
    assert_eq!(told, [("", "--robot r", 4, "--n 3"), ("", "", 1, ""), ("sub/s.xml", "", 1, "")]);
    let of_none = bench.plan_requests(&requests[1..]);
    assert_eq!(of_none.suites[0].tests[0].repetitions, 1);
    assert_eq!(bench.request_problems(&requests[1..]), ["without-effect"; 3]);
}

#[test]
fn types_may_be_written_in_capitals() {
    let bench = bench();
    let suite = "<suite><test type='LUA'>A</test><test type='Dll'>lib/D</test></suite>";
    bench.file("cell/capitals.xml", suite);
    let plan = bench.plan_requests(&[Request::Suite("capitals.xml".into())]);
    assert_eq!(files(&bench, &plan), ["cell/A.lua", "cell/lib/libD.so"]);
}
