//! Faults of a proxy: they last as long as a connection to it.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::Shutdown;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixStream};
use std::time::Duration;

use rtf_model::ValuesFault;

/// How long a proxy may take to begin a fault.
const BEGIN_LIMIT: Duration = Duration::from_secs(10);
/// How long it may take to end one.
const END_LIMIT: Duration = Duration::from_secs(1);
/// An answer has at most so many bytes.
const ANSWER_LIMIT: u64 = 64 * 1024;
/// The answer when a fault has begun.
const DONE: &str = "ok";

/// A fault of a proxy. The kernel closes the connection if this process ends, and the proxy ends
/// the fault.
#[derive(Debug)]
pub(crate) struct ChangedValues(UnixStream);

/// Begins a fault, and returns when messages are changed.
///
/// # Errors
/// Why that is not possible.
pub(crate) fn change(socket: &str, fault: &ValuesFault) -> Result<ChangedValues, String> {
    let failed = |error: io::Error| format!("the proxy does not answer: {error}");
    let (connection, answer) = exchange(socket, fault).map_err(failed)?;
    match answer.trim_end() {
        DONE => Ok(ChangedValues(connection)),
        "" => Err("the proxy has closed the connection".to_owned()),
        problem => Err(problem.to_owned()),
    }
}

fn exchange(socket: &str, fault: &ValuesFault) -> io::Result<(UnixStream, String)> {
    let connection = UnixStream::connect_addr(&SocketAddr::from_abstract_name(socket)?)?;
    connection.set_read_timeout(Some(BEGIN_LIMIT))?;
    let mut request = serde_json::to_string(fault)?;
    request.push('\n');
    (&connection).write_all(request.as_bytes())?;
    let mut answer = String::new();
    BufReader::new((&connection).take(ANSWER_LIMIT)).read_line(&mut answer)?;
    Ok((connection, answer))
}

impl Drop for ChangedValues {
    /// Waits until the proxy has ended the fault.
    fn drop(&mut self) {
        let Self(connection) = self;
        let _ = connection.shutdown(Shutdown::Write);
        let _ = connection.set_read_timeout(Some(END_LIMIT));
        let _ = connection.read(&mut [0]);
    }
}
