//! From a plug-in's name to its file.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::context::Role;
use super::hosts::{self, HOSTS, HostKind};
use super::scope::Scope;
use crate::suite::{Plugin, nearest};

/// The type of a plug-in: as written, else as its extension tells, else `dll`.
pub(super) fn kind_of(plugin: &Plugin, role: Role) -> Result<&'static HostKind, Box<Diagnostic>> {
    let Some(written) = &plugin.plugin_type else {
        let told = hosts::by_extension(Path::new(&plugin.name.value));
        return Ok(told.unwrap_or(&HOSTS[0]));
    };
    hosts::by_name(&written.value).ok_or_else(|| {
        let process = (role == Role::Fixture).then_some("process");
        let names: Vec<&str> = HOSTS.iter().map(|kind| kind.name).chain(process).collect();
        let known: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
        let problem =
            Diagnostic::error("unknown-type", format!("unknown type `{}`", written.value))
                .note(format!("known types are {}", known.join(", ")));
        if role == Role::Hook && written.value == "process" {
            return problem.hint("a program is written as `<command>`, without a `type`").into();
        }
        match nearest(&written.value, names.into_iter()) {
            Some(name) => problem.hint(format!("did you mean `{name}`?")).into(),
            None => problem.into(),
        }
    })
}

/// Finds plug-ins for one scope; what was found once is not searched again.
pub(super) struct Finder {
    folders: HashMap<&'static str, Arc<[PathBuf]>>,
    found: HashMap<(&'static str, String), Option<PathBuf>>,
}

impl Finder {
    /// A finder without memory.
    pub fn new() -> Self {
        Self { folders: HashMap::new(), found: HashMap::new() }
    }

    /// The plug-in's file.
    pub fn find(
        &mut self,
        name: &str,
        kind: &'static HostKind,
        scope: &Scope<'_>,
    ) -> Option<PathBuf> {
        if let Some(known) = self.found.get(&(kind.name, name.to_owned())) {
            return known.clone();
        }
        let folders =
            self.folders.entry(kind.name).or_insert_with(|| search_folders(kind, scope).into());
        let file = search(name, kind, folders);
        self.found.insert((kind.name, name.to_owned()), file.clone());
        file
    }
}

/// Where plug-ins are searched, in order.
fn search_folders(kind: &HostKind, scope: &Scope<'_>) -> Vec<PathBuf> {
    let mut folders = own_folders(scope);
    folders.extend(kind.library_path.map(|name| scope.folders(name)).unwrap_or_default());
    folders.extend(scope.surroundings.prefix().map(|prefix| prefix.join("lib/rtf/plugins")));
    folders.extend(shipped_folder(scope));
    let mut seen = std::collections::HashSet::new();
    folders.retain(|folder| seen.insert(folder.clone()));
    folders
}

/// A fixture manager that comes with rtf, such as `roslaunch`, and its type: its
/// name needs neither a folder nor a type. Plug-ins of the user go before it.
pub(super) fn shipped(name: &str, scope: &Scope<'_>) -> Option<(PathBuf, &'static HostKind)> {
    let is_name = Path::new(name).components().count() == 1;
    let folder = shipped_folder(scope).filter(|_| is_name)?;
    HOSTS.iter().find_map(|kind| {
        let extension = kind.extensions.first()?;
        let file = folder.join(format!("{name}.{extension}"));
        file.is_file().then_some((file, kind))
    })
}

/// Whether a plug-in is where its user has put plug-ins, not merely among the
/// libraries of the platform.
pub(super) fn is_beside_suite(file: &Path, scope: &Scope<'_>) -> bool {
    own_folders(scope).iter().any(|folder| file.starts_with(folder))
}

/// Where a user puts plug-ins.
fn own_folders(scope: &Scope<'_>) -> Vec<PathBuf> {
    let mut folders = vec![scope.folder.to_path_buf()];
    folders.extend(scope.beside.map(Path::to_path_buf));
    folders.extend(scope.folders("RTF_PLUGIN_PATH"));
    folders
}

/// The folder of what comes with rtf: below its prefix, or in the source tree.
pub(super) fn shipped_folder(scope: &Scope<'_>) -> Option<PathBuf> {
    let installed = scope.surroundings.prefix().map(|prefix| prefix.join("share/rtf/fixtures"));
    let above = scope.surroundings.executable.ancestors().skip(1);
    let source = above.map(|folder| folder.join("fixtures"));
    installed.into_iter().chain(source).find(|folder| folder.join("rtf_fixtures").is_dir())
}

/// The names that a plug-in's file can have. Only the file's own extension is
/// looked at, never one elsewhere in the path.
fn candidates(name: &str, kind: &HostKind) -> Vec<PathBuf> {
    let path = Path::new(name);
    let file = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let mut names: Vec<String> = Vec::new();
    let extension = path.extension().and_then(OsStr::to_str);
    if extension.is_some_and(|extension| kind.extensions.contains(&extension)) {
        names.extend(kind.prefixes.iter().map(|prefix| format!("{prefix}{file}")));
    } else {
        let mut stems = vec![file];
        if hosts::by_extension(path).is_some_and(|told| told.name == kind.name) {
            stems.push(path.file_stem().and_then(OsStr::to_str).unwrap_or_default());
        }
        for stem in stems {
            for extension in kind.extensions {
                let with = |prefix: &&str| format!("{prefix}{stem}.{extension}");
                names.extend(kind.prefixes.iter().map(with));
            }
        }
        // A file without an extension comes last: `SensorTest` beside
        // `SensorTest.so` is a program.
        names.push(file.to_owned());
    }
    names.into_iter().map(|name| path.with_file_name(name)).collect()
}

fn search(name: &str, kind: &HostKind, folders: &[PathBuf]) -> Option<PathBuf> {
    let candidates = candidates(name, kind);
    let all =
        folders.iter().flat_map(|folder| candidates.iter().map(move |file| folder.join(file)));
    all.into_iter().find(|file| file.is_file()).map(|file| file.components().collect())
}

/// What to say when nothing was found: where and for what we looked.
///
/// The search for what may have been meant reads whole folders; `advise` is
/// false when that was done often enough.
pub(super) fn not_found(
    name: &str,
    kind: &'static HostKind,
    scope: &Scope<'_>,
    advise: bool,
) -> Diagnostic {
    let folders = search_folders(kind, scope);
    let names: Vec<_> =
        candidates(name, kind).iter().map(|file| format!("`{}`", file.display())).collect();
    let message = format!("there is no plug-in `{name}` of type `{}`", kind.name);
    let problem = Diagnostic::error("no-such-plugin", message);
    let problem = if Path::new(name).is_absolute() {
        problem.note(format!("looked for {}", names.join(", ")))
    } else {
        let list: Vec<_> = folders.iter().map(|folder| format!("  {}", folder.display())).collect();
        problem.note(format!("looked for {} in\n{}", names.join(", "), list.join("\n")))
    };
    if !advise {
        return problem;
    }
    match other_type(name, kind, scope).or_else(|| similar(name, kind, &folders)) {
        Some(hint) => problem.hint(hint),
        None if Path::new(name).is_absolute() => problem,
        None => problem.hint("other folders are searched when `RTF_PLUGIN_PATH` names them"),
    }
}

/// A plug-in of this name that has another type.
fn other_type(name: &str, kind: &HostKind, scope: &Scope<'_>) -> Option<String> {
    HOSTS.iter().filter(|other| other.name != kind.name).find_map(|other| {
        let file = search(name, other, &search_folders(other, scope))?;
        hosts::by_extension(&file).filter(|told| told.name == other.name)?;
        let file = file.file_name()?.to_str()?.to_owned();
        Some(format!("there is `{file}`; write `type=\"{}\"`", other.name))
    })
}

/// A plug-in with a similar name.
fn similar(name: &str, kind: &HostKind, folders: &[PathBuf]) -> Option<String> {
    let path = Path::new(name);
    let wanted = path.file_name()?.to_str()?;
    let known: Vec<String> = folders
        .iter()
        .filter_map(|folder| folder.join(path).parent()?.read_dir().ok())
        .flatten()
        .filter_map(|entry| {
            let file = PathBuf::from(entry.ok()?.file_name());
            hosts::by_extension(&file).filter(|told| told.name == kind.name)?;
            let stem = file.file_stem()?.to_str()?;
            Some(
                stem.strip_prefix("lib")
                    .filter(|_| kind.prefixes.len() > 1)
                    .unwrap_or(stem)
                    .to_owned(),
            )
        })
        .collect();
    let stem = Path::new(wanted).file_stem()?.to_str()?;
    let found = nearest(stem, known.iter().map(String::as_str))?;
    Some(format!("did you mean `{found}`?"))
}

/// The name of a test, fixture or hook that has none of its own: the plug-in's,
/// without its folder and without an extension that says its type.
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
