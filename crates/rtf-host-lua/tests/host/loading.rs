//! Which files are plug-ins, where modules are found, and `--check`.

use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::driver::{Host, run, run_body};

#[test]
fn a_file_that_is_no_test_is_an_error() {
    let cases = [
        ("x = 1", "`FILE` defines no function `TestCase.run`"),
        (
            "function FixtureManager.setup() end",
            "`FILE` defines no function `TestCase.run`; it has a `FixtureManager`",
        ),
        ("TestCase = 3", "`TestCase` of `FILE` is no table of functions, but: integer"),
        ("x =", "unexpected symbol near <eof>"),
    ];
    for (source, reason) in cases {
        let (answer, host) = run(source);
        let file = host.dir.path().join("plugin.lua");
        let reason = reason.replace("FILE", &file.to_string_lossy());
        assert_eq!(answer, json!({"outcome": "error"}));
        assert_eq!(host.problem().unwrap(), reason);
        assert!(host.all("phase").is_empty());
    }
}

#[test]
fn a_syntax_error_is_told_with_its_line() {
    let (_, host) = run("#!/usr/bin/lua\nx = 1\ny = = 2\n");
    let message = host.all("message")[0];
    assert_eq!(message["text"], "unexpected symbol near '='");
    assert_eq!(message["location"]["line"], 3);
}

#[test]
fn a_line_for_the_shell_and_a_byte_order_mark_are_not_code() {
    for start in ["#!/usr/bin/lua\n", "\u{FEFF}", "\u{FEFF}#!/usr/bin/lua\n"] {
        let (answer, _) = run(&format!("{start}function TestCase.run() end"));
        assert_eq!(answer, json!({"outcome": "passed"}), "{start}");
    }
}

#[test]
fn an_error_while_the_file_is_loaded_is_told_with_its_traceback() {
    let (answer, host) = run("local x\nx()");
    assert_eq!(answer["outcome"], "error");
    let message = host.all("message")[0];
    assert!(
        message["text"]
            .as_str()
            .unwrap()
            .starts_with("attempt to call a nil value (local 'x')\nstack")
    );
    assert_eq!(message["location"]["line"], 2);
}

#[test]
fn the_global_functions_stay_luas_own() {
    let (answer, _) = run_body(
        "assert(require('string') == string)\nassert(not pcall(error, 'x'))\nassert(require('rtf') == rtf)",
    );
    assert_eq!(answer, json!({"outcome": "passed"}));
}

#[test]
fn modules_beside_the_plugin_are_found() {
    let mut host = Host::start();
    let dir = host.dir.path().join("arms");
    std::fs::create_dir(&dir).unwrap();
    std::fs::write(dir.join("init.lua"), "return { joints = 6 }").unwrap();
    std::fs::write(host.dir.path().join("legs.lua"), "return { joints = 12 }").unwrap();
    host.start_plugin(
        "run-test",
        "function TestCase.run() rtf.report(require('arms').joints + require('legs').joints) end",
    );
    assert_eq!(host.answer(), json!({"outcome": "passed"}));
    assert_eq!(host.texts(), ["report: 18"]);
}

/// Debian's `lua-socket`: a C module needs the symbols that the host exports.
#[test]
fn c_modules_load() {
    let (answer, host) = run_body(
        "local socket = require('socket')\n\
         local server = assert(socket.bind('127.0.0.1', 0))\n\
         local _, port = server:getsockname()\n\
         local client = assert(socket.connect('127.0.0.1', port))\n\
         client:send('hello\\n')\n\
         rtf.report(server:accept():receive())",
    );
    assert_eq!(answer, json!({"outcome": "passed"}), "needs Debian's package lua-socket");
    assert_eq!(host.texts(), ["report: hello"]);
}

#[test]
fn the_second_plugin_of_a_host_knows_nothing_of_the_first() {
    let mut host = Host::start();
    let file = host.dir.path().join("plugin.lua");
    std::fs::write(&file, "rtf.report(left)\nleft = 'left'\nfunction TestCase.run() end").unwrap();
    for id in 1..=2 {
        host.send(
            Some(id),
            "run-test",
            json!({"file": file, "name": "Arm", "args": [], "is_last": id == 2}),
        );
        assert_eq!(host.answer(), json!({"outcome": "passed"}));
    }
    assert_eq!(host.texts(), ["report: nil", "report: nil"]);
    assert!(host.end().0.success());
}

#[test]
fn the_host_names_its_lua() {
    let host = Host::start();
    let named = host.seen[0]["result"]["host"].as_str().unwrap();
    let release = named.strip_prefix("lua 5.4.").unwrap();
    assert!(release.parse::<u32>().is_ok(), "{named}");
    assert_eq!(host.seen[0]["result"]["stack"], "message");
}

#[test]
fn files_are_checked_without_running_them() {
    let dir = TempDir::new().unwrap();
    let files = [
        ("test.lua", "print('ran')\nfunction TestCase.run() end"),
        ("fixture.lua", "FixtureManager = {}"),
        ("unknown.lua", "-- TestCase.run\nlocal TestCases = require('base')"),
        ("broken.lua", "x = 1\ny = = 2"),
    ];
    for (name, text) in files {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let names = files.iter().map(|(name, _)| *name).chain(["gone.lua"]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_rtf-host-lua"));
    let output = command.arg("--check").args(names).current_dir(dir.path()).output().unwrap();
    assert!(output.status.success());
    let lines = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let gone = "`gone.lua` cannot be read: No such file or directory (os error 2)";
    assert_eq!(
        lines,
        [
            json!({"file": "test.lua", "ok": true, "kinds": ["test"]}),
            json!({"file": "fixture.lua", "ok": true, "kinds": ["fixture"]}),
            json!({"file": "unknown.lua", "ok": true}),
            json!({"file": "broken.lua", "ok": false, "message": "unexpected symbol near '='", "line": 2}),
            json!({"file": "gone.lua", "ok": false, "message": gone}),
        ]
    );
}

#[test]
fn a_host_that_no_runner_started_says_so() {
    let output = Command::new(env!("CARGO_BIN_EXE_rtf-host-lua"))
        .env_remove("RTF_CHANNEL")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text, "error: `RTF_CHANNEL` is not set: a host is started by `rtf`\n");
}
