//! The socket of `RTF_SESSION`, over which a program reports while it runs.

use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::time::Duration;

use rtf_model::protocol::FixtureValue;
use rtf_model::{Attachment, Location, Measurement, Message, Outcome, Parameter, Samples};
use rustix::io::{Errno, FdFlags};
use rustix::net::{
    AddressFamily, RecvFlags, SendFlags, SocketFlags, SocketType, recv, send, socketpair,
};
use serde::Deserialize;
use serde_json::Value;

use crate::case::{CaseResult, StartedCase};
use crate::case_reporter::CaseReporter;

/// The longest packet.
const PACKET: usize = 256 * 1024;

/// A packet was accepted, or the case runs.
const YES: u8 = b'0';
/// It was not, or the case does not run.
const NO: u8 = b'1';
/// An empty list of values.
const NO_VALUES: &[u8] = b"[]";

/// Our end.
#[derive(Debug)]
pub(super) struct SessionSocket {
    socket: OwnedFd,
    /// For received packets.
    buffer: Vec<u8>,
    pace: Pace,
}

/// Whether the packets can be read less often: the program measures its cases itself, and
/// waits for no answer.
#[derive(Debug, Default)]
struct Pace {
    /// Whether a packet was answered since the last end of a case.
    any_answer: bool,
    is_relaxed: bool,
}

impl Pace {
    fn on_answer(&mut self) {
        *self = Self { any_answer: true, is_relaxed: false };
    }

    fn on_case_end(&mut self, is_measured: bool) {
        *self = Self { any_answer: false, is_relaxed: is_measured && !self.any_answer };
    }
}

/// Opens a socket; the second descriptor is inherited by the program.
pub(super) fn pair() -> std::io::Result<(SessionSocket, OwnedFd)> {
    let flags = SocketFlags::CLOEXEC;
    let (ours, theirs) = socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, flags, None)?;
    rustix::io::fcntl_setfd(&theirs, FdFlags::empty())?;
    Ok((SessionSocket { socket: ours, buffer: vec![0; PACKET], pace: Pace::default() }, theirs))
}

impl AsFd for SessionSocket {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.socket.as_fd()
    }
}

/// A packet of the program (`spec/frameworks.md`).
#[derive(Debug, Deserialize)]
#[serde(tag = "method", content = "params", rename_all = "kebab-case")]
enum Packet {
    Measured(InCase<Measurement>),
    Sampled(InCase<Samples>),
    Attached(InCase<Attachment>),
    Message(InCase<Message>),
    FixtureValues {},
    CasesPlanned { names: Vec<String> },
    CaseStarted(Start),
    CaseFinished(Finish),
    Finished {},
}

/// Whether the program waits for the answer to a packet.
#[derive(Debug, Deserialize)]
struct Answered {
    #[serde(default = "yes")]
    answer: bool,
}

fn yes() -> bool {
    true
}

/// A report with the path of its case.
#[derive(Debug)]
struct InCase<T> {
    case: Option<String>,
    report: T,
}

impl<'de, T: serde::de::DeserializeOwned> Deserialize<'de> for InCase<T> {
    fn deserialize<D: serde::Deserializer<'de>>(input: D) -> Result<Self, D::Error> {
        let mut value = Value::deserialize(input)?;
        let case = value.as_object_mut().and_then(|fields| fields.remove("case"));
        let case = case.and_then(|case| case.as_str().map(str::to_owned));
        let report = serde_json::from_value(value).map_err(serde::de::Error::custom)?;
        Ok(Self { case, report })
    }
}

#[derive(Debug, Deserialize)]
struct Start {
    name: String,
    parent: Option<String>,
    #[serde(default)]
    parameters: Vec<Parameter>,
    #[serde(default)]
    tags: Vec<String>,
    location: Option<Location>,
}

#[derive(Debug, Deserialize)]
struct Finish {
    name: String,
    outcome: Option<Outcome>,
    reason: Option<String>,
    duration_us: Option<u64>,
    #[serde(default)]
    rerun: bool,
}

impl SessionSocket {
    /// Whether the next packets can wait: the program does not expect answers to them. Each
    /// packet that wakes the host takes time of the program that sends it.
    pub fn is_relaxed(&self) -> bool {
        self.pace.is_relaxed
    }

    /// The next packet, if there is one.
    pub fn receive(&mut self) -> Option<Vec<u8>> {
        let (socket, buffer, flags) = (&self.socket, &mut self.buffer, RecvFlags::DONTWAIT);
        let received = rustix::io::retry_on_intr(|| recv(socket, &mut buffer[..], flags));
        let (_, length) = received.ok().filter(|(_, length)| *length > 0)?;
        Some(buffer[..length].to_vec())
    }

    /// Carries out a packet, and answers it if the program waits for that.
    pub fn handle(&mut self, packet: &[u8], values: &[FixtureValue], cases: &mut CaseReporter<'_>) {
        let answer = match serde_json::from_slice(packet) {
            Ok(packet) => {
                if let Packet::CaseFinished(Finish { duration_us, .. }) = &packet {
                    self.pace.on_case_end(duration_us.is_some());
                }
                carry_out(packet, values, cases)
            }
            Err(error) => {
                let start: String = String::from_utf8_lossy(packet).chars().take(200).collect();
                cases.test_error(format!("a packet of the session is malformed: {error}: {start}"));
                vec![NO]
            }
        };
        let answered = serde_json::from_slice::<Answered>(packet);
        if answered.is_ok_and(|it| !it.answer) {
            return;
        }
        self.pace.on_answer();
        if self.send(&answer) == Err(Errno::MSGSIZE) {
            // Without an answer, the program would wait.
            let text = "the values of the fixtures are longer than a packet of the session";
            cases.test_error(text.to_owned());
            let _ = self.send(NO_VALUES);
        }
    }

    /// Sends an answer. Fails if the program has ended.
    fn send(&self, answer: &[u8]) -> Result<usize, Errno> {
        rustix::io::retry_on_intr(|| send(&self.socket, answer, SendFlags::NOSIGNAL))
    }
}

fn carry_out(packet: Packet, values: &[FixtureValue], cases: &mut CaseReporter<'_>) -> Vec<u8> {
    let answer = |is_accepted| vec![if is_accepted { YES } else { NO }];
    match packet {
        Packet::Measured(it) => cases.measure(it.case.as_deref(), it.report),
        Packet::Sampled(it) => cases.sample(it.case.as_deref(), it.report),
        Packet::Attached(it) => return answer(cases.attach(it.case.as_deref(), it.report)),
        Packet::Message(it) => cases.full_message(it.case.as_deref(), it.report),
        Packet::FixtureValues {} => return serde_json::to_vec(values).unwrap_or_default(),
        Packet::CasesPlanned { names } => {
            let runs = cases.announce(names).into_iter();
            let answers: Vec<u8> = runs.map(|runs| if runs { YES } else { NO }).collect();
            // An empty packet looks like the end of the socket.
            return if answers.is_empty() { vec![YES] } else { answers };
        }
        Packet::CaseStarted(Start { name, parent, parameters, tags, location }) => {
            if parent.is_none() && !cases.runs(&name) {
                return answer(false);
            }
            cases.start_case(parent.as_deref(), StartedCase { name, parameters, tags, location });
        }
        Packet::CaseFinished(Finish { name, outcome, reason, duration_us, rerun }) => {
            let duration = duration_us.map(Duration::from_micros);
            cases.finish(&name, CaseResult { outcome, reason, duration, rerun });
        }
        Packet::Finished {} => cases.complete_report(),
    }
    answer(true)
}

#[cfg(test)]
mod tests {
    use std::os::unix::net::UnixStream;

    use rtf_host::Session;

    use super::*;

    /// Asks for values of this length, and returns the answer.
    fn ask_for_values(bytes: usize) -> Vec<u8> {
        let (_runner, theirs) = UnixStream::pair().unwrap();
        let session = Session::over(theirs);
        let mut cases = CaseReporter::new(&session);
        let (mut ours, program) = pair().unwrap();
        let value = |name: &str| {
            let value = Value::String("x".repeat(bytes));
            FixtureValue { name: name.to_owned(), value }
        };
        let request = br#"{"method":"fixture-values","params":{}}"#;
        send(&program, request, SendFlags::NOSIGNAL).unwrap();
        let packet = ours.receive().unwrap();
        ours.handle(&packet, &[value("arm.port"), value("arm.model")], &mut cases);
        let mut answer = vec![0; 4 * PACKET];
        let (_, length) = recv(&program, &mut answer[..], RecvFlags::DONTWAIT).unwrap();
        answer.truncate(length);
        answer
    }

    #[test]
    fn packets_are_read_less_often_unless_the_program_waits_for_answers() {
        let (_runner, theirs) = UnixStream::pair().unwrap();
        let session = Session::over(theirs);
        let mut cases = CaseReporter::new(&session);
        let (mut ours, _program) = pair().unwrap();
        let mut is_relaxed_after = |packet: &str| {
            ours.handle(packet.as_bytes(), &[], &mut cases);
            ours.is_relaxed()
        };
        let start = r#"{"method":"case-started","answer":false,"params":{"name":"a"}}"#;
        let end = r#"{"method":"case-finished","answer":false,"params":{"name":"a"}}"#;
        let measured_end = &end.replace(r#""a"}"#, r#""a","duration_us":5}"#);
        let request = r#"{"method":"message","params":{"kind":"report","text":"x"}}"#;
        assert!(!is_relaxed_after(start));
        assert!(is_relaxed_after(measured_end));
        assert!(is_relaxed_after(start));
        assert!(!is_relaxed_after(request));
        assert!(!is_relaxed_after(measured_end), "the next case may ask, too");
        assert!(!is_relaxed_after(start));
        assert!(is_relaxed_after(measured_end));
        assert!(!is_relaxed_after(end), "the host measures the case");
    }

    /// The notifications that the runner gets for these packets.
    fn notifications(packets: &[&str]) -> String {
        let (mut runner, theirs) = UnixStream::pair().unwrap();
        let session = Session::over(theirs);
        let mut cases = CaseReporter::new(&session);
        let (mut ours, _program) = pair().unwrap();
        for packet in packets {
            ours.handle(packet.as_bytes(), &[], &mut cases);
        }
        runner.set_nonblocking(true).unwrap();
        let mut bytes = vec![0; PACKET];
        let length = std::io::Read::read(&mut runner, &mut bytes).unwrap();
        String::from_utf8_lossy(&bytes[..length]).into_owned()
    }

    #[test]
    fn a_case_can_run_several_times_in_a_process() {
        let start = r#"{"method":"case-started","answer":false,"params":{"name":"a"}}"#;
        let end = r#"{"method":"case-finished","answer":false,"params":{"name":"a"}}"#;
        let rerun = r#"{"method":"case-finished","answer":false,
            "params":{"name":"a","outcome":"failed","rerun":true}}"#;
        let got = notifications(&[start, rerun, start, end, start, end]);
        assert_eq!(got.matches("case-started").count(), 3, "{got}");
        assert_eq!(got.matches("case-finished").count(), 3, "{got}");
        assert_eq!(got.matches(r#""rerun":true"#).count(), 1, "{got}");
        assert!(!got.contains("not running"), "{got}");
    }

    #[test]
    fn an_end_without_a_start_is_an_error_only_if_it_is_a_problem() {
        let end = r#"{"method":"case-finished","answer":false,"params":{"name":"a"}}"#;
        let got = notifications(&[end]);
        let text = "warning: the program finished `a`, which is not running";
        assert!(got.contains(text) && got.contains(r#""kind":"report""#), "{got}");
        let failed = end.replace(r#""a"}"#, r#""a","outcome":"failed","reason":"stuck"}"#);
        let got = notifications(&[&failed]);
        assert!(got.contains("not running: stuck") && got.contains(r#""kind":"error""#), "{got}");
    }

    #[test]
    fn a_program_always_gets_an_answer() {
        assert!(ask_for_values(10).starts_with(br#"[{"name":"arm.port","value":"xxxxxxxxxx"}"#));
        assert_eq!(ask_for_values(64 * 1024 * 1024), NO_VALUES);
    }
}
