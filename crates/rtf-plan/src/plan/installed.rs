//! The hosts and fixture managers that are installed, independent of a suite.

use std::path::PathBuf;

use rtf_model::Diagnostic;

use super::hosts::HOSTS;
use super::search_scope::SearchScope;
use super::{HostPlan, RunnerEnvironment, plugin_search, program};

/// The plan of a host, or the reason why it cannot be used.
pub type LocatedHost = Result<HostPlan, Box<Diagnostic>>;

/// Returns all hosts by the names of their types.
#[must_use]
pub fn installed_hosts(runner: &RunnerEnvironment) -> Vec<(&'static str, LocatedHost)> {
    let scope = SearchScope::of_runner(runner);
    HOSTS.iter().map(|kind| (kind.name, kind.locate(&scope))).collect()
}

/// Returns the directory of the fixture managers that come with `rtf`.
#[must_use]
pub fn shipped_fixtures_dir(runner: &RunnerEnvironment) -> Option<PathBuf> {
    plugin_search::shipped_dir(&SearchScope::of_runner(runner))
}

/// Returns the directory of the CMake packages `rtf` and `RobotTestingFramework`.
#[must_use]
pub fn cmake_dir(runner: &RunnerEnvironment) -> Option<PathBuf> {
    runner.shipped(&["lib/cmake", "share/cmake"], "sdk/cpp/cmake", "rtf/rtf-config.cmake")
}

/// Returns the directory of the Ada SDK's projects.
#[must_use]
pub fn ada_dir(runner: &RunnerEnvironment) -> Option<PathBuf> {
    runner.shipped(&["share/rtf/ada"], "sdk/ada", "robottestingframework.gpr")
}

/// Returns the directory with the package `ament_cmake_rtf`.
#[must_use]
pub fn ament_dir(runner: &RunnerEnvironment) -> Option<PathBuf> {
    runner.shipped(&["share/rtf/ament"], "packaging/ament", "ament_cmake_rtf/package.xml")
}

#[must_use]
pub fn find_in_path(name: &str, runner: &RunnerEnvironment) -> Option<PathBuf> {
    program::in_path(name, &SearchScope::of_runner(runner))
}
