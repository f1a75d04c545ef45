//! Options of `rtf new` and `rtf init`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Options of `rtf new`.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// What to write
    #[arg(value_name = "KIND")]
    pub kind: ProjectKind,

    /// The name: it starts with a letter and contains letters, digits, `-` and `_`
    #[arg(value_name = "NAME")]
    pub name: String,

    /// The language
    #[arg(short, long, value_name = "LANGUAGE")]
    pub language: Language,

    /// The directory of the project [default: NAME]
    #[arg(short, long, value_name = "DIR")]
    pub directory: Option<PathBuf>,
}

/// Options of `rtf init`.
#[derive(Debug, Args)]
pub struct InitArgs {
    /// The directory of the project
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub directory: PathBuf,
}

/// The content of a new project.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProjectKind {
    /// A suite with a program as its fixture, and a test
    Suite,
    /// A test
    Test,
    /// A fixture, with a suite and a test that use it
    Fixture,
}

/// The language of a new project.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// C++, built with CMake
    Cpp,
    /// Python
    Python,
    /// Lua
    Lua,
    /// Ruby
    Ruby,
    /// Ada, built with gprbuild
    Ada,
}
