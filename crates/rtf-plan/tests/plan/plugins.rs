//! The search for plug-ins and hosts.

use std::sync::Arc;

use rtf_plan::plan::FixtureBody;

use crate::bench::Bench;

/// Defect 11 of the predecessor: `.so` was searched anywhere in the path.
#[test]
fn a_directory_named_like_a_library_is_not_a_library() {
    let bench = Bench::new();
    bench.file("cell/my.sources/Arm.so", "");
    bench.file("cell/my.sources/libArm.so/x", "");
    bench.file("cell/my.sources/Gaze.lua", "");
    bench.file("cell/my.sources/s.xml", "<suite><test>Arm</test><test>Gaze.lua</test></suite>");
    bench.file("cell/s.xml", "<suite><test>my.sources/Arm</test></suite>");
    let plan = bench.plan(&["my.sources/s.xml", "s.xml", "my.sources/Arm.so"]);
    for test in plan.suites.iter().map(|suite| &suite.tests[0]) {
        assert_eq!(bench.relative(&test.plugin.file), "cell/my.sources/Arm.so");
    }
}

#[test]
fn plugins_are_searched_in_order() {
    let mut bench = Bench::new();
    bench.file("cell/s.xml", "<suite><test>Arm</test></suite>");
    let found =
        |bench: &Bench| bench.relative(&bench.plan(&["s.xml"]).suites[0].tests[0].plugin.file);
    bench.file("lib/rtf/plugins/libArm.so", "");
    assert_eq!(found(&bench), "lib/rtf/plugins/libArm.so");
    bench.file("cell/system/Arm.so", "");
    bench.set("LD_LIBRARY_PATH", "system");
    assert_eq!(found(&bench), "cell/system/Arm.so");
    bench.file("own/Arm.so", "");
    let own = format!("{}:{}", bench.path("nowhere"), bench.path("own"));
    bench.set("RTF_PLUGIN_PATH", &own);
    assert_eq!(found(&bench), "own/Arm.so");
    bench.file("cell/Arm", "a program, not a plug-in, but of this name");
    assert_eq!(found(&bench), "cell/Arm");
    bench.file("cell/libArm.so", "");
    assert_eq!(found(&bench), "cell/libArm.so");
    bench.file("cell/Arm.so", "");
    assert_eq!(found(&bench), "cell/Arm.so");
    // The suite's variables override the user's; their paths are relative to its directory.
    bench.file("cell/deep/only/Gaze.so", "");
    bench.file(
        "cell/deep/s.xml",
        "<suite><env name='RTF_PLUGIN_PATH' value='only'/><test>Gaze</test></suite>",
    );
    let plan = bench.plan(&["deep/s.xml"]);
    assert_eq!(bench.relative(&plan.suites[0].tests[0].plugin.file), "cell/deep/only/Gaze.so");
}

/// A shipped fixture manager is found by its name alone. A user's plug-in of the
/// same name takes precedence, and a test never uses it.
#[test]
fn shipped_fixtures_are_found_by_name() {
    let mut bench = Bench::new();
    bench.file("share/rtf/fixtures/rtf_fixtures/__init__.py", "");
    bench.file("share/rtf/fixtures/roscore.py", "");
    bench.file("cell/Arm.so", "");
    bench.file("cell/s.xml", "<suite><fixture>roscore</fixture><test>Arm</test></suite>");
    bench.file("cell/t.xml", "<suite><test>roscore</test></suite>");
    let found = |bench: &Bench| match &bench.plan(&["s.xml"]).suites[0].fixtures[0].body {
        FixtureBody::Plugin(plugin) => {
            (bench.relative(&plugin.file), plugin.plugin_type.to_string())
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(found(&bench), ("share/rtf/fixtures/roscore.py".into(), "python".into()));
    assert!(bench.build(&["t.xml"]).plan.is_none());
    // The middleware's own library, when its environment is set up.
    bench.file("ros/lib/libroscore.so", "");
    bench.set("LD_LIBRARY_PATH", &bench.path("ros/lib"));
    assert_eq!(found(&bench), ("share/rtf/fixtures/roscore.py".into(), "python".into()));
    bench.file("cell/roscore.so", "");
    assert_eq!(found(&bench), ("cell/roscore.so".into(), "dll".into()));
}

#[test]
fn the_report_of_a_missing_plugin_lists_all_searched_directories() {
    let mut bench = Bench::new();
    bench.set("RTF_PLUGIN_PATH", "/p1:/p2");
    bench.set("LD_LIBRARY_PATH", "/l1");
    bench.file("cell/s.xml", "<suite>\n<test>Arm</test>\n<test type='lua'>Arm</test></suite>");
    let outcome = bench.build(&["s.xml"]);
    assert!(outcome.plan.is_none());
    let (dll, lua) = (&outcome.diagnostics[0], &outcome.diagnostics[1]);
    let installed = bench.path("lib/rtf/plugins");
    assert_eq!(
        dll.notes,
        [format!(
            "looked for `Arm.so`, `libArm.so`, `Arm` in\n  {}\n  /p1\n  /p2\n  /l1\n  {installed}",
            bench.path("cell")
        )]
    );
    assert_eq!(
        lua.notes,
        [format!(
            "looked for `Arm.lua`, `Arm` in\n  {}\n  /p1\n  /p2\n  {installed}",
            bench.path("cell")
        )]
    );
    assert_eq!((dll.labels[0].line, dll.labels[0].column), (2, 7));
}

#[test]
fn a_plugin_that_is_missing_in_many_places_is_reported_once() {
    let bench = Bench::new();
    let tests = "<test>Arm</test>\n".repeat(10);
    bench.file("cell/s.xml", &format!("<suite>{tests}</suite>"));
    let outcome = bench.build(&["s.xml"]);
    assert_eq!(outcome.diagnostics.len(), 1);
    assert_eq!(outcome.diagnostics[0].labels.len(), 3);
    assert_eq!(outcome.diagnostics[0].notes[1], "needed in 7 more places");
}

#[test]
fn the_users_python_is_found() {
    let mut bench = Bench::new();
    bench.file("cell/A.py", "");
    bench.file("cell/s.xml", "<suite><test>A.py</test></suite>");
    let host = |bench: &Bench, suite: &str| {
        let host = Arc::clone(&bench.plan(&[suite]).suites[0].tests[0].plugin.host);
        (host.command.clone(), host.env.clone())
    };
    let venv = bench.program("venv/bin/python3", "");
    let path = format!("{}:{}", bench.path("venv/bin"), bench.path("bin"));
    bench.set("PATH", &path);
    let (command, env) = host(&bench, "s.xml");
    assert_eq!(command, [venv.to_str().unwrap(), "-m", "rtf_start", "rtf.host"]);
    // Without our module, the interpreter may have an installed one.
    assert!(env.is_empty());
    // In a source tree; then installed, which comes first.
    bench.file("sdk/python/rtf/host/__main__.py", "");
    bench.set("PYTHONPATH", "/mine");
    let path =
        |folder: &str| vec![("PYTHONPATH".to_owned(), format!("{}:/mine", bench.path(folder)))];
    assert_eq!(host(&bench, "s.xml").1, path("sdk/python"));
    bench.file("share/rtf/python/rtf/host/__main__.py", "");
    assert_eq!(host(&bench, "s.xml").1, path("share/rtf/python"));
    // Directories that a suite adds come after ours.
    bench.file(
        "cell/t.xml",
        "<suite><env name='PYTHONPATH' value='theirs'/><test>A.py</test></suite>",
    );
    let expected = format!("{}:theirs", bench.path("share/rtf/python"));
    assert_eq!(host(&bench, "t.xml").1[0].1, expected);
    // A user's relative path refers to the current directory.
    bench.program("cell/mine/python", "");
    bench.set("RTF_PYTHON", "mine/python");
    bench.file("cell/deep/A.py", "");
    bench.file("cell/deep/s.xml", "<suite><test>A.py</test></suite>");
    assert_eq!(host(&bench, "deep/s.xml").0[0], bench.path("cell/mine/python"));
    let other = bench.program("other/python3.12", "");
    bench.set("RTF_PYTHON", other.to_str().unwrap());
    assert_eq!(host(&bench, "s.xml").0[0], other.to_str().unwrap());
}

#[test]
fn the_users_ruby_is_found() {
    let mut bench = Bench::new();
    bench.file("cell/A.rb", "");
    bench.file("cell/s.xml", "<suite><test>A.rb</test></suite>");
    let path = bench.path("bin");
    bench.set("PATH", &path);
    assert_eq!(bench.build(&["s.xml"]).diagnostics[0].code, "no-such-interpreter");
    let ruby = bench.program("bin/ruby", "");
    bench.file("sdk/ruby/lib/rtf/host.rb", "");
    bench.set("RUBYLIB", "/mine");
    let plugin = bench.plan(&["s.xml"]).suites[0].tests[0].plugin.clone();
    assert_eq!(&*plugin.plugin_type, "ruby");
    let program = "require 'rtf/host'; RTF::Host.main";
    assert_eq!(plugin.host.command, [ruby.to_str().unwrap(), "-e", program, "--"]);
    let library = format!("{}:/mine", bench.path("sdk/ruby/lib"));
    assert_eq!(plugin.host.env, [("RUBYLIB".to_owned(), library)]);
    let other = bench.program("other/ruby3.4", "");
    bench.set("RTF_RUBY", other.to_str().unwrap());
    assert_eq!(
        bench.plan(&["s.xml"]).suites[0].tests[0].plugin.host.command[0],
        other.to_str().unwrap()
    );
}

#[test]
fn a_missing_host_is_reported_once_in_addition_to_missing_plugins() {
    let bench = Bench::new();
    std::fs::remove_file(bench.root.join("bin/rtf-host-lua")).unwrap();
    bench.file("cell/A.lua", "");
    bench.file(
        "cell/s.xml",
        "<suite><test>A.lua</test><test>A.lua</test><test type='lua'>B</test></suite>",
    );
    let codes: Vec<_> = bench.problems(&["s.xml"]).into_iter().map(|(code, _)| code).collect();
    assert_eq!(codes, ["no-such-host", "no-such-plugin"]);
    bench.program("libexec/rtf/rtf-host-lua", "");
    bench.file("cell/B.lua", "");
    let plan = bench.plan(&["s.xml"]);
    let host = &plan.suites[0].tests[0].plugin.host;
    assert_eq!(host.command, [bench.path("libexec/rtf/rtf-host-lua")]);
}
