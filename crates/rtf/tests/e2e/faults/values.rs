//! Faults of proxies. Those of real middleware: `tests/middleware/test_proxies.py`.

use rtf_model::{EventKind, FaultKind};

use super::faults;
use super::leftovers::process_below;
use crate::support::{Finished, Folder, Journal, nothing_left, send, wait_until};

/// A proxy: the file `fault` contains the request while a fault lasts. A field `none` is unknown.
const PROXY: &str = r#"import os, pathlib, socket, threading
import rtf

FILE = pathlib.Path("fault")

def serve(connection):
    with connection, connection.makefile("rw") as stream:
        request = stream.readline()
        if '"field":"none"' in request:
            print("there is no field `none`", file=stream, flush=True)
            return
        FILE.write_text(request)
        try:  # the other side may be killed before it has read the answer
            print("ok", file=stream, flush=True)
            stream.read()
        finally:
            FILE.unlink()

def accept(server):
    while True:
        threading.Thread(target=serve, args=(server.accept()[0],), daemon=True).start()

class Proxy(rtf.FixtureManager):
    def setup(self, args):
        if "silent" in args:
            return
        server = socket.socket(socket.AF_UNIX)
        server.bind(f"\0rtf-test-proxy-{os.getpid()}")
        server.listen()
        threading.Thread(target=accept, args=(server,), daemon=True).start()
        self.provide("fault-socket", f"rtf-test-proxy-{os.getpid()}")
"#;

const TEST: &str = r#"import pathlib
import rtf

class T(rtf.TestCase):
    def run(self):
        fault = pathlib.Path("fault")
        with self.fault("wrong"):
            self.attach(fault)
        self.check(not fault.exists(), "it is removed when `remove` returns")
        if self.param == "stay":
            self.fault("wrong")
            self.sleep(60)
        self.fault("unknown")
"#;

fn folder(param: &str, proxy: &str) -> Folder {
    let folder = Folder::new();
    folder.file("proxy.py", PROXY).file("T.py", TEST);
    let suite = format!(
        "<suite name='arm'>
         <fixture type='python' name='proxy' param='{proxy}'> proxy.py </fixture>
         <fault name='wrong' kind='values' fixture='proxy' field='position[elbow]' set='NaN'
                noise='0.5' loss='2.5%' delay='10ms' seed='3'/>
         <fault name='unknown' kind='values' fixture='proxy' field='none' freeze='true'/>
         <test param='{param}'> T.py </test></suite>"
    );
    folder.file("s.xml", &suite);
    folder
}

fn run(param: &str, proxy: &str) -> (Finished, Journal, Folder) {
    let folder = folder(param, proxy);
    let finished = folder.rtf(&["run", "s.xml"]);
    let journal = folder.journal();
    assert!(nothing_left(&folder));
    (finished, journal, folder)
}

#[test]
fn a_proxy_gets_the_request_and_the_fault_lasts_as_long_as_the_connection() {
    let (finished, journal, folder) = run("", "");
    let reason = journal.record.tests[0].reason().unwrap_or_default();
    assert_eq!(reason, "the fault \"unknown\" was not injected: there is no field `none`");
    let [fault] = faults(&journal) else { panic!("{}", finished.stdout) };
    assert_eq!(fault.fault.kind, FaultKind::Values);
    let effect =
        "changed `position[elbow]` of `proxy`: set NaN, noise 0.5, loss 2.5 %, delay 10 ms";
    assert_eq!(fault.fault.effect, effect);
    assert!(fault.removed.is_some());
    let attachments = &journal.record.tests[0].attempts[0].attachments;
    let path = folder.path().join("rtf-results/latest").join(&attachments[0].path);
    let request = std::fs::read_to_string(path).expect("the request");
    assert_eq!(
        request,
        "{\"field\":\"position[elbow]\",\"set\":\"NaN\",\"scale\":null,\"offset\":null,\
         \"noise\":\"0.5\",\"freezes\":false,\"loss_ppm\":25000,\"delay_us\":10000,\"seed\":3}\n"
    );
    assert!(!folder.path().join("fault").exists());
}

#[test]
fn a_fixture_without_the_socket_is_no_proxy() {
    let (finished, ..) = run("", "silent");
    assert_eq!(finished.code, Some(1));
    let problem = "the fixture `proxy` is no proxy: it provides no value `fault-socket`";
    assert!(finished.stdout.contains(problem), "{}", finished.stdout);
}

/// The kernel closes the connection of a killed process.
#[test]
fn the_fault_of_a_proxy_ends_with_the_program_that_injected_it() {
    let folder = folder("stay", "");
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultRemoved { .. }));
    let fault = folder.path().join("fault");
    wait_until("the second fault", || fault.exists().then_some(()));
    let host = wait_until("the host", || process_below(running.runner(), "rtf-host-faults"));
    send(host, "KILL");
    wait_until("the end of the fault", || (!fault.exists()).then_some(()));
    running.signal("INT");
    let _ = running.finish();
    assert!(nothing_left(&folder));
}

/// The proxy dies with the run; a proxy that lives on would end the fault.
#[test]
fn after_the_death_of_the_runner_no_proxy_is_left() {
    let folder = folder("stay", "");
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultRemoved { .. }));
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    assert!(nothing_left(&folder));
}
