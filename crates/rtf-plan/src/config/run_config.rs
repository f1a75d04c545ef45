//! The settings that apply to a whole run.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use rtf_model::Diagnostic;

use super::file::{ConfigFile, ConfigFiles};
use super::keys::RUN_KEYS;
use super::profile_view::{ConfigRequest, ProfileView};
use super::toml_reader::Entry;

/// Returns the directory in which the search for the `rtf.toml` of an input
/// starts: the input itself, or the directory of the file that it names, with
/// or without `::` and a test.
#[must_use]
pub fn input_dir(path: &Path) -> PathBuf {
    if path.is_dir() {
        return path.to_owned();
    }
    // Split first: the name of a test may contain a slash.
    let text = path.to_string_lossy();
    let file = text.split_once("::").map_or(text.as_ref(), |(file, _)| file);
    Path::new(file).parent().unwrap_or(path).to_owned()
}

#[derive(Clone, Debug)]
pub struct RunValue {
    pub file: Rc<ConfigFile>,
    pub entry: Entry,
}

/// The settings that apply to a whole run.
#[derive(Debug, Default)]
pub struct RunConfig {
    /// The values, at most one per key.
    pub values: Vec<RunValue>,
    /// Conflicts between files.
    pub problems: Vec<Diagnostic>,
}

impl RunConfig {
    /// Collects the settings from the files nearest to these directories.
    #[must_use]
    pub fn collect<'a>(
        dirs: impl Iterator<Item = &'a Path>,
        request: &ConfigRequest,
        files: &mut ConfigFiles,
    ) -> Self {
        let mut run = Self::default();
        let mut seen: Vec<Rc<ConfigFile>> = Vec::new();
        for dir in dirs {
            let Some(file) = files.find_nearest(dir) else { continue };
            if !seen.iter().any(|known| Rc::ptr_eq(known, &file)) {
                seen.push(Rc::clone(&file));
                let view = ProfileView::new(file, request);
                RUN_KEYS.iter().for_each(|key| run.add(&view, key));
            }
        }
        run
    }

    fn add(&mut self, view: &ProfileView, key: &str) {
        let Some(entry) = view.get(key) else { return };
        let texts = |entry: &Entry| -> Vec<String> {
            entry.values.iter().map(|value| value.value.clone()).collect()
        };
        let Some(known) = self.get(key) else {
            self.values.push(RunValue { file: Rc::clone(&view.file), entry: entry.clone() });
            return;
        };
        // Equal relative paths in two directories differ.
        let is_path = matches!(key, "results" | "reports" | "history.url");
        if is_path || texts(&known.entry) != texts(entry) {
            let message = format!("`{key}` applies to the whole run, and two files set it");
            let problem = Diagnostic::error("several-values", message)
                .label(known.file.source.label(known.entry.span, ""))
                .label(view.file.source.label(entry.span, ""))
                .hint("run the suites one after the other, or set it in one file above both");
            self.problems.push(problem);
        }
    }

    #[must_use]
    pub fn get(&self, key: &str) -> Option<&RunValue> {
        self.values.iter().find(|value| value.entry.key == key)
    }
}
