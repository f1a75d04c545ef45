//! What is wrong with a file is told, all at once and with its place.

use rtf_engine::suite;

use crate::{at, places, problems};

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

/// The guard, and what finds left processes, rely on them.
#[test]
fn variables_of_rtf_cannot_be_set() {
    for name in ["RTF_CHANNEL", "RTF_OWNER", "RTF_FORK_SERVER", "RTF_FIXTURE_START", "RTF_PORT_X"] {
        let text = format!("<suite><test>A<env name='{name}' value='1'/></test></suite>");
        let told: Vec<_> = problems(&text).into_iter().map(|problem| problem.message).collect();
        assert_eq!(told, [format!("`name` is a variable that rtf sets itself: `{name}`")]);
    }
}

#[test]
fn what_is_wrong_with_a_clock() {
    let clock = |attributes: &str| {
        let text = format!("<suite {attributes}><test>A.lua</test></suite>");
        problems(&text).into_iter().map(|problem| problem.message).collect::<Vec<_>>()
    };
    assert!(clock("clock='wall'").is_empty());
    assert!(clock("clock='file' clock-backstop='1'").is_empty());
    assert_eq!(
        clock("clock='rso' clock-backstop='0'"),
        [
            "`clock` has to be `wall` or `ros` or `ros2` or `yarp` or `file`: `rso`",
            "`clock-backstop` is not a whole number from 1 to 1000000: `0`"
        ]
    );
    let message = "`clock-backstop` has no meaning for the wall clock: `3`";
    assert_eq!(clock("clock-backstop='3'"), [message]);
    assert_eq!(clock("clock='wall' clock-backstop='3'"), [message]);
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
