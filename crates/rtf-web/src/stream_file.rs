//! A part of a file as the body of an answer, read as the client takes it.

use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::ops::Range;

use axum::body::{Body, Bytes};
use futures_util::stream;
use tokio::io::AsyncReadExt;
use tokio::sync::OwnedSemaphorePermit;

use crate::problem::Problem;

/// How much is read at once.
const PIECE: u64 = 64 * 1024;

/// The bytes of this range; fewer when the file ends before. `place` is given back
/// when the file is closed.
///
/// # Errors
/// The file cannot be read there.
pub fn body(
    mut file: File,
    range: Range<u64>,
    place: OwnedSemaphorePermit,
) -> Result<Body, Problem> {
    let failed = |error| Problem::unreadable(std::path::Path::new("file"), &error);
    file.seek(SeekFrom::Start(range.start)).map_err(failed)?;
    let (file, length) = (tokio::fs::File::from_std(file), range.end - range.start);
    let pieces = stream::try_unfold((file, length, place), |(mut file, left, place)| async move {
        let mut piece = Vec::with_capacity(usize::try_from(left.min(PIECE)).unwrap_or(0));
        (&mut file).take(left.min(PIECE)).read_to_end(&mut piece).await?;
        let left = left - piece.len() as u64;
        let next = (!piece.is_empty()).then(|| (Bytes::from(piece), (file, left, place)));
        Ok::<_, std::io::Error>(next)
    });
    Ok(Body::from_stream(pieces))
}
