//! Requests to stop, hangs, and a runner that is gone.

use std::os::unix::process::ExitStatusExt;

use serde_json::json;

use crate::driver::Host;

const TEAR_DOWN: &str =
    "function TestCase.tearDown() rtf.sleep(0.01) rtf.report('torn down') end\n";

fn going(body: &str) -> Host {
    let mut host = Host::start();
    let run = format!("function TestCase.run()\nrtf.report('going')\n{body}\nend\n{TEAR_DOWN}");
    host.start_plugin("run-test", &run);
    host.wait_for("message");
    host
}

#[test]
fn a_request_to_stop_unwinds_the_plugin_and_tears_it_down() {
    let waiting = [
        "rtf.sleep(1000)",
        "rtf.wait_until(function() return false end, 1000, 'the end of days')",
        "while not rtf.interrupted() do end",
        "while true do end",
        "while true do pcall(function() while true do end end) if rtf.interrupted() then error('x') end end",
    ];
    for body in waiting {
        let mut host = going(body);
        host.send(None, "interrupt", json!({"reason": "the simulator collapsed"}));
        let interrupted = json!({"outcome": "interrupted", "reason": "the simulator collapsed"});
        assert_eq!(host.answer(), interrupted, "{body}");
        assert_eq!(host.texts().last().unwrap(), "report: torn down", "{body}");
        assert!(host.end().0.success(), "{body}");
    }
}

/// Asks for stacks until one shows this: the plug-in may still be on its way.
fn wait_for_stack(host: &mut Host, part: &str) {
    loop {
        host.send(None, "dump-stack", json!({}));
        let stack = host.wait_for("stack");
        let text = stack["text"].as_str().unwrap();
        assert!(text.starts_with("stack traceback:\n"), "{text}");
        if text.contains(part) {
            return;
        }
    }
}

#[test]
fn a_busy_loop_tells_where_it_is_and_goes_on() {
    let mut host = going("local n = 0\nwhile true do n = n + 1 end");
    wait_for_stack(&mut host, "plugin.lua:4: in ");
    wait_for_stack(&mut host, "plugin.lua:4: in ");
    host.send(None, "interrupt", json!({"reason": "Ctrl-C"}));
    assert_eq!(host.answer()["outcome"], "interrupted");
}

#[test]
fn a_loop_that_catches_the_stop_continues_until_it_is_killed() {
    let mut host =
        going("local function busy() while true do end end\nwhile true do pcall(busy) end");
    host.send(None, "interrupt", json!({"reason": "Ctrl-C"}));
    wait_for_stack(&mut host, "'pcall'");
    host.hang_up();
    assert!(!host.end().0.success());
}

#[test]
fn a_failure_before_the_request_to_stop_decides() {
    let mut host = going("rtf.check(false, 'reached') rtf.sleep(1000)");
    host.wait_for("message");
    host.send(None, "interrupt", json!({"reason": "Ctrl-C"}));
    assert_eq!(host.answer(), json!({"outcome": "failed"}));
}

#[test]
fn the_host_ends_with_its_runner_while_a_test_runs() {
    let mut host = going("while true do end");
    host.hang_up();
    assert_eq!(host.end().0.code(), Some(1));
    assert_eq!(host.texts(), ["report: going"]);
}

#[test]
fn what_was_printed_before_a_crash_is_not_lost() {
    for (name, signal) in [("SEGV", 11), ("ABRT", 6)] {
        let mut host = going(&format!("print('printed')\nos.execute('kill -{name} $PPID')"));
        let (status, printed) = host.end();
        assert_eq!(status.signal(), Some(signal));
        assert_eq!(printed, "printed\n");
    }
}

#[test]
fn children_have_neither_the_channel_nor_its_name() {
    let mut host =
        going("rtf.report(io.popen('ls -l /proc/self/fd; echo name=$RTF_CHANNEL.'):read('a'))");
    host.answer();
    let listed = &host.texts()[1];
    assert!(listed.contains("name=.") && !listed.contains("socket:"), "{listed}");
}
