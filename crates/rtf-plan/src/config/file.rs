//! Finds `rtf.toml` files and reads each of them once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::toml_reader::{self, Layer, ParsedConfig};
use crate::suite::{self, SourceMap, SourceText, Spanned};

const FILE_NAME: &str = "rtf.toml";

/// An `rtf.toml`.
#[derive(Debug)]
pub struct ConfigFile {
    pub source: Arc<SourceText>,
    /// Its absolute path.
    pub path: PathBuf,
    /// The profile that applies unless the user selects one.
    pub profile: Option<Spanned<String>>,
    /// The values outside of profiles.
    pub defaults: Layer,
    pub profiles: Vec<(Spanned<String>, Layer)>,
}

/// The `rtf.toml` files of a run, found on demand.
#[derive(Debug, Default)]
pub struct ConfigFiles {
    /// The files by directory; `None` for a directory without one.
    by_dir: HashMap<PathBuf, Option<Rc<ConfigFile>>>,
    pub problems: Vec<Diagnostic>,
    /// The directory to which the paths in messages are relative.
    current_dir: PathBuf,
    disabled: bool,
}

impl ConfigFiles {
    /// Messages name files relative to `current_dir`.
    #[must_use]
    pub fn new(current_dir: &Path) -> Self {
        Self { current_dir: current_dir.to_owned(), ..Self::default() }
    }

    /// Creates a set that finds no file, for the command line of 2.x.
    #[must_use]
    pub fn disabled() -> Self {
        Self { disabled: true, ..Self::default() }
    }

    /// Finds the nearest file: in `dir` or in a directory above it, up to the
    /// root of the repository (the directory with `.git`) or of the file system.
    pub fn find_nearest(&mut self, dir: &Path) -> Option<Rc<ConfigFile>> {
        if self.disabled {
            return None;
        }
        for dir in dir.ancestors() {
            if let Some(known) = self.by_dir.get(dir) {
                if known.is_some() {
                    return known.clone();
                }
            } else {
                let found = self.read(dir).map(Rc::new);
                self.by_dir.insert(dir.to_owned(), found.clone());
                if found.is_some() {
                    return found;
                }
            }
            if dir.join(".git").exists() {
                return None;
            }
        }
        None
    }

    /// Returns all files found so far, sorted by path.
    #[must_use]
    pub fn all(&self) -> Vec<Rc<ConfigFile>> {
        let mut all: Vec<_> = self.by_dir.values().flatten().cloned().collect();
        all.sort_by(|a, b| a.path.cmp(&b.path));
        all
    }

    #[must_use]
    pub fn sources(&self) -> SourceMap {
        let mut sources = SourceMap::default();
        for file in self.all() {
            sources.add(Arc::clone(&file.source));
        }
        sources
    }

    fn read(&mut self, dir: &Path) -> Option<ConfigFile> {
        let path = dir.join(FILE_NAME);
        if !path.is_file() {
            return None;
        }
        let name = path.strip_prefix(&self.current_dir).unwrap_or(&path).display().to_string();
        let (source, parsed) = match suite::read_source(&path, &name) {
            Ok(source) => {
                let parsed = toml_reader::parse(&source, &mut self.problems);
                (source, parsed)
            }
            Err(unreadable) => {
                self.problems.push(unreadable.problem);
                let empty = || SourceText::new(name, "");
                (unreadable.source.unwrap_or_else(empty), ParsedConfig::default())
            }
        };
        let source = Arc::new(source);
        let ParsedConfig { profile, defaults, profiles } = parsed;
        Some(ConfigFile { source, path, profile, defaults, profiles })
    }
}
