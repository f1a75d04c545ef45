//! The search path of `require`: the plug-in's directory, Lua's defaults (`LUA_PATH`,
//! `/usr/local`), and the directories in which distributions install modules.

use std::path::Path;

use mlua::{Lua, Table};

/// Prepends the plug-in's directory to the search paths, and appends the directories of
/// distributions.
pub(crate) fn extend(lua: &Lua, file: &Path) -> mlua::Result<()> {
    let package: Table = lua.globals().get("package")?;
    let dir = file.parent().map(|dir| dir.to_string_lossy().into_owned());
    // A search path cannot express these two characters.
    let dir = dir.filter(|dir| !dir.contains([';', '?']));
    let own = |patterns: &[&str]| -> Vec<String> {
        dir.iter().flat_map(|d| patterns.iter().map(move |p| format!("{d}/{p}"))).collect()
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

fn system(dir: &str, patterns: &[&str]) -> Vec<String> {
    patterns.iter().map(|pattern| format!("/usr/{dir}/lua/5.4/{pattern}")).collect()
}

/// The directory in which Debian and its derivatives install an architecture's libraries.
fn triplet() -> &'static str {
    match std::env::consts::ARCH {
        "aarch64" => "aarch64-linux-gnu",
        "arm" => "arm-linux-gnueabihf",
        "riscv64" => "riscv64-linux-gnu",
        "x86" => "i386-linux-gnu",
        _ => "x86_64-linux-gnu",
    }
}
