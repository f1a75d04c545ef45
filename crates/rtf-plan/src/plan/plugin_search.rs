//! Finds the file of a plug-in by its name.

use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::framework_search;
use super::frameworks::FRAMEWORKS;
use super::host_kind::HostKind;
use super::hosts::{self, HOSTS};
use super::program::list;
use super::search_scope::SearchScope;
use super::use_site::PluginRole;
use crate::suite::DeclaredPlugin;
use crate::wording::{nearest, quoted, suggest};

/// Returns the type of a plug-in: as declared, else by its extension, else `dll`.
pub(super) fn kind_of(
    plugin: &DeclaredPlugin,
    role: PluginRole,
) -> Result<&'static HostKind, Box<Diagnostic>> {
    let Some(declared) = &plugin.plugin_type else {
        let by_extension = hosts::by_extension(Path::new(&plugin.name.value));
        return Ok(by_extension.unwrap_or(&HOSTS[0]));
    };
    if let Some(kind) = hosts::by_name(&declared.value) {
        return if kind.framework.is_some() && role != PluginRole::Test {
            Err(only_for_tests(kind, role).into())
        } else {
            Ok(kind)
        };
    }
    Err(unknown_type(&declared.value, role).into())
}

fn only_for_tests(kind: &HostKind, role: PluginRole) -> Diagnostic {
    let (name, element) = (kind.name, role.element());
    let message = format!("the type `{name}` is only for tests, not for a {element}");
    let problem = Diagnostic::error("wrong-kind", message);
    match role {
        PluginRole::Hook => problem.hint("write a program as `<command>`, without a `type`"),
        _ => problem.hint("`type=\"process\"` is a fixture that runs a program"),
    }
}

fn unknown_type(declared: &str, role: PluginRole) -> Diagnostic {
    let others: &[HostKind] = if role == PluginRole::Test { &FRAMEWORKS } else { &[] };
    let process = (role == PluginRole::Fixture).then_some("process");
    let names: Vec<&str> =
        HOSTS.iter().chain(others).map(|kind| kind.name).chain(process).collect();
    let list = quoted(names.iter().copied(), ", ");
    let problem = Diagnostic::error("unknown-type", format!("unknown type `{declared}`"))
        .note(format!("known types are {list}"));
    if role == PluginRole::Hook && declared == "process" {
        return problem.hint("a program is written as `<command>`, without a `type`");
    }
    suggest(problem, declared, names.into_iter())
}

/// Finds plug-ins in one scope and caches the results.
#[derive(Default)]
pub(super) struct PluginFinder {
    dirs: HashMap<&'static str, Arc<[PathBuf]>>,
    found: HashMap<(&'static str, String), Option<PathBuf>>,
}

impl PluginFinder {
    pub fn find(
        &mut self,
        name: &str,
        kind: &'static HostKind,
        scope: &SearchScope<'_>,
    ) -> Option<PathBuf> {
        if let Some(known) = self.found.get(&(kind.name, name.to_owned())) {
            return known.clone();
        }
        let file = match kind.framework {
            Some(framework) => framework_search::find(name, framework.subject, scope),
            None => {
                let dirs = || search_dirs(kind, scope).into();
                search(name, kind, self.dirs.entry(kind.name).or_insert_with(dirs))
            }
        };
        self.found.insert((kind.name, name.to_owned()), file.clone());
        file
    }
}

/// Returns the directories in which plug-ins are searched, in order.
fn search_dirs(kind: &HostKind, scope: &SearchScope<'_>) -> Vec<PathBuf> {
    let mut dirs = scope.user_dirs();
    dirs.extend(kind.library_path.map(|name| scope.dirs(name)).unwrap_or_default());
    dirs.extend(scope.runner.prefix().map(|prefix| prefix.join("lib/rtf/plugins")));
    dirs.extend(shipped_dir(scope));
    let mut seen = HashSet::new();
    dirs.retain(|dir| seen.insert(dir.clone()));
    dirs
}

/// Finds a fixture manager that comes with `rtf`, such as `roslaunch`, and its
/// type. A suite names it without a directory or type; plug-ins of the user take
/// precedence.
pub(super) fn shipped(name: &str, scope: &SearchScope<'_>) -> Option<(PathBuf, &'static HostKind)> {
    let is_name = Path::new(name).components().count() == 1;
    let dir = shipped_dir(scope).filter(|_| is_name)?;
    HOSTS.iter().find_map(|kind| {
        let extension = kind.extensions.first()?;
        let file = dir.join(format!("{name}.{extension}"));
        file.is_file().then_some((file, kind))
    })
}

/// Checks whether a file is in a directory for the user's plug-ins, and not just
/// a library of the platform.
pub(super) fn is_in_user_dir(file: &Path, scope: &SearchScope<'_>) -> bool {
    scope.user_dirs().iter().any(|dir| file.starts_with(dir))
}

/// Finds the directory of the shipped fixture managers: in the prefix, or in the
/// source tree.
pub(super) fn shipped_dir(scope: &SearchScope<'_>) -> Option<PathBuf> {
    scope.runner.shipped(&["share/rtf/fixtures"], "fixtures", "rtf_fixtures")
}

/// Returns the possible paths of a plug-in's file. Only the extension of the
/// file is relevant, not one elsewhere in the path.
fn candidates(name: &str, kind: &HostKind) -> Vec<PathBuf> {
    let path = Path::new(name);
    let file = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let mut names: Vec<String> = Vec::new();
    let extension = path.extension().and_then(OsStr::to_str);
    if extension.is_some_and(|extension| kind.extensions.contains(&extension)) {
        names.extend(kind.prefixes.iter().map(|prefix| format!("{prefix}{file}")));
    } else {
        let mut stems = vec![file];
        if hosts::by_extension(path).is_some_and(|other| other.name == kind.name) {
            stems.push(path.file_stem().and_then(OsStr::to_str).unwrap_or_default());
        }
        for stem in stems {
            for extension in kind.extensions {
                let with = |prefix: &&str| format!("{prefix}{stem}.{extension}");
                names.extend(kind.prefixes.iter().map(with));
            }
        }
        // A file without an extension comes last: it may be a program, `SensorTest`
        // next to `SensorTest.so`.
        names.push(file.to_owned());
    }
    names.into_iter().map(|name| path.with_file_name(name)).collect()
}

fn search(name: &str, kind: &HostKind, dirs: &[PathBuf]) -> Option<PathBuf> {
    let candidates = candidates(name, kind);
    let mut all = dirs.iter().flat_map(|dir| candidates.iter().map(move |file| dir.join(file)));
    all.find(|file| file.is_file()).map(|file| file.components().collect())
}

/// Reports a missing plug-in with the searched files and directories. `suggest`
/// adds a similar name, which requires reading all directories.
pub(super) fn not_found(
    name: &str,
    kind: &'static HostKind,
    scope: &SearchScope<'_>,
    suggest: bool,
) -> Diagnostic {
    if let Some(framework) = kind.framework {
        let kind = (kind.name, framework.subject);
        return framework_search::not_found(name, kind, scope, suggest);
    }
    let dirs = search_dirs(kind, scope);
    let files: Vec<_> =
        candidates(name, kind).iter().map(|file| file.display().to_string()).collect();
    let files = quoted(files.iter().map(String::as_str), ", ");
    let message = format!("there is no plug-in `{name}` of type `{}`", kind.name);
    let problem = Diagnostic::error("no-such-plugin", message);
    let problem = if Path::new(name).is_absolute() {
        problem.note(format!("looked for {files}"))
    } else {
        problem.note(format!("looked for {files} in\n{}", list(&dirs)))
    };
    if !suggest {
        return problem;
    }
    match other_type(name, kind, scope).or_else(|| similar(name, kind, &dirs)) {
        Some(hint) => problem.hint(hint),
        None if Path::new(name).is_absolute() => problem,
        None => problem.hint("`RTF_PLUGIN_PATH` adds directories to the search"),
    }
}

/// Suggests a plug-in of the same name with another type.
fn other_type(name: &str, kind: &HostKind, scope: &SearchScope<'_>) -> Option<String> {
    HOSTS.iter().filter(|other| other.name != kind.name).find_map(|other| {
        let file = search(name, other, &search_dirs(other, scope))?;
        hosts::by_extension(&file).filter(|kind| kind.name == other.name)?;
        let file = file.file_name()?.to_str()?.to_owned();
        Some(format!("there is `{file}`; write `type=\"{}\"`", other.name))
    })
}

/// Suggests a plug-in with a similar name.
fn similar(name: &str, kind: &HostKind, dirs: &[PathBuf]) -> Option<String> {
    let path = Path::new(name);
    let known: Vec<String> = dirs
        .iter()
        .filter_map(|dir| dir.join(path).parent()?.read_dir().ok())
        .flatten()
        .filter_map(|entry| {
            let file = PathBuf::from(entry.ok()?.file_name());
            hosts::by_extension(&file).filter(|other| other.name == kind.name)?;
            let stem = file.file_stem()?.to_str()?;
            Some(
                stem.strip_prefix("lib")
                    .filter(|_| kind.prefixes.len() > 1)
                    .unwrap_or(stem)
                    .to_owned(),
            )
        })
        .collect();
    // The extension may be what selects the type.
    let has_extension = hosts::by_extension(path).is_some_and(|other| other.name == kind.name);
    let extension = path.extension().and_then(OsStr::to_str).filter(|_| has_extension);
    let stem = if has_extension { path.file_stem() } else { path.file_name() };
    let found = nearest(stem?.to_str()?, known.iter().map(String::as_str))?;
    let extension = extension.map(|extension| format!(".{extension}")).unwrap_or_default();
    let found = path.with_file_name(format!("{found}{extension}"));
    Some(format!("did you mean `{}`?", found.display()))
}

/// Returns the default name of a test, fixture or hook: the plug-in's name
/// without its directory and without a known extension.
pub(super) fn base_name(name: &str) -> &str {
    let path = Path::new(name);
    let file = path.file_name().and_then(OsStr::to_str).unwrap_or(name);
    match hosts::by_extension(path) {
        Some(_) => path.file_stem().and_then(OsStr::to_str).unwrap_or(file),
        None => file,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(name: &str, kind: &str) -> Vec<String> {
        let kind = hosts::by_name(kind).unwrap();
        candidates(name, kind).iter().map(|file| file.display().to_string()).collect()
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn with_and_without_prefix_and_extension() {
        assert_eq!(names("Arm", "dll"), ["Arm.so", "libArm.so", "Arm"]);
        assert_eq!(names("b/libArm.so", "dll"), ["b/libArm.so", "b/liblibArm.so"]);
        assert_eq!(
            names("Arm.dll", "dll"),
            ["Arm.dll.so", "libArm.dll.so", "Arm.so", "libArm.so", "Arm.dll"]
        );
        assert_eq!(names("Arm", "lua"), ["Arm.lua", "Arm"]);
        assert_eq!(names("Arm.lua", "lua"), ["Arm.lua"]);
    }

    /// Defect 11 of the predecessor: `.so` was searched anywhere in the path.
    #[test]
    fn an_extension_is_at_the_end_of_the_file() {
        assert_eq!(names("my.sources/Arm", "lua"), ["my.sources/Arm.lua", "my.sources/Arm"]);
        assert!(hosts::by_extension(Path::new("my.so/Arm")).is_none());
        assert!(hosts::by_extension(Path::new("Arm.so.txt")).is_none());
        assert_eq!(base_name("my.so/Arm.lua"), "Arm");
        assert_eq!(base_name("Arm.v2"), "Arm.v2");
    }
}
