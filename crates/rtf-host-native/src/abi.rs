//! The binary interface between the native host and a plug-in.
//!
//! `xtask header` generates `sdk/c/include/rtf/plugin.h` from this file, comments
//! included. Appending fields to structures increments the minor version; any other
//! change increments the major version.

use std::ffi::{c_char, c_int, c_void};

/// The version that a plug-in and its host must share.
pub const RTF_ABI_MAJOR: u32 = 1;
/// Counts the fields that were appended since the major version began.
pub const RTF_ABI_MINOR: u32 = 5;

/// The plug-in is a test: `setup`, `run`, `tear_down`.
pub const RTF_KIND_TEST: i32 = 1;
/// The plug-in is a fixture: `setup`, `check`, `tear_down`.
pub const RTF_KIND_FIXTURE: i32 = 2;

/// The step is complete. The host knows whether its checks held.
pub const RTF_DONE: i32 = 0;
/// The step failed, like `return false` in other languages.
pub const RTF_REFUSED: i32 = 1;
/// An assertion or an error that was reported ended the step, or
/// a stop request did.
pub const RTF_STOPPED: i32 = 2;

/// A message for information only.
pub const RTF_MESSAGE_REPORT: i32 = 0;
/// A check that held.
pub const RTF_MESSAGE_CHECK: i32 = 1;
/// A failed check or assertion: the robot is wrong.
pub const RTF_MESSAGE_FAILURE: i32 = 2;
/// An error: the bench is wrong.
pub const RTF_MESSAGE_ERROR: i32 = 3;

/// The value of a fixture is the text itself.
pub const RTF_VALUE_TEXT: i32 = 0;
/// The text is JSON: a number, `true`, `[1, 2]`, …
pub const RTF_VALUE_JSON: i32 = 1;

/// A UTF-8 text, not necessarily terminated by zero. Invalid bytes become `U+FFFD`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rtf_text {
    /// The first byte; may be null if `length` is 0.
    pub data: *const c_char,
    /// The number of bytes.
    pub length: usize,
}

/// The numbers of a near-equality check: one entry for a scalar.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_comparison {
    /// `sizeof(rtf_comparison)`.
    pub size: usize,
    /// The expected numbers.
    pub expected: *const f64,
    /// The number of entries of `expected`.
    pub expected_count: usize,
    /// The actual numbers.
    pub got: *const f64,
    /// The number of entries of `got`.
    pub got_count: usize,
    /// The largest accepted absolute difference.
    pub tolerance: f64,
    /// The index with the largest difference; negative if there is none.
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
    /// Not 0: it is unsafe to continue, so the rest of the suite is skipped.
    pub critical: i32,
    /// The text, of any length.
    pub text: rtf_text,
    /// The source file (`__FILE__`), null if unknown.
    pub file: *const c_char,
    /// The line in it (`__LINE__`), 0 if unknown.
    pub line: u32,
    /// The compared numbers, null if there are none.
    pub comparison: *const rtf_comparison,
}

/// A number that a test measured.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_measurement {
    /// `sizeof(rtf_measurement)`.
    pub size: usize,
    /// The name of the measurement.
    pub name: rtf_text,
    /// The value.
    pub value: f64,
    /// Its unit, empty for a pure number.
    pub unit: rtf_text,
    /// The smallest accepted value, null if there is no such limit.
    pub low: *const f64,
    /// The largest accepted value, null if there is no such limit.
    pub high: *const f64,
    /// The source file, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
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
    /// The smallest accepted value, null if there is no such limit.
    pub low: *const f64,
    /// The largest accepted value, null if there is no such limit.
    pub high: *const f64,
    /// The time in seconds since the test's set-up began; null: now.
    pub time: *const f64,
    /// The source file, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
    pub line: u32,
}

/// Times start at the first sample of both trajectories.
pub const RTF_ALIGN_TIME: i32 = 0;

/// Times are aligned by dynamic time warping.
pub const RTF_ALIGN_DTW: i32 = 1;

/// The fault begins.
pub const RTF_FAULT_INJECT: i32 = 0;

/// The fault ends. No effect if it has ended already.
pub const RTF_FAULT_REMOVE: i32 = 1;

/// A check of a signal against a stored trajectory.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_trajectory {
    /// `sizeof(rtf_trajectory)`.
    pub size: usize,
    /// The signal.
    pub name: rtf_text,
    /// The file of the stored trajectory, relative to the directory of the suite.
    pub reference: rtf_text,
    /// The largest accepted difference.
    pub tolerance: f64,
    /// With `RTF_ALIGN_DTW`, by how many seconds times may differ; null: the default.
    pub band: *const f64,
    /// The source file, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
    pub line: u32,
    /// `RTF_ALIGN_TIME` or `RTF_ALIGN_DTW`.
    pub align: i32,
}

/// A picture that is compared with a stored one.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_picture {
    /// `sizeof(rtf_picture)`.
    pub size: usize,
    /// The name of the attachment.
    pub name: rtf_text,
    /// A PNG or JPEG file.
    pub picture: rtf_text,
    /// The file of the stored picture, relative to the directory of the suite.
    pub reference: rtf_text,
    /// The largest accepted difference: 1 minus the structural similarity.
    pub tolerance: f64,
    /// The source file, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
    pub line: u32,
}

/// A formula over signals that judges the rest of a test.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_monitor {
    /// `sizeof(rtf_monitor)`.
    pub size: usize,
    /// The formula.
    pub formula: rtf_text,
    /// Its name; empty: the formula.
    pub name: rtf_text,
    /// `fail`, `error`, `stop` or `critical`; empty: `fail`.
    pub severity: rtf_text,
    /// The source file, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
    pub line: u32,
}

/// A file to be added to the results.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_attachment {
    /// `sizeof(rtf_attachment)`.
    pub size: usize,
    /// Its path. It is copied before the call returns.
    pub path: rtf_text,
    /// Its name in reports; empty: the path's last part.
    pub name: rtf_text,
    /// Its media type (`text/csv`), empty if unknown.
    pub media_type: rtf_text,
}

/// A named value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rtf_parameter {
    /// The name.
    pub name: rtf_text,
    /// The value.
    pub value: rtf_text,
}

/// A case of a test: a named result.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_case {
    /// `sizeof(rtf_case)`.
    pub size: usize,
    /// Its name.
    pub name: rtf_text,
    /// Its parameters, may be null if `parameter_count` is 0.
    pub parameters: *const rtf_parameter,
    /// The number of entries of `parameters`.
    pub parameter_count: usize,
    /// The source file, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
    pub line: u32,
}

/// A question to an operator.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_question {
    /// `sizeof(rtf_question)`.
    pub size: usize,
    /// The text; may have several lines.
    pub text: rtf_text,
    /// The possible answers, may be null if `choice_count` is 0: then the answer is any line
    /// of text.
    pub choices: *const rtf_text,
    /// The number of entries of `choices`.
    pub choice_count: usize,
    /// The answer if no operator answers, empty if that is an error.
    pub default_answer: rtf_text,
    /// How long it waits for an answer, in seconds.
    pub timeout: f64,
    /// The path of a PNG or JPEG file, empty for none. It is copied before the call returns.
    pub picture: rtf_text,
    /// The source file, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
    pub line: u32,
}

/// The episode passed, unless a problem was reported in it.
pub const RTF_EPISODE_PASSED: i32 = 0;
/// The episode failed: the robot is wrong.
pub const RTF_EPISODE_FAILED: i32 = 1;
/// The episode has no result: the bench is wrong.
pub const RTF_EPISODE_ERROR: i32 = 2;
/// The episode reached a limit in steps or in simulated time.
pub const RTF_EPISODE_TIMED_OUT: i32 = 3;

/// How a test runs the episodes of a campaign.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_slots {
    /// `sizeof(rtf_slots)`. The host does not write fields beyond it.
    pub size: usize,
    /// The number of episodes that may be open at the same time, from 1.
    pub slots: u32,
    /// Set to 0 by the host; reserved.
    pub reserved: u32,
    /// The limit of an episode in steps, 0 if there is none.
    pub max_steps: u64,
    /// The limit of an episode in simulated time, in seconds; 0 if there is none.
    pub max_time: f64,
}

/// An episode of a campaign that has started.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_episode {
    /// `sizeof(rtf_episode)`. The host does not write fields beyond it.
    pub size: usize,
    /// The number, from 1.
    pub id: u64,
    /// The seed for its random numbers: from 0 to 2³¹ − 1.
    pub seed: u32,
    /// Set to 0 by the host; reserved.
    pub reserved: u32,
    /// Its parameters.
    pub parameters: *const rtf_parameter,
    /// The number of entries of `parameters`.
    pub parameter_count: usize,
}

/// The result of an episode.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_episode_end {
    /// `sizeof(rtf_episode_end)`.
    pub size: usize,
    /// `RTF_EPISODE_PASSED`, `RTF_EPISODE_FAILED`, `RTF_EPISODE_ERROR` or
    /// `RTF_EPISODE_TIMED_OUT`.
    pub outcome: i32,
    /// Always 0; reserved.
    pub reserved: u32,
    /// Why it did not pass; empty if the messages in the episode contain it.
    pub reason: rtf_text,
    /// How many steps it took; negative if unknown.
    pub steps: i64,
    /// Its duration in simulated time, in seconds; negative or not a number if unknown.
    pub time: f64,
    /// At most 64 characters that are the same if the first observation is the same, such as a
    /// hash; empty if unknown.
    pub first_observation: rtf_text,
    /// The source file for an error of the call, null if unknown.
    pub file: *const c_char,
    /// The line in it, 0 if unknown.
    pub line: u32,
}

/// An attempt of a test.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_test {
    /// The size of this structure in the host. Fields beyond it do not exist.
    pub size: usize,
    /// The test's number in the run.
    pub id: u32,
    /// The repetition, from 1.
    pub repetition: u32,
    /// The attempt at this repetition, from 1.
    pub attempt: u32,
    /// Always 0; reserved.
    pub reserved: u32,
    /// The test's name in the suite.
    pub name: rtf_text,
    /// Its verdict: `passed`, `failed`, …; empty before it starts.
    pub verdict: rtf_text,
    /// The reason if it did not pass, otherwise empty.
    pub reason: rtf_text,
}

/// The host's functions for a plug-in. Their first argument is `context`. They
/// may be called from any thread until the process ends.
#[repr(C)]
#[derive(Debug)]
pub struct rtf_host {
    /// The host's `RTF_ABI_MAJOR`.
    pub abi_major: u32,
    /// The host's `RTF_ABI_MINOR`.
    pub abi_minor: u32,
    /// The size of this table in the host. Fields beyond it do not exist.
    pub size: usize,
    /// The first argument of the functions below.
    pub context: *mut c_void,
    /// Sends a message. The first failure or error decides the
    /// verdict.
    pub message: unsafe extern "C" fn(context: *mut c_void, message: *const rtf_message),
    /// Records a number. Returns 1 if it is within its limits, otherwise 0, which
    /// is a failure.
    pub measure:
        unsafe extern "C" fn(context: *mut c_void, measurement: *const rtf_measurement) -> c_int,
    /// Adds a file to the results.
    pub attach: unsafe extern "C" fn(context: *mut c_void, attachment: *const rtf_attachment),
    /// Reports that a fixture collapsed.
    pub collapsed: unsafe extern "C" fn(context: *mut c_void, reason: rtf_text),
    /// Returns 1 if the plug-in was asked to stop, otherwise 0.
    pub interrupted: unsafe extern "C" fn(context: *mut c_void) -> c_int,
    /// Sleeps. Returns 1 as soon as the plug-in is asked to stop, otherwise 0 after
    /// this time in seconds.
    pub wait: unsafe extern "C" fn(context: *mut c_void, seconds: f64) -> c_int,
    /// The plug-in's name in the suite.
    pub name: unsafe extern "C" fn(context: *mut c_void) -> rtf_text,
    /// Its parameter string in the suite.
    pub param: unsafe extern "C" fn(context: *mut c_void) -> rtf_text,
    /// The suite's environment string.
    pub environment: unsafe extern "C" fn(context: *mut c_void) -> rtf_text,
    /// The repetition, from 1.
    pub repetition: unsafe extern "C" fn(context: *mut c_void) -> u32,
    /// Since 1.2: takes a sample of a signal. Returns 1 if it is within its
    /// limits, otherwise 0, which is a failure. Only for tests.
    pub sample: unsafe extern "C" fn(context: *mut c_void, sample: *const rtf_sample) -> c_int,
    /// Since 1.3: starts a case on this thread. Returns 1 if its body runs. Returns 0 if it
    /// is not selected or not allowed: then neither run the body nor call `case_end`.
    pub case_begin: unsafe extern "C" fn(context: *mut c_void, test_case: *const rtf_case) -> c_int,
    /// Since 1.3: finishes the innermost case of this thread. `result` is `RTF_DONE`, or
    /// `RTF_STOPPED` if an assertion, an error or a skip ended it.
    pub case_end: unsafe extern "C" fn(context: *mut c_void, result: i32),
    /// Since 1.3: announces top-level cases.
    pub plan_cases:
        unsafe extern "C" fn(context: *mut c_void, names: *const rtf_text, count: usize),
    /// Since 1.3: skips the innermost case of this thread, or without one the test. Then
    /// return from it with `RTF_STOPPED`.
    pub skip: unsafe extern "C" fn(context: *mut c_void, reason: rtf_text),
    /// Since 1.3: the test's values of a matrix, `count` of them.
    pub parameters:
        unsafe extern "C" fn(context: *mut c_void, count: *mut usize) -> *const rtf_parameter,
    /// Since 1.3: provides a value of the fixture, in its set-up. `kind` is `RTF_VALUE_TEXT`
    /// or `RTF_VALUE_JSON`.
    pub provide:
        unsafe extern "C" fn(context: *mut c_void, name: rtf_text, kind: i32, value: rtf_text),
    /// Since 1.3: the values that fixtures provided, `count` of them, by name:
    /// `simulator.port`. A value is its text: JSON, except for a text.
    pub fixture_values:
        unsafe extern "C" fn(context: *mut c_void, count: *mut usize) -> *const rtf_parameter,
    /// Since 1.3: asks an operator, and waits; in `setup` and `run` of a test. Returns `RTF_DONE`
    /// with the answer, which stays valid until the process ends. Returns `RTF_STOPPED` after a
    /// stop request, and without an answer, which the host has reported as an error: then
    /// return from the step with `RTF_STOPPED`.
    pub ask: unsafe extern "C" fn(
        context: *mut c_void,
        question: *const rtf_question,
        answer: *mut rtf_text,
    ) -> i32,
    /// Since 1.4: checks a signal, as sampled so far, against a stored trajectory. The runner
    /// compares: a deviation is a failure, and the test continues. Only for tests.
    pub check_trajectory: unsafe extern "C" fn(context: *mut c_void, check: *const rtf_trajectory),
    /// Since 1.4: declares a formula that judges the rest of the test. Only for tests.
    pub monitor: unsafe extern "C" fn(context: *mut c_void, monitor: *const rtf_monitor),
    /// Since 1.4: injects or removes a fault of the suite (`RTF_FAULT_INJECT`,
    /// `RTF_FAULT_REMOVE`), and returns `RTF_DONE` when it has begun or ended. Returns
    /// `RTF_STOPPED` if that is not possible, which the host has reported as an error: then return
    /// from the step with `RTF_STOPPED`. Only for tests. `file` may be null.
    pub fault: unsafe extern "C" fn(
        context: *mut c_void,
        action: i32,
        name: rtf_text,
        file: *const c_char,
        line: u32,
    ) -> i32,
    /// Since 1.4: attaches a picture, which the runner compares with a stored one: a difference is a
    /// failure, and the test continues. Only for tests.
    pub check_picture: unsafe extern "C" fn(context: *mut c_void, check: *const rtf_picture),
    /// Since 1.5: how the test runs episodes. Returns `RTF_DONE`, or `RTF_REFUSED` if it has no
    /// `slots` in its suite. Set `size` before.
    pub slots: unsafe extern "C" fn(context: *mut c_void, slots: *mut rtf_slots) -> i32,
    /// Since 1.5: starts the next episode, in `run`. Returns `RTF_DONE` with the episode, whose
    /// parameters are valid until this thread calls the function again, or ends. Returns
    /// `RTF_REFUSED` if there is none: if `wait` is not 0, no episode follows; otherwise, none has
    /// arrived, or no slot is free. Returns `RTF_STOPPED` after a stop request, and after an error
    /// that the host has reported: then return from `run` with `RTF_STOPPED`. Wait only if no
    /// episode is open that this thread has to finish. Set `size` before.
    pub take_episode:
        unsafe extern "C" fn(context: *mut c_void, wait: c_int, episode: *mut rtf_episode) -> i32,
    /// Since 1.5: from now on, what this thread reports belongs to the episode, as in a case.
    /// Returns `RTF_DONE`, or `RTF_STOPPED` after an error that the host has reported.
    pub enter_episode: unsafe extern "C" fn(context: *mut c_void, id: u64) -> i32,
    /// Since 1.5: this thread leaves the episode, which it has entered last. Returns `RTF_DONE`,
    /// or `RTF_STOPPED` after an error that the host has reported.
    pub leave_episode: unsafe extern "C" fn(context: *mut c_void, id: u64) -> i32,
    /// Since 1.5: finishes an episode, once, in `run`, on any thread, entered or not. Returns
    /// `RTF_DONE`, or `RTF_STOPPED` after an error that the host has reported.
    pub finish_episode:
        unsafe extern "C" fn(context: *mut c_void, id: u64, end: *const rtf_episode_end) -> i32,
}

/// The plug-in's kind and functions. All functions are called on the
/// process's main thread, one at a time. They must not throw exceptions.
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
    /// Creates the plug-in. The result is `self` of the other functions.
    /// Null means failure; send a message with the reason first.
    pub create: Option<unsafe extern "C" fn(host: *const rtf_host) -> *mut c_void>,
    /// Destroys it. Called once, after `tear_down`. May be null.
    pub destroy: Option<unsafe extern "C" fn(self_: *mut c_void)>,
    /// Called first, with arguments like those of `main`: `argv[0]` is the
    /// name, `argv[argc]` is null. May be null.
    pub setup: Option<
        unsafe extern "C" fn(self_: *mut c_void, argc: c_int, argv: *mut *mut c_char) -> i32,
    >,
    /// Runs the test. Called if `setup` succeeded. Null in a fixture.
    pub run: Option<unsafe extern "C" fn(self_: *mut c_void) -> i32>,
    /// Checks whether the fixture works. Null in a test, and in a fixture
    /// without a check.
    pub check: Option<unsafe extern "C" fn(self_: *mut c_void) -> i32>,
    /// Called last, in any case. May be null.
    pub tear_down: Option<unsafe extern "C" fn(self_: *mut c_void) -> i32>,
    /// Since 1.1: called before a test starts. Only in fixtures, may be null; `test`
    /// and its texts are valid until it returns.
    pub test_started:
        Option<unsafe extern "C" fn(self_: *mut c_void, test: *const rtf_test) -> i32>,
    /// Since 1.1: called after a test's verdict. Its reports, measurements and
    /// attachments belong to that test.
    pub test_finished:
        Option<unsafe extern "C" fn(self_: *mut c_void, test: *const rtf_test) -> i32>,
}
