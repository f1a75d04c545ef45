//! Requests of a test to the fixture `faults`: `spec/faults.md`.

use std::io::{self, Read, Write};
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixStream};

use rtf_model::protocol::Plugin;
use rtf_model::{Location, value_text};

use super::Session;

/// The value of a fixture that contains the name of the socket.
const SOCKET: &str = "faults.socket";

/// A request of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultRequest {
    /// The fault begins.
    Inject,
    /// The fault ends. No effect if it has ended already.
    Remove,
}

impl Session {
    /// Injects or removes a fault of the suite, and waits until that is done. Returns false if it
    /// is not possible, which it has reported as an error: the plug-in then leaves the step.
    #[must_use]
    pub fn fault(
        &self,
        plugin: &Plugin,
        request: FaultRequest,
        name: &str,
        location: Option<Location>,
    ) -> bool {
        let (verb, done) = match request {
            FaultRequest::Inject => ("inject", "injected"),
            FaultRequest::Remove => ("remove", "removed"),
        };
        self.flush();
        match send(plugin, &format!("{verb}\n{name}\n{}\n", plugin.name)) {
            Ok(()) => true,
            Err(problem) => {
                self.error(format!("the fault \"{name}\" was not {done}: {problem}"), location);
                false
            }
        }
    }
}

fn send(plugin: &Plugin, request: &str) -> Result<(), String> {
    let socket = plugin.fixture_values.iter().find(|value| value.name == SOCKET);
    let socket = socket.ok_or("the suite declares no `<fault>` without `at`")?;
    let answer = exchange(&value_text(&socket.value), request);
    match answer {
        Ok(problem) if problem.is_empty() => Ok(()),
        Ok(problem) => Err(problem),
        Err(error) => Err(format!("the fixture `faults` does not answer: {error}")),
    }
}

fn exchange(socket: &str, request: &str) -> io::Result<String> {
    let mut connection = UnixStream::connect_addr(&SocketAddr::from_abstract_name(socket)?)?;
    connection.write_all(request.as_bytes())?;
    let mut answer = String::new();
    connection.read_to_string(&mut answer)?;
    Ok(answer)
}
