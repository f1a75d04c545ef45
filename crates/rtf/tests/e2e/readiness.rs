//! Process fixtures, hooks and tests whose programs print as real ones do, and whose reasons are
//! what their programs said.

use rtf_model::{TestId, Verdict};

use crate::support::{Finished, Folder, nothing_left};

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() end\n";

/// A shell's command that prints and then runs for long.
fn printing(format: &str) -> String {
    format!("sh -c 'printf \"{format}\"; exec sleep 1000'")
}

fn folder(children: &str) -> Folder {
    let folder = Folder::new();
    let suite = format!("<suite name='s'>\n  {children}\n  <test>Passes.lua</test>\n</suite>\n");
    folder.file("Passes.lua", PASSES).file("s.xml", &suite);
    folder
}

fn output(finished: &Finished) -> String {
    format!("{}{}", finished.stdout, finished.stderr)
}

fn broken(folder: &Folder) -> String {
    folder.journal().record.fixtures[0].broken.clone().expect("a broken fixture")
}

#[test]
fn a_log_pattern_matches_what_a_terminal_shows() {
    let fixtures = [
        ("prompt", "boot\\npxh> ", "^pxh> $"),
        ("colours", "\\033[1;32mREADY\\033[0m on 5\\n", "^READY on 5$"),
        ("windows", "up\\r\\n", "^up$"),
        ("progress", "\\r 50 %%\\r100 %%\\r", "^100 %$"),
    ]
    .map(|(name, format, pattern)| {
        format!(
            "<fixture type='process' name='{name}' depends='' restarts='0'>\
             <command>{}</command><ready log='{pattern}'/></fixture>",
            printing(format)
        )
    });
    let folder = folder(&fixtures.join("\n  "));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}", output(&finished));
    assert!(nothing_left(&folder));
}

#[test]
fn a_line_without_an_end_provides_whole_values() {
    let folder = Folder::new();
    let test = "TestCase = {}\nfunction TestCase.setup(args) ports = table.concat(args, ' ') end\n\
                function TestCase.run() rtf.check(ports == '4711 4712', ports) end\n";
    let fixture = |name, format| {
        format!(
            "<fixture type='process' name='{name}' depends='' restarts='0'><command>{}</command>\
             <provide name='port' log='port (\\d+)'/></fixture>",
            printing(format)
        )
    };
    let fixtures = fixture("a", "port 4711 pxh> ") + &fixture("b", "\\033[1mport\\033[0m 4712");
    let suite = format!(
        "<suite name='s'>{fixtures}\
         <test param='${{fixture:a.port}} ${{fixture:b.port}}'>Ports.lua</test></suite>"
    );
    folder.file("Ports.lua", test).file("s.xml", &suite);
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}", output(&finished));
}

#[test]
fn a_bad_line_in_colours_and_without_an_end_is_a_collapse() {
    let program = "echo up; until test -e go; do sleep 0.01; done; \
                   printf \"\\033[31mFATAL\\033[0m: motor 3 \"; exec sleep 1000";
    let folder = Folder::new();
    let test = "TestCase = {}\nfunction TestCase.run()\n  io.open('go', 'w'):close()\n  \
                while true do rtf.sleep(0.01) end\nend\n";
    let suite = format!(
        "<suite name='s'><fixture type='process' name='sim' restarts='0'><command>sh -c '{program}'\
         </command><ready log='up'/><alive log-bad='^FATAL: motor'/></fixture>\
         <test>Runs.lua</test></suite>"
    );
    folder.file("Runs.lua", test).file("s.xml", &suite);
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}", output(&finished));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let reason = "fixture `sim` collapsed: it printed `FATAL: motor 3 `";
    assert_eq!(record.tests[0].reason(), Some(reason));
}

/// A fixture in Python that prints into a pipe.
fn python(env: &str, timeout: &str) -> Folder {
    let program = "import time\nprint('up')\ntime.sleep(1000)\n";
    let fixture = format!(
        "<fixture type='process' name='sim' restarts='0' timeout='{timeout}'>{env}\
         <command>python3 sim.py</command><ready log='^up$'/></fixture>"
    );
    let folder = folder(&fixture);
    folder.file("sim.py", program);
    folder
}

#[test]
fn what_a_program_in_python_prints_arrives_at_once() {
    let folder = python("", "60s");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}", output(&finished));
}

#[test]
fn the_suite_decides_whether_python_has_a_buffer() {
    let folder = python("<env name='PYTHONUNBUFFERED' value=''/>", "1500ms");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let reason = broken(&folder);
    assert!(reason.contains("no line matched `^up$`; it printed nothing"), "{reason}");
    assert!(reason.contains("`stdbuf -oL`"), "{reason}");
}

#[test]
fn a_program_that_printed_something_has_no_hint_about_its_buffer() {
    let command = printing("down\\n");
    let folder = folder(&format!(
        "<fixture type='process' name='sim' restarts='0' timeout='1500ms'><command>{command}</command>\
         <ready log='^up$'/></fixture>"
    ));
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let reason = broken(&folder);
    assert!(reason.ends_with("no line matched `^up$`"), "{reason}");
}

fn script(folder: &Folder, name: &str, text: &str) {
    use std::os::unix::fs::PermissionsExt as _;
    folder.file(name, text);
    let mode = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(folder.path().join(name), mode).expect("the mode");
}

#[test]
fn a_missing_interpreter_is_found_before_anything_starts() {
    let nowhere = ("#!/usr/bin/nowhere\n", "its interpreter `/usr/bin/nowhere` does not exist");
    let windows = ("#!/bin/sh\r\nexit 0\r\n", "ends with a carriage return, as on Windows");
    let searched = ("#!/usr/bin/env nowhere\n", "there is no program `nowhere`, its interpreter");
    for (text, problem) in [nowhere, windows, searched] {
        for element in [
            "<fixture type='process'><command>./run.sh</command></fixture>",
            "<fixture type='process' name='f'><command>sleep 9</command><ready command='./run.sh'/></fixture>",
            "<hook on='end'><command>./run.sh</command></hook>",
            "<test type='program'>run.sh</test>",
        ] {
            let folder = folder(element);
            script(&folder, "run.sh", text);
            let finished = folder.rtf(&["check", "s.xml"]);
            assert_ne!(finished.code, Some(0), "{element}");
            assert!(finished.stderr.contains("run.sh` cannot be started: "), "{}", finished.stderr);
            assert!(finished.stderr.contains(problem), "{}", finished.stderr);
        }
    }
}

#[test]
fn a_missing_interpreter_is_named_by_what_could_not_be_started() {
    let broken_script = "printf \"#!/usr/bin/nowhere\\n\" > run.sh";
    let folder = folder(&format!(
        "<fixture type='process' name='first'><command>sh -c '{broken_script}; echo up; exec sleep 1000'\
         </command><ready log='up'/></fixture>\
         <fixture type='process' name='second' restarts='0'><command>./run.sh</command></fixture>\
         <hook on='end' name='park'><command>./run.sh</command></hook>"
    ));
    script(&folder, "run.sh", "#!/bin/sh\n");
    assert_ne!(folder.rtf(&["run", "s.xml"]).code, Some(0));
    let record = folder.journal().record;
    let fixture = record.fixtures[1].broken.as_deref().unwrap_or_default();
    let hook = record.hooks[0].runs[0].problem().unwrap_or_default();
    for reason in [fixture, hook] {
        assert!(reason.contains("its interpreter `/usr/bin/nowhere` does not exist"), "{reason}");
    }
}

#[test]
fn reasons_are_what_the_program_said() {
    let program = "import sys\nprint('\\x1b[32mstarting\\x1b[0m')\n\
                   try:\n    raise ValueError('no arm\\nat all')\n\
                   except ValueError:\n    import traceback\n    traceback.print_exc()\n\
                   print('bye', file=sys.stderr)\nsys.exit(3)\n";
    let folder = Folder::new();
    let suites = [
        "<suite name='fixture'><fixture type='process' name='sim' restarts='0'>\
         <command>python3 sim.py</command><ready log='never'/></fixture>\
         <test>Passes.lua</test></suite>",
        "<suite name='program'><test type='program'>sim.py</test></suite>",
        "<suite name='hook'><hook on='end' name='park'><command>python3 sim.py</command></hook>\
         <test>Passes.lua</test></suite>",
    ];
    script(&folder, "sim.py", &format!("#!/usr/bin/env python3\n{program}"));
    folder.file("Passes.lua", PASSES);
    for (number, suite) in suites.iter().enumerate() {
        folder.file(&format!("{number}.xml"), suite);
    }
    let finished = folder.rtf(&["run", "--report", "junit=j.xml", "0.xml", "1.xml", "2.xml"]);
    let record = folder.journal().record;
    let broken = record.fixtures[0].broken.as_deref();
    let reason = "it ended with exit code 3 before it was ready: ValueError: no arm";
    assert_eq!(broken, Some(format!("set-up failed: {reason}").as_str()), "{}", output(&finished));
    let skipped = record.tests[0].reason().unwrap_or_default();
    assert!(skipped.ends_with(reason), "{skipped}");
    assert_eq!(record.tests[1].reason(), Some("exit code 3: ValueError: no arm"));
    let problem = record.hooks[0].runs[0].problem();
    assert_eq!(problem, Some("it ended with exit code 3: ValueError: no arm"));
    let junit = folder.read("j.xml");
    assert!(junit.contains("before it was ready: ValueError: no arm"), "{junit}");
}

#[test]
fn a_long_failure_is_shortened_on_the_console_and_complete_elsewhere() {
    let folder = Folder::new();
    let test = "TestCase = {}\nfunction TestCase.run()\n  \
                rtf.check(false, string.rep('x', 600000) .. 'END-OF-LINE\\n' .. string.rep('line\\n', 100000) .. 'END')\nend\n";
    folder.file("Long.lua", test).file("s.xml", "<suite name='s'><test>Long.lua</test></suite>");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}", finished.stderr);
    assert!(finished.stdout.len() < 20_000, "{} bytes", finished.stdout.len());
    assert!(finished.stdout.contains("more lines; `rtf show --verbose rtf-results/"));
    let all = folder.rtf(&["show", "--verbose"]);
    for text in ["xEND-OF-LINE", "END"] {
        assert!(all.stdout.contains(text), "{} bytes", all.stdout.len());
    }
}
