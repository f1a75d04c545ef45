//! Libraries that are loaded into programs (`LD_PRELOAD`).

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Finds a library: next to this program, or in the build directory of its source tree.
pub fn library(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    let dir = program.parent()?;
    let build = dir.ancestors().map(|dir| dir.join("build"));
    let dirs = std::iter::once(dir.to_path_buf()).chain(build);
    dirs.map(|dir| dir.join(name)).find(|library| library.is_file())
}

/// Has a command load libraries first, before those of the user.
///
/// # Errors
/// A library cannot be copied to a path that `LD_PRELOAD` can contain.
pub fn add(command: &mut Command, libraries: &[PathBuf], scratch: &Path) -> Result<(), String> {
    let mut list = OsString::new();
    for library in libraries {
        list.push(if list.is_empty() { "" } else { ":" });
        list.push(preloadable(library, scratch)?);
    }
    for (name, first) in [("LD_PRELOAD", list), ("ASAN_OPTIONS", OsString::from(ANY_ORDER))] {
        command.env(name, joined(first, name));
    }
    Ok(())
}

/// The variables that [`add`] sets.
pub const VARIABLES: [&str; 2] = ["LD_PRELOAD", "ASAN_OPTIONS"];

/// Otherwise its library demands to be the first one.
const ANY_ORDER: &str = "verify_asan_link_order=0";

/// A list with the user's value of a variable, separated with colons.
fn joined(first: OsString, variable: &str) -> OsString {
    let mut list = first;
    if let Some(user) = std::env::var_os(variable).filter(|user| !user.is_empty()) {
        list.push(":");
        list.push(user);
    }
    list
}

/// A path of the library that `LD_PRELOAD` can contain, which separates paths with blanks and
/// colons.
fn preloadable(library: &Path, scratch: &Path) -> Result<PathBuf, String> {
    if !library.to_string_lossy().contains([' ', ':']) {
        return Ok(library.to_owned());
    }
    let copy = scratch.join(library.file_name().unwrap_or_default());
    let copied = std::fs::copy(library, &copy);
    copied.map_err(|error| format!("`{}` cannot be copied: {error}", library.display()))?;
    Ok(copy)
}
