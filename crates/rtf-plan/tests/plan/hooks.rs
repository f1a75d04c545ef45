//! Hooks and leaks.

use std::fmt::Write as _;

use insta::assert_snapshot;
use rtf_plan::plan::{FixtureBody, HookBody, Plan};

use crate::bench::Bench;

/// A bench with a test, a fixture and two hooks.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/F.lua", "");
    bench.file("cell/Park.lua", "");
    bench.program("cell/park.sh", "");
    bench
}

/// Returns a suite with a hook, given its attributes and its content.
fn hook(attributes: &str, inside: &str) -> String {
    format!("<suite>\n<hook {attributes}>{inside}</hook>\n<test>A.lua</test></suite>")
}

/// Formats the fixtures, hooks and tests of a plan.
fn shown(bench: &Bench, plan: &Plan) -> String {
    let mut out = String::new();
    let suite = &plan.suites[0];
    for fixture in &suite.fixtures {
        let kind = match &fixture.body {
            FixtureBody::Plugin(plugin) => &plugin.plugin_type,
            FixtureBody::Process(_) => "process",
            FixtureBody::Attached(_) => "attached",
        };
        let (id, name, delay) = (fixture.id, &fixture.name, fixture.restart_delay);
        writeln!(
            out,
            "fixture {id} {name} ({kind}) depends {:?} restart {delay:?}",
            fixture.depends
        )
        .unwrap();
    }
    for hook in &suite.hooks {
        let on: Vec<_> = hook.on.iter().map(|trigger| trigger.as_str()).collect();
        let body = match &hook.body {
            HookBody::Plugin(plugin) => format!("{} {:?}", plugin.file.display(), plugin.args),
            HookBody::Command(words) => format!("{words:?}"),
        };
        let (id, name, timeout, env) = (hook.id, &hook.name, hook.timeout, &hook.env);
        writeln!(out, "hook {id} {name} on {} within {timeout:?} env {env:?}", on.join(" "))
            .unwrap();
        writeln!(out, "  {body}").unwrap();
    }
    for test in &suite.tests {
        writeln!(out, "test {} {} leaks {:?}", test.id, test.name, test.settings.leaks).unwrap();
    }
    out.replace(&bench.root.display().to_string(), "[ROOT]")
}

#[test]
fn a_suite_with_hooks_and_leaks() {
    let bench = bench();
    bench.file(
        "cell/s.xml",
        "<suite leaks='fail'>\n\
         <fixture name='driver' depends='sim' restart-delay='1s'>F.lua</fixture>\n\
         <fixture name='sim' type='process' depends=''><command>./park.sh sim</command></fixture>\n\
         <hook on='failure, collapse timeout' name='park' param='--slow' timeout='10s'> Park.lua\n\
           <env name='SPEED' value='0.1'/>\n\
         </hook>\n\
         <hook on='end end'>Park.lua</hook>\n\
         <hook on='interrupt fixture-broken'><command>./park.sh --fast 'a b'</command></hook>\n\
         <hook on='end'>Park.lua</hook>\n\
         <hook on='end'><command>here</command><env name='PATH' value='tools'/></hook>\n\
         <test>A.lua</test><test leaks='report'>A.lua</test></suite>",
    );
    bench.program("cell/tools/here", "");
    let plan = bench.plan(&["s.xml"]);
    assert_eq!(plan.hooks, 5);
    assert_snapshot!(shown(&bench, &plan), @r#"
    fixture 0 sim (process) depends [] restart 100ms
    fixture 1 driver (lua) depends [0] restart 1s
    hook 0 park on failure collapse timeout within 10s env [("SPEED", "0.1")]
      [ROOT]/cell/Park.lua ["--slow"]
    hook 1 Park on end within 30s env []
      [ROOT]/cell/Park.lua []
    hook 2 park.sh on interrupt fixture-broken within 30s env []
      ["[ROOT]/cell/park.sh", "--fast", "a b"]
    hook 3 Park#2 on end within 30s env []
      [ROOT]/cell/Park.lua []
    hook 4 here on end within 30s env [("PATH", "tools")]
      ["[ROOT]/cell/tools/here"]
    test 0 A leaks Fail
    test 1 A#2 leaks Report
    "#);
}

#[test]
fn ids_of_hooks_continue_in_the_next_suite() {
    let bench = bench();
    bench.file("cell/s.xml", &hook("on='end'", "Park.lua"));
    let plan = bench.plan(&["s.xml", "s.xml", "A.lua"]);
    let ids: Vec<_> =
        plan.suites.iter().flat_map(|suite| &suite.hooks).map(|hook| hook.id.0).collect();
    assert_eq!((plan.hooks, ids), (2, vec![0, 1]));
}

#[test]
fn on_is_required_and_known() {
    let bench = bench();
    assert_snapshot!(bench.shown(&hook("", "Park.lua")), @"
    incomplete: `<hook>` needs the attribute `on` with its triggers
      2:1 <hook
    ");
    assert_snapshot!(bench.shown(&hook("on=' , '", "Park.lua")), @"
    invalid-value: `on` names no trigger: `,`
      2:11 ,
      hint: the triggers are `failure`, `collapse`, `timeout`, `interrupt`, `fixture-broken`, `end`
    ");
    assert_snapshot!(bench.shown(&hook("on='colapse end crash'", "Park.lua")), @"
    invalid-value: unknown trigger `colapse`
      2:11 colapse not known in `on`
      note: the triggers are `failure`, `collapse`, `timeout`, `interrupt`, `fixture-broken`, `end`
      hint: did you mean `collapse`?
    invalid-value: unknown trigger `crash`
      2:23 crash not known in `on`
      note: the triggers are `failure`, `collapse`, `timeout`, `interrupt`, `fixture-broken`, `end`
    ");
}

#[test]
fn a_plugin_or_a_command() {
    let bench = bench();
    assert_snapshot!(bench.shown(&hook("on='end'", " ")), @"
    incomplete: `<hook>` needs the name of a plug-in as its text, or a `<command>`
      2:1 <hook
    ");
    let program = "<command>./park.sh</command>";
    assert_snapshot!(bench.shown(&hook("on='end' type='lua' param='-x'", program)), @"
    without-effect: `type` has no effect with `<command>`
      2:16 type
      hint: a program has no type; remove the attribute
    without-effect: `param` has no effect with `<command>`
      2:27 param
      hint: write the arguments after the program, in `<command>`
    ");
    assert_snapshot!(bench.shown(&hook("on='end'", &format!("Park.lua{program}{program}"))), @"
    wrong-type: the hook has a plug-in and a `<command>`
      2:16 Park.lua the plug-in
      hint: write two hooks; both are run
    repeated-element: `<command>` twice in one hook
      2:52 <command the second one
      2:24 <command the first one
    ");
    assert_snapshot!(bench.shown(&hook("on='end' type='process'", "./park.sh")), @"
    unknown-type: unknown type `process`
      2:22 process
      note: known types are `dll`, `lua`, `python`, `ruby`
      hint: a program is written as `<command>`, without a `type`
    ");
}

#[test]
fn missing_plugins_and_programs_of_hooks() {
    let bench = bench();
    assert_snapshot!(bench.shown(&hook("on='end'", "Parc.lua")), @"
    no-such-plugin: there is no plug-in `Parc.lua` of type `lua`
      2:16 Parc.lua
      note: looked for `Parc.lua` in
      [ROOT]/cell
      [ROOT]/lib/rtf/plugins
      hint: did you mean `Park.lua`?
    ");
    assert_snapshot!(bench.shown(&hook("on='end'", "<command>./parc.sh</command>")), @"
    no-such-program: there is no program `./parc.sh`
      2:25 ./parc.sh
      note: looked for [ROOT]/cell/parc.sh
    ");
    assert_snapshot!(bench.shown(&hook("on='end'", "<command/>")), @"
    incomplete: `<command>` needs a program as its text
      2:16 <command
    ");
}

#[test]
fn hooks_belong_to_suites_and_have_unique_names() {
    let bench = bench();
    let text = "<suite>\n<hook on='end' name='park' retries='1'>Park.lua</hook>\n\
                <hook on='end' name='park'>Park.lua<env name='RTF_HOOK_TEST' value='x'/></hook>\n\
                <fixture>F.lua<hook on='end'>Park.lua</hook></fixture>\n\
                <test name='park'>A.lua<hook on='end'>Park.lua</hook></test></suite>";
    assert_snapshot!(bench.shown(text), @"
    unknown-attribute: unknown attribute `retries`
      2:28 retries not known in `<hook>`
      note: `<hook>` can have the attributes `name`, `on`, `type`, `param`, `timeout`
    duplicate-name: two hooks are named `park`
      3:22 park the second one
      2:22 park the first one
      hint: give one of them another `name`
    invalid-value: `name` is a variable that rtf sets itself: `RTF_HOOK_TEST`
      3:47 RTF_HOOK_TEST
    unknown-element: unknown element `<hook>`
      4:15 <hook not known in `<fixture>`
      note: `<fixture>` can have the elements `env`, `provide`, `reset`
      hint: `<hook>` is written directly in `<suite>`
    unknown-element: unknown element `<hook>`
      5:24 <hook not known in `<test>`
      note: `<test>` can have the elements `env`, `matrix`, `matrix-exclude`, `learn`, `monitor`, `fault`
      hint: `<hook>` is written directly in `<suite>`
    ");
}

#[test]
fn leaks_are_reported_or_fail() {
    let text = "<suite leaks='yes'>\n<test leaks='repot'>A.lua</test></suite>";
    assert_snapshot!(bench().shown(text), @"
    invalid-value: `leaks` has to be `report` or `fail`: `yes`
      1:15 yes
    invalid-value: `leaks` has to be `report` or `fail`: `repot`
      2:14 repot
      hint: did you mean `report`?
    ");
}

#[test]
fn a_reset_has_a_plugin_or_a_command() {
    let bench = bench();
    let reset = |reset: &str| {
        format!(
            "<suite name='s'>\n<fixture type='process'><command>sleep 9</command>{reset}</fixture>\n<test>A.lua</test></suite>"
        )
    };
    assert_snapshot!(bench.shown(&reset("<reset/>")), @"
    incomplete: `<reset>` needs the attribute `command`, or the name of a plug-in as its text
      2:51 <reset
    ");
    assert_snapshot!(bench.shown(&reset("<reset command='true' type='lua'>Park.lua</reset>")), @"
    without-effect: `type` has no effect with `command`
      2:73 type
      hint: a program has no type; remove the attribute
    wrong-type: the reset has a plug-in and a `command`
      2:84 Park.lua the plug-in
      hint: remove one of them
    ");
    assert_snapshot!(bench.shown(&reset("<reset>Missing.lua</reset>")), @"
    no-such-plugin: there is no plug-in `Missing.lua` of type `lua`
      2:58 Missing.lua
      note: looked for `Missing.lua` in
      [ROOT]/cell
      [ROOT]/lib/rtf/plugins
      hint: `RTF_PLUGIN_PATH` adds directories to the search
    ");
}
