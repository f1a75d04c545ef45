//! What is there for any suite, before one is written: hosts, and the fixture
//! managers that come with rtf.

use std::path::PathBuf;

use rtf_model::Diagnostic;

use super::hosts::HOSTS;
use super::program::in_path;
use super::scope::Scope;
use super::{HostPlan, Surroundings, plugin};

/// How the host of a type would be started, or why there is none.
pub type HostThere = Result<HostPlan, Box<Diagnostic>>;

/// All hosts, by their types' names.
#[must_use]
pub fn hosts_there(surroundings: &Surroundings) -> Vec<(&'static str, HostThere)> {
    let scope = scope(surroundings);
    HOSTS.iter().map(|kind| (kind.name, kind.locate(&scope))).collect()
}

/// The folder of the fixture managers that come with rtf.
#[must_use]
pub fn fixtures_there(surroundings: &Surroundings) -> Option<PathBuf> {
    plugin::shipped_folder(&scope(surroundings))
}

/// The program of this name in the user's `PATH`.
#[must_use]
pub fn program_there(name: &str, surroundings: &Surroundings) -> Option<PathBuf> {
    in_path(name, &scope(surroundings))
}

/// What a suite in the current folder without variables of its own would find.
fn scope(surroundings: &Surroundings) -> Scope<'_> {
    let folder = &surroundings.current_folder;
    Scope { surroundings, folder, beside: None, suite: &[], own: &[] }
}
