//! Addresses of the API: the parts that are known outside of its routes.

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

pub const API: &str = "/api/v1";

/// What is encoded in a part of a path: all except the unreserved characters of RFC 3986.
const PART: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');
/// What is encoded in a path.
const PATH: &AsciiSet = &PART.remove(b'/');

/// The address of a file in the run's directory.
pub fn file(run: &str, path: &str) -> String {
    format!("{API}/runs/{}/files/{}", encoded(run), encoded(path))
}

/// As it may stand in a part of a path or a header: a `/` is encoded, too.
pub fn encoded_part(text: &str) -> String {
    utf8_percent_encode(text, PART).to_string()
}

/// As it may stand in a path; a `/` stays one.
pub fn encoded(text: &str) -> String {
    utf8_percent_encode(text, PATH).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_except_unreserved_characters_is_encoded() {
        let text = "a Z-_.~/\"%?#&+é\n";
        assert_eq!(encoded(text), "a%20Z-_.~/%22%25%3F%23%26%2B%C3%A9%0A");
        assert_eq!(encoded_part(text), "a%20Z-_.~%2F%22%25%3F%23%26%2B%C3%A9%0A");
    }
}
