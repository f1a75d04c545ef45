//! The inputs and options of planning.

use std::path::{Path, PathBuf};

use jiff::civil::Date;

use super::RunnerEnvironment;
use crate::config::ConfigRequest;

/// A path that the user gave.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InputPath {
    /// A suite, a plug-in, or a directory of either, depending on the path.
    Any(PathBuf),
    /// A plug-in, by its path, or by its name as in a suite.
    Plugin(PathBuf),
    /// The plug-ins of a directory.
    Plugins(PathBuf),
    Suite(PathBuf),
    /// The suites of a directory.
    Suites(PathBuf),
}

impl InputPath {
    /// Returns the path as the user gave it.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Any(path)
            | Self::Plugin(path)
            | Self::Plugins(path)
            | Self::Suite(path)
            | Self::Suites(path) => path,
        }
    }
}

/// The rules by which names are resolved and options apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compatibility {
    /// A suite's names refer to its directory, which is the working directory of
    /// its processes.
    #[default]
    Native,
    /// The rules of robot-testing-framework 2.x. A suite's names refer to the
    /// current directory, which is the working directory of all processes, and
    /// then to the suite's. Plug-ins run before suites. Parameters, environment
    /// and repetitions apply to named plug-ins, not to those of directories. No
    /// `rtf.toml` is read.
    Predecessor,
}

/// The tests of other frameworks whose cases are listed before the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CaseListing {
    #[default]
    All,
    /// Those from whose cases some are selected, and those whose list also checks a program
    /// or compiles it. The others announce their cases when they run.
    IfNeeded,
}

#[derive(Clone, Debug)]
pub struct Options {
    /// Whether subdirectories of input directories are searched.
    pub recursive: bool,
    /// The parameter string of plug-ins that are given directly.
    pub param: String,
    /// The environment string of plug-ins that are given directly.
    pub environment: String,
    /// The number of repetitions of plug-ins that are given directly; 0 means 1.
    pub repetitions: u32,
    pub compatibility: Compatibility,
    pub runner: RunnerEnvironment,
    pub config_request: ConfigRequest,
    pub case_listing: CaseListing,
    /// The local day on which the run starts, which known failures are compared with.
    pub today: Date,
}

impl Options {
    /// Creates options without parameters and with one repetition, for a run that starts on
    /// this local day.
    #[must_use]
    pub fn new(runner: RunnerEnvironment, today: Date) -> Self {
        Self {
            recursive: false,
            param: String::new(),
            environment: String::new(),
            repetitions: 1,
            compatibility: Compatibility::default(),
            runner,
            config_request: ConfigRequest::default(),
            case_listing: CaseListing::default(),
            today,
        }
    }

    /// Checks whether parameters, environment and repetitions apply to a plug-in
    /// that is given directly: by name, or as a file of a directory.
    pub(super) fn apply_to_plugin(&self, from_dir: bool) -> bool {
        self.compatibility == Compatibility::Native || !from_dir
    }
}
