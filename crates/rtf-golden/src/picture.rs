//! Pictures of tests, decoded within limits.

use crate::picture_error::{MAX_PIXELS, MIN_SIDE, PictureError};
use crate::pixels::{Format, Pixels};

/// The largest file of a picture, in bytes.
pub const MAX_PICTURE_BYTES: u64 = 64 * 1024 * 1024;

/// The most memory for decoding, in bytes: each pixel has at most four channels of 16 bits.
const MAX_MEMORY: usize = 3 * 8 * MAX_PIXELS as usize;

/// A picture with 8 bits for red, green and blue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    pub(crate) pixels: Pixels,
    format: Format,
}

impl Picture {
    /// Decodes a file, PNG or JPEG. Its size is checked before pixels are decoded.
    ///
    /// # Errors
    /// It has another format, is damaged, too large or too small.
    pub fn decode(file: &[u8]) -> Result<Self, PictureError> {
        let format = Format::of(file).ok_or(PictureError::Format)?;
        let pixels = Pixels::decode(file, format, MAX_MEMORY, |(width, height)| {
            if u64::from(width) * u64::from(height) > MAX_PIXELS {
                return Err(PictureError::TooLarge(width, height));
            }
            if width.min(height) < MIN_SIDE {
                return Err(PictureError::TooSmall(width, height));
            }
            Ok(())
        })?;
        Ok(Self { pixels, format })
    }

    /// The media type of its file: `image/png` or `image/jpeg`.
    #[must_use]
    pub fn media_type(&self) -> &'static str {
        match self.format {
            Format::Png => "image/png",
            Format::Jpeg => "image/jpeg",
        }
    }

    /// The usual ending of its file: `png` or `jpg`.
    #[must_use]
    pub fn ending(&self) -> &'static str {
        match self.format {
            Format::Png => "png",
            Format::Jpeg => "jpg",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32) -> Vec<u8> {
        Pixels::draw((width, height), |_, _| [0; 3]).to_png().unwrap()
    }

    fn error(file: &[u8]) -> String {
        Picture::decode(file).unwrap_err().to_string()
    }

    #[test]
    fn formats_and_sizes_are_checked() {
        assert_eq!(error(b"GIF89a"), "it is neither PNG nor JPEG");
        assert_eq!(error(&png(10, 20)), "it has 10 × 20 pixels, expected at least 11 × 11");
        let whole = png(20, 20);
        assert!(error(&whole[..whole.len() / 2]).starts_with("it is damaged: "));
        assert_eq!(Picture::decode(&whole).unwrap().media_type(), "image/png");
    }

    #[test]
    fn a_huge_picture_is_refused_before_its_pixels_are_decoded() {
        let mut file = png(20, 20);
        // The header claims 65535 × 65535 pixels; its check value is that of the new header.
        file[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
        let check = crc32(&file[12..29]);
        file[29..33].copy_from_slice(&check.to_be_bytes());
        let refused = error(&file);
        assert!(refused.contains("65535 × 65535 pixels, the limit"), "{refused}");
    }

    /// The check value of a chunk of a PNG file.
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
            })
        })
    }
}
