//! Few descriptors, idle web clients, a blocked console and a full results disk at the same time:
//! if a fixture is killed, the robot is still parked.

use std::net::{SocketAddr, TcpStream};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::support::{Folder, kill, nothing_left, wait_until};
use crate::web::Web;

/// Far more than the run may have open files.
const CONNECTIONS: usize = 1000;

const FLOOD: &str = "
function TestCase.run()
  for number = 1, 20000 do rtf.report(('x'):rep(100) .. number) end
  io.open('filled', 'w'):close()
  rtf.sleep(1000)
end
";

const SUITE: &str = "<suite name='arm'>
  <fixture type='process' name='robot'>
    <command>sh -c 'echo $$ > pid; echo up; exec sleep 1000'</command><ready log='up'/>
  </fixture>
  <hook name='park' on='collapse'><command>touch parked</command></hook>
  <test type='lua' name='flood' after-collapse='fail'>flood.lua</test>
</suite>";

/// `rtf run` with 256 descriptors and 512 KiB for its results, in a mount namespace.
fn starved(folder: &Folder) -> Command {
    let script = "mount -t tmpfs -o size=512k none disk && ulimit -n 256 && exec \"$@\"";
    let args = ["run", "-v", "suite.xml", "--web=127.0.0.1:0", "--results", "disk/results"];
    let rtf = folder.command(&args);
    let mut command = Command::new("unshare");
    command.args(["-Urm", "sh", "-c", script, "sh"]).arg(rtf.get_program()).args(rtf.get_args());
    command.current_dir(folder.path()).env("NO_COLOR", "1").stdin(Stdio::null());
    command
}

fn idle(address: SocketAddr) -> Option<TcpStream> {
    TcpStream::connect_timeout(&address, Duration::from_secs(1)).ok()
}

#[test]
fn a_killed_fixture_parks_the_robot_while_everything_is_scarce() {
    let folder = Folder::new();
    folder.file("flood.lua", FLOOD).file("suite.xml", SUITE).file("disk/.keep", "");
    let web = Web::of(folder.start_command(starved(&folder)));
    let connections: Vec<_> = (0..CONNECTIONS).filter_map(|_| idle(web.address)).collect();
    wait_until("a full disk", || folder.path().join("filled").exists().then_some(()));
    let robot = folder.read("pid").trim().parse().expect("a process id");
    assert!(kill(robot));
    wait_until("the hook", || folder.path().join("parked").exists().then_some(()));
    // Only now is the console read.
    let finished = web.finish();
    drop(connections);
    assert_eq!(finished.code, Some(3), "{}\n{}", finished.stdout, finished.stderr);
    let shown = &finished.stdout;
    assert!(shown.contains("COLLAPSED  fixture robot"), "{shown}");
    assert!(shown.contains("No space left on device"), "{shown}");
    assert!(shown.contains("1 collapsed"), "{shown}");
    assert!(!finished.stderr.contains("Too many open files"), "{}", finished.stderr);
    assert!(nothing_left(&folder));
}
