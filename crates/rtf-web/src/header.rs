//! Headers of responses.

use axum::http::{HeaderMap, HeaderName, HeaderValue};

/// Adds a header, unless the value cannot be one.
pub fn insert(headers: &mut HeaderMap, name: HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        headers.insert(name, value);
    }
}
