//! Suites that are XML with invalid elements, attributes or values.

use insta::assert_snapshot;

use crate::bad_input::{LUA_TEST, refused, refused_suite};
use crate::support::Folder;

#[test]
fn an_unknown_element() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <tets>EncoderTest.lua</tets>\n</suite>\n"), @"
    error: unknown element `<tets>`
     --> arm.xml:2:3
      |
    2 |   <tets>EncoderTest.lua</tets>
      |   ^^^^^ not known in `<suite>`
      |
      = note: `<suite>` can have the elements `description`, `environment`, `env`, `fixture`, `hook`, `signal`, `signals`, `monitor`, `envelope`, `fault`, `test`
      = help: did you mean `test`?

    1 error; nothing was started
    ");
}

#[test]
fn an_unknown_attribute() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <test timout=\"3s\">EncoderTest.lua</test>\n</suite>\n"), @r#"
    error: unknown attribute `timout`
     --> arm.xml:2:9
      |
    2 |   <test timout="3s">EncoderTest.lua</test>
      |         ^^^^^^ not known in `<test>`
      |
      = note: `<test>` can have the attributes `name`, `type`, `param`, `cases`, `repetition`, `tags`, `timeout`, `case-timeout`, `load-timeout`, `setup-timeout`, `teardown-timeout`, `slow`, `grace`, `after-collapse`, `leaks`, `retries`, `retry-delay`, `critical`, `exclusive`, `isolation`, `middleware`, `fork`, `slots`, `max-steps`, `max-time`, `expect`, `issue`, `until`, `was`
      = help: did you mean `timeout`?

    1 error; nothing was started
    "#);
}

#[test]
fn values_of_the_wrong_type() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <test timeout=\"soon\" repetition=\"-1\" critical=\"yes\" after-collapse=\"again\">EncoderTest.lua</test>\n</suite>\n"), @r#"
    error: `timeout` is not a duration: `soon`
     --> arm.xml:2:18
      |
    2 |   <test timeout="soon" repetition="-1" critical="yes" after-collapse="again">EncoderTest.lua</test>
      |                  ^^^^
      |
      = help: write it like `250ms`, `1.5s`, `2min` or `1h 30m`; a bare number is seconds

    error: `repetition` is not a whole number from 1 to 1000000: `-1`
     --> arm.xml:2:36
      |
    2 |   <test timeout="soon" repetition="-1" critical="yes" after-collapse="again">EncoderTest.lua</test>
      |                                    ^^

    error: `critical` has to be `true` or `false`: `yes`
     --> arm.xml:2:50
      |
    2 |   <test timeout="soon" repetition="-1" critical="yes" after-collapse="again">EncoderTest.lua</test>
      |                                                  ^^^

    error: `after-collapse` has to be `rerun` or `fail` or `skip`: `again`
     --> arm.xml:2:71
      |
    2 |   <test timeout="soon" repetition="-1" critical="yes" after-collapse="again">EncoderTest.lua</test>
      |                                                                       ^^^^^

    4 errors; nothing was started
    "#);
}

#[test]
fn two_tests_of_one_name() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <test name=\"rate\">EncoderTest.lua</test>\n  <test name=\"rate\">EncoderTest.lua</test>\n</suite>\n"), @r#"
    error: two tests are named `rate`
     --> arm.xml:3:15
      |
    2 |   <test name="rate">EncoderTest.lua</test>
      |               ---- the first one
    3 |   <test name="rate">EncoderTest.lua</test>
      |               ^^^^ the second one
      |
      = help: give one of them another `name`

    1 error; nothing was started
    "#);
}

#[test]
fn an_unknown_type() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <test type=\"lau\">EncoderTest</test>\n</suite>\n"), @r#"
    error: unknown type `lau`
     --> arm.xml:2:15
      |
    2 |   <test type="lau">EncoderTest</test>
      |               ^^^
      |
      = note: known types are `dll`, `lua`, `python`, `ruby`, `gtest`, `catch2`, `doctest`, `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`
      = help: did you mean `lua`?

    1 error; nothing was started
    "#);
}

#[test]
fn a_suite_without_tests() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <description>empty</description>\n</suite>\n"), @r#"
    error: the suite has no tests
     --> arm.xml:1:1
      |
    1 | <suite name="arm">
      | ^^^^^^ contains no `<test>`

    1 error; nothing was started
    "#);
}

#[test]
fn five_mistakes_are_five_messages() {
    let folder = Folder::new();
    folder.file("EncoderTest.lua", LUA_TEST);
    folder.file(
        "arm.xml",
        "<suite name=\"arm\" tag=\"smoke\">\n  <fixtures/>\n  <test timeout=\"soon\">EncoderTest.lua</test>\n  \
         <test type=\"rust\">EncoderTest</test>\n  <test>Missing.lua</test>\n</suite>\n",
    );
    let shown = refused(&folder, &["check", "arm.xml"]);
    let errors: Vec<&str> = shown.lines().filter(|line| line.starts_with("error")).collect();
    assert_eq!(errors.len(), 5, "{shown}");
    assert_snapshot!(shown, @r#"
    error: unknown attribute `tag`
     --> arm.xml:1:19
      |
    1 | <suite name="arm" tag="smoke">
      |                   ^^^ not known in `<suite>`
      |
      = note: `<suite>` can have the attributes `name`, `timeout`, `tags`, `isolate`, `requires`, `critical-stops`, `parallel`, `middleware`, `clock`, `clock-backstop`, `tolerate-collapse`, `skips`, `after-collapse`, `leaks`, `retries`, `retry-delay`, `test-timeout`, `test-load-timeout`, `test-setup-timeout`, `test-teardown-timeout`, `test-slow`, `test-grace`
      = help: did you mean `tags`?

    error: unknown element `<fixtures>`
     --> arm.xml:2:3
      |
    2 |   <fixtures/>
      |   ^^^^^^^^^ not known in `<suite>`
      |
      = note: `<suite>` can have the elements `description`, `environment`, `env`, `fixture`, `hook`, `signal`, `signals`, `monitor`, `envelope`, `fault`, `test`
      = help: did you mean `fixture`?

    error: `timeout` is not a duration: `soon`
     --> arm.xml:3:18
      |
    3 |   <test timeout="soon">EncoderTest.lua</test>
      |                  ^^^^
      |
      = help: write it like `250ms`, `1.5s`, `2min` or `1h 30m`; a bare number is seconds

    error: unknown type `rust`
     --> arm.xml:4:15
      |
    4 |   <test type="rust">EncoderTest</test>
      |               ^^^^
      |
      = note: known types are `dll`, `lua`, `python`, `ruby`, `gtest`, `catch2`, `doctest`, `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`

    error: there is no plug-in `Missing.lua` of type `lua`
     --> arm.xml:5:9
      |
    5 |   <test>Missing.lua</test>
      |         ^^^^^^^^^^^
      |
      = note: looked for `Missing.lua` in
                [FOLDER]
                [PREFIX]/lib/rtf/plugins
                [ROOT]/fixtures
      = help: `RTF_PLUGIN_PATH` adds directories to the search

    5 errors; nothing was started
    "#);
}
