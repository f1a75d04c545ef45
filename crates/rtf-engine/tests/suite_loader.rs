//! Suite files → what was written: the predecessor's files, every element and
//! attribute, the schema, and whatever else may come.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "that is where a test ends")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use proptest::prelude::*;
use rtf_engine::suite::{
    self, AfterCollapse, FixtureKind, HookKind, Leaks, MiddlewareQuestion, Question, Source, Suite,
    WrittenLimits,
};
use rtf_model::{Diagnostic, Severity, Trigger};

fn data(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(folder);
    let mut files: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

fn file(name: &str) -> (Suite, Vec<Diagnostic>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    let source = suite::open(&path, name).unwrap();
    let mut problems = Vec::new();
    let suite = suite::load(&source, &mut problems).unwrap();
    (suite, problems)
}

fn problems(text: &str) -> Vec<Diagnostic> {
    let mut problems = Vec::new();
    let _ = suite::load(&Source::new("s.xml", text), &mut problems);
    problems
}

/// Code and place of each problem.
fn places(text: &str) -> Vec<(String, u32, u32)> {
    let place = |problem: Diagnostic| {
        let label = problem.labels.first().expect("a place");
        (problem.code.clone(), label.line, label.column)
    };
    problems(text).into_iter().map(place).collect()
}

fn at(code: &str, line: u32, column: u32) -> (String, u32, u32) {
    (code.to_owned(), line, column)
}

#[test]
fn the_predecessors_files_load_unchanged() {
    for path in data("legacy") {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let (suite, problems) = file(&format!("legacy/{name}"));
        assert!(!suite.tests.is_empty(), "{name}");
        let codes: Vec<_> = problems.iter().map(|problem| problem.code.as_str()).collect();
        let expected: &[&str] = if name.starts_with("dashes") { &["comment-dashes"] } else { &[] };
        assert_eq!(codes, expected, "{name}");
        assert!(problems.iter().all(|problem| problem.severity == Severity::Warning));
    }
}

#[test]
fn a_predecessors_file_in_full() {
    let (suite, _) = file("legacy/basics.xml");
    assert_eq!(suite.name.unwrap().value, "Basic checks");
    assert_eq!(suite.description, "Checking the basic features of the robot");
    assert_eq!(suite.environment, "--robot simulator");
    let FixtureKind::Plugin(fixture) = &suite.fixtures[0].body else { panic!("a plug-in") };
    assert_eq!(fixture.name.value, "AppLauncher");
    assert_eq!(fixture.param, "--fixture launch-simulator.xml");
    let tests: Vec<_> = suite
        .tests
        .iter()
        .map(|test| (test.plugin.name.value.as_str(), test.plugin.param.as_str()))
        .collect();
    assert_eq!(
        tests,
        [
            ("SensorRate", "--from sensors_left.ini"),
            ("SensorRate", "--from sensors_right.ini"),
            ("BoardVersions", ""),
        ]
    );
}

#[test]
fn what_is_commented_out_with_dashes_stays_out() {
    let (suite, problems) = file("legacy/dashes-options.xml");
    let params: Vec<_> = suite.tests.iter().map(|test| test.plugin.param.as_str()).collect();
    assert_eq!(params, ["--from arms.ini", "--from torso.ini"]);
    let label = &problems[0].labels[0];
    assert_eq!((label.line, label.column), (6, 34));
    assert_eq!(problems[0].notes, ["one more comment of this file has it"]);
    let (suite, problems) = file("legacy/dashes-ruler.xml");
    assert_eq!(suite.tests[1].plugin.param, "--port /right --name \"right camera\"");
    assert_eq!(problems[0].notes, ["2 more comments of this file have it"]);
}

#[test]
fn positions_after_a_blanked_comment_are_right() {
    let text = "<suite><!-- ü -- ü --><test timeout='x'>A</test></suite>";
    assert_eq!(places(text), [at("comment-dashes", 1, 15), at("invalid-value", 1, 38)]);
    // Also where the parser itself stops.
    let text = "<suite><!-- ü -- ü --><test>A</tset></suite>";
    assert_eq!(places(text), [at("comment-dashes", 1, 15), at("malformed-xml", 1, 30)]);
}

#[test]
fn every_attribute_arrives() {
    let (suite, problems) = file("valid/everything.xml");
    assert!(problems.is_empty(), "{problems:#?}");
    let secs = Duration::from_secs;
    assert_eq!(suite.timeout, Some(secs(5400)));
    assert_eq!(suite.tags, ["hardware", "slow"]);
    assert!(suite.tolerates_collapse);
    assert!(suite.critical_stops_run);
    assert_eq!(suite.parallel, 4);
    assert_eq!(
        suite.env,
        [("ARM_PORT", "17681"), ("EMPTY", "")].map(|(n, v)| (n.into(), v.into()))
    );
    let test = &suite.tests[0];
    assert_eq!(test.name.as_ref().unwrap().value, "reach");
    assert_eq!(test.plugin.name.value, "ReachTest");
    assert_eq!(test.plugin.param, "--n 3 \"a b\"");
    assert_eq!(test.repetitions, 5);
    assert_eq!(
        test.limits,
        WrittenLimits {
            load: Some(secs(11)),
            setup: Some(secs(12)),
            run: Some(secs(120)),
            teardown: Some(secs(13)),
            slow: Some(secs(14)),
            grace: Some(secs(15)),
        }
    );
    assert_eq!((test.after_collapse, test.leaks), (AfterCollapse::Skip, Leaks::Report));
    assert!(test.critical && test.exclusive);
    assert_eq!(test.tags, ["reach", "slow"]);
    assert_eq!(test.env, [("SEED".to_owned(), "7".to_owned())]);
    let other = &suite.tests[1];
    assert!(!other.critical && !other.exclusive);
    assert_eq!((other.after_collapse, other.leaks), (AfterCollapse::Rerun, Leaks::Fail));
    assert_eq!(
        other.limits,
        WrittenLimits {
            load: Some(secs(1)),
            setup: Some(secs(2)),
            run: Some(secs(10)),
            teardown: Some(secs(3)),
            slow: Some(secs(4)),
            grace: Some(Duration::from_millis(500)),
        }
    );
}

#[test]
fn every_part_of_a_process_fixture_arrives() {
    let (suite, _) = file("valid/everything.xml");
    let fixture = &suite.fixtures[0];
    assert_eq!(fixture.setup, Some(Duration::from_secs(20)));
    assert_eq!(fixture.restarts, Some(0));
    assert_eq!(fixture.check_every, Some(Duration::from_secs(2)));
    let FixtureKind::Process(process) = &fixture.body else { panic!("a process") };
    assert_eq!(process.command.value, ["python3", "simulator.py", "two words", "#7"]);
    assert_eq!(process.stop_signal, Some(2));
    assert_eq!(process.stop_grace, Some(Duration::from_secs(3)));
    let asked = |kind, name: &str, min_rate| {
        format!("{:?}", MiddlewareQuestion { kind, name: name.to_owned(), min_rate })
    };
    let kinds = |probes: &[suite::Probe]| {
        let kind = |probe: &suite::Probe| match &probe.question {
            Question::Tcp(address) => address.clone(),
            Question::Http(url) => url.clone(),
            Question::Log(pattern) => pattern.to_string(),
            Question::Command(words) => words.join("|"),
            Question::File(path) => path.clone(),
            Question::Middleware(asked) => format!("{asked:?}"),
        };
        probes.iter().map(kind).collect::<Vec<_>>()
    };
    assert_eq!(
        kinds(&process.ready),
        [
            "127.0.0.1:17681",
            "http://127.0.0.1:8080/health",
            "listening on port \\d+",
            "run/sim.pid",
            "python3|arm_client.py|time",
            &asked("ros-node", "/robot/${param:node=driver}", None),
            &asked("ros-service", "/reset", None),
            &asked("yarp-port", "/icubSim/head/state:o", None),
        ]
    );
    assert_eq!(
        kinds(&process.alive),
        [
            "python3|arm_client.py|time",
            "(?i)fatal",
            "[::1]:17681",
            &asked("ros-topic", "/joint_states", Some(99.5)),
            &asked("ros2-topic", "/joint_states", Some(0.5))
        ]
    );
    assert_eq!(process.ready[0].every, Some(Duration::from_millis(50)));
    assert_eq!(process.ready[0].timeout, Some(Duration::from_millis(500)));
    assert_eq!(suite.fixtures[0].depends, None);
    assert_eq!(suite.fixtures[0].restart_delay, Some(Duration::from_millis(500)));
    assert_eq!(suite.fixtures[1].depends.as_ref().unwrap()[0].value, "sim");
}

#[test]
fn every_part_of_a_hook_arrives() {
    let (suite, _) = file("valid/everything.xml");
    let park = &suite.hooks[0];
    assert_eq!(park.name.as_ref().unwrap().value, "park");
    assert_eq!(
        park.on,
        [
            Trigger::Failure,
            Trigger::Collapse,
            Trigger::Timeout,
            Trigger::Interrupt,
            Trigger::FixtureBroken,
            Trigger::End,
        ]
    );
    assert_eq!(park.timeout, Some(Duration::from_secs(10)));
    assert_eq!(park.env, [("SPEED".to_owned(), "0.1".to_owned())]);
    let HookKind::Plugin(plugin) = &park.body else { panic!("a plug-in") };
    assert_eq!((plugin.name.value.as_str(), plugin.param.as_str()), ("Park.lua", "--slow"));
    let HookKind::Command(command) = &suite.hooks[1].body else { panic!("a command") };
    assert_eq!(command.value, ["python3", "park.py", "--fast"]);
    assert_eq!((suite.hooks[1].timeout, suite.hooks[1].name.is_none()), (None, true));
}

#[test]
fn all_problems_of_a_file_come_at_once_with_their_places() {
    let text = "<suite nam='x'>\n <env name='A=B' value=''/>\n <env name='RTF_SCOPE' value=''/>\n \
                <env value='x'/>\n <env name='C' value='1'/><env name='C' value='2'/>\n \
                stray\n <test>A<env name='x'/>B</test>\n <test> </test>\n</suite>";
    assert_eq!(
        places(text),
        [
            at("unknown-attribute", 1, 8),
            at("stray-text", 6, 2),
            at("invalid-value", 2, 13),
            at("invalid-value", 3, 13),
            at("incomplete", 4, 2),
            at("repeated-variable", 5, 38),
            at("incomplete", 7, 9),
            at("divided-text", 7, 24),
            at("incomplete", 8, 2),
        ]
    );
}

#[test]
fn what_is_wrong_with_a_process_fixture() {
    let fixture = |inside: &str| {
        let text =
            format!("<suite><fixture type='process'>{inside}</fixture><test>A</test></suite>");
        problems(&text).into_iter().map(|problem| problem.message).collect::<Vec<_>>()
    };
    assert_eq!(fixture(""), ["`<fixture>` needs a `<command>` for `type=\"process\"`"]);
    assert_eq!(fixture("<command/>"), ["`<command>` needs a program as its text"]);
    assert_eq!(
        fixture("<command>a 'b</command>"),
        ["`<command>` has a quote that is not closed: `a 'b`"]
    );
    assert_eq!(
        fixture("<command>a | b</command>"),
        ["no shell reads this command: the program gets `|` as an argument"]
    );
    assert_eq!(
        fixture("<command>a</command><command>b</command>"),
        ["`<command>` twice in one fixture"]
    );
    let text = "<suite><fixture type='proces'><command>a</command><stop/></fixture>\
                <fixture><command>a</command></fixture><test>A</test></suite>";
    assert_eq!(places(text), [at("wrong-type", 1, 23), at("wrong-type", 1, 68)]);
    let probe = |probe: &str| fixture(&format!("<command>a</command>{probe}"));
    assert_eq!(
        probe("<ready/>"),
        ["`<ready>` needs one of the attributes `tcp`, `http`, `log`, `file`, `command`, \
          `ros-node`, `ros-topic`, `ros-service`, `ros2-topic`, `yarp-port`"]
    );
    assert_eq!(
        probe("<ready tcp='a:1' file='b'/>"),
        ["`<ready>` asks several things: `tcp` and `file`"]
    );
    assert_eq!(probe("<ready tcp='a:0'/>"), ["`tcp` is not a host and a port: `a:0`"]);
    assert_eq!(probe("<ready http='https://a/'/>"), ["`http` cannot ask over TLS: `https://a/`"]);
    assert_eq!(probe("<ready log='('/>"), ["`log` is not a regular expression: `(`"]);
    assert_eq!(probe("<ready log='x' every='1s'/>"), ["`every` has no effect beside `log`"]);
    assert_eq!(
        probe("<alive log-bad='x' timeout='1s'/>"),
        ["`timeout` has no effect beside `log-bad`"]
    );
    assert_eq!(
        probe("<ready ros-topic='chatter'/>"),
        ["`ros-topic` is not a name from the root: `chatter`"]
    );
    assert_eq!(
        probe("<ready ros2-topic='chatter'/>"),
        ["`ros2-topic` is not a name from the root: `chatter`"]
    );
    assert_eq!(
        probe("<alive ros-topic='/chatter' min-rate='0'/>"),
        ["`min-rate` is not a rate: `0`"]
    );
    assert_eq!(
        probe("<alive ros-node='/talker' min-rate='5'/>"),
        ["`min-rate` has no effect beside `ros-node`"]
    );
    assert_eq!(probe("<stop signal='x'/>"), ["`signal` is not a signal: `x`"]);
}

#[test]
fn files_that_are_no_utf8_or_too_long() {
    let folder = tempfile::tempdir().unwrap();
    let open = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        suite::open(&path, name).map(|_| ()).map_err(|unreadable| Box::new(unreadable.problem))
    };
    let problem = open("a.xml", b"<suite>\n<test>\xe4</test></suite>").unwrap_err();
    assert_eq!(
        (problem.code.as_str(), problem.labels[0].line, problem.labels[0].column),
        ("encoding", 2, 7)
    );
    let latin = "<?xml version='1.0' encoding='ISO-8859-1'?><suite name='ä'/>";
    let problem = open("b.xml", latin.as_bytes()).unwrap_err();
    assert_eq!((problem.code.as_str(), problem.labels[0].column), ("encoding", 31));
    assert!(open("c.xml", b"<?xml version='1.0' encoding='ISO-8859-1'?><suite/>").is_ok());
    assert_eq!(open("d.xml", b"\xff\xfe<\0").unwrap_err().code, "encoding");
    let long = vec![b' '; usize::try_from(suite::MAX_SUITE_BYTES).unwrap() + 1];
    assert_eq!(open("e.xml", &long).unwrap_err().code, "file-too-long");
    assert!(open("f.xml", &long[1..]).is_ok());
    let missing = suite::open(&folder.path().join("g.xml"), "g.xml").unwrap_err().problem;
    assert_eq!(missing.code, "no-such-file");
}

fn xmllint(path: &Path) -> (bool, String) {
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/suite.xsd");
    let output = Command::new("xmllint")
        .args(["--noout", "--nonet", "--schema"])
        .arg(schema)
        .arg(path)
        .output()
        .expect("xmllint, of the package libxml2-utils");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    // 3 and 4: the file does not fit; anything else: the schema or the call is wrong.
    assert!(matches!(output.status.code(), Some(0 | 3 | 4)), "{text}");
    (output.status.success(), text)
}

#[test]
fn the_schema_and_the_loader_accept_the_same_files() {
    let legacy = data("legacy").into_iter().filter(|path| {
        // Not well-formed: no other program reads these.
        !path.file_name().unwrap().to_str().unwrap().starts_with("dashes")
    });
    for path in data("valid").into_iter().chain(legacy) {
        let (valid, said) = xmllint(&path);
        assert!(valid, "{said}");
    }
    for path in data("invalid") {
        let (valid, _) = xmllint(&path);
        assert!(!valid, "the schema accepts {}", path.display());
        let source = suite::open(&path, "a.xml").unwrap();
        let mut found = Vec::new();
        let loaded = suite::load(&source, &mut found);
        // Whether a type is known is for the planner to say.
        let left_to_plan = path.file_stem().unwrap() == "type";
        let refused = loaded.is_none() || found.iter().any(|p| p.severity == Severity::Error);
        assert!(refused != left_to_plan, "{}: {found:?}", path.display());
    }
}

/// Pieces from which texts arise that look like suites.
fn suite_like() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "<suite",
        "<test",
        "<fixture",
        "<hook",
        "</hook>",
        " on='end'",
        "<env",
        "<command>",
        "<ready",
        "</test>",
        "</suite>",
        "</fixture>",
        "</command>",
        " type='process'",
        " timeout='1s'",
        " tcp='a:1'",
        " log='['",
        " name='ä'",
        " value=''",
        ">",
        "/>",
        "<!-- -- -->",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
        "<?xml version='1.0'?>",
        "<!DOCTYPE",
        "&amp;",
        "&x;",
        "A.lua",
        "\n",
        "\r\n",
        " ",
        "\"",
        "'",
        "é",
        "\u{0}",
        " tags='a,b'",
        " depends='x'",
        " xmlns='u'",
        "x:",
        " xmlns:x='u'",
    ]);
    prop::collection::vec(piece, 0..60).prop_map(|pieces| pieces.concat())
}

/// Loads a text and shows that every label lies in it.
fn load_and_check(text: &str) {
    let source = Source::new("s.xml", text);
    let mut problems = Vec::new();
    let suite = suite::load(&source, &mut problems);
    assert!(suite.is_some() || !problems.is_empty());
    for label in problems.iter().flat_map(|problem| &problem.labels) {
        let range = usize::try_from(label.start).unwrap()..usize::try_from(label.end).unwrap();
        assert!(text.get(range).is_some(), "{label:?}");
        assert!(label.line >= 1 && label.column >= 1);
    }
}

proptest! {
    #[test]
    fn no_text_makes_the_loader_panic(text in any::<String>()) {
        load_and_check(&text);
    }

    #[test]
    fn no_text_like_a_suite_makes_the_loader_panic(text in suite_like()) {
        load_and_check(&text);
        load_and_check(&format!("<suite>{text}</suite>"));
    }

    #[test]
    fn no_attribute_value_makes_the_loader_panic(
        name in "timeout|type|param|tags|name|repetition|depends|signal|on|leaks|restart-delay",
        value in "[^<&'\\p{Cc}]*",
    ) {
        load_and_check(&format!("<suite {name}='{value}'><test {name}='{value}'>A</test></suite>"));
        load_and_check(&format!("<suite><fixture type='process'><command>{}</command>\
            <ready log='{value}'/><ready command='{value}'/><ready http='{value}'/>\
            <stop signal='{value}'/></fixture><fixture {name}='{value}'>A</fixture>\
            <hook {name}='{value}'>A</hook><test>A</test></suite>", value.replace("]]>", "")));
    }
}
