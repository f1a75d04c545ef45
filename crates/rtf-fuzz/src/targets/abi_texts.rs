//! Texts and numbers that a C or C++ plug-in passes to its host: for all of them, the runner
//! understands the host's lines.
#![expect(unsafe_code, reason = "calls the table as foreign code does")]

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::io::Read as _;
use std::os::unix::net::UnixStream;

use ::rtf_host::Session;
use rtf_model::protocol::{Notification, Plugin};
use rtf_process::codec::{HostMessage, decode};

use crate::abi::{
    rtf_case, rtf_comparison, rtf_host, rtf_measurement, rtf_message, rtf_parameter, rtf_sample,
    rtf_text,
};
use crate::host_table;

/// The table of functions, which is never freed because threads of a plug-in may use it, and the
/// other end of the channel.
struct Channel {
    table: &'static rtf_host,
    ours: UnixStream,
}

thread_local! {
    static CHANNEL: RefCell<Channel> = RefCell::new(Channel::open());
}

impl Channel {
    fn open() -> Self {
        let (ours, theirs) = UnixStream::pair().expect("sockets");
        ours.set_nonblocking(true).expect("a socket");
        let table = host_table::for_plugin(&Session::over(theirs), &Plugin::default());
        Self { table, ours }
    }

    /// The lines that the host has written.
    fn lines(&mut self) -> Vec<Vec<u8>> {
        let mut bytes = Vec::new();
        // The error is that nothing more has arrived.
        let error = self.ours.read_to_end(&mut bytes).map_err(|error| error.kind());
        assert_eq!(error, Err(std::io::ErrorKind::WouldBlock));
        assert!(bytes.is_empty() || bytes.ends_with(b"\n"), "an incomplete line");
        bytes.split(|byte| *byte == b'\n').filter(|it| !it.is_empty()).map(<[u8]>::to_vec).collect()
    }
}

/// What a plug-in passes: a number, its bytes as a text, and the parts between zero bytes.
struct Passed<'a> {
    kind: i32,
    number: f64,
    parts: Vec<&'a [u8]>,
}

impl<'a> Passed<'a> {
    fn part(&self, index: usize) -> &'a [u8] {
        self.parts.get(index).copied().unwrap_or_default()
    }

    fn text(&self, index: usize) -> rtf_text {
        lend(self.part(index))
    }

    /// The third part, as a file name.
    fn file(&self) -> CString {
        CString::new(self.part(2)).expect("a part has no zero")
    }

    /// What the host makes of a text.
    fn expected(&self, index: usize) -> String {
        String::from_utf8_lossy(self.part(index)).into_owned()
    }
}

fn lend(bytes: &[u8]) -> rtf_text {
    rtf_text { data: bytes.as_ptr().cast::<c_char>(), length: bytes.len() }
}

/// Calls of a plug-in: the first byte of an input selects the function.
pub fn check(data: &[u8]) {
    let Some(([function, kind, number @ ..], rest)) = data.split_first_chunk::<10>() else {
        return;
    };
    let parts = rest.split(|byte| *byte == 0).collect();
    let number = f64::from_le_bytes(*number);
    let passed = Passed { kind: i32::from(*kind).wrapping_sub(2), number, parts };
    CHANNEL.with_borrow_mut(|channel| {
        // SAFETY: all pointers are valid during the call.
        let expected = unsafe { call(channel.table, function % 7, &passed) };
        let mut is_found = expected.is_none();
        for line in channel.lines() {
            match decode(&line) {
                Ok(HostMessage::Notification(told)) => {
                    is_found |= text_of(&told) == expected.as_deref();
                }
                other => panic!("{other:?}: {}", String::from_utf8_lossy(&line)),
            }
        }
        assert!(is_found, "the runner gets another text than {expected:?}");
    });
}

/// Calls a function, and returns a text that the runner must get, if it must.
///
/// # Safety
/// The table is that of a host.
unsafe fn call(table: &rtf_host, function: u8, passed: &Passed<'_>) -> Option<String> {
    // SAFETY: the caller's promise, and all pointers are valid during the calls.
    unsafe {
        match function {
            0 => {
                message(table, passed);
                return Some(passed.expected(0));
            }
            1 => measure(table, passed),
            2 => sample(table, passed),
            3 => {
                (table.collapsed)(table.context, passed.text(0));
                return Some(passed.expected(0));
            }
            4 => (table.provide)(table.context, passed.text(0), passed.kind, passed.text(1)),
            5 => {
                let names: Vec<rtf_text> = passed.parts.iter().map(|part| lend(part)).collect();
                (table.plan_cases)(table.context, names.as_ptr(), names.len());
            }
            _ => case(table, passed),
        }
    }
    None
}

/// # Safety
/// As for [`call`].
unsafe fn message(table: &rtf_host, passed: &Passed<'_>) {
    let file = passed.file();
    let numbers = rtf_comparison {
        size: size_of::<rtf_comparison>(),
        expected: &raw const passed.number,
        expected_count: 1,
        got: &raw const passed.number,
        got_count: 1,
        tolerance: passed.number,
        worst: i64::from(passed.kind),
    };
    let message = rtf_message {
        size: size_of::<rtf_message>(),
        kind: passed.kind,
        critical: passed.kind,
        text: passed.text(0),
        file: file.as_ptr(),
        line: 7,
        comparison: &raw const numbers,
    };
    // SAFETY: the caller's promise.
    unsafe { (table.message)(table.context, &raw const message) }
}

/// # Safety
/// As for [`call`].
unsafe fn measure(table: &rtf_host, passed: &Passed<'_>) {
    let file = passed.file();
    let measurement = rtf_measurement {
        size: size_of::<rtf_measurement>(),
        name: passed.text(0),
        value: passed.number,
        unit: passed.text(1),
        low: &raw const passed.number,
        high: std::ptr::null(),
        file: file.as_ptr(),
        line: 7,
    };
    // SAFETY: the caller's promise.
    let _ = unsafe { (table.measure)(table.context, &raw const measurement) };
}

/// # Safety
/// As for [`call`].
unsafe fn sample(table: &rtf_host, passed: &Passed<'_>) {
    let file = passed.file();
    let sample = rtf_sample {
        size: size_of::<rtf_sample>(),
        name: passed.text(0),
        value: passed.number,
        unit: passed.text(1),
        low: std::ptr::null(),
        high: &raw const passed.number,
        time: &raw const passed.number,
        file: file.as_ptr(),
        line: 7,
    };
    // SAFETY: the caller's promise.
    let _ = unsafe { (table.sample)(table.context, &raw const sample) };
}

/// # Safety
/// As for [`call`].
unsafe fn case(table: &rtf_host, passed: &Passed<'_>) {
    let file = passed.file();
    let parameter = rtf_parameter { name: passed.text(1), value: passed.text(3) };
    let case = rtf_case {
        size: size_of::<rtf_case>(),
        name: passed.text(0),
        parameters: &raw const parameter,
        parameter_count: 1,
        file: file.as_ptr(),
        line: 7,
    };
    // SAFETY: the caller's promise.
    unsafe {
        if (table.case_begin)(table.context, &raw const case) != 0 {
            (table.case_end)(table.context, passed.kind);
        }
    }
}

fn text_of(told: &Notification) -> Option<&str> {
    match told {
        Notification::Message(message) => Some(&message.text),
        Notification::Collapsed { reason } => Some(reason),
        _ => None,
    }
}
