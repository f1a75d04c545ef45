//! Pictures that `rtf golden accept` stores.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use rtf_golden::{MAX_PICTURE_BYTES, Picture, PictureDifference};

/// A picture of a run.
pub struct PictureFile {
    /// The name of the attachment.
    pub name: String,
    /// The file, as the test wrote it.
    pub bytes: Vec<u8>,
    picture: Picture,
    tolerance: f64,
}

impl PictureFile {
    /// Reads a picture. What cannot be compared later cannot be accepted.
    pub fn read(name: &str, path: &Path, tolerance: f64) -> Result<Self, String> {
        let (bytes, picture) = read(path)?;
        Ok(Self { name: name.to_owned(), bytes, picture, tolerance })
    }

    /// Whether the stored picture differs by at most the tolerance.
    pub fn resembles(&self, stored: &Path) -> bool {
        let stored = read(stored).ok();
        let compared = stored.and_then(|(_, it)| PictureDifference::of(&self.picture, &it).ok());
        compared.is_some_and(|difference| difference.size <= self.tolerance)
    }
}

fn read(path: &Path) -> Result<(Vec<u8>, Picture), String> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| error.to_string())?;
    file.take(MAX_PICTURE_BYTES).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    let picture = Picture::decode(&bytes).map_err(|error| error.to_string())?;
    Ok((bytes, picture))
}
