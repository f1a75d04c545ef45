//! Private networks without root, and on systems that do not allow them.

use std::path::Path;
use std::process::Command;

use rtf_model::{TestId, Verdict};

use crate::isolation::{Network, prepared};
use crate::support::{Folder, Running, nothing_left, wait_until};

/// The folder and the programs for a user who may read nothing else of ours.
fn for_nobody(folder: &Folder) -> Command {
    let bins = Path::new(env!("CARGO_BIN_EXE_rtf")).parent().expect("a folder");
    for program in ["rtf", "rtf-host-lua"] {
        std::fs::copy(bins.join(program), folder.path().join(program)).expect("a copy");
    }
    let path = folder.path().display().to_string();
    let is_root = std::fs::metadata("/proc/self").is_ok_and(|own| {
        use std::os::unix::fs::MetadataExt;
        own.uid() == 0
    });
    if !is_root {
        let mut command = Command::new(format!("{path}/rtf"));
        command.current_dir(path);
        return command;
    }
    let given = Command::new("chown").args(["-R", "65534:65534", &path]).status();
    assert!(given.expect("chown").success());
    let mut command = Command::new("setpriv");
    command.args(["--reuid=65534", "--regid=65534", "--clear-groups", &format!("{path}/rtf")]);
    command.current_dir(path);
    command
}

fn nobodys_suite() -> Folder {
    let folder = Folder::new();
    let look = "TestCase = {}\nfunction TestCase.run()\n  local f = io.popen('readlink /proc/self/ns/net; id -u; sleep 1000 >/dev/null 2>&1 &')\n\
         \x20 io.open('looked', 'w'):write(f:read('a')):close()\nend\n";
    let suite = "<suite name='s' isolate='network'><fixture type='process' name='web'>\
         <command>python3 -m http.server --bind 127.0.0.1 8080</command>\
         <ready http='http://127.0.0.1:8080/'/><alive tcp='127.0.0.1:8080' every='20ms'/></fixture><test>Look.lua</test></suite>";
    folder.file("Look.lua", look).file("s.xml", suite);
    folder
}

fn start(folder: &Folder, mut command: Command) -> Running {
    command.env("NO_COLOR", "1").env_remove("LD_LIBRARY_PATH").env_remove("RTF_RESULTS");
    folder.start_command(command)
}

fn end(running: Running) -> (Option<i32>, String) {
    let finished = running.finish();
    (finished.code, finished.stdout + &finished.stderr)
}

/// Without control groups, it has to be caught between two of its lives.
#[test]
fn what_a_test_left_is_found_when_it_starts_anew_all_the_time() {
    assert_chain_is_found("");
}

/// While a large process exits, an ordinary user cannot read its environment any more, and its
/// child is not an orphan yet.
#[test]
fn what_a_test_left_is_found_when_each_life_exits_slowly() {
    assert_chain_is_found("memory = bytearray(b'1') * 400_000_000");
}

/// A test leaves a process that forks and exits all the time.
fn assert_chain_is_found(before: &str) {
    let folder = Folder::new();
    // It ends by itself if nobody catches it.
    let chain = format!(
        "import os, time\n{before}\nos.setsid()\nopen('began', 'w').close()\nend = time.monotonic() + 20\n\
         while time.monotonic() < end:\n    if os.fork():\n        os._exit(0)\n"
    );
    let test = "TestCase = {}\nfunction TestCase.run()\n  \
        os.execute('python3 chain.py >/dev/null 2>&1 & while ! test -e began; do sleep 0.01; done')\nend\n";
    folder.file("chain.py", &chain).file("T.lua", test);
    folder.file("s.xml", "<suite name='s'><test leaks='fail'>T.lua</test></suite>");
    let mut command = for_nobody(&folder);
    command.args(["run", "s.xml"]);
    let (code, printed) = end(start(&folder, command));
    assert_eq!(code, Some(1), "{printed}");
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Error), "{printed}");
    let reason = record.tests[0].reason().expect("a reason");
    // A process that exits has no arguments any more.
    assert!(reason.contains("behind") && reason.contains("python3"), "{reason}");
    wait_until("the end of what was killed", || nothing_left(&folder).then_some(()));
}

/// Where the kernel allows it to everybody, it needs no root; where it does
/// not, that is said.
#[test]
fn without_root_a_user_namespace_does() {
    let folder = nobodys_suite();
    let mut probe = for_nobody(&folder);
    let program = probe.get_program().to_owned();
    let as_nobody: Vec<_> = probe
        .get_args()
        .filter(|word| word.to_string_lossy().starts_with("--"))
        .map(ToOwned::to_owned)
        .collect();
    let allowed = match as_nobody.is_empty() {
        true => Command::new("unshare").args(["-Un", "true"]).status(),
        false => Command::new(program).args(as_nobody).args(["unshare", "-Un", "true"]).status(),
    };
    let allowed = allowed.expect("unshare").success();
    probe.args(["run", "s.xml"]);
    let running = start(&folder, probe);
    if !allowed {
        let (code, told) = end(running);
        return assert_refused(&folder, code, &told);
    }
    let network = Network::of(&running);
    let (code, told) = end(running);
    assert_eq!(code, Some(0), "{told}");
    let prepared = prepared(&folder, "rtf-results");
    assert!(prepared.network.expect("a network").user_namespace, "{prepared:?}");
    assert!(prepared.join_command.contains("--user --preserve-credentials --net"), "{prepared:?}");
    let looked = std::fs::read_to_string(folder.path().join("looked")).expect("a file");
    let (net, uid) = looked.trim().split_once('\n').expect("two lines");
    let own = std::fs::read_link("/proc/self/ns/net").expect("a namespace");
    assert_eq!(net, network.name());
    assert_ne!(net, own.to_string_lossy());
    assert_ne!(uid, "0", "in the suite, one is who one was");
    assert!(told.contains("leaked"), "what a test leaves is found across namespaces: {told}");
    assert!(nothing_left(&folder) && network.is_empty());
}

fn assert_refused(folder: &Folder, code: Option<i32>, told: &str) {
    assert_eq!(code, Some(1), "{told}");
    let journal = folder.journal();
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Error), "{told}");
    assert_eq!(journal.record.fixtures[0].starts, 0, "nothing is started");
    assert!(!folder.path().join("looked").exists());
    assert!(told.contains("no network of its own: the system refuses"), "{told}");
}

/// In a user namespace that may have no further ones, without capabilities,
/// the system refuses whatever it allows outside.
#[test]
fn where_the_system_refuses_each_test_is_an_error_that_says_why() {
    let folder = nobodys_suite();
    let inner = "echo 0 > /proc/sys/user/max_user_namespaces || exit 99; \
         exec setpriv --bounding-set=-all --inh-caps=-all \"$@\"";
    let rtf = for_nobody(&folder);
    let mut command = Command::new(rtf.get_program());
    let (user, program): (Vec<_>, Vec<_>) =
        rtf.get_args().partition(|word| word.to_string_lossy().starts_with("--"));
    command.args(&user).current_dir(folder.path());
    let outside = std::fs::read_to_string("/proc/sys/user/max_user_namespaces").expect("a limit");
    if user.is_empty() {
        command = Command::new("unshare");
        command.current_dir(folder.path());
    } else {
        command.arg("unshare");
    }
    command.args(["--user", "--map-root-user", "sh", "-c", inner, "sh"]);
    command.arg(program.first().copied().unwrap_or(rtf.get_program())).args(["run", "s.xml"]);
    let (code, told) = end(start(&folder, command));
    assert_refused(&folder, code, &told);
    assert!(told.contains("`user.max_user_namespaces` is 0 here: `sysctl"), "{told}");
    let now = std::fs::read_to_string("/proc/sys/user/max_user_namespaces").expect("a limit");
    assert_eq!(now, outside, "the machine's own limit is untouched");
}
