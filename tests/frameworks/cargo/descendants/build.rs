//! Compiles the cases of tests/frameworks/descendants.

use std::path::Path;
use std::process::Command;

fn main() {
    let out = std::env::var("OUT_DIR").unwrap();
    let (header, object) = ("../../descendants/descendants.hpp", Path::new(&out).join("deeds.o"));
    println!("cargo:rerun-if-changed={header}");
    println!("cargo:rerun-if-changed=../../descendants/deeds.cpp");
    let mut compiler = Command::new("c++");
    compiler.args(["-std=c++17", "-c", "../../descendants/deeds.cpp", "-o"]).arg(&object);
    assert!(compiler.status().unwrap().success());
    println!("cargo:rustc-link-arg={}", object.display());
    println!("cargo:rustc-link-arg=-lstdc++");
}
