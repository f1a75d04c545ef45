//! Suites, plug-ins and directories in any mix.

use crate::bench::{Bench, names};

#[test]
fn a_directory_stands_for_its_suites_or_else_its_plugins() {
    let mut bench = Bench::new();
    bench.file("cell/all/b.xml", "<suite><test>../A.lua</test></suite>");
    bench.file("cell/all/a.xml", "<suite><test>../A.lua</test></suite>");
    bench.file("cell/all/launch.xml", "<robot/>");
    bench.file("cell/all/C.lua", "");
    bench.file("cell/all/below/c.xml", "<suite><test>../../A.lua</test></suite>");
    bench.file("cell/A.lua", "");
    let files = |bench: &Bench| {
        let plan = bench.plan(&["all"]);
        plan.suites.iter().map(|suite| suite.file.clone()).collect::<Vec<_>>()
    };
    assert_eq!(files(&bench), ["all/a.xml", "all/b.xml"]);
    bench.options.recursive = true;
    assert_eq!(files(&bench), ["all/a.xml", "all/b.xml", "all/below/c.xml"]);
    for name in ["b.lua", "a.py", "c.so", "note.txt", ".hidden.lua", "sub/d.lua", ".git/e.lua"] {
        bench.file(&format!("cell/plain/{name}"), "");
    }
    let plan = bench.plan(&["plain"]);
    assert_eq!(names(&plan, 0), ["a", "b", "c", "d"]);
    assert_eq!(plan.suites[0].name, "plug-ins");
    bench.options.recursive = false;
    assert_eq!(names(&bench.plan(&["plain"]), 0), ["a", "b", "c"]);
}

#[test]
fn plugins_given_directly_form_one_suite() {
    let mut bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/b/A.lua", "");
    bench.file("cell/s.xml", "<suite name='plug-ins'><test>A.lua</test></suite>");
    bench.options.param = "--n 3".to_owned();
    bench.options.environment = "--robot r".to_owned();
    bench.options.repetitions = 4;
    let plan = bench.plan(&["A.lua", "s.xml", "b/A.lua", "s.xml"]);
    let suites: Vec<_> = plan.suites.iter().map(|suite| suite.name.as_str()).collect();
    assert_eq!(suites, ["plug-ins", "plug-ins#2", "plug-ins#3"]);
    let suite = &plan.suites[2];
    assert_eq!(names(&plan, 2), ["A", "A#2"]);
    assert_eq!((suite.file.as_str(), bench.relative(&suite.folder).as_str()), ("", "cell"));
    assert_eq!(suite.settings.environment, "--robot r");
    assert_eq!((suite.tests[0].settings.repetitions, suite.tests[0].plugin.args.len()), (4, 2));
    assert_eq!((suite.tests[1].id.0, plan.tests), (3, 4));
    // The options do not apply to the suite's own tests.
    assert_eq!(
        (plan.suites[0].tests[0].settings.repetitions, plan.suites[0].tests[0].plugin.args.len()),
        (1, 0)
    );
}

/// Defect 1 of the predecessor: missing plug-ins and empty directories were green.
#[test]
fn nothing_to_run_is_an_error() {
    let bench = Bench::new();
    bench.file("cell/empty/note.txt", "");
    bench.file("cell/none.xml", "<suite><description>x</description></suite>");
    bench.file("cell/robot.xml", "<robot/>");
    let code = |path: &str| {
        let outcome = bench.build(&[path]);
        assert!(outcome.plan.is_none());
        outcome.diagnostics[0].code.clone()
    };
    assert_eq!(code("empty"), "no-tests");
    assert_eq!(code("none.xml"), "no-tests");
    assert_eq!(code("robot.xml"), "not-a-suite");
    assert_eq!(code("nothing.xml"), "no-such-file");
    assert_eq!(code("empty/note.txt"), "unknown-file");
    assert_eq!(bench.problems(&[])[0].0, "no-tests");
}
