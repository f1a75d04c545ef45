//! A target: a function that gets arbitrary bytes and panics if a property does not hold, and the
//! files with bytes that were interesting once.

#![expect(clippy::expect_used, reason = "a property that does not hold is a panic")]

#[path = "../../rtf-host-native/src/abi.rs"]
#[expect(dead_code, reason = "only the table is called")]
mod abi;
#[path = "../../rtf-host-native/src/conversion.rs"]
mod conversion;
#[path = "../../rtf-host-native/src/host_table.rs"]
mod host_table;
#[cfg(feature = "libfuzzer")]
mod libfuzzer;
mod targets;

use std::io;
use std::path::{Path, PathBuf};

#[cfg(feature = "libfuzzer")]
pub use libfuzzer::run;
pub use targets::TARGETS;

/// A function that gets arbitrary bytes.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name, and that of its directory in `corpus`.
    pub name: &'static str,
    /// Panics if a property does not hold.
    pub check: fn(&[u8]),
    /// Directories and files of the repository with more inputs, relative to its root.
    pub more: &'static [&'static str],
}

impl Target {
    /// The inputs that are part of the repository: the corpus and [`Self::more`].
    #[must_use]
    pub fn inputs(&self) -> Vec<PathBuf> {
        let crate_dir = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = crate_dir.join("../..");
        let own = std::iter::once(crate_dir.join("corpus").join(self.name));
        own.chain(self.more.iter().map(|path| root.join(path))).collect()
    }

    /// Gives all inputs of the repository to the target, and returns their number.
    ///
    /// # Errors
    /// A file or directory cannot be read.
    pub fn replay(&self) -> io::Result<usize> {
        let mut files = Vec::new();
        for input in self.inputs() {
            collect(&input, &mut files)?;
        }
        for file in &files {
            (self.check)(&std::fs::read(file)?);
        }
        Ok(files.len())
    }
}

/// Adds the files in a directory, or the file itself.
fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in std::fs::read_dir(path)? {
            collect(&entry?.path(), files)?;
        }
    } else {
        files.push(path.to_owned());
    }
    Ok(())
}
