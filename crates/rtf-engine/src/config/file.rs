//! Finding `rtf.toml`, each read once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::read::{self, Layer};
use crate::suite::{self, Source, Sources, Spanned};

/// The file's name.
const NAME: &str = "rtf.toml";

/// An `rtf.toml`.
#[derive(Debug)]
pub struct ConfigFile {
    /// Its text.
    pub source: Arc<Source>,
    /// Where it is, absolute.
    pub path: PathBuf,
    /// The profile that holds when none is asked for.
    pub profile: Option<Spanned<String>>,
    /// What is outside of profiles.
    pub defaults: Layer,
    /// The profiles.
    pub profiles: Vec<(Spanned<String>, Layer)>,
}

/// The files of a run, found on demand.
#[derive(Debug, Default)]
pub struct Files {
    /// By the folder that holds them.
    read: HashMap<PathBuf, Option<Rc<ConfigFile>>>,
    /// What is wrong with them.
    pub problems: Vec<Diagnostic>,
    /// The folder from which the user sees them.
    current: PathBuf,
    /// Whether none is looked for.
    blind: bool,
}

impl Files {
    /// No file yet. Files below `current` are named from it.
    #[must_use]
    pub fn new(current: &Path) -> Self {
        Self { current: current.to_owned(), ..Self::default() }
    }

    /// No file, ever: for those who know of none.
    #[must_use]
    pub fn none() -> Self {
        Self { blind: true, ..Self::default() }
    }

    /// The nearest file: in `folder`, or above it up to the root of its
    /// repository (the folder with `.git`), or else of the file system.
    pub fn above(&mut self, folder: &Path) -> Option<Rc<ConfigFile>> {
        if self.blind {
            return None;
        }
        for folder in folder.ancestors() {
            if let Some(known) = self.read.get(folder) {
                if known.is_some() {
                    return known.clone();
                }
            } else {
                let found = self.open(folder).map(Rc::new);
                self.read.insert(folder.to_owned(), found.clone());
                if found.is_some() {
                    return found;
                }
            }
            if folder.join(".git").exists() {
                return None;
            }
        }
        None
    }

    /// All that were found, in the order of their folders.
    #[must_use]
    pub fn all(&self) -> Vec<Rc<ConfigFile>> {
        let mut all: Vec<_> = self.read.values().flatten().cloned().collect();
        all.sort_by(|a, b| a.path.cmp(&b.path));
        all
    }

    /// The texts of all.
    #[must_use]
    pub fn sources(&self) -> Sources {
        let mut sources = Sources::default();
        for file in self.all() {
            sources.add(Arc::clone(&file.source));
        }
        sources
    }

    fn open(&mut self, folder: &Path) -> Option<ConfigFile> {
        let path = folder.join(NAME);
        if !path.is_file() {
            return None;
        }
        let shown = path.strip_prefix(&self.current).unwrap_or(&path).display().to_string();
        let (source, written) = match suite::open(&path, &shown) {
            Ok(source) => {
                let written = read::read(&source, &mut self.problems);
                (source, written)
            }
            Err(unreadable) => {
                self.problems.push(unreadable.problem);
                let nothing = Source::new(shown, "");
                let written = read::read(&nothing, &mut self.problems);
                (unreadable.source.unwrap_or(nothing), written)
            }
        };
        let source = Arc::new(source);
        let read::Written { profile, defaults, profiles } = written;
        Some(ConfigFile { source, path, profile, defaults, profiles })
    }
}
