//! Requests for a part of a file.

use axum::http::{HeaderMap, header};

/// What a `Range` asks for.
#[derive(Debug, PartialEq, Eq)]
pub enum RangeRequest {
    All,
    /// From the first byte on, up to and without the second.
    Part(u64, u64),
    /// A part that the file does not have.
    Nothing,
}

/// One range is understood; anything else is answered with the whole file.
pub fn range(headers: &HeaderMap, length: u64) -> RangeRequest {
    let text = headers.get(header::RANGE).and_then(|value| value.to_str().ok());
    let Some(range) = text.and_then(|text| text.strip_prefix("bytes=")) else {
        return RangeRequest::All;
    };
    let Some((from, to)) = range.split_once('-') else { return RangeRequest::All };
    let (from, to) = (from.trim().parse::<u64>(), to.trim().parse::<u64>());
    let (start, end) = match (from, to) {
        (Ok(from), Ok(to)) if from <= to => (from, to.saturating_add(1).min(length)),
        (Ok(from), Err(_)) if range.ends_with('-') => (from, length),
        (Err(_), Ok(last)) if range.starts_with('-') => (length.saturating_sub(last), length),
        _ => return RangeRequest::All,
    };
    if start < end { RangeRequest::Part(start, end) } else { RangeRequest::Nothing }
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    #[test]
    fn one_range_is_understood() {
        let asked = |text: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::RANGE, HeaderValue::from_str(text).unwrap());
            range(&headers, 10)
        };
        assert_eq!(asked("bytes=0-3"), RangeRequest::Part(0, 4));
        assert_eq!(asked("bytes=8-99"), RangeRequest::Part(8, 10));
        assert_eq!(asked("bytes=4-"), RangeRequest::Part(4, 10));
        assert_eq!(asked("bytes=-3"), RangeRequest::Part(7, 10));
        assert_eq!(asked("bytes=10-"), RangeRequest::Nothing);
        for odd in ["bytes=5-2", "bytes=0-1,4-5", "pages=1-2", "bytes=x-y", "bytes=-"] {
            assert_eq!(asked(odd), RangeRequest::All, "{odd}");
        }
    }
}
