//! Where `require` looks: beside the plug-in, where Lua looks by itself
//! (`LUA_PATH`, `/usr/local`), and where distributions install modules.

use std::path::Path;

use mlua::{Lua, Table};

/// Prepends the plug-in's folder to the search paths and appends the folders
/// of distributions.
pub(crate) fn extend(lua: &Lua, file: &Path) -> mlua::Result<()> {
    let package: Table = lua.globals().get("package")?;
    let folder = file.parent().map(|folder| folder.to_string_lossy().into_owned());
    // A search path cannot express these two characters.
    let folder = folder.filter(|folder| !folder.contains([';', '?']));
    let own = |patterns: &[&str]| -> Vec<String> {
        let folder = folder.iter();
        folder.flat_map(|f| patterns.iter().map(move |p| format!("{f}/{p}"))).collect()
    };
    add(
        &package,
        "path",
        &own(&["?.lua", "?/init.lua"]),
        &system("share", &["?.lua", "?/init.lua"]),
    )?;
    let mut modules = system("lib", &["?.so"]);
    modules.extend(system("lib64", &["?.so"]));
    modules.extend(system(&format!("lib/{}", triplet()), &["?.so"]));
    add(&package, "cpath", &own(&["?.so"]), &modules)
}

fn add(package: &Table, name: &str, first: &[String], last: &[String]) -> mlua::Result<()> {
    let present: String = package.get(name)?;
    let mut entries: Vec<&str> = first.iter().map(String::as_str).collect();
    entries.extend(present.split(';'));
    for entry in last {
        if !entries.contains(&entry.as_str()) {
            entries.push(entry);
        }
    }
    package.set(name, entries.join(";"))
}

fn system(folder: &str, patterns: &[&str]) -> Vec<String> {
    patterns.iter().map(|pattern| format!("/usr/{folder}/lua/5.4/{pattern}")).collect()
}

/// The folder under which Debian and its descendants keep libraries of an
/// architecture.
fn triplet() -> &'static str {
    match std::env::consts::ARCH {
        "aarch64" => "aarch64-linux-gnu",
        "arm" => "arm-linux-gnueabihf",
        "riscv64" => "riscv64-linux-gnu",
        "x86" => "i386-linux-gnu",
        _ => "x86_64-linux-gnu",
    }
}
