//! A client that can also send requests that no browser would send.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use serde_json::Value;

/// Nothing here takes as long, unless it hangs.
const LIMIT: Duration = Duration::from_secs(30);

/// What a server answered.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn read(mut stream: impl Read) -> Self {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("an answer");
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("headers");
        let head = String::from_utf8(bytes[..end].to_vec()).expect("headers in ASCII");
        let status = head.split(' ').nth(1).and_then(|code| code.parse().ok());
        Self { status: status.expect("a status"), head, body: bytes[end + 4..].to_vec() }
    }

    pub fn header(&self, name: &str) -> Option<&str> {
        let mut lines = self.head.lines().filter_map(|line| line.split_once(": "));
        lines.find(|(found, _)| found.eq_ignore_ascii_case(name)).map(|(_, value)| value)
    }

    pub fn text(&self) -> String {
        String::from_utf8(self.body.clone()).expect("text")
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.text()))
    }
}

/// A request with these lines after the first one; HTTP/1.0, so that the answer
/// ends with the connection.
pub fn request(address: SocketAddr, first: &str, lines: &[&str], body: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(LIMIT)).expect("a limit");
    let mut text = format!("{first} HTTP/1.0\r\n");
    if !lines.iter().any(|line| line.starts_with("Host:")) {
        text += &format!("Host: {address}\r\n");
    }
    for line in lines {
        text += &format!("{line}\r\n");
    }
    if !body.is_empty() {
        text += &format!("Content-Length: {}\r\n", body.len());
    }
    stream.write_all(format!("{text}\r\n{body}").as_bytes()).expect("a request");
    stream
}

pub fn ask(address: SocketAddr, first: &str, lines: &[&str], body: &str) -> Answer {
    Answer::read(request(address, first, lines, body))
}

pub fn get(address: SocketAddr, path: &str) -> Answer {
    ask(address, &format!("GET {path}"), &[], "")
}

/// A stream of server-sent events.
pub struct Stream {
    lines: std::io::Lines<BufReader<TcpStream>>,
}

/// One of its events.
#[derive(Debug, PartialEq)]
pub struct Sent {
    pub name: String,
    pub id: u64,
    pub data: Value,
}

impl Stream {
    pub fn open(address: SocketAddr, path: &str, lines: &[&str]) -> Self {
        let stream = request(address, &format!("GET {path}"), lines, "");
        let mut lines = BufReader::new(stream).lines();
        let head: Vec<_> = lines
            .by_ref()
            .map(|line| line.expect("a header"))
            .take_while(|line| !line.is_empty())
            .collect();
        assert!(head[0].contains(" 200 "), "{head:?}");
        Self { lines }
    }

    /// The next event; nothing at the end of the stream.
    pub fn next(&mut self) -> Option<Sent> {
        let mut sent = Sent { name: "message".to_owned(), id: 0, data: Value::Null };
        for line in self.lines.by_ref() {
            let line = line.expect("a line");
            match line.split_once(": ") {
                Some(("event", name)) => sent.name = name.to_owned(),
                Some(("id", id)) => sent.id = id.parse().expect("a number"),
                Some(("data", data)) => sent.data = serde_json::from_str(data).expect("JSON"),
                _ if line.is_empty() && !sent.data.is_null() => return Some(sent),
                _ => {}
            }
        }
        None
    }

    /// The next one that is not about progress.
    pub fn next_event(&mut self) -> Sent {
        loop {
            let sent = self.next().expect("an event");
            if sent.name != "progress" {
                return sent;
            }
        }
    }

    /// All that come, up to the end of the stream.
    pub fn rest(mut self) -> Vec<Sent> {
        std::iter::from_fn(|| self.next()).filter(|sent| sent.name != "progress").collect()
    }
}
