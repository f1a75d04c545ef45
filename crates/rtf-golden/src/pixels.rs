//! The pixels of a picture, and their files.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Encoder, Limits, Transformations};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::picture_error::PictureError;

/// How files begin.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG: &[u8] = b"\xff\xd8\xff";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Png,
    Jpeg,
}

/// Pixels with 8 bits for red, green and blue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pixels {
    /// Columns and rows.
    pub size: (u32, u32),
    /// By rows.
    pub values: Vec<[u8; 3]>,
}

impl Format {
    /// The format of a file by its first bytes.
    pub fn of(file: &[u8]) -> Option<Self> {
        let is = |mark| file.starts_with(mark);
        is(PNG).then_some(Self::Png).or(is(JPEG).then_some(Self::Jpeg))
    }
}

impl Pixels {
    /// A picture whose pixels are computed from column and row.
    pub fn draw(size: (u32, u32), colour: impl Fn(u32, u32) -> [u8; 3]) -> Self {
        let (columns, rows) = size;
        let values = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Self { size, values: values.map(|(column, row)| colour(column, row)).collect() }
    }

    pub fn at(&self, column: u32, row: u32) -> [u8; 3] {
        self.row(row)[column as usize]
    }

    pub fn row(&self, row: u32) -> &[[u8; 3]] {
        let columns = self.size.0 as usize;
        &self.values[row as usize * columns..][..columns]
    }

    /// Decodes a file. `check` gets its columns and rows before pixels are decoded; decoding takes
    /// at most `memory` bytes.
    pub fn decode(
        file: &[u8],
        format: Format,
        memory: usize,
        check: impl Fn((u32, u32)) -> Result<(), PictureError>,
    ) -> Result<Self, PictureError> {
        match format {
            Format::Png => Self::decode_png(file, memory, check),
            Format::Jpeg => Self::decode_jpeg(file, check),
        }
    }

    fn decode_png(
        file: &[u8],
        memory: usize,
        check: impl Fn((u32, u32)) -> Result<(), PictureError>,
    ) -> Result<Self, PictureError> {
        let mut decoder = Decoder::new_with_limits(Cursor::new(file), Limits { bytes: memory });
        decoder.set_transformations(Transformations::normalize_to_color8());
        check(decoder.read_header_info().map_err(damaged)?.size())?;
        let mut reader = decoder.read_info().map_err(damaged)?;
        let size = reader.info().size();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap_or(usize::MAX)];
        let frame = reader.next_frame(&mut bytes).map_err(damaged)?;
        bytes.truncate(frame.buffer_size());
        // Transparency has no colour.
        let values = match frame.color_type {
            ColorType::Grayscale => bytes.iter().map(|grey| [*grey; 3]).collect(),
            ColorType::GrayscaleAlpha => bytes.chunks_exact(2).map(|it| [it[0]; 3]).collect(),
            ColorType::Rgba => bytes.chunks_exact(4).map(|it| [it[0], it[1], it[2]]).collect(),
            ColorType::Rgb | ColorType::Indexed => colours(&bytes),
        };
        Ok(Self { size, values })
    }

    fn decode_jpeg(
        file: &[u8],
        check: impl Fn((u32, u32)) -> Result<(), PictureError>,
    ) -> Result<Self, PictureError> {
        // The format has no more columns and rows.
        let most = usize::from(u16::MAX);
        let options = DecoderOptions::default().set_max_width(most).set_max_height(most);
        let options = options.jpeg_set_out_colorspace(ColorSpace::RGB);
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(file), options);
        decoder.decode_headers().map_err(damaged)?;
        let (width, height) = decoder.dimensions().unwrap_or_default();
        let size = (width as u32, height as u32);
        check(size)?;
        Ok(Self { size, values: colours(&decoder.decode().map_err(damaged)?) })
    }

    pub fn to_png(&self) -> Result<Vec<u8>, PictureError> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, self.size.0, self.size.1);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        let written = encoder.write_header().and_then(|mut writer| {
            writer.write_image_data(self.values.as_flattened())?;
            writer.finish()
        });
        written.map_err(|error| PictureError::Write(error.to_string()))?;
        Ok(file)
    }
}

fn damaged(error: impl std::fmt::Display) -> PictureError {
    PictureError::Damaged(error.to_string())
}

fn colours(bytes: &[u8]) -> Vec<[u8; 3]> {
    bytes.as_chunks().0.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(color: ColorType, depth: BitDepth, palette: &[u8], data: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if !palette.is_empty() {
            encoder.set_palette(palette);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        file
    }

    #[test]
    fn all_kinds_of_pixels_become_colours() {
        use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
        let (red, blue) = ([255, 0, 0], [0, 0, 255]);
        let files = [
            (file(Grayscale, BitDepth::One, &[], &[0b0100_0000]), [[0; 3], [255; 3]]),
            (file(Grayscale, BitDepth::Sixteen, &[], &[7, 1, 9, 1]), [[7; 3], [9; 3]]),
            (file(GrayscaleAlpha, BitDepth::Eight, &[], &[7, 0, 9, 255]), [[7; 3], [9; 3]]),
            (file(Indexed, BitDepth::Eight, &[255, 0, 0, 0, 0, 255], &[1, 0]), [blue, red]),
            (file(Rgb, BitDepth::Eight, &[], &[255, 0, 0, 0, 0, 255]), [red, blue]),
            (file(Rgba, BitDepth::Eight, &[], &[255, 0, 0, 0, 0, 0, 255, 9]), [red, blue]),
        ];
        for (file, expected) in files {
            assert_eq!(Format::of(&file), Some(Format::Png));
            let pixels = Pixels::decode(&file, Format::Png, 1 << 20, |_| Ok(())).unwrap();
            assert_eq!(pixels, Pixels { size: (2, 1), values: expected.to_vec() });
        }
    }
}
