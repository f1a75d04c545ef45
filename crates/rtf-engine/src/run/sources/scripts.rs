//! Where the modules of scripts are.

use std::collections::BTreeSet;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use rtf_plan::plan::SuitePlan;

use super::imports::{self, Import, Language};
use super::{MAX_FILES, is_installed};

/// A script is read up to here.
const MAX_BYTES: u64 = 4 * 1024 * 1024;

/// The directories in which modules are searched for.
#[derive(Debug, Default)]
pub(super) struct ModulePath {
    /// The working directory of the suite.
    dir: PathBuf,
    python: Vec<PathBuf>,
    ruby: Vec<PathBuf>,
}

impl ModulePath {
    pub fn of_suite(suite: &SuitePlan) -> Self {
        let dirs = |language: Language| {
            let value = language.variable().and_then(|name| variable(suite, name));
            let dirs = value.iter().flat_map(|dirs| std::env::split_paths(dirs));
            let dirs = dirs.filter(|dir| !dir.as_os_str().is_empty());
            dirs.map(|dir| suite.folder.join(dir)).collect()
        };
        let (python, ruby) = (dirs(Language::Python), dirs(Language::Ruby));
        Self { dir: suite.folder.clone(), python, ruby }
    }

    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The files of the modules that a script imports; `None` if there are too many.
    pub fn imported_by(&self, script: &Path, language: Language) -> Option<Vec<PathBuf>> {
        let mut text = Vec::new();
        let file = std::fs::File::open(script).ok()?;
        file.take(MAX_BYTES).read_to_end(&mut text).ok()?;
        let mut files = Vec::new();
        for import in imports::find(&String::from_utf8_lossy(&text), language) {
            files.extend(self.resolve(script, &import, language)?);
        }
        Some(files)
    }

    /// The files of a module: of a Python package, all of them.
    fn resolve(&self, script: &Path, import: &Import, language: Language) -> Option<Vec<PathBuf>> {
        let own = script.parent().unwrap_or(Path::new(""));
        let dirs: Vec<&Path> = match (import.parents, language) {
            (Some(parents), _) => own.ancestors().nth(parents).into_iter().collect(),
            (None, Language::Lua) => vec![own, &self.dir],
            (None, Language::Python) => self.searched(own, &self.python),
            (None, Language::Ruby) => self.searched(own, &self.ruby),
        };
        for dir in dirs {
            if language == Language::Python {
                // `import a.b` executes `a`, which may import the rest of the package.
                let top = import.name.split('/').next().unwrap_or_default();
                let package = dir.join(top);
                if package.is_dir() && !is_installed(&package) {
                    let files = below(&package, &["py"])?;
                    if !files.is_empty() {
                        return Some(files);
                    }
                }
                if let Some(file) = existing(language.files(&package)) {
                    return Some(vec![file]);
                }
            } else if let Some(file) = existing(language.files(&dir.join(&import.name))) {
                return Some(vec![file]);
            }
        }
        Some(Vec::new())
    }

    fn searched<'a>(&'a self, own: &'a Path, further: &'a [PathBuf]) -> Vec<&'a Path> {
        let further = further.iter().map(PathBuf::as_path);
        [own, self.dir.as_path()].into_iter().chain(further).collect()
    }
}

/// A variable of the processes of a suite.
pub(super) fn variable(suite: &SuitePlan, name: &str) -> Option<std::ffi::OsString> {
    let of_suite = suite.env.iter().rev().find(|(key, _)| key == name);
    of_suite.map(|(_, value)| value.into()).or_else(|| std::env::var_os(name))
}

fn existing(files: Vec<PathBuf>) -> Option<PathBuf> {
    files.into_iter().find(|file| file.is_file())
}

/// The files with these extensions below a directory, sorted; `None` if there are too many. Links to
/// directories are not followed; hidden ones and those of build systems have no sources.
pub(super) fn below(dir: &Path, extensions: &[&str]) -> Option<Vec<PathBuf>> {
    let (mut files, mut dirs, mut seen) = (BTreeSet::new(), vec![dir.to_owned()], 0);
    while let Some(dir) = dirs.pop() {
        for entry in std::fs::read_dir(&dir).ok().into_iter().flatten().flatten() {
            seen += 1;
            if seen > 10 * MAX_FILES || files.len() > MAX_FILES {
                return None;
            }
            let path = entry.path();
            let name = entry.file_name();
            let is_left_out = name.as_encoded_bytes().starts_with(b".") || name == "target";
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                dirs.extend((!is_left_out).then_some(path));
                continue;
            }
            let extension = path.extension().and_then(|it| it.to_str());
            if extension.is_some_and(|it| extensions.contains(&it)) && path.is_file() {
                files.insert(path);
            }
        }
    }
    Some(files.into_iter().collect())
}
