//! Tests of other frameworks: their types, files, attributes and checks.

use std::time::Duration;

use rtf_plan::plan::TestPlan;

use crate::bench::{Bench, names};

fn bench() -> Bench {
    let bench = Bench::new();
    bench.program("cell/arm_test", "exit 0");
    bench.program("cell/build/gaze_test", "exit 0");
    bench.file("cell/tests/test_arm.py", "");
    bench
}

fn first(bench: &Bench, suite: &str) -> TestPlan {
    bench.file("cell/s.xml", suite);
    bench.plan(&["s.xml"]).suites[0].tests[0].clone()
}

#[test]
fn a_type_of_another_framework_has_one_host() {
    let bench = bench();
    let test = first(&bench, "<suite><test type='GTest' param='-v'>arm_test</test></suite>");
    assert_eq!(&*test.plugin.plugin_type, "gtest");
    assert_eq!(bench.relative(&test.plugin.file), "cell/arm_test");
    assert_eq!(test.plugin.args, ["-v"]);
    assert_eq!(test.plugin.host.command, [bench.path("bin/rtf-host-framework"), "gtest".into()]);
    assert!(!test.plugin.host.forks);
    let cases = test.cases_in_programs.unwrap();
    assert_eq!((cases.case_timeout, cases.separate, cases.listed), (None, false, None));
    // The extension of a file does not select such a type.
    let test = first(&bench, "<suite><test>tests/test_arm.py</test></suite>");
    assert_eq!((&*test.plugin.plugin_type, test.cases_in_programs), ("python", None));
}

#[test]
fn python_tests_can_import_the_sdk() {
    let mut bench = bench();
    bench.file("share/rtf/python/rtf/host/__init__.py", "");
    bench.set("PYTHONPATH", "/own");
    for kind in ["pytest", "unittest"] {
        let test = first(&bench, &format!("<suite><test type='{kind}'>tests</test></suite>"));
        let path = format!("{}:/own", bench.path("share/rtf/python"));
        assert_eq!(test.plugin.host.env, [("PYTHONPATH".to_owned(), path)]);
        assert_eq!(test.plugin.host.command[1], kind);
    }
}

#[test]
fn programs_are_searched_by_their_exact_name_and_at_last_in_path() {
    let mut bench = bench();
    let found = |bench: &Bench, name: &str| {
        let test = first(bench, &format!("<suite><test type='tap'>{name}</test></suite>"));
        bench.relative(&test.plugin.file)
    };
    bench.program("bin/lift_test", "exit 0");
    assert_eq!(found(&bench, "lift_test"), "bin/lift_test");
    assert_eq!(found(&bench, "build/gaze_test"), "cell/build/gaze_test");
    bench.program("own/lift_test", "exit 0");
    bench.set("RTF_PLUGIN_PATH", &bench.path("own"));
    assert_eq!(found(&bench, "lift_test"), "own/lift_test");
    // A file that cannot be executed is no program.
    bench.file("cell/lift_test", "");
    bench.file("cell/lift_test.so", "");
    assert_eq!(found(&bench, "lift_test"), "own/lift_test");
    bench.file("bin/lift_test.so", "");
    assert_eq!(found(&bench, &bench.path("bin/lift_test")), "bin/lift_test");
}

#[test]
fn a_test_is_named_after_its_file() {
    let bench = bench();
    bench.file("cell/arm.jar", "");
    bench.file("cell/arm.test", "");
    bench.program("cell/arm.v2", "exit 0");
    bench.file(
        "cell/s.xml",
        "<suite><test type='junit'>arm.jar</test><test type='rostest'>arm.test</test>\
         <test type='gtest'>arm.v2</test><test type='pytest'>tests/test_arm.py</test>\
         <test type='go'> . </test><test type='ctest'>build/</test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    let expected = ["arm", "arm#2", "arm.v2", "test_arm.py", "cell", "build"];
    assert_eq!(names(&plan, 0), expected);
}

#[test]
fn a_missing_or_unsuitable_file_is_reported() {
    let bench = bench();
    bench.file("cell/old_test", "");
    let shown = bench.shown(
        "<suite>\n<test type='gtest'>amr_test</test>\n<test type='gtest'>old_test</test>\n\
         <test type='gtest'>build</test>\n<test type='ctest'>arm_test</test>\n\
         <test type='cargo'>biuld</test>\n<test type='rostest'>tests</test>\n\
         <test type='pytest'>tets</test>\n<test type='tap'>build/gase_test</test>\n</suite>",
    );
    insta::assert_snapshot!(shown, @"
    no-such-plugin: there is no program `amr_test` for a test of type `gtest`
      2:20 amr_test
      note: looked for `amr_test` in
      [ROOT]/cell
      note: searched `PATH`:
      [ROOT]/bin
      /usr/bin
      /bin
      hint: did you mean `arm_test`?
    no-such-plugin: the program `old_test` is not executable
      3:20 old_test
      note: the file is [ROOT]/cell/old_test
      hint: make it executable with `chmod +x old_test`
    no-such-plugin: `build` is a directory, not a program
      4:20 build
      note: found [ROOT]/cell/build
    no-such-plugin: `arm_test` is a file, not a directory
      5:20 arm_test
      note: found [ROOT]/cell/arm_test
    no-such-plugin: there is no directory `biuld` for a test of type `cargo`
      6:20 biuld
      note: looked for `biuld` in
      [ROOT]/cell
      hint: did you mean `build`?
    no-such-plugin: `tests` is a directory, not a file
      7:22 tests
      note: found [ROOT]/cell/tests
    no-such-plugin: there is no file or directory `tets` for a test of type `pytest`
      8:21 tets
      note: looked for `tets` in
      [ROOT]/cell
      hint: did you mean `tests`?
    no-such-plugin: there is no program `build/gase_test` for a test of type `tap`
      9:18 build/gase_test
      note: looked for `build/gase_test` in
      [ROOT]/cell
      hint: did you mean `build/gaze_test`?
    ");
}

#[test]
fn other_frameworks_are_only_for_tests() {
    let shown = bench().shown(
        "<suite>\n<fixture type='gtest'>arm_test</fixture>\n\
         <hook on='end' type='program'>arm_test</hook>\n<test type='gtset'>arm_test</test>\n</suite>",
    );
    insta::assert_snapshot!(shown, @"
    wrong-kind: the type `gtest` is only for tests, not for a fixture
      2:16 gtest
      hint: `type=\"process\"` is a fixture that runs a program
    wrong-kind: the type `program` is only for tests, not for a hook
      3:22 program
      hint: write a program as `<command>`, without a `type`
    unknown-type: unknown type `gtset`
      4:13 gtset
      note: known types are `dll`, `lua`, `python`, `ruby`, `gtest`, `catch2`, `doctest`, `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`
      hint: did you mean `gtest`?
    ");
}

#[test]
fn cases_have_limits_and_processes() {
    let bench = bench();
    let cases = |attributes: &str| {
        let suite = format!("<suite><test type='gtest' {attributes}>arm_test</test></suite>");
        let cases = first(&bench, &suite).cases_in_programs.unwrap();
        (cases.case_timeout, cases.separate, cases.fork_at_main)
    };
    assert_eq!(cases("case-timeout='2s'"), (Some(Duration::from_secs(2)), false, false));
    assert_eq!(cases("isolation='case'"), (None, true, false));
    assert_eq!(cases("isolation='case' fork='start'"), (None, true, false));
    assert_eq!(cases("isolation='case' fork='main'"), (None, true, true));
    assert_eq!(cases("isolation='process'"), (None, false, false));
    // The scale of a slow machine applies.
    bench.file("cell/rtf.toml", "[timeouts]\nscale = 2.0\n");
    assert_eq!(cases("case-timeout='2s'"), (Some(Duration::from_secs(4)), false, false));
}

#[test]
fn only_programs_with_a_process_for_each_case_are_forked() {
    let bench = bench();
    bench.file("cell/A.lua", "");
    let boost = "<suite><test type='boost' fork='main'>arm_test</test></suite>";
    assert!(first(&bench, boost).cases_in_programs.unwrap().fork_at_main);
    let shown = bench.shown(
        "<suite>\n<test fork='main'>A.lua</test>\n\
         <test type='gtest' fork='main'>arm_test</test>\n\
         <test type='ctest' isolation='case' fork='start'>.</test>\n\
         <test type='gtest' isolation='case' fork='early'>arm_test</test>\n</suite>",
    );
    insta::assert_snapshot!(shown, @"
    not-of-this-type: `fork` is only for tests of other frameworks
      2:13 main
      note: their types are `gtest`, `catch2`, `doctest`, `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`
      hint: `rtf run --fork` chooses how processes of plug-ins start
    not-of-this-type: `fork` needs `isolation=\"case\"`
      3:26 main
      hint: without it, one process runs all cases, and nothing is forked
    not-of-this-type: `fork` is for programs that can be forked
      4:43 start
      hint: their types are `gtest`, `catch2`, `doctest`, `boost`
    invalid-value: `fork` has to be `start` or `main`: `early`
      5:43 early
    ");
}

#[test]
fn attributes_of_other_types_are_errors() {
    let bench = bench();
    bench.file("cell/A.lua", "");
    let shown = bench.shown(
        "<suite>\n<test cases='*' case-timeout='1s' isolation='case'>A.lua\
         <matrix name='n' values='1 2'/></test>\n\
         <test type='gtest' isolation='shared'>arm_test</test>\n\
         <test type='tap' cases='*' isolation='case' case-timeout='1s'>arm_test</test>\n\
         <test type='gtest' cases=' '>arm_test</test>\n\
         <test type='program' case-timeout='1s'>arm_test</test>\n</suite>",
    );
    insta::assert_snapshot!(shown, @"
    not-of-this-type: `cases` is only for tests of other frameworks
      2:14 *
      note: their types are `gtest`, `catch2`, `doctest`, `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`
      hint: `rtf run SUITE::TEST/CASE` selects a case of a plug-in
    not-of-this-type: `case-timeout` is only for tests of other frameworks
      2:31 1s
      note: their types are `gtest`, `catch2`, `doctest`, `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`
      hint: `timeout` limits the whole test
    not-of-this-type: `isolation=\"case\"` is only for tests of other frameworks
      2:46 case
      note: their types are `gtest`, `catch2`, `doctest`, `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`
      hint: each test already has a separate process
    not-of-this-type: a test of type `gtest` cannot share a process
      3:31 shared
      hint: all cases of the test run in one process without `isolation`
    not-of-this-type: `cases` needs a list of cases, which a test of type `tap` does not have
      4:25 *
      hint: if the program can select tests, use `param`
    not-of-this-type: `isolation=\"case\"` needs a list of cases, which a test of type `tap` does not have
      4:39 case
      hint: if the program can select tests, use `param`
    invalid-value: `cases` is empty
      5:27
    not-of-this-type: `case-timeout` cannot limit the cases of a test of type `program`
      6:36 1s
      hint: `timeout` limits the whole test
    without-effect: `case-timeout` limits only announced subtests of type `tap`
      4:59 1s
      hint: `timeout` limits the whole test
    ");
}

#[test]
fn a_check_has_the_variables_of_the_test() {
    let bench = bench();
    bench.file(
        "cell/s.xml",
        "<suite><env name='MODE' value='fast'/>\
         <test type='gtest'>arm_test<env name='ROBOT' value='sim'/>\
         <matrix name='joint' values='1 2 3'/></test></suite>",
    );
    let draft = bench.draft(&["s.xml"]);
    // One check for all combinations.
    let [group] = draft.check_groups() else { panic!("{:?}", draft.check_groups()) };
    let expected = [("MODE", "fast"), ("ROBOT", "sim")];
    assert_eq!(group.env, expected.map(|(name, value)| (name.to_owned(), value.to_owned())));
}

#[test]
fn a_check_has_the_arguments_of_the_test() {
    let bench = bench();
    bench.file(
        "cell/s.xml",
        "<suite><env name='MODE' value='fast'/>\
         <test type='gtest'>arm_test</test><test type='gtest' name='B'>arm_test</test>\
         <test type='gtest'>build/gaze_test</test>\
         <test type='gtest' name='C' param='--robot ${port:sim}'>arm_test</test>\
         <test type='tap' name='D' param='-x'>arm_test</test>\
         <test type='cargo' name='E'>build</test>\
         <test type='gtest' name='M' param='${param:j}'>arm_test<matrix name='j' values='1 2'/></test>\
         </suite>",
    );
    let limit = Duration::from_secs(30);
    let shown = |paths: &[&str]| {
        let draft = bench.draft(paths);
        let groups = draft.check_groups().iter().map(|group| {
            let files: Vec<_> = group.files().map(|file| bench.relative(file)).collect();
            let (kind, arguments) = (&group.host.command[1], &group.arguments);
            assert_eq!(group.env[0], ("MODE".to_owned(), "fast".to_owned()));
            format!("{kind} {files:?} {arguments:?} {:?}", group.limit(limit))
        });
        groups.collect::<Vec<_>>()
    };
    assert_eq!(
        shown(&["s.xml"]),
        [
            r#"gtest ["cell/arm_test", "cell/build/gaze_test"] [] 120s"#,
            r#"gtest ["cell/arm_test"] ["--robot", "${port:sim}"] 120s"#,
            r#"tap ["cell/arm_test"] [] 30s"#,
            r#"cargo ["cell/build"] [] 600s"#,
            r#"gtest ["cell/arm_test"] ["1"] 120s"#,
            r#"gtest ["cell/arm_test"] ["2"] 120s"#,
        ]
    );
    // Only the cases of selected tests are listed.
    assert_eq!(shown(&["s.xml::M[j=2]"]), [r#"gtest ["cell/arm_test"] ["2"] 120s"#]);
}
