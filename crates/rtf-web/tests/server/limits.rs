//! What clients cannot use up: connections, descriptors, patience.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use rtf_web::{Limits, Settings};

use crate::world::{World, settings};

const LIMIT: Duration = Duration::from_secs(30);

fn with(limits: Limits) -> World {
    let (world, mut run) = World::with(&Settings { limits, ..settings() });
    run.plan("arm", &["first"]);
    run.flush();
    world
}

fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    stream
}

/// All that comes before the server closes the connection; whether it was closed
/// in an orderly way does not matter.
fn rest(mut stream: TcpStream) -> Vec<u8> {
    let mut bytes = Vec::new();
    match stream.read_to_end(&mut bytes) {
        Ok(_) => {}
        Err(error) => assert_eq!(error.kind(), std::io::ErrorKind::ConnectionReset, "{error}"),
    }
    bytes
}

fn is_answered(address: SocketAddr) -> bool {
    let mut stream = connect(address);
    let request = format!("GET /api/v1 HTTP/1.0\r\nHost: {address}\r\n\r\n");
    // A refused connection may be closed before this.
    let _ = stream.write_all(request.as_bytes());
    rest(stream).starts_with(b"HTTP/1.0 200")
}

#[test]
fn connections_beyond_the_budget_are_refused_and_the_others_served() {
    let patient = Limits { connections: 8, per_address: 8, head: LIMIT, idle: LIMIT };
    let world = with(patient);
    let mut idle: Vec<_> = (0..8).map(|_| connect(world.address())).collect();
    for _ in 0..20 {
        let refused = rest(connect(world.address()));
        assert!(
            refused.is_empty() || refused.starts_with(b"HTTP/1.1 503 "),
            "{}",
            String::from_utf8_lossy(&refused)
        );
    }
    // Those that were there first are served as ever.
    let mut first = idle.remove(0);
    let request = format!("GET /api/v1 HTTP/1.0\r\nHost: {}\r\n\r\n", world.address());
    first.write_all(request.as_bytes()).unwrap();
    assert!(rest(first).starts_with(b"HTTP/1.0 200"));
    assert!(is_answered(world.address()), "what one gives back is there for the next");
}

#[test]
fn one_address_does_not_take_all_connections() {
    let limits = Limits { connections: 8, per_address: 4, head: LIMIT, idle: LIMIT };
    let world = with(limits);
    let _idle: Vec<_> = (0..4).map(|_| connect(world.address())).collect();
    assert!(rest(connect(world.address())).len() < 200, "refused");
    assert!(!is_answered(world.address()));
}

#[test]
fn a_connection_that_sends_no_request_is_closed() {
    let soon = Duration::from_millis(200);
    let limits = Limits { head: soon, ..Limits::of_files(1024) };
    let world = with(limits);
    let before = Instant::now();
    let mut slow = connect(world.address());
    slow.write_all(b"GET /api/v1 HTTP/1.1\r\nHost: ").unwrap();
    assert!(rest(connect(world.address())).is_empty(), "it never sent a byte");
    assert!(!rest(slow).starts_with(b"HTTP/1.1 200"), "it never sent the rest");
    let mut kept = connect(world.address());
    let request = format!("GET /api/v1 HTTP/1.1\r\nHost: {}\r\n\r\n", world.address());
    kept.write_all(request.as_bytes()).unwrap();
    assert!(rest(kept).starts_with(b"HTTP/1.1 200"), "one that is kept open is closed, too");
    assert!(before.elapsed() >= soon);
}

#[test]
fn a_client_that_takes_nothing_loses_its_connection() {
    let limits = Limits { idle: Duration::from_millis(300), ..Limits::of_files(1024) };
    let (world, mut run) = World::with(&Settings { limits, ..settings() });
    run.plan("arm", &["first"]);
    run.start(crate::world::TEST);
    run.attach("long.bin", &vec![b'x'; 64 << 20]);
    run.flush();
    let path = "/api/v1/runs/own/files/attachments/long.bin";
    let mut lazy = connect(world.address());
    let request = format!("GET {path} HTTP/1.0\r\nHost: {}\r\n\r\n", world.address());
    lazy.write_all(request.as_bytes()).unwrap();
    lazy.read_exact(&mut [0; 16]).unwrap();
    assert_eq!(held_files("long.bin"), 1);
    let start = Instant::now();
    while held_files("long.bin") > 0 {
        assert!(start.elapsed() < LIMIT, "the file of a client that takes nothing stays open");
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(lazy);
    assert!(is_answered(world.address()), "the others are served");
}

/// How many descriptors of this process lead to a file of this name.
fn held_files(name: &str) -> usize {
    let links = std::fs::read_dir("/proc/self/fd").unwrap();
    let links = links.filter_map(|entry| std::fs::read_link(entry.ok()?.path()).ok());
    links.filter(|path| path.ends_with(name)).count()
}
