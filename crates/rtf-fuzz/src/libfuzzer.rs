//! Runs a target with libFuzzer, which needs its crates compiled with the flags of
//! `tools/fuzz_rustc.sh`.
#![expect(unsafe_code, reason = "libFuzzer is C++")]

use std::ffi::{CString, c_char, c_int};
use std::process::ExitCode;
use std::sync::OnceLock;

use crate::Target;

static CHECK: OnceLock<fn(&[u8])> = OnceLock::new();

type Callback = unsafe extern "C" fn(*const u8, usize) -> c_int;

unsafe extern "C" {
    fn LLVMFuzzerTestOneInput(data: *const u8, size: usize) -> c_int;
    fn LLVMFuzzerRunDriver(argc: *mut c_int, argv: *mut *mut *mut c_char, run: Callback) -> c_int;
}

/// Called by `LLVMFuzzerTestOneInput`, which is part of `libfuzzer-sys`.
#[unsafe(no_mangle)]
#[expect(improper_ctypes_definitions, reason = "both sides are Rust")]
extern "C" fn rust_fuzzer_test_input(input: &[u8]) -> c_int {
    if let Some(check) = CHECK.get() {
        check(input);
    }
    0
}

/// Gives inputs to a target until it panics, or until a limit in the arguments of the program.
/// Only one target runs in a process.
pub fn run(target: &Target) -> ExitCode {
    if CHECK.set(target.check).is_err() {
        return ExitCode::FAILURE;
    }
    // A panic ends the process, so that libFuzzer sees its stack and stores the input.
    libfuzzer_sys::initialize(std::ptr::null(), std::ptr::null());
    let texts: Vec<CString> = std::env::args().filter_map(|arg| CString::new(arg).ok()).collect();
    let mut pointers: Vec<*mut c_char> =
        texts.iter().map(|text| text.as_ptr().cast_mut()).collect();
    pointers.push(std::ptr::null_mut());
    let mut count = c_int::try_from(texts.len()).unwrap_or(c_int::MAX);
    let mut arguments = pointers.as_mut_ptr();
    // SAFETY: the arguments live as long as the process, and end with a null pointer.
    let status =
        unsafe { LLVMFuzzerRunDriver(&raw mut count, &raw mut arguments, LLVMFuzzerTestOneInput) };
    u8::try_from(status).map_or(ExitCode::FAILURE, ExitCode::from)
}
