//! A test with a matrix runs once for each combination.

use insta::assert_snapshot;

use crate::support::Folder;

const MOVES: &str = "TestCase = {}
function TestCase.setup(args) joint = args[1] end
function TestCase.run()
  rtf.check(joint == rtf.parameter('joint'), 'param')
  rtf.check(joint == os.getenv('RTF_PARAM_JOINT'), 'variable')
  rtf.check(not (joint == '1' and rtf.parameter('speed') == 'fast'), 'too fast')
end
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("Move.lua", MOVES).file("speeds.csv", "speed\nslow\nfast\n");
    folder.file(
        "arm.xml",
        "<suite name=\"arm\"><test param=\"${param:joint}\">Move.lua\
         <matrix name=\"joint\" values=\"0 1\"/><matrix values-from=\"speeds.csv\"/></test></suite>",
    );
    folder
}

#[test]
fn each_combination_has_a_verdict_and_is_rerun_alone() {
    let folder = folder();
    assert_eq!(folder.rtf(&["run", "arm.xml"]).code, Some(1));
    let record = folder.journal().record;
    let failed = record.tests.iter().filter(|test| !test.final_verdict().is_green());
    let failed: Vec<_> = failed.map(|test| (test.plan.name.as_str(), test.reason())).collect();
    assert_eq!(failed, [("Move[joint=1,speed=fast]", Some("too fast"))]);
    assert_eq!(folder.rtf(&["run", "--rerun", "failed"]).code, Some(1));
    assert_eq!(folder.journal().record.tests.len(), 1);
    assert_eq!(folder.rtf(&["run", "arm.xml::Move[joint=1,speed=slow]"]).code, Some(0));
    assert_eq!(folder.rtf(&["run", "arm.xml", "-E", "param(joint=0)"]).code, Some(0));
    assert_eq!(folder.journal().record.tests[1].plan.parameters[1].value, "fast");
}

#[test]
fn the_list_shows_combinations() {
    let folder = folder();
    let finished = folder.rtf(&["list", "arm.xml::Move"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    arm/Move[joint=0,speed=slow]
    arm/Move[joint=0,speed=fast]
    arm/Move[joint=1,speed=slow]
    arm/Move[joint=1,speed=fast]
    ----- stderr
    ");
    let finished = folder.rtf(&["list", "--format", "json", "arm.xml", "-E", "param(speed=fast)"]);
    let list: serde_json::Value = serde_json::from_str(&finished.stdout).unwrap();
    assert_eq!(list["tests"][0]["parameters"][0], serde_json::json!({"name":"joint","value":"0"}));
    assert_eq!(list["tests"][1]["select"], "arm.xml::Move[joint=1,speed=fast]");
}
