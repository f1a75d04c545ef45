//! Hashes of plug-ins: whether two runs had the same tests.

use std::collections::HashMap;
use std::fs::File;
use std::hash::Hasher as _;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use siphasher::sip::SipHasher13;

/// The hashes of the plug-ins of a suite. Each file is read once.
#[derive(Debug, Default)]
pub struct PluginHashes(HashMap<PathBuf, Option<String>>);

impl PluginHashes {
    /// The hash of a file, as hexadecimal digits; `None` if it cannot be read.
    pub fn of(&mut self, file: &Path) -> Option<String> {
        if let Some(known) = self.0.get(file) {
            return known.clone();
        }
        let hash = hash(file).ok().map(|hash| format!("{hash:016x}"));
        self.0.insert(file.to_owned(), hash.clone());
        hash
    }
}

fn hash(path: &Path) -> io::Result<u64> {
    // A pipe would wait for its writer.
    if !path.metadata()?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let mut file = File::open(path)?;
    let (mut hasher, mut buffer) = (SipHasher13::new(), vec![0; 64 * 1024]);
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hasher.finish()),
            read => hasher.write(&buffer[..read]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_files_have_equal_hashes() {
        let dir = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| {
            let path = dir.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let long = "x".repeat(100_000);
        let (a, b, c) = (file("a", &long), file("b", &long), file("c", "y"));
        let mut hashes = PluginHashes::default();
        assert_eq!(hashes.of(&a), hashes.of(&b));
        assert_ne!(hashes.of(&a), hashes.of(&c));
        assert_eq!(hashes.of(dir.path()), None);
        assert_eq!(hashes.of(&dir.path().join("missing")), None);
    }
}
