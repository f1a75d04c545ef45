//! Text that arrives in pieces, which may cut characters.

/// The bytes of a character whose rest has not arrived.
#[derive(Debug, Default)]
pub struct Utf8Pieces {
    rest: Vec<u8>,
}

impl Utf8Pieces {
    /// Appends the next piece to `text`, without an incomplete last character. Invalid bytes become
    /// `U+FFFD`.
    pub fn append(&mut self, piece: &[u8], text: &mut String) {
        self.rest.extend_from_slice(piece);
        let complete = self.rest.len() - incomplete_bytes(&self.rest);
        text.push_str(&String::from_utf8_lossy(&self.rest[..complete]));
        self.rest.drain(..complete);
    }

    /// Appends an incomplete last character.
    pub fn finish(&mut self, text: &mut String) {
        text.push_str(&String::from_utf8_lossy(&self.rest));
        self.rest.clear();
    }
}

/// How many bytes at the end are the beginning of a character.
fn incomplete_bytes(bytes: &[u8]) -> usize {
    // A character has up to four bytes.
    let end = &bytes[bytes.len().saturating_sub(3)..];
    let Some(last) = end.utf8_chunks().last().map(|chunk| chunk.invalid()) else { return 0 };
    let is_cut = std::str::from_utf8(last).is_err_and(|error| error.error_len().is_none());
    if is_cut { last.len() } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_the_pieces_does_not_matter() {
        for bytes in ["a\u{e9}\u{20ac}\u{1f916} z".as_bytes(), b"\xff\xe2\x82 \xf0\x9f\xa4\xe2\x82"]
        {
            for size in 1..=bytes.len() {
                let (mut pieces, mut text) = (Utf8Pieces::default(), String::new());
                bytes.chunks(size).for_each(|piece| pieces.append(piece, &mut text));
                pieces.finish(&mut text);
                assert_eq!(text, String::from_utf8_lossy(bytes), "pieces of {size} bytes");
            }
        }
    }
}
