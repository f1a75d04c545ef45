//! Hashes of sources: whether two runs had the same tests.
//!
//! The sources of a test are the file of its suite, its plug-in, the plug-ins and programs of
//! fixtures and hooks, and the modules and libraries of all these, as far as they are known from
//! the files themselves. What a launch file starts, data files, and what is installed on the
//! machine are not known.

mod frameworks;
mod imports;
mod libraries;
mod scripts;

use std::collections::{BTreeSet, HashMap};
use std::fs::File;
use std::hash::Hasher as _;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use rtf_plan::plan::{FixtureBody, PluginPlan, SuitePlan, TestPlan};
use siphasher::sip::SipHasher13;

use imports::Language;
use libraries::Libraries;
use scripts::ModulePath;

/// A test with more files has no hash: reading them would delay the run.
const MAX_FILES: usize = 2000;

/// Files below these directories belong to the machine.
const INSTALLED: [&str; 6] = ["/usr", "/lib", "/lib64", "/bin", "/sbin", "/opt/ros"];

/// The hashes of the files of a suite. Each file is read once.
#[derive(Debug, Default)]
pub struct SourceHashes {
    hashes: HashMap<PathBuf, Option<u64>>,
    /// The modules and libraries that a file names.
    dependencies: HashMap<PathBuf, Vec<PathBuf>>,
    modules: ModulePath,
    libraries: Libraries,
    /// The file of the suite, and its fixtures and hooks.
    suite: Option<u64>,
}

impl SourceHashes {
    pub fn of_suite(suite: &SuitePlan) -> Self {
        let mut hashes = Self {
            modules: ModulePath::of_suite(suite),
            libraries: Libraries::of_suite(suite),
            ..Self::default()
        };
        let mut texts = vec![suite.settings.environment.as_str()];
        texts.extend(suite.env.iter().flat_map(|(name, value)| [name.as_str(), value]));
        let params = suite.fixtures.iter().filter_map(|fixture| match &fixture.body {
            FixtureBody::Plugin(plugin) => Some(plugin.param.as_str()),
            FixtureBody::Process(_) | FixtureBody::Attached(_) => None,
        });
        // Those of fixtures that rtf adds have values from other files.
        texts.extend(params);
        let mut files = suite.bench_files();
        files.retain(|file| !is_installed(file));
        if !suite.file.is_empty() {
            files.push(PathBuf::from(&suite.file));
        }
        hashes.suite = hashes.hash_with_dependencies(files, &texts);
        hashes
    }

    /// The hash of a plug-in's file, as hexadecimal digits; `None` if it cannot be read.
    pub fn of_plugin(&mut self, plugin: &PluginPlan) -> Option<String> {
        self.of_file(&plugin.file).map(text)
    }

    /// The hash of the sources of a test; `None` if a file that it needs cannot be read.
    pub fn of_test(&mut self, test: &TestPlan) -> Option<String> {
        let suite = format!("{:016x}", self.suite?);
        let plugin = &test.plugin;
        let mut files = frameworks::files(plugin, self.modules.dir())?;
        if !plugin.file.is_dir() {
            files.push(plugin.file.clone());
        }
        let mut texts = vec![suite.as_str(), &plugin.plugin_type, &plugin.param];
        texts.extend(test.env.iter().flat_map(|(name, value)| [name.as_str(), value]));
        self.hash_with_dependencies(files, &texts).map(text)
    }

    /// The hash of texts, and of files with all that they need. Directories do not count, so that
    /// two copies of a project are equal.
    fn hash_with_dependencies(&mut self, files: Vec<PathBuf>, texts: &[&str]) -> Option<u64> {
        let mut hasher = SipHasher13::new();
        for text in texts {
            hasher.write_usize(text.len());
            hasher.write(text.as_bytes());
        }
        let (mut found, mut waiting) = (BTreeSet::new(), files);
        waiting.reverse();
        while let Some(file) = waiting.pop() {
            if found.contains(&file) {
                continue;
            }
            hasher.write(file.file_name().unwrap_or_default().as_encoded_bytes());
            hasher.write_u64(self.of_file(&file)?);
            waiting.extend(self.dependencies_of(&file)?.into_iter().rev());
            found.insert(file);
            if found.len() > MAX_FILES {
                return None;
            }
        }
        Some(hasher.finish())
    }

    fn of_file(&mut self, file: &Path) -> Option<u64> {
        if let Some(known) = self.hashes.get(file) {
            return *known;
        }
        let hash = hash(file).ok();
        self.hashes.insert(file.to_owned(), hash);
        hash
    }

    /// The modules that a script imports, or the libraries that a program needs; `None` if there
    /// are too many.
    fn dependencies_of(&mut self, file: &Path) -> Option<Vec<PathBuf>> {
        if let Some(known) = self.dependencies.get(file) {
            return Some(known.clone());
        }
        let mut found = match Language::of(file) {
            Some(language) => self.modules.imported_by(file, language)?,
            None => self.libraries.needed_by(file),
        };
        found.retain(|file| !is_installed(file));
        self.dependencies.insert(file.to_owned(), found.clone());
        Some(found)
    }
}

fn text(hash: u64) -> String {
    format!("{hash:016x}")
}

fn is_installed(file: &Path) -> bool {
    INSTALLED.iter().any(|dir| file.starts_with(dir))
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
        let mut hashes = SourceHashes::default();
        assert_eq!(hashes.of_file(&a), hashes.of_file(&b));
        assert_ne!(hashes.of_file(&a), hashes.of_file(&c));
        assert_eq!(hashes.of_file(dir.path()), None);
        assert_eq!(hashes.of_file(&dir.path().join("missing")), None);
    }

    #[test]
    fn a_changed_module_changes_the_hash_wherever_the_files_are() {
        let hash = |text: &str| {
            let dir = tempfile::tempdir().unwrap();
            let write = |name: &str, text: &str| {
                std::fs::write(dir.path().join(name), text).unwrap();
            };
            write("a.py", "import b, os\n");
            write("b.py", "from c import x\nimport a\n");
            write("c.py", text);
            let mut hashes = SourceHashes::default();
            hashes.hash_with_dependencies(vec![dir.path().join("a.py")], &[]).unwrap()
        };
        assert_eq!(hash("x = 1"), hash("x = 1"));
        assert_ne!(hash("x = 1"), hash("x = 2"));
    }
}
