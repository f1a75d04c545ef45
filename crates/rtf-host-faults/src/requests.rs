//! The socket at which tests inject and remove faults.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixListener, UnixStream};
use std::sync::Arc;
use std::time::Duration;

use rustix::net::sockopt::socket_peercred;

use crate::injector::{Injector, NotInjected};

/// A request has at most so many bytes.
const REQUEST_LIMIT: u64 = 64 * 1024;
/// How long a test may take to write its request.
const READ_LIMIT: Duration = Duration::from_secs(10);

/// A request of a test: three lines.
#[derive(Debug)]
struct Request {
    verb: Verb,
    /// The name of the fault.
    fault: String,
    /// The name of the test.
    test: String,
}

#[derive(Debug)]
enum Verb {
    Inject,
    Remove,
}

impl Request {
    fn read(connection: &UnixStream) -> Option<Self> {
        let mut lines = BufReader::new(connection.take(REQUEST_LIMIT)).lines();
        let mut next = || lines.next()?.ok();
        let verb = match next()?.as_str() {
            "inject" => Verb::Inject,
            "remove" => Verb::Remove,
            _ => return None,
        };
        Some(Self { verb, fault: next()?, test: next()? })
    }
}

/// Opens the socket in the abstract namespace, which leaves no file, and serves it on a thread
/// until the process ends. Returns its name.
pub(crate) fn listen(injector: &Arc<Injector>) -> io::Result<String> {
    let name = format!("rtf-faults-{}", std::process::id());
    let listener = UnixListener::bind_addr(&SocketAddr::from_abstract_name(&name)?)?;
    let injector = Arc::clone(injector);
    std::thread::Builder::new().spawn(move || {
        for connection in listener.incoming().flatten() {
            let injector = Arc::clone(&injector);
            std::thread::spawn(move || serve(&connection, &injector));
        }
    })?;
    Ok(name)
}

fn serve(connection: &UnixStream, injector: &Injector) {
    let own = rustix::process::geteuid();
    if !socket_peercred(connection).is_ok_and(|peer| peer.uid == own) {
        return;
    }
    let _ = connection.set_read_timeout(Some(READ_LIMIT));
    let Some(request) = Request::read(connection) else { return };
    if let Err(problem) = carry_out(&request, injector) {
        let mut connection = connection;
        // The test may have ended.
        let _ = connection.write_all(problem.as_bytes());
    }
}

fn carry_out(request: &Request, injector: &Injector) -> Result<(), String> {
    let (test, fault) = find(request, injector)?;
    match request.verb {
        Verb::Inject => injector.inject(test, fault).map_err(|problem| match problem {
            NotInjected::Failed(problem) => problem,
            NotInjected::TestEnded => "the test has ended".to_owned(),
        }),
        // It may have ended already.
        Verb::Remove => {
            injector.remove(test, fault);
            Ok(())
        }
    }
}

fn find(request: &Request, injector: &Injector) -> Result<(rtf_model::TestId, usize), String> {
    let state = injector.state();
    let running = state.tests.iter().rfind(|running| running.name == request.test);
    let running = running.ok_or_else(|| format!("the test `{}` does not run", request.test))?;
    let all = injector.settings.faults.iter().map(|fault| &fault.config);
    let own = all.enumerate().filter(|(_, fault)| fault.belongs_to(&request.test));
    let requested: Vec<_> = own.clone().filter(|(_, fault)| fault.at.is_none()).collect();
    if let Some((index, _)) = requested.iter().find(|(_, fault)| fault.name == request.fault) {
        return Ok((running.id, *index));
    }
    if own.clone().any(|(_, fault)| fault.name == request.fault) {
        return Err("it has a time, `at`, at which the suite injects it".to_owned());
    }
    let names: Vec<_> = requested.iter().map(|(_, fault)| format!("`{}`", fault.name)).collect();
    Err(format!("the suite declares no such fault; this test can inject {}", names.join(", ")))
}
