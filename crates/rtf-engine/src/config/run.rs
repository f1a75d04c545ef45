//! What files say about a run as a whole.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use rtf_model::Diagnostic;

use super::file::{ConfigFile, Files};
use super::keys::OF_RUN;
use super::read::Entry;
use super::view::{Asked, View};

/// The folder in which the search for the file of an input begins: it, or the
/// folder of the file that it names, with or without `::` and a test.
#[must_use]
pub fn folder_of_input(path: &Path) -> PathBuf {
    if path.is_dir() {
        return path.to_owned();
    }
    // A test's name may have a slash.
    let text = path.to_string_lossy();
    let file = text.split_once("::").map_or(text.as_ref(), |(file, _)| file);
    Path::new(file).parent().unwrap_or(path).to_owned()
}

/// A value that holds for the run.
#[derive(Clone, Debug)]
pub struct RunValue {
    /// The file that it is from.
    pub file: Rc<ConfigFile>,
    /// It.
    pub entry: Entry,
}

/// What the files of a run's inputs say about the run.
#[derive(Debug, Default)]
pub struct Run {
    /// The values that hold.
    pub values: Vec<RunValue>,
    /// Where two files say different things.
    pub problems: Vec<Diagnostic>,
}

impl Run {
    /// Asks the files above these folders.
    #[must_use]
    pub fn of<'a>(
        folders: impl Iterator<Item = &'a Path>,
        asked: &Asked,
        files: &mut Files,
    ) -> Self {
        let mut run = Self::default();
        let mut seen: Vec<Rc<ConfigFile>> = Vec::new();
        for folder in folders {
            let Some(file) = files.above(folder) else { continue };
            if !seen.iter().any(|known| Rc::ptr_eq(known, &file)) {
                seen.push(Rc::clone(&file));
                let view = View::of(file, asked);
                OF_RUN.iter().for_each(|key| run.take(&view, key));
            }
        }
        run
    }

    fn take(&mut self, view: &View, key: &str) {
        let Some(entry) = view.get(key) else { return };
        let texts = |entry: &Entry| -> Vec<String> {
            entry.values.iter().map(|value| value.value.clone()).collect()
        };
        let Some(known) = self.get(key) else {
            self.values.push(RunValue { file: Rc::clone(&view.file), entry: entry.clone() });
            return;
        };
        // A path is another one in another folder.
        let is_path = matches!(key, "results" | "reports");
        if is_path || texts(&known.entry) != texts(entry) {
            let message =
                format!("`{key}` holds for the whole run, and two files of it say what it is");
            let problem = Diagnostic::error("several-values", message)
                .label(known.file.source.label(known.entry.span, ""))
                .label(view.file.source.label(entry.span, ""))
                .hint("run the suites one after the other, or say it in one file above both");
            self.problems.push(problem);
        }
    }

    /// The value of a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&RunValue> {
        self.values.iter().find(|value| value.entry.key == key)
    }
}
