//! Private networks and ports of suites, with real namespaces.

use std::fs::File;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::Command;

use rtf_model::{EventKind, Phase, SuitePrepared};

use crate::support::{Folder, Running, free_port, nothing_left, wait_until};

/// A server that says whose it is.
const SERVER: &str = "import os, socket, sys\n\
s = socket.socket()\ns.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)\n\
s.bind(('127.0.0.1', int(sys.argv[1])))\ns.listen()\n\
open('net-' + os.environ['ME'], 'w').write(os.readlink('/proc/self/ns/net'))\n\
while True:\n    c, _ = s.accept()\n    c.sendall(os.environ['ME'].encode())\n    c.close()\n";

/// Is there with all who are named, and then asks its server whose it is.
const MEET: &str = "
import os, rtf, socket

class T(rtf.TestCase):
    def run(self):
        port, *all = self.param.split()
        me = os.environ['ME']
        open('at-' + me, 'w').close()
        self.wait_until(lambda: there(all), 60, 'all are there')
        said = socket.create_connection(('127.0.0.1', int(port)), 5).recv(9).decode()
        self.check(said == me, 'the server is ' + said + ' of ' + me)

def there(names):
    return all(os.path.exists('at-' + name) for name in names)
";

const SIM: &str = "<fixture type='process' name='sim' restarts='0'><command>python3 server.py PORT</command>\
    <ready tcp='127.0.0.1:PORT'/><alive tcp='localhost:PORT' every='20ms'/></fixture>";

fn folder(attributes: &str, port: &str) -> Folder {
    let folder = Folder::new();
    let sim = SIM.replace("PORT", port);
    let suite = format!(
        "<suite name='s' {attributes}>{sim}<test type='python' param='{port} a b'>T</test></suite>"
    );
    folder.file("server.py", SERVER).file("T.py", MEET).file("s.xml", &suite);
    folder
}

fn start(folder: &Folder, me: &str) -> Running {
    let mut command = folder.command(&["run", "s.xml", "--results", me]);
    command.env("ME", me).env_remove("ROS_DOMAIN_ID");
    folder.start_command(command)
}

pub fn prepared(folder: &Folder, results: &str) -> SuitePrepared {
    let journal = folder.journal_in(results);
    let prepared = journal.record.suites[0].prepared.clone();
    prepared.expect("an event")
}

#[test]
fn two_runs_with_one_port_at_one_time_are_green_in_networks_of_their_own() {
    let port = free_port().to_string();
    let folder = folder("isolate='network'", &port);
    let runs = ["a", "b"].map(|me| start(&folder, me));
    for run in runs {
        let finished = run.finish();
        assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
        assert!(finished.stdout.contains("/logs/s.suite.log\n"), "{}", finished.stdout);
    }
    let net = |me: &str| std::fs::read_to_string(folder.path().join(format!("net-{me}")));
    let nets = ["a", "b"].map(|me| net(me).expect("a file"));
    assert_ne!(nets[0], nets[1]);
    let own = std::fs::read_link("/proc/self/ns/net").expect("a namespace");
    assert!(!nets.contains(&own.to_string_lossy().into_owned()));
    assert!(nothing_left(&folder));
}

/// The control of the test above: it is the isolation that makes both green.
#[test]
fn without_a_network_of_its_own_the_second_run_finds_the_port_taken() {
    let port = free_port().to_string();
    let folder = folder("", &port);
    let first = start(&folder, "a");
    wait_until("the first run", || folder.path().join("at-a").exists().then_some(()));
    let second = start(&folder, "b").finish();
    assert_eq!(second.code, Some(1), "{}{}", second.stdout, second.stderr);
    let taken = format!("127.0.0.1:{port} answers already, before the fixture was started");
    assert!(second.stdout.contains(&taken), "{}", second.stdout);
    folder.file("at-b", "");
    let first = first.finish();
    assert_eq!(first.code, Some(0), "{}{}", first.stdout, first.stderr);
}

#[test]
fn ports_and_ids_of_two_runs_at_one_time_differ() {
    let folder = folder("", "${port:sim}");
    let runs = ["a", "b"].map(|me| start(&folder, me));
    for run in runs {
        let finished = run.finish();
        assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    }
    let [a, b] = ["a", "b"].map(|me| prepared(&folder, me));
    assert_eq!((&a.network, &b.network), (&None, &None));
    let names = |own: &SuitePrepared| own.ports.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&a), ["gazebo-master", "ros-master", "sim"]);
    for mine in &a.ports {
        assert!(b.ports.iter().all(|other| other.port != mine.port), "{a:?} {b:?}");
    }
    let same = ["ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_HOSTNAME"];
    for mine in a.variables.iter().filter(|own| !same.contains(&own.name.as_str())) {
        assert!(!mine.inherited);
        assert!(b.variables.iter().all(|other| other != mine), "{a:?} {b:?}");
    }
}

/// Forked hosts, multicast, and HTTP probes in a network of its own.
#[test]
fn all_of_a_suite_is_in_its_network() {
    let folder = Folder::new();
    let look = "local f = io.popen('readlink /proc/self/ns/net')\nlocal net = f:read('l')\nf:close()\n\
        TestCase = {}\nfunction TestCase.run()\n  local f = io.open('nets', 'a')\n  f:write(net, '\\n')\n  f:close()\nend\n";
    let multicast = "
import rtf, socket, struct

class M(rtf.TestCase):
    def run(self):
        group = '239.255.76.67'
        s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        s.bind(('', 17667))
        s.settimeout(5)
        any = socket.inet_aton(group) + struct.pack('@I', 0)
        s.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, any)
        s.sendto(b'here', (group, 17667))
        self.check(s.recv(9) == b'here', 'multicast comes back')
        names = [line.split(':')[0].strip() for line in open('/proc/net/dev') if ':' in line]
        self.check(names == ['lo'], str(names))
";
    let link = "readlink /proc/self/ns/net >> nets";
    let suite = format!(
        "<suite name='s' isolate='network'>\
         <fixture type='process' name='web'><command>sh -c '{link}; exec python3 -m http.server --bind 127.0.0.1 8080'</command>\
         <ready http='http://localhost:8080/'/><ready command='sh -c \"{link}\"'/></fixture>\
         <hook on='end' name='h'><command>sh -c '{link}'</command></hook>\
         <test repetition='4'>Look.lua</test><test>M.py</test></suite>"
    );
    // When the next suite runs, nobody is in the first one's network any more. The kernel
    // may have given its number to that of another test, whose processes are elsewhere.
    let next = "<suite name='next'><test>Gone.py</test></suite>";
    let gone = "
import os, rtf

class Gone(rtf.TestCase):
    def run(self):
        net = open('nets').readline().strip()
        for pid in filter(str.isdigit, os.listdir('/proc')):
            try:
                if os.readlink('/proc/' + pid + '/cwd') != os.getcwd():
                    continue
                self.check(os.readlink('/proc/' + pid + '/ns/net') != net, pid + ' is not in it')
            except OSError:
                pass
";
    folder.file("Look.lua", look).file("M.py", multicast).file("s.xml", &suite);
    folder.file("next.xml", next).file("Gone.py", gone);
    let running = folder.start(&["run", "s.xml", "next.xml"]);
    let network = Network::of(&running);
    let finished = running.finish();
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let text = std::fs::read_to_string(folder.path().join("nets")).expect("a file");
    let nets: Vec<_> = text.lines().collect();
    assert_eq!(nets.len(), 7, "{nets:?}");
    assert!(nets.iter().all(|net| *net == network.name()), "{nets:?}");
    let own = std::fs::read_link("/proc/self/ns/net").expect("a namespace");
    assert_ne!(own.to_string_lossy(), network.name());
    assert!(nothing_left(&folder) && network.is_empty());
}

/// The network of a suite. As long as this is there, the kernel gives its number to
/// no other one.
pub struct Network {
    held: File,
}

impl Network {
    /// That of the first suite, once it is prepared.
    pub fn of(running: &Running) -> Self {
        let event = running.wait_for(|kind| matches!(kind, EventKind::SuitePrepared(_)));
        let EventKind::SuitePrepared(prepared) = event.kind else { unreachable!() };
        let holder = prepared.network.expect("a network").pid;
        let held = File::open(format!("/proc/{holder}/ns/net")).expect("its holder lives");
        Self { held }
    }

    /// As links in /proc have it.
    pub fn name(&self) -> String {
        format!("net:[{}]", self.held.metadata().expect("a number").ino())
    }

    /// Whether no process is in it any more.
    pub fn is_empty(&self) -> bool {
        let entries = std::fs::read_dir("/proc").expect("/proc").flatten();
        entries
            .filter_map(|entry| std::fs::read_link(entry.path().join("ns/net")).ok())
            .all(|link| link.to_string_lossy() != self.name())
    }
}

#[test]
fn when_the_runner_is_killed_the_abort_hook_is_in_the_network_and_nothing_is_left() {
    let folder = Folder::new();
    let test = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";
    let suite = format!(
        "<suite name='s' isolate='network'>{}\
         <hook on='interrupt' name='park'><command>sh -c 'readlink /proc/self/ns/net > parked; echo $RTF_PORT_SIM >> parked; python3 ask.py $RTF_PORT_SIM >> parked'</command></hook>\
         <test type='python'>T</test></suite>",
        SIM.replace("PORT", "${port:sim}")
    );
    let ask = "import socket, sys\nprint(socket.create_connection(('127.0.0.1', int(sys.argv[1])), 5).recv(9).decode())\n";
    folder.file("server.py", SERVER).file("ask.py", ask).file("T.py", test).file("s.xml", &suite);
    let mut command = folder.command(&["run", "s.xml"]);
    command.env("ME", "arm");
    let running = folder.start_command(command);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    assert_eq!(joined_in(&running), std::fs::read_to_string(folder.path().join("net-arm")).ok());
    let network = Network::of(&running);
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    assert!(!finished.stderr.contains("--hold-network"), "{}", finished.stderr);
    let journal = folder.journal();
    let prepared = journal.record.suites[0].prepared.as_ref().expect("an event");
    let holder = prepared.network.expect("a network").pid;
    assert!(!Path::new(&format!("/proc/{holder}")).exists(), "the holder is gone");
    let net = std::fs::read_to_string(folder.path().join("net-arm")).expect("a file");
    let sim = prepared.ports.iter().find(|own| own.name == "sim").expect("a port").port;
    let parked = std::fs::read_to_string(folder.path().join("parked")).expect("a file");
    assert_eq!(parked, format!("{net}\n{sim}\narm\n"));
    assert!(nothing_left(&folder) && network.is_empty());
}

/// The network that the command leads to with which a person joins in.
fn joined_in(running: &Running) -> Option<String> {
    let is_prepared = |kind: &EventKind| matches!(kind, EventKind::SuitePrepared(_));
    let EventKind::SuitePrepared(prepared) = running.wait_for(is_prepared).kind else {
        return None;
    };
    let mut shell = Command::new("sh");
    shell.args(["-c", &prepared.join_command]).env("SHELL", "readlink -n /proc/self/ns/net");
    String::from_utf8(shell.output().expect("sh").stdout).ok()
}

/// The numbers of a suite are its own as long as something of it runs: also
/// while the guard parks the robot.
#[test]
fn the_guard_keeps_the_numbers_while_the_abort_hook_runs() {
    let folder = Folder::new();
    let test = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";
    let hook = "<hook on='interrupt' name='park'><command>sh -c 'grep -o \"@rtf/.*\" /proc/net/unix > held'</command></hook>";
    let sim = SIM.replace("PORT", "${port:sim}");
    let suite = format!("<suite name='s'>{sim}{hook}<test type='python'>T</test></suite>");
    folder.file("server.py", SERVER).file("T.py", test).file("s.xml", &suite);
    let mut command = folder.command(&["run", "s.xml"]);
    command.env("ME", "arm").env_remove("ROS_DOMAIN_ID");
    let running = folder.start_command(command);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    let held = std::fs::read_to_string(folder.path().join("held")).expect("a file");
    let prepared = folder.journal().record.suites[0].prepared.clone().expect("an event");
    let domain = prepared.variables.iter().find(|own| own.name == "ROS_DOMAIN_ID");
    let mut names: Vec<_> =
        prepared.ports.iter().map(|own| format!("@rtf/port/{}", own.port)).collect();
    names.extend(domain.map(|own| format!("@rtf/domain/{}", own.value)));
    assert_eq!(names.len(), 4, "{prepared:?}");
    for name in names {
        assert!(held.lines().any(|line| line == name), "{name} in {held}");
    }
}
