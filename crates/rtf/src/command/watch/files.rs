//! Which files a run depends on, and what an event in their folders means.

use std::collections::BTreeSet;
use std::fs::Metadata;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use notify::event::{AccessKind, AccessMode, CreateKind, ModifyKind, RenameMode};
use notify::{Event, EventKind};
use rtf_model::Diagnostic;
use rtf_plan::config::ConfigFiles;
use rtf_plan::plan::{FixtureBody, HookBody, Plan};

use super::debounce::Touch;
use crate::cli::RunArgs;
use crate::command::planning::{self, Draft, Verify};

/// What is watched. Paths are absolute, their folders without links.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Watched {
    /// A change of one of them counts.
    pub files: BTreeSet<PathBuf>,
    /// The folders of suites or plug-ins that were given: what comes into them
    /// counts when it changes the plan.
    given: BTreeSet<PathBuf>,
    /// Where nothing counts.
    results: PathBuf,
    /// What is wrong with the suites.
    problems: Vec<Diagnostic>,
    /// Whether there is no plan.
    pub broken: bool,
}

impl Watched {
    /// Finds out what a run would use. Where there is no plan, what it used
    /// `before` is watched, too.
    pub fn look(args: &RunArgs, before: &Self) -> Self {
        let results = std::path::absolute(&args.results.results).unwrap_or_default();
        let mut watched = Self { results: place(&results), ..Self::default() };
        let inputs = &args.input.inputs;
        for input in inputs.iter().filter(|_| args.input.select.rerun.is_empty()) {
            watched.add_input(input, args.input.recursive);
        }
        let draft = planning::draft(&args.input, &args.results, Verify::Nothing).ok();
        watched.broken = draft.as_ref().is_none_or(|draft| draft.plan.is_none());
        if watched.broken {
            watched.files.extend(before.files.iter().cloned());
        }
        if let Some(Draft { plan, folder, problems, .. }) = draft {
            watched.problems = problems;
            plan.iter().for_each(|plan| watched.add_plan(plan, &folder));
        }
        watched
    }

    /// The folders to be watched, as far as they are there, with their inodes.
    pub fn folders(&self) -> BTreeSet<(PathBuf, u64)> {
        let parents = self.files.iter().filter_map(|file| file.parent());
        let all = parents.chain(self.given.iter().map(PathBuf::as_path));
        let there = all.filter_map(|folder| {
            let found = folder.metadata().ok().filter(Metadata::is_dir)?;
            Some((folder.to_owned(), found.ino()))
        });
        there.collect()
    }

    /// How many of the files are there.
    pub fn there(&self) -> usize {
        self.files.iter().filter(|file| file.exists()).count()
    }

    /// Whether one of these files is used.
    pub fn uses(&self, touched: &BTreeSet<PathBuf>) -> bool {
        !self.files.is_disjoint(touched)
    }

    fn add(&mut self, file: &Path) {
        self.files.insert(place(file));
        if file.is_symlink()
            && let Ok(target) = file.canonicalize()
        {
            self.files.insert(target);
        }
    }

    fn add_input(&mut self, input: &Path, recursive: bool) {
        let text = input.to_string_lossy();
        let named = text.split_once("::").filter(|_| !input.exists());
        let path = named.map_or(input, |(file, _)| Path::new(file));
        let Ok(path) = std::path::absolute(path) else { return };
        self.add_configuration(&rtf_plan::config::input_dir(&path));
        match path.canonicalize() {
            Ok(folder) if folder.is_dir() => self.add_folder(folder, recursive),
            _ => self.add(&path),
        }
    }

    fn add_folder(&mut self, folder: PathBuf, recursive: bool) {
        if folder == self.results {
            return;
        }
        let entries = std::fs::read_dir(&folder).ok().filter(|_| recursive);
        for entry in entries.into_iter().flatten().flatten() {
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                self.add_folder(entry.path(), recursive);
            }
        }
        self.given.insert(folder);
    }

    /// The `rtf.toml` that holds in a folder, and the one that it may get.
    fn add_configuration(&mut self, folder: &Path) {
        let mut files = ConfigFiles::new(folder);
        files.find_nearest(folder);
        files.all().iter().for_each(|file| self.add(&file.path));
        self.add(&folder.join("rtf.toml"));
    }

    fn add_plan(&mut self, plan: &Plan, folder: &Path) {
        for suite in &plan.suites {
            if !suite.file.is_empty() {
                self.add(&folder.join(&suite.file));
            }
            self.add_configuration(&suite.folder);
            suite.tests.iter().for_each(|test| self.add(&test.plugin.file));
            for hook in &suite.hooks {
                match &hook.body {
                    HookBody::Plugin(plugin) => self.add(&plugin.file),
                    HookBody::Command(command) => self.add_command(command, &suite.folder),
                }
            }
            for fixture in &suite.fixtures {
                match &fixture.body {
                    FixtureBody::Plugin(plugin) => self.add(&plugin.file),
                    FixtureBody::Process(process) if process.remote.is_none() => {
                        self.add_command(&process.command, &suite.folder);
                    }
                    FixtureBody::Process(_) | FixtureBody::Attached(_) => {}
                }
            }
        }
    }

    /// A program, and the script that an interpreter is given first. Further
    /// arguments may be files that the program writes.
    fn add_command(&mut self, command: &[String], folder: &Path) {
        let Some((program, args)) = command.split_first() else { return };
        let script = args.iter().find(|arg| !arg.starts_with('-'));
        for path in script.into_iter().chain([program]).map(|word| folder.join(word)) {
            if path.is_file() {
                self.add(&path);
            }
        }
    }

    /// What an event means for which files.
    pub fn touches(&self, event: &Event) -> Vec<(PathBuf, Touch)> {
        let mut touches = Vec::new();
        for path in event.paths.iter().filter(|path| !path.starts_with(&self.results)) {
            let Some(touch) = touch(&event.kind, path) else { continue };
            let given = path.parent().is_some_and(|folder| self.given.contains(folder));
            if given || self.files.contains(path) {
                touches.push((path.clone(), touch));
            } else if touch == Touch::Removed {
                let inside = self.files.iter().filter(|file| file.starts_with(path));
                touches.extend(inside.map(|file| (file.clone(), touch)));
            }
        }
        touches
    }
}

fn touch(kind: &EventKind, path: &Path) -> Option<Touch> {
    match kind {
        EventKind::Create(CreateKind::Folder) => Some(Touch::Replaced),
        // A link is whole, and nobody closes it.
        EventKind::Create(_) if is_link(path) => Some(Touch::Replaced),
        EventKind::Create(_) => Some(Touch::Created),
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => Some(Touch::Closed),
        EventKind::Modify(ModifyKind::Data(_)) => Some(Touch::Written),
        EventKind::Modify(ModifyKind::Metadata(_)) => Some(Touch::Attributes),
        EventKind::Modify(ModifyKind::Name(RenameMode::From)) | EventKind::Remove(_) => {
            Some(Touch::Removed)
        }
        EventKind::Modify(ModifyKind::Name(RenameMode::To)) => Some(Touch::Replaced),
        _ => None,
    }
}

fn is_link(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|file| file.is_symlink() || file.nlink() > 1)
}

/// The path as events tell it: its folder without links.
fn place(path: &Path) -> PathBuf {
    let (folder, name) = (path.parent(), path.file_name());
    match (folder.and_then(|folder| folder.canonicalize().ok()), name) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}
