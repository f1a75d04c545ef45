//! Input paths + options → [`Plan`].
//!
//! Responsible for finding every suite, plug-in, host and program, for unique
//! names, and for reporting *all* problems at once. A [`PlanDraft`] lists the
//! plug-ins that their hosts have to check, and becomes a [`PlanOutcome`] with the
//! hosts' answers. A valid plan can fail only because of the outside world, not
//! because of its input files.

mod added_fixture;
mod bench_files;
mod case_narrowing;
mod case_patterns;
mod case_selection;
mod checks;
mod clock;
mod context;
pub(crate) mod defaults;
mod dependencies;
mod draft;
mod envelopes;
mod faults;
mod fixture;
mod fixture_values;
mod framework_kind;
mod framework_search;
mod framework_tests;
mod frameworks;
mod hook;
mod host_kind;
mod hosts;
mod input_file;
mod inputs;
mod installed;
mod isolation;
mod known_failure;
mod matrix;
pub mod matrix_file;
mod middleware;
mod monitors;
mod named_tests;
mod names;
mod of_tests;
mod options;
mod own_processes;
mod plugin_planner;
mod plugin_search;
mod process_types;
mod program;
mod quarantines;
mod runner_environment;
mod sdk;
mod search_scope;
mod signals;
mod suite;
mod test_planner;
mod types;
mod unix;
mod use_site;

pub use case_selection::{CaseSelection, CaseSelectionOrigin};
pub use checks::{CheckAnswer, CheckGroup, CheckReport};
pub use draft::{PlanDraft, PlanOutcome, draft};
pub use installed::{
    LocatedHost, ada_dir, ament_dir, cmake_dir, find_in_path, installed_hosts, shipped_fixtures_dir,
};
pub use options::{CaseListing, Compatibility, InputPath, Options};
pub use process_types::*;
pub use runner_environment::RunnerEnvironment;
pub use types::*;
