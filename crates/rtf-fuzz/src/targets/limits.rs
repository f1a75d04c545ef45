//! Files of limits, stored trajectories and pictures.

use rtf_golden::{Picture, PictureDifference, Reference, by_time, by_warp};
use rtf_plan::envelope::check_text;

use super::labels;

/// A file of limits: problems have positions in it.
pub fn check(data: &[u8]) {
    labels::check(data, |source, problems| {
        check_text(source, problems);
        problems.is_empty()
    });
}

/// A stored trajectory: it is read as it was written, and equals itself.
pub fn check_trajectory(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(reference) = Reference::parse(text) else { return };
    let written = reference.to_string();
    // Decimals beyond those that a number has are not kept.
    if let Ok(again) = Reference::parse(&written) {
        assert_eq!(again.to_string(), written);
    }
    let trajectory = &reference.trajectory;
    assert_eq!(by_time(trajectory, trajectory).worst.size(), 0.0);
    if trajectory.points().len() < 100 {
        assert!(by_warp(trajectory, trajectory, 0.0).is_some());
    }
}

/// More pixels than this only take long. Unit tests examine the limit of the decoder.
const MOST_PIXELS: u64 = 1 << 14;

/// A file of a picture: one that is accepted equals itself.
pub fn check_picture(data: &[u8]) {
    if claimed_pixels(data) > MOST_PIXELS {
        return;
    }
    let Ok(picture) = Picture::decode(data) else { return };
    let difference = PictureDifference::of(&picture, &picture).expect("one size");
    assert_eq!(difference.size, 0.0);
    let drawn = difference.picture(&picture).expect("a picture");
    assert!(Picture::decode(&drawn).is_ok());
}

/// The pixels in the header of a PNG, or in the largest frame of a JPEG.
fn claimed_pixels(data: &[u8]) -> u64 {
    let number = |bytes: &[u8]| bytes.iter().fold(0, |number, byte| number << 8 | u64::from(*byte));
    if data.starts_with(b"\x89PNG") {
        return data.get(16..24).map_or(0, |size| number(&size[..4]) * number(&size[4..]));
    }
    // A frame: marker, length, depth, rows, columns.
    let frames = data.windows(9).filter(|it| it[0] == 0xff && matches!(it[1], 0xc0..=0xc3));
    frames.map(|it| number(&it[5..7]) * number(&it[7..9])).max().unwrap_or(0)
}
