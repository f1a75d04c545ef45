//! Options of `rtf import`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Where tests are imported from.
#[derive(Debug, Subcommand)]
pub enum ImportVerb {
    /// Import the tests of a build directory of CMake
    Ctest {
        /// The build directory
        #[arg(value_name = "BUILD")]
        build: PathBuf,

        /// The configuration of a multi-configuration generator: `Release`
        #[arg(short = 'C', long, value_name = "NAME")]
        config: Option<String>,

        #[command(flatten)]
        output: ImportOutput,
    },
    /// Import the tests of all packages that `colcon build` has built
    Colcon {
        /// The workspace, which contains `build`
        #[arg(value_name = "WORKSPACE", default_value = ".")]
        workspace: PathBuf,

        #[command(flatten)]
        output: ImportOutput,
    },
}

/// The suite file.
#[derive(Debug, Args)]
pub struct ImportOutput {
    /// Output file
    #[arg(short, long, value_name = "FILE", default_value = "suite.xml")]
    pub output: PathBuf,

    /// Overwrite the output file
    #[arg(short, long)]
    pub force: bool,
}
