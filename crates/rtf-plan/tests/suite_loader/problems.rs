//! All problems of a file are reported at once, with their positions.

use rtf_plan::suite;

use crate::{at, positions, problems};

#[test]
fn all_problems_of_a_file_are_reported_at_once() {
    let text = "<suite nam='x'>\n <env name='A=B' value=''/>\n <env name='RTF_SCOPE' value=''/>\n \
                <env value='x'/>\n <env name='C' value='1'/><env name='C' value='2'/>\n \
                stray\n <test>A<env name='x'/>B</test>\n <test> </test>\n</suite>";
    assert_eq!(
        positions(text),
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

/// The guard and the search for leftover processes rely on these variables.
#[test]
fn variables_of_rtf_cannot_be_set() {
    for name in ["RTF_CHANNEL", "RTF_OWNER", "RTF_FORK_SERVER", "RTF_FIXTURE_START", "RTF_PORT_X"] {
        let text = format!("<suite><test>A<env name='{name}' value='1'/></test></suite>");
        let messages: Vec<_> = problems(&text).into_iter().map(|problem| problem.message).collect();
        assert_eq!(messages, [format!("`name` is a variable that rtf sets itself: `{name}`")]);
    }
}

#[test]
fn invalid_clocks() {
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

/// The messages about a process fixture with these elements.
fn fixture(inside: &str) -> Vec<String> {
    let text = format!("<suite><fixture type='process'>{inside}</fixture><test>A</test></suite>");
    problems(&text).into_iter().map(|problem| problem.message).collect()
}

#[test]
fn invalid_process_fixtures() {
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
        fixture("<command>a $PORT</command>"),
        ["no shell reads this command: the program gets `$PORT` as an argument"]
    );
    assert_eq!(
        fixture("<command>PORT=1 a</command>"),
        ["no shell reads this command: `PORT=1` is no program"]
    );
    assert_eq!(
        fixture("<command>source setup.bash</command>"),
        ["no shell reads this command: `source` is a command of a shell"]
    );
    assert_eq!(
        fixture("<command>a</command><command>b</command>"),
        ["`<command>` twice in one fixture"]
    );
    let text = "<suite><fixture type='proces'><command>a</command><stop/></fixture>\
                <fixture><command>a</command></fixture><test>A</test></suite>";
    assert_eq!(positions(text), [at("wrong-type", 1, 23), at("wrong-type", 1, 68)]);
}

#[test]
fn invalid_probes_of_process_fixtures() {
    let probe = |probe: &str| fixture(&format!("<command>a</command>{probe}"));
    assert_eq!(
        probe("<ready/>"),
        ["`<ready>` needs one of the attributes `tcp`, `http`, `log`, `file`, `command`, \
          `ros-node`, `ros-topic`, `ros-service`, `ros2-topic`, `yarp-port`"]
    );
    assert_eq!(
        probe("<ready tcp='a:1' file='b'/>"),
        ["`<ready>` has several probes: `tcp` and `file`"]
    );
    assert_eq!(probe("<ready tcp='a:0'/>"), ["`tcp` is not a host and a port: `a:0`"]);
    assert_eq!(
        probe("<ready http='https://a/'/>"),
        ["`http` supports only plain HTTP, not TLS: `https://a/`"]
    );
    assert_eq!(probe("<ready log='('/>"), ["`log` is not a regular expression: `(`"]);
    assert_eq!(probe("<ready log='x' every='1s'/>"), ["`every` has no effect with `log`"]);
    assert_eq!(
        probe("<alive log-bad='x' timeout='1s'/>"),
        ["`timeout` has no effect with `log-bad`"]
    );
    assert_eq!(
        probe("<ready ros-topic='chatter'/>"),
        ["`ros-topic` is not an absolute name: `chatter`"]
    );
    assert_eq!(
        probe("<ready ros2-topic='chatter'/>"),
        ["`ros2-topic` is not an absolute name: `chatter`"]
    );
    assert_eq!(
        probe("<alive ros-topic='/chatter' min-rate='0'/>"),
        ["`min-rate` is not a rate: `0`"]
    );
    assert_eq!(
        probe("<alive ros-node='/talker' min-rate='5'/>"),
        ["`min-rate` has no effect with `ros-node`"]
    );
    assert_eq!(probe("<stop signal='x'/>"), ["`signal` is not a signal: `x`"]);
    let codes = probe("<stop exit-codes='1 256 x'/>");
    let wrong = |word| format!("`exit-codes` has to be numbers from 0 to 255: `{word}`");
    assert_eq!(codes, [wrong("256"), wrong("x")]);
}

#[test]
fn files_that_are_not_utf8_or_too_long() {
    let dir = tempfile::tempdir().unwrap();
    let open = |name: &str, bytes: &[u8]| {
        let path = dir.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        suite::read_source(&path, name)
            .map(|_| ())
            .map_err(|unreadable| Box::new(unreadable.problem))
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
    let missing = suite::read_source(&dir.path().join("g.xml"), "g.xml").unwrap_err().problem;
    assert_eq!(missing.code, "no-such-file");
}
