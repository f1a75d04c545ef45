//! Planning with the rules of robot-testing-framework 2.x.

use rtf_plan::plan::{Compatibility, InputPath, Plan};

use crate::bench::{Bench, names};

fn bench() -> Bench {
    let mut bench = Bench::new();
    bench.options.compatibility = Compatibility::Predecessor;
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
fn names_of_a_suite_refer_to_the_current_directory() {
    let mut bench = bench();
    let plan = bench.plan_inputs(&[InputPath::Suite("sub/s.xml".into())]);
    assert_eq!(files(&bench, &plan), ["cell/A.lua", "cell/sub/B.lua"]);
    assert_eq!(bench.relative(&plan.suites[0].folder), "cell");
    bench.options.compatibility = Compatibility::Native;
    let plan = bench.plan_inputs(&[InputPath::Suite("sub/s.xml".into())]);
    assert_eq!(files(&bench, &plan), ["cell/sub/A.lua", "cell/sub/B.lua"]);
    assert_eq!(bench.relative(&plan.suites[0].folder), "cell/sub");
}

#[test]
fn a_directory_is_searched_for_plugins_or_for_suites() {
    let mut bench = bench();
    let plugins = [InputPath::Plugins("sub".into())];
    assert_eq!(names(&bench.plan_inputs(&plugins), 0), ["A", "B"]);
    bench.options.recursive = true;
    assert_eq!(names(&bench.plan_inputs(&plugins), 0), ["A", "B", "C"]);
    let plan = bench.plan_inputs(&[InputPath::Suites(".".into())]);
    assert_eq!(plan.suites.iter().map(|suite| &suite.file).collect::<Vec<_>>(), ["./sub/s.xml"]);
    bench.options.recursive = false;
    for nothing in [InputPath::Suites(".".into()), InputPath::Plugins("lib/none".into())] {
        assert!(!bench.input_problems(&[nothing]).is_empty());
    }
    assert_eq!(bench.input_problems(&[InputPath::Suites("sub/deep".into())]), ["no-tests"]);
    assert_eq!(bench.input_problems(&[InputPath::Suite("sub/other.xml".into())]), ["not-a-suite"]);
    assert_eq!(bench.input_problems(&[InputPath::Suite("none.xml".into())]), ["no-such-file"]);
    // A plug-in in place of a suite does not run.
    assert!(!bench.input_problems(&[InputPath::Suite("A.lua".into())]).is_empty());
}

#[test]
fn a_plug_in_is_named_as_in_a_suite() {
    let mut bench = bench();
    bench.set("LD_LIBRARY_PATH", "lib");
    for name in ["libD.so", "D", "lib/libD.so", "./lib/libD"] {
        let plan = bench.plan_inputs(&[InputPath::Plugin(name.into())]);
        assert_eq!(files(&bench, &plan), ["cell/lib/libD.so"], "{name}");
    }
    assert_eq!(bench.input_problems(&[InputPath::Plugin("E.so".into())]), ["no-such-plugin"]);
}

#[test]
fn plug_ins_come_first_and_options_apply_to_named_ones() {
    let mut bench = bench();
    bench.options.param = "--n 3".to_owned();
    bench.options.environment = "--robot r".to_owned();
    bench.options.repetitions = 4;
    let inputs = [
        InputPath::Plugin("A.lua".into()),
        InputPath::Plugins("sub".into()),
        InputPath::Suite("sub/s.xml".into()),
    ];
    let plan = bench.plan_inputs(&inputs);
    let planned: Vec<_> = plan
        .suites
        .iter()
        .map(|suite| {
            let test = &suite.tests[0];
            (
                suite.file.as_str(),
                suite.settings.environment.as_str(),
                test.settings.repetitions,
                &*test.plugin.param,
            )
        })
        .collect();
    assert_eq!(planned, [("", "--robot r", 4, "--n 3"), ("", "", 1, ""), ("sub/s.xml", "", 1, "")]);
    let unnamed = bench.plan_inputs(&inputs[1..]);
    assert_eq!(unnamed.suites[0].tests[0].settings.repetitions, 1);
    assert_eq!(bench.input_problems(&inputs[1..]), ["without-effect"; 3]);
}

#[test]
fn types_may_be_written_in_capitals() {
    let bench = bench();
    let suite = "<suite><test type='LUA'>A</test><test type='Dll'>lib/D</test></suite>";
    bench.file("cell/capitals.xml", suite);
    let plan = bench.plan_inputs(&[InputPath::Suite("capitals.xml".into())]);
    assert_eq!(files(&bench, &plan), ["cell/A.lua", "cell/lib/libD.so"]);
}
