//! `rtf.toml`: settings of all suites below a directory, and the profiles (the
//! real robot, a simulator, CI) that override them.
//!
//! Responsible for finding the file, for parsing it with the position of each
//! value, and for overlaying its values on a [`crate::suite::DeclaredSuite`].
//! Settings of a whole run are only returned, as a [`RunConfig`]. `spec/config.md`
//! specifies the file; `docs/decisions/0015-precedence-of-settings.md` explains
//! the order of precedence.

mod effective;
mod file;
mod keys;
mod overlay;
mod param_reference;
mod profile_view;
mod quarantine;
mod run_config;
mod schema;
mod toml_reader;
mod toml_value;
mod unknown_profile;

pub use effective::{Setting, SettingsQuery, effective_settings};
pub use file::{ConfigFile, ConfigFiles};
pub use keys::REPORTS;
pub use param_reference::{describe_same_variable, is_name, variable};
pub use profile_view::{ConfigRequest, ProfileView};
pub use quarantine::Quarantine;
pub use run_config::{RunConfig, RunValue, input_dir};
pub use schema::json_schema;
pub use toml_reader::{Entry, Layer, ParsedConfig, parse};

pub(crate) use overlay::{DirectPluginConfig, direct_plugin_config, overlay_suite};
pub(crate) use param_reference::sample;
