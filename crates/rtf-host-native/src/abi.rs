//! The binary interface between the native host and a plug-in.
//!
//! `xtask header` turns this file into `sdk/c/include/rtf/plugin.h`; what is
//! written here is what a plug-in's author reads there. Fields may be appended
//! to the structures, which raises the minor version; anything else raises the
//! major version.

use std::ffi::{c_char, c_int, c_void};

/// The version that a plug-in and its host must share.
pub const RTF_ABI_MAJOR: u32 = 1;
/// Counts the fields that were appended since the major version began.
pub const RTF_ABI_MINOR: u32 = 2;

/// The plug-in is a test: `setup`, `run`, `tear_down`.
pub const RTF_KIND_TEST: i32 = 1;
/// The plug-in is a fixture: `setup`, `check`, `tear_down`.
pub const RTF_KIND_FIXTURE: i32 = 2;

/// A step ended: it did its work. Whether checks held, the host knows.
pub const RTF_DONE: i32 = 0;
/// A step ended: no, it failed. As `return false` in other languages.
pub const RTF_REFUSED: i32 = 1;
/// A step ended early, by an assertion or an error that was reported, or
/// because the host asked to stop.
pub const RTF_STOPPED: i32 = 2;

/// A message for information only.
pub const RTF_MESSAGE_REPORT: i32 = 0;
/// A check that held.
pub const RTF_MESSAGE_CHECK: i32 = 1;
/// A check or an assertion that did not hold: the robot is wrong.
pub const RTF_MESSAGE_FAILURE: i32 = 2;
/// The plug-in could not do its work: the bench is wrong.
pub const RTF_MESSAGE_ERROR: i32 = 3;

/// Some text in UTF-8; need not end with a zero. Other bytes are shown as `U+FFFD`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rtf_text {
    /// The first byte; may be null when `length` is 0.
    pub data: *const c_char,
    /// The number of bytes.
    pub length: usize,
}

/// The numbers behind a near-equality check: one entry for a scalar.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_comparison {
    /// `sizeof(rtf_comparison)`.
    pub size: usize,
    /// What was expected.
    pub expected: *const f64,
    /// The number of entries of `expected`.
    pub expected_count: usize,
    /// What was found.
    pub got: *const f64,
    /// The number of entries of `got`.
    pub got_count: usize,
    /// The largest absolute difference that is accepted.
    pub tolerance: f64,
    /// The index with the largest difference; negative when there is none.
    pub worst: i64,
}

/// A message for the report.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_message {
    /// `sizeof(rtf_message)`.
    pub size: usize,
    /// `RTF_MESSAGE_REPORT`, `RTF_MESSAGE_CHECK`, `RTF_MESSAGE_FAILURE` or `RTF_MESSAGE_ERROR`.
    pub kind: i32,
    /// Not 0: going on would be unsafe, the rest of the suite is skipped.
    pub critical: i32,
    /// The text, of any length.
    pub text: rtf_text,
    /// The source file (`__FILE__`), null when unknown.
    pub file: *const c_char,
    /// The line in it (`__LINE__`), 0 when unknown.
    pub line: u32,
    /// The numbers behind it, null when there are none.
    pub comparison: *const rtf_comparison,
}

/// A number that a test measured.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_measurement {
    /// `sizeof(rtf_measurement)`.
    pub size: usize,
    /// What was measured.
    pub name: rtf_text,
    /// The value.
    pub value: f64,
    /// Its unit, empty for a pure number.
    pub unit: rtf_text,
    /// The smallest accepted value, null when there is no such limit.
    pub low: *const f64,
    /// The largest accepted value, null when there is no such limit.
    pub high: *const f64,
    /// The source file, null when unknown.
    pub file: *const c_char,
    /// The line in it, 0 when unknown.
    pub line: u32,
}

/// A sample of a signal.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_sample {
    /// `sizeof(rtf_sample)`.
    pub size: usize,
    /// The signal.
    pub name: rtf_text,
    /// The value.
    pub value: f64,
    /// Its unit, empty for a pure number.
    pub unit: rtf_text,
    /// The smallest accepted value, null when there is no such limit.
    pub low: *const f64,
    /// The largest accepted value, null when there is no such limit.
    pub high: *const f64,
    /// When, in seconds since the test's set-up began; null: now.
    pub time: *const f64,
    /// The source file, null when unknown.
    pub file: *const c_char,
    /// The line in it, 0 when unknown.
    pub line: u32,
}

/// A file that is kept with the result.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_attachment {
    /// `sizeof(rtf_attachment)`.
    pub size: usize,
    /// Where it is. It is copied before the call returns.
    pub path: rtf_text,
    /// The name under which reports show it; empty: the path's last part.
    pub name: rtf_text,
    /// Its media type (`text/csv`), empty when unknown.
    pub media_type: rtf_text,
}

/// An attempt of a test, of which a fixture is told.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_test {
    /// The size of this structure in the host. A field that lies beyond it is not there.
    pub size: usize,
    /// The test's number in the run.
    pub id: u32,
    /// The repetition, from 1.
    pub repetition: u32,
    /// The attempt at this repetition, from 1.
    pub attempt: u32,
    /// Always 0; room for what may come.
    pub reserved: u32,
    /// The test's name in the suite.
    pub name: rtf_text,
    /// How it was judged: `passed`, `failed`, …; empty before it begins.
    pub verdict: rtf_text,
    /// Why it did not pass, else empty.
    pub reason: rtf_text,
}

/// What the host does for a plug-in. Every function takes `context` first and
/// may be called from any thread, until the process ends.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_host {
    /// The host's `RTF_ABI_MAJOR`.
    pub abi_major: u32,
    /// The host's `RTF_ABI_MINOR`.
    pub abi_minor: u32,
    /// The size of this table in the host. A field that lies beyond it is not there.
    pub size: usize,
    /// The first argument of the functions below.
    pub context: *mut c_void,
    /// Reports something. A failure or an error decides the verdict, the first
    /// of them does.
    pub message: unsafe extern "C" fn(context: *mut c_void, message: *const rtf_message),
    /// Records a number. Returns 1 when it is within its limits, else 0, which
    /// is a failure.
    pub measure:
        unsafe extern "C" fn(context: *mut c_void, measurement: *const rtf_measurement) -> c_int,
    /// Keeps a file with the result.
    pub attach: unsafe extern "C" fn(context: *mut c_void, attachment: *const rtf_attachment),
    /// Reports that a fixture is not well any more.
    pub collapsed: unsafe extern "C" fn(context: *mut c_void, reason: rtf_text),
    /// Returns 1 when the plug-in was asked to stop, else 0.
    pub interrupted: unsafe extern "C" fn(context: *mut c_void) -> c_int,
    /// Sleeps. Returns 1 at once when the plug-in is asked to stop, else 0 after
    /// that many seconds.
    pub wait: unsafe extern "C" fn(context: *mut c_void, seconds: f64) -> c_int,
    /// The plug-in's name in the suite.
    pub name: unsafe extern "C" fn(context: *mut c_void) -> rtf_text,
    /// Its parameter string in the suite.
    pub param: unsafe extern "C" fn(context: *mut c_void) -> rtf_text,
    /// The suite's environment string.
    pub environment: unsafe extern "C" fn(context: *mut c_void) -> rtf_text,
    /// The repetition, from 1.
    pub repetition: unsafe extern "C" fn(context: *mut c_void) -> u32,
    /// Since 1.2: takes a sample of a signal. Returns 1 when it is within its
    /// limits, else 0, which is a failure. Only for tests.
    pub sample: unsafe extern "C" fn(context: *mut c_void, sample: *const rtf_sample) -> c_int,
}

/// What a plug-in is, and how it is called. All functions are called on the
/// process's main thread, one at a time. No exception may leave them.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_plugin_table {
    /// `RTF_ABI_MAJOR`.
    pub abi_major: u32,
    /// `RTF_ABI_MINOR`.
    pub abi_minor: u32,
    /// `sizeof(rtf_plugin_table)`.
    pub size: usize,
    /// `RTF_KIND_TEST` or `RTF_KIND_FIXTURE`.
    pub kind: i32,
    /// The name of the class or module, for messages. May be null.
    pub name: *const c_char,
    /// Makes the plug-in, which gets back the result as `self` from now on.
    /// Null means that this failed; say why in a message first.
    pub create: Option<unsafe extern "C" fn(host: *const rtf_host) -> *mut c_void>,
    /// Ends it. Called once, after `tear_down`. May be null.
    pub destroy: Option<unsafe extern "C" fn(self_: *mut c_void)>,
    /// Called first, with arguments as `main` gets them: `argv[0]` is the
    /// name, `argv[argc]` is null. May be null.
    pub setup: Option<
        unsafe extern "C" fn(self_: *mut c_void, argc: c_int, argv: *mut *mut c_char) -> i32,
    >,
    /// The test itself, called when `setup` succeeded. Null in a fixture.
    pub run: Option<unsafe extern "C" fn(self_: *mut c_void) -> i32>,
    /// Tells whether the fixture is well. Null in a test, and in a fixture that
    /// cannot tell.
    pub check: Option<unsafe extern "C" fn(self_: *mut c_void) -> i32>,
    /// Called last, whatever happened before. May be null.
    pub tear_down: Option<unsafe extern "C" fn(self_: *mut c_void) -> i32>,
    /// Since 1.1: a test is about to begin. Only in fixtures, may be null; `test`
    /// and its texts are there until it returns.
    pub test_started:
        Option<unsafe extern "C" fn(self_: *mut c_void, test: *const rtf_test) -> i32>,
    /// Since 1.1: a test was judged. What is reported, measured and attached
    /// meanwhile belongs to its result.
    pub test_finished:
        Option<unsafe extern "C" fn(self_: *mut c_void, test: *const rtf_test) -> i32>,
}
