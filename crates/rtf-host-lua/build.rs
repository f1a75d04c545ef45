//! Exports Lua's own functions from the host, so that C modules
//! (`require("socket")`) find them. Nothing else is exported: another
//! library's symbols must not meet those of a module.

fn main() {
    let system = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    let option = match system.as_str() {
        "windows" => return,
        "macos" => "-Wl,-exported_symbol,_lua*",
        _ => "-Wl,--export-dynamic-symbol=lua*",
    };
    println!("cargo::rustc-link-arg-bins={option}");
    println!("cargo::rerun-if-changed=build.rs");
}
