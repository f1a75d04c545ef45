//! Programs start with the signals that a shell starts them with: none is blocked or ignored.

use rtf_model::{EventKind, Phase};

use crate::support::Folder;

/// Writes its masks to `signals-NAME`.
const SCRIPT: &str = "#!/bin/sh\nsed -n 's/^Sig\\(Blk\\|Ign\\):\\t//p' /proc/self/status | tr '\\n' ' ' > signals-$1\necho 1..1\necho ok 1\n";
const PYTHON: &str = "import rtf, subprocess\nclass T(rtf.TestCase):\n    def run(self):\n        \
    subprocess.run(['sh', 'show.sh', 'python'], check=True)\n";
const WAITS: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";
/// Its child would show what Lua does.
const LUA: &str = "TestCase = {}\nfunction TestCase.run()\n  \
    local status = io.open('/proc/self/status'):read('a')\n  \
    local out = io.open('signals-lua', 'w')\n  \
    out:write(status:match('SigBlk:%s*(%x+)'), ' ', status:match('SigIgn:%s*(%x+)'), ' ')\n  \
    out:close()\nend\n";

/// Whoever starts the tests may ignore signals, as a script does in the background.
const START: &str = "--default-signal=HUP,INT,QUIT";

fn check(folder: &Folder, name: &str) {
    let found = folder.read(&format!("signals-{name}"));
    assert_eq!(found, format!("{0:016x} {0:016x} ", 0), "{name}");
}

fn folder(tests: &str) -> Folder {
    let folder = Folder::new();
    folder.file("T.py", PYTHON).file("W.py", WAITS).file("L.lua", LUA).file("show.sh", SCRIPT);
    let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    std::fs::set_permissions(folder.path().join("show.sh"), executable).expect("the file");
    folder.file(
        "s.xml",
        &format!(
            "<suite name='s'>\
             <fixture type='process' name='f'><command>sh -c 'sh show.sh fixture; exec sleep 1000'</command>\
             <ready command='sh show.sh probe'/><ready file='signals-fixture'/></fixture>\
             <hook name='h' on='end interrupt'><command>sh show.sh hook</command></hook>\
             {tests}</suite>"
        ),
    );
    folder
}

#[test]
fn nothing_that_rtf_starts_has_a_blocked_or_ignored_signal() {
    let folder = folder(
        "<test type='python' name='python'>T</test><test>L.lua</test>\
         <test type='tap' name='tap' param='tap'>show.sh</test>\
         <test type='program' name='program' param='program'>show.sh</test>",
    );
    // With this limit, processes are forked instead.
    for limit in ["", "ulimit -Sn 256; "] {
        let script = format!("{limit}exec env {START} \"$0\" run s.xml");
        let rtf = folder.command(&[]).get_program().to_owned();
        let mut command = folder.command_of(std::path::Path::new("/bin/sh"), &["-c", &script]);
        let output = command.arg(rtf).output().expect("a shell");
        let stdout = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{stdout}{}", String::from_utf8_lossy(&output.stderr));
        for name in ["fixture", "probe", "hook", "python", "lua", "tap", "program"] {
            check(&folder, name);
        }
    }
}

#[test]
fn a_hook_of_the_guard_has_no_blocked_or_ignored_signal() {
    let folder = folder("<test type='python'>W</test>");
    let rtf = folder.command(&[]).get_program().to_owned();
    let mut command = folder.command_of(std::path::Path::new("env"), &[START]);
    command.arg(rtf).args(["run", "s.xml"]);
    let running = folder.start_command(command);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    check(&folder, "hook");
}
