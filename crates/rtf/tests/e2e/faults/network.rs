//! Faults of the private network.

use rtf_model::EventKind;

use super::{faults, passes};
use crate::support::{Folder, nothing_left};

/// Answers what it gets, over TCP at the first port, and over UDP at both.
const ECHO: &str = "import socket, sys, threading\n\
def tcp(port):\n    \
server = socket.create_server(('127.0.0.1', port)); print('up', flush=True)\n    \
while True:\n        connection, _ = server.accept()\n        \
while data := connection.recv(65536): connection.sendall(data[:1])\n\
def udp(port):\n    \
socket_ = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); socket_.bind(('127.0.0.1', port))\n    \
while True:\n        data, sender = socket_.recvfrom(65536); socket_.sendto(data, sender)\n\
ports = [int(port) for port in sys.argv[1:]]\n\
for port in ports: threading.Thread(target=udp, args=(port,)).start()\n\
tcp(ports[0])\n";

const NETWORK_TEST: &str = "import socket, time, rtf\n\
class T(rtf.TestCase):\n    \
def setup(self, args):\n        \
self.ports = [int(port) for port in args]\n        \
self.tcp = socket.create_connection(('127.0.0.1', self.ports[0]))\n        \
self.udp = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in self.ports]\n        \
for udp, port in zip(self.udp, self.ports): udp.connect(('127.0.0.1', port))\n    \
def trip(self, size=1):\n        \
start = time.monotonic(); self.tcp.sendall(b'x' * size); self.tcp.recv(1); return time.monotonic() - start\n    \
def answers(self, which, count):\n        \
udp = self.udp[which]; udp.settimeout(0.5)\n        \
for number in range(count): udp.send(b'%d' % number)\n        \
received = []\n        \
try:\n            while True: received.append(int(udp.recv(100)))\n        \
except TimeoutError: return received\n    \
def run(self):\n        \
self.require(self.trip() < 0.08, 'fast before')\n        \
with self.fault('late'):\n            \
self.require(self.trip() >= 0.1, 'late'); self.require(self.answers(0, 10) == list(range(10)), 'none lost')\n        \
self.wait_until(lambda: self.trip() < 0.08, 30, 'fast afterwards')\n        \
with self.fault('lossy'): lossy = self.answers(0, 200)\n        \
self.require(5 < len(lossy) < 150, f'lossy: {len(lossy)}')\n        \
with self.fault('double'): double = self.answers(0, 10)\n        \
self.require(sorted(double) == sorted(list(range(10)) * 4), f'double: {double}')\n        \
with self.fault('mixed'): mixed = self.answers(0, 50)\n        \
self.require(sorted(mixed) == list(range(50)) != mixed, f'mixed: {mixed}')\n        \
with self.fault('cut'):\n            \
self.require(self.answers(1, 5) == [], 'cut'); self.require(self.answers(0, 5) == list(range(5)), 'other')\n        \
self.require(self.answers(1, 5) == list(range(5)), 'joined')\n        \
with self.fault('narrow'): narrow = self.trip(30000)\n        \
self.require(0.2 < narrow < 30, f'narrow: {narrow}')\n";

#[test]
fn packets_of_a_private_network_are_impaired() {
    let folder = Folder::new();
    folder.file("echo.py", ECHO).file("T.py", NETWORK_TEST);
    folder.file(
        "s.xml",
        "<suite name='net' isolate='network'>
         <fixture type='process' name='echo'>
           <command>python3 echo.py ${port:a} ${port:b}</command><ready log='up'/></fixture>
         <fault name='late' kind='network' delay='50ms'/>
         <fault name='lossy' kind='network' loss='50%' seed='1'/>
         <fault name='double' kind='network' duplicate='100%'/>
         <fault name='mixed' kind='network' delay='20ms' jitter='20ms'/>
         <fault name='cut' kind='network' loss='100%' port='${port:b}'/>
         <fault name='narrow' kind='network' rate='1Mbit'/>
         <test param='${port:a} ${port:b}'> T.py </test></suite>",
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    passes(&finished);
    let journal = folder.journal();
    let effects = faults(&journal).iter().map(|fault| &*fault.fault.effect);
    assert_eq!(effects.clone().next(), Some("impaired the packets: delay 50 ms"));
    assert!(effects.clone().any(|effect| effect.ends_with("loss 100 %")), "{effects:?}");
    assert!(faults(&journal).iter().all(|fault| fault.removed.is_some()));
    assert!(nothing_left(&folder));
}

/// Ports are refused for new connections, existing ones and datagrams, in both directions.
const REFUSED: &str = "import socket, rtf\n\
class T(rtf.TestCase):\n    \
def connect(self, port): return socket.create_connection(('127.0.0.1', port), timeout=30)\n    \
def echo(self, tcp): tcp.sendall(b'x'); return tcp.recv(1) == b'x'\n    \
def datagram(self, port):\n        \
udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); udp.connect(('127.0.0.1', port)); udp.settimeout(30)\n        \
udp.send(b'7'); return udp.recv(10) == b'7'\n    \
def raises(self, error, call, *arguments):\n        \
try: call(*arguments)\n        \
except error: return True\n        \
return False\n    \
def run(self):\n        \
port, other = map(int, self.param.split())\n        \
tcp = self.connect(port); self.require(self.echo(tcp), 'a connection')\n        \
idle = self.connect(port)\n        \
with self.fault('gone'):\n            \
self.require(self.raises(ConnectionRefusedError, self.connect, port), 'refused')\n            \
self.require(self.raises(ConnectionResetError, self.echo, tcp), 'reset')\n            \
self.require(self.raises(ConnectionRefusedError, self.datagram, port), 'unreachable')\n            \
self.require(self.datagram(other), 'the other port')\n        \
self.require(self.raises(ConnectionError, self.echo, tcp), 'it stays reset')\n        \
with self.connect(port) as later: self.require(self.echo(later), 'accepted afterwards')\n        \
self.require(self.datagram(port), 'datagrams afterwards')\n        \
self.require(self.echo(idle), 'a connection that was idle')\n        \
with self.fault('all gone'):\n            \
self.require(self.raises(ConnectionRefusedError, self.datagram, other), 'all ports')\n";

/// Serves each connection in a thread; reports those that were reset.
const THREADED_ECHO: &str = "import socket, sys, threading\n\
def serve(connection):\n    \
try:\n        while data := connection.recv(65536): connection.sendall(data)\n    \
except ConnectionResetError: print('server: reset', flush=True)\n\
def udp(port):\n    \
socket_ = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); socket_.bind(('127.0.0.1', port))\n    \
while True:\n        data, sender = socket_.recvfrom(65536); socket_.sendto(data, sender)\n\
ports = [int(port) for port in sys.argv[1:]]\n\
for port in ports: threading.Thread(target=udp, args=(port,)).start()\n\
server = socket.create_server(('127.0.0.1', ports[0])); print('up', flush=True)\n\
while True: threading.Thread(target=serve, args=(server.accept()[0],)).start()\n";

#[test]
fn a_refused_port_is_as_if_no_process_had_it() {
    let folder = Folder::new();
    folder.file("echo.py", THREADED_ECHO).file("T.py", REFUSED);
    folder.file(
        "s.xml",
        "<suite name='net' isolate='network'>
         <fixture type='process' name='echo'>
           <command>python3 echo.py ${port:a} ${port:b}</command><ready log='up'/></fixture>
         <fault name='gone' kind='network' refuse='true' port='${port:a}'/>
         <fault name='all gone' kind='network' refuse='true'/>
         <test param='${port:a} ${port:b}'> T.py </test></suite>",
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    passes(&finished);
    let journal = folder.journal();
    let effects: Vec<&str> = faults(&journal).iter().map(|fault| &*fault.fault.effect).collect();
    let [gone, all] = effects[..] else { panic!("{effects:?}") };
    assert!(gone.starts_with("impaired the packets of port ") && gone.ends_with(": refused"));
    assert_eq!(all, "impaired the packets: refused");
    let output = journal.events.iter().any(|event| {
        matches!(&event.kind, EventKind::Output(output) if output.text.contains("server: reset"))
    });
    assert!(output, "the server's end of the connection was not reset");
    assert!(nothing_left(&folder));
}
