//! The files that a run depends on, and the meaning of events in their directories.

use std::collections::BTreeSet;
use std::fs::Metadata;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use notify::event::{AccessKind, AccessMode, CreateKind, ModifyKind, RenameMode};
use notify::{Event, EventKind};
use rtf_model::Diagnostic;
use rtf_plan::config::ConfigFiles;
use rtf_plan::plan::{Plan, PlanDraft};
use rtf_run::plan::{self, Draft};
use rtf_run::watch::debounce::FileChange;

use crate::cli::InputArgs;
use crate::request;

/// What is watched. Paths are absolute, their directories without links.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Watched {
    /// The files that a run reads.
    pub files: BTreeSet<PathBuf>,
    /// The input directories: a new file in them counts if it changes the plan.
    input_dirs: BTreeSet<PathBuf>,
    /// The results directory, whose changes are ignored.
    results: PathBuf,
    problems: Vec<Diagnostic>,
    pub has_errors: bool,
}

impl Watched {
    /// Finds the files that a run would use. If the suites have errors, the files of
    /// `previous` are watched, too.
    pub fn find(args: &InputArgs, previous: &Self) -> Self {
        let results = std::path::absolute(&args.results.results).unwrap_or_default();
        let mut watched = Self { results: resolve_dir(&results), ..Self::default() };
        for input in args.inputs.iter().filter(|_| args.select.rerun.is_empty()) {
            watched.add_input(input, args.recursive);
        }
        watched.has_errors = true;
        if let Ok(request) = request::tests(args) {
            let Draft { plan, problems, .. } = plan::draft(&request, PlanDraft::unchecked);
            (watched.problems, watched.has_errors) = (problems, plan.is_none());
            let dir = &request.options.runner.current_dir;
            plan.iter().for_each(|plan| watched.add_plan(plan, dir));
        }
        if watched.has_errors {
            watched.files.extend(previous.files.iter().cloned());
        }
        watched
    }

    /// The existing directories to watch, with their inodes.
    pub fn dirs(&self) -> BTreeSet<(PathBuf, u64)> {
        let parents = self.files.iter().filter_map(|file| file.parent());
        let all = parents.chain(self.input_dirs.iter().map(PathBuf::as_path));
        let existing = all.filter_map(|dir| {
            let metadata = dir.metadata().ok().filter(Metadata::is_dir)?;
            Some((dir.to_owned(), metadata.ino()))
        });
        existing.collect()
    }

    /// The number of files that exist.
    pub fn existing_files(&self) -> usize {
        self.files.iter().filter(|file| file.exists()).count()
    }

    /// Whether a run reads one of these files.
    pub fn uses(&self, changed: &BTreeSet<PathBuf>) -> bool {
        !self.files.is_disjoint(changed)
    }

    fn add(&mut self, file: &Path) {
        self.files.insert(resolve_dir(file));
        if file.is_symlink()
            && let Ok(target) = file.canonicalize()
        {
            self.files.insert(target);
        }
    }

    fn add_input(&mut self, input: &Path, recursive: bool) {
        let text = input.to_string_lossy();
        let suite = text.split_once("::").filter(|_| !input.exists());
        let path = suite.map_or(input, |(file, _)| Path::new(file));
        let Ok(path) = std::path::absolute(path) else { return };
        self.add_config(&rtf_plan::config::input_dir(&path));
        match path.canonicalize() {
            Ok(dir) if dir.is_dir() => self.add_dir(dir, recursive),
            _ => self.add(&path),
        }
    }

    fn add_dir(&mut self, dir: PathBuf, recursive: bool) {
        if dir == self.results {
            return;
        }
        let entries = std::fs::read_dir(&dir).ok().filter(|_| recursive);
        for entry in entries.into_iter().flatten().flatten() {
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                self.add_dir(entry.path(), recursive);
            }
        }
        self.input_dirs.insert(dir);
    }

    /// The `rtf.toml` of a directory, and the one that it may get.
    fn add_config(&mut self, dir: &Path) {
        let mut files = ConfigFiles::new(dir);
        files.find_nearest(dir);
        files.all().iter().for_each(|file| self.add(&file.path));
        self.add(&dir.join("rtf.toml"));
    }

    fn add_plan(&mut self, plan: &Plan, dir: &Path) {
        for suite in &plan.suites {
            if !suite.file.is_empty() {
                self.add(&dir.join(&suite.file));
            }
            self.add_config(&suite.folder);
            suite.tests.iter().for_each(|test| self.add(&test.plugin.file));
            suite.bench_files().iter().for_each(|file| self.add(file));
        }
    }

    /// The changes that an event reports.
    pub fn changes(&self, event: &Event) -> Vec<(PathBuf, FileChange)> {
        let mut changes = Vec::new();
        for path in event.paths.iter().filter(|path| !path.starts_with(&self.results)) {
            let Some(change) = file_change(&event.kind, path) else { continue };
            let is_input = path.parent().is_some_and(|dir| self.input_dirs.contains(dir));
            if is_input || self.files.contains(path) {
                changes.push((path.clone(), change));
            } else if change == FileChange::Removed {
                let inside = self.files.iter().filter(|file| file.starts_with(path));
                changes.extend(inside.map(|file| (file.clone(), change)));
            }
        }
        changes
    }
}

fn file_change(kind: &EventKind, path: &Path) -> Option<FileChange> {
    match kind {
        EventKind::Create(CreateKind::Folder) => Some(FileChange::Replaced),
        // A link is complete from the start, and is never closed.
        EventKind::Create(_) if is_link(path) => Some(FileChange::Replaced),
        EventKind::Create(_) => Some(FileChange::Created),
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => Some(FileChange::Closed),
        EventKind::Modify(ModifyKind::Data(_)) => Some(FileChange::Written),
        EventKind::Modify(ModifyKind::Metadata(_)) => Some(FileChange::Attributes),
        EventKind::Modify(ModifyKind::Name(RenameMode::From)) | EventKind::Remove(_) => {
            Some(FileChange::Removed)
        }
        EventKind::Modify(ModifyKind::Name(RenameMode::To)) => Some(FileChange::Replaced),
        _ => None,
    }
}

fn is_link(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|file| file.is_symlink() || file.nlink() > 1)
}

/// The path as events report it: its directory without links.
fn resolve_dir(path: &Path) -> PathBuf {
    let (dir, name) = (path.parent(), path.file_name());
    match (dir.and_then(|dir| dir.canonicalize().ok()), name) {
        (Some(dir), Some(name)) => dir.join(name),
        _ => path.to_owned(),
    }
}
