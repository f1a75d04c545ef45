//! Addresses of the API: the parts that are known outside of its routes.

/// Where the API is.
pub const API: &str = "/api/v1";

/// The address of a file in the run's directory.
pub fn file(run: &str, path: &str) -> String {
    format!("{API}/runs/{}/files/{}", encoded(run), encoded(path))
}

/// As it may stand in a part of a path or a header: a `/` is encoded, too.
pub fn encoded_part(text: &str) -> String {
    encoded(text).replace('/', "%2F")
}

/// As it may stand in a path; a `/` stays one.
pub fn encoded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for byte in text.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' => {
                out.push(char::from(byte));
            }
            byte => out += &format!("%{byte:02X}"),
        }
    }
    out
}
