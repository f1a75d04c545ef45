//! Values of the binary interface as those of Rust.
#![expect(unsafe_code, reason = "called with the pointers of foreign code")]

use std::ffi::{CStr, c_char};

use rtf_model::{Comparison, Location};

use crate::abi::{rtf_comparison, rtf_text};

/// # Safety
/// `text` points to `length` bytes, or `length` is 0.
pub(crate) unsafe fn text(text: rtf_text) -> String {
    if text.length == 0 || text.data.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    let bytes = unsafe { std::slice::from_raw_parts(text.data.cast::<u8>(), text.length) };
    String::from_utf8_lossy(bytes).into_owned()
}

pub(crate) fn lend(text: &'static str) -> rtf_text {
    rtf_text { data: text.as_ptr().cast(), length: text.len() }
}

/// # Safety
/// `file` is null or a string that ends with a zero.
pub(crate) unsafe fn location(file: *const c_char, line: u32) -> Option<Location> {
    if file.is_null() {
        return None;
    }
    // SAFETY: the caller's promise.
    let file = unsafe { CStr::from_ptr(file) }.to_string_lossy().into_owned();
    Some(Location { file, line })
}

/// # Safety
/// The arrays have as many entries as they say.
pub(crate) unsafe fn comparison(numbers: &rtf_comparison) -> Comparison {
    // SAFETY: the caller's promise.
    let (expected, got) = unsafe {
        (list(numbers.expected, numbers.expected_count), list(numbers.got, numbers.got_count))
    };
    // JSON has only finite numbers. An infinite tolerance accepts any value.
    let tolerance = if numbers.tolerance.is_nan() { 0.0 } else { numbers.tolerance };
    let tolerance = tolerance.clamp(f64::MIN, f64::MAX);
    Comparison { expected, got, tolerance, worst: u64::try_from(numbers.worst).ok() }
}

/// # Safety
/// `numbers` points to `count` numbers, or `count` is 0.
unsafe fn list(numbers: *const f64, count: usize) -> Vec<Option<f64>> {
    // SAFETY: the caller's promise.
    unsafe { slice(numbers, count) }.iter().copied().map(finite).collect()
}

/// # Safety
/// `data` points to `count` entries that are valid as long as the caller uses the slice, or
/// it is null.
pub(crate) unsafe fn slice<'a, T>(data: *const T, count: usize) -> &'a [T] {
    if count == 0 || data.is_null() {
        return &[];
    }
    // SAFETY: the caller's promise.
    unsafe { std::slice::from_raw_parts(data, count) }
}

pub(crate) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
