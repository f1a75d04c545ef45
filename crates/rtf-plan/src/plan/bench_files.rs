//! The files that a suite names apart from its tests.

use std::path::{Path, PathBuf};

use super::{FixtureBody, HookBody, SuitePlan};

impl SuitePlan {
    /// The files of its hooks, resets and fixtures on this machine: plug-ins, programs and
    /// scripts. Those of plug-ins may be missing.
    #[must_use]
    pub fn bench_files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        let resets = self.fixtures.iter().filter_map(|fixture| fixture.reset.as_ref());
        let hooks = self.hooks.iter().map(|hook| &hook.body);
        for body in hooks.chain(resets.map(|reset| &reset.body)) {
            match body {
                HookBody::Plugin(plugin) => files.push(plugin.file.clone()),
                HookBody::Command(command) => files.extend(command_files(command, &self.folder)),
            }
        }
        for fixture in &self.fixtures {
            match &fixture.body {
                FixtureBody::Plugin(plugin) => files.push(plugin.file.clone()),
                FixtureBody::Process(process) if process.remote.is_none() => {
                    files.extend(command_files(&process.command, &self.folder));
                }
                FixtureBody::Process(_) | FixtureBody::Attached(_) => {}
            }
        }
        files
    }
}

/// A program, and its first argument if that is a script. The program may write to further
/// arguments.
fn command_files(command: &[String], dir: &Path) -> impl Iterator<Item = PathBuf> {
    let (program, args) = command.split_first().unzip();
    let script = args.and_then(|args| args.iter().find(|arg| !arg.starts_with('-')));
    let words = script.into_iter().chain(program);
    words.map(|word| dir.join(word)).filter(|path| path.is_file()).collect::<Vec<_>>().into_iter()
}
