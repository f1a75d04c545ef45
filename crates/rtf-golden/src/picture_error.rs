//! Why pictures cannot be compared, and the limits of their sizes.

pub const MAX_PIXELS: u64 = 1 << 24;

/// The fewest pixels of a row or a column: the size of a window.
pub const MIN_SIDE: u32 = 11;

/// Why pictures cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    #[error("it is neither PNG nor JPEG")]
    Format,
    #[error("it is damaged: {0}")]
    Damaged(String),
    #[error("it has {0} × {1} pixels, the limit is {MAX_PIXELS} pixels")]
    TooLarge(u32, u32),
    #[error("it has {0} × {1} pixels, expected at least {MIN_SIDE} × {MIN_SIDE}")]
    TooSmall(u32, u32),
    #[error("it has {} × {} pixels, the reference {} × {}", .got.0, .got.1, .expected.0, .expected.1)]
    Sizes {
        /// The width and the height of the picture.
        got: (u32, u32),
        /// Those of the reference.
        expected: (u32, u32),
    },
    #[error("the difference cannot be written: {0}")]
    Write(String),
}
