//! Golden trajectories: what a signal did in a run that was accepted, as a text for review, and the
//! comparison of another run with it. The same for pictures, by their structural similarity.
//!
//! `spec/golden.md` specifies the text, the comparisons and their sources. No I/O, no threads, no
//! clock; depends on no other crate of the project.

mod picture;
mod picture_error;
mod pixels;
mod reference;
mod similarity;
mod thin;
mod time;
mod trajectory;
mod warp;

pub use picture::{MAX_PICTURE_BYTES, Picture};
pub use picture_error::PictureError;
pub use reference::{MEDIA_TYPE, ParseError, Reference};
pub use similarity::PictureDifference;
pub use thin::{Thinned, thin};
pub use time::by_time;
pub use trajectory::{Aligned, Comparison, Deviation, Trajectory, TrajectoryError};
pub use warp::{Warp, by_warp, warp};
