//! Missing or broken plug-ins and hosts are reported before anything is started.

use std::path::Path;

use insta::assert_snapshot;

use crate::bad_input::{LUA_TEST, refused};
use crate::support::Folder;

/// A folder with one suite of one test or fixture.
pub fn folder(element: &str) -> Folder {
    let folder = Folder::new();
    folder.file("arm.xml", &format!("<suite name=\"arm\">\n  {element}\n</suite>\n"));
    folder
}

#[test]
fn a_plug_in_that_is_not_there() {
    let folder = folder("<test type=\"dll\">SensorTest</test>");
    let output =
        folder.command(&["run", "arm.xml"]).env("RTF_PLUGIN_PATH", "build:/opt/robot").output();
    let output = output.expect("rtf runs");
    assert_eq!(output.status.code(), Some(2));
    assert_snapshot!(folder.redact_paths(&String::from_utf8_lossy(&output.stderr)), @r#"
    error: there is no plug-in `SensorTest` of type `dll`
     --> arm.xml:2:20
      |
    2 |   <test type="dll">SensorTest</test>
      |                    ^^^^^^^^^^
      |
      = note: looked for `SensorTest.so`, `libSensorTest.so`, `SensorTest` in
                [FOLDER]
                [FOLDER]/build
                /opt/robot
                [PREFIX]/lib/rtf/plugins
                [ROOT]/fixtures
      = help: `RTF_PLUGIN_PATH` adds directories to the search

    1 error; nothing was started
    "#);
}

#[test]
fn a_plug_in_with_a_similar_name() {
    let folder = folder("<test type=\"lua\">EncodrTest</test>");
    folder.file("EncoderTest.lua", LUA_TEST);
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @r#"
    error: there is no plug-in `EncodrTest` of type `lua`
     --> arm.xml:2:20
      |
    2 |   <test type="lua">EncodrTest</test>
      |                    ^^^^^^^^^^
      |
      = note: looked for `EncodrTest.lua`, `EncodrTest` in
                [FOLDER]
                [PREFIX]/lib/rtf/plugins
                [ROOT]/fixtures
      = help: did you mean `EncoderTest`?

    1 error; nothing was started
    "#);
}

#[test]
fn a_syntax_error_in_lua() {
    let folder = folder("<test>EncoderTest.lua</test>");
    folder.file(
        "EncoderTest.lua",
        "TestCase = {}\n\nfunction TestCase.run(\n  rtf.fail('no')\nend\n",
    );
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: the plug-in `EncoderTest.lua` cannot be loaded: ')' expected near '.'
     --> arm.xml:2:9
      |
    2 |   <test>EncoderTest.lua</test>
      |         ^^^^^^^^^^^^^^^ needed here
      |
     ::: [FOLDER]/EncoderTest.lua:4:3
      |
    4 |   rtf.fail('no')
      |   -------------- ')' expected near '.'

    1 error; nothing was started
    ");
}

#[test]
fn a_syntax_error_in_python() {
    let folder = folder("<test>encoder.py</test>");
    folder.file(
        "encoder.py",
        "import rtf\n\nclass Encoder(rtf.TestCase):\n    def run(self)\n        self.fail('no')\n",
    );
    let shown = refused(&folder, &["run", "arm.xml"]);
    // Pythons before 3.10 do not say what they expected.
    assert_snapshot!(shown.replace("invalid syntax", "expected ':'"), @"
    error: the plug-in `encoder.py` cannot be loaded: expected ':'
     --> arm.xml:2:9
      |
    2 |   <test>encoder.py</test>
      |         ^^^^^^^^^^ needed here
      |
     ::: [FOLDER]/encoder.py:4:5
      |
    4 |     def run(self)
      |     ------------- expected ':'

    1 error; nothing was started
    ");
}

#[test]
fn a_fixture_that_is_used_as_a_test() {
    let folder = folder("<test>Driver.lua</test>");
    folder.file("Driver.lua", "FixtureManager = {}\nfunction FixtureManager.setup() end\n");
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: the plug-in `Driver.lua` is a fixture, not a test
     --> arm.xml:2:9
      |
    2 |   <test>Driver.lua</test>
      |         ^^^^^^^^^^ used here
      |
      = help: in a suite it is written as `<fixture>`

    1 error; nothing was started
    ");
    assert_snapshot!(refused(&folder, &["run", "Driver.lua"]), @"
    error: the plug-in `Driver.lua` is a fixture, not a test
     |
     = help: in a suite it is written as `<fixture>`

    1 error; nothing was started
    ");
}

#[test]
fn a_test_that_is_used_as_a_fixture() {
    let folder = folder("<fixture>EncoderTest.lua</fixture>\n  <test>EncoderTest.lua</test>");
    folder.file("EncoderTest.lua", LUA_TEST);
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: the plug-in `EncoderTest.lua` is a test, not a fixture
     --> arm.xml:2:12
      |
    2 |   <fixture>EncoderTest.lua</fixture>
      |            ^^^^^^^^^^^^^^^ used here
      |
      = help: in a suite it is written as `<test>`

    1 error; nothing was started
    ");
}

/// What is printed for a Python test when the environment is so.
fn without_python(variable: &str, value: &Path) -> String {
    let folder = folder("<test>encoder.py</test>");
    folder.file("encoder.py", "import rtf\nclass Encoder(rtf.TestCase):\n    pass\n");
    let mut command = folder.command(&["run", "arm.xml"]);
    let output = command.env("PATH", "/nowhere").env(variable, value).output().expect("rtf runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(!folder.path().join("rtf-results").exists(), "nothing was started");
    folder.redact_paths(&String::from_utf8_lossy(&output.stderr))
}

#[test]
fn an_interpreter_that_is_not_there() {
    assert_snapshot!(without_python("PATH", Path::new("/nowhere")), @"
    error: plug-ins of type `python` need `python3`, which is missing
     --> arm.xml:2:9
      |
    2 |   <test>encoder.py</test>
      |         ^^^^^^^^^^ needed here
      |
      = note: searched `PATH`:
                /nowhere
      = help: install it, or select another one in `RTF_PYTHON`

    1 error; nothing was started
    ");
}

#[test]
fn an_interpreter_that_was_named_and_is_not_there() {
    assert_snapshot!(without_python("RTF_PYTHON", Path::new("python2.4")), @"
    error: the interpreter `python2.4` is missing
     --> arm.xml:2:9
      |
    2 |   <test>encoder.py</test>
      |         ^^^^^^^^^^ needed here
      |
      = note: searched `PATH`:
                /nowhere
      = note: `RTF_PYTHON` selects it

    1 error; nothing was started
    ");
}

#[test]
fn an_interpreter_that_is_none() {
    assert_snapshot!(without_python("RTF_PYTHON", Path::new("/bin/false")), @"
    error: the host `/bin/false -m rtf_start rtf.host` does not work: exit code 1
     --> arm.xml:2:9
      |
    2 |   <test>encoder.py</test>
      |         ^^^^^^^^^^ needed here
      |
      = help: `/bin/false -m rtf_start rtf.host --check` must exit with code 0

    1 error; nothing was started
    ");
}

#[test]
fn a_plug_in_with_nothing_in_it() {
    let folder = folder("<fixture>Arm.py</fixture>\n  <test>Encoder.rb</test>");
    folder.file("Arm.py", "import rtf\n").file("Encoder.rb", "class Encoder; end\n");
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: `Arm.py` contains no fixture
     --> arm.xml:2:12
      |
    2 |   <fixture>Arm.py</fixture>
      |            ^^^^^^ used here
      |
      = help: a fixture is a class that derives from `rtf.FixtureManager`

    error: `Encoder.rb` contains no test
     --> arm.xml:3:9
      |
    3 |   <test>Encoder.rb</test>
      |         ^^^^^^^^^^ used here
      |
      = help: a test is a class that derives from `RTF::TestCase`

    2 errors; nothing was started
    ");
}
