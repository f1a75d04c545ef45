//! The hot paths, each alone and always the same: `rtf-counts WORK FOLDER`.
//!
//! `tools/counts.py` runs it below callgrind, which counts the instructions, and
//! compares them with `benches/counts.json`. The directory is empty at the start.

mod plan;
mod protocol;
mod stream;

use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let (work, folder) = (args.next().unwrap_or_default(), args.next().unwrap_or_default());
    let folder = PathBuf::from(folder).canonicalize()?;
    match work.as_str() {
        "plan" => plan::run(&folder),
        "stream" => stream::run(&folder),
        "protocol" => protocol::run(),
        _ => Err("usage: rtf-counts plan|stream|protocol FOLDER".into()),
    }
}
