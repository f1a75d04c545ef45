//! The Lua host with real plug-ins, driven as the runner drives it.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first surprise")]

mod cases;
mod driver;
mod fixture_values;
mod fixtures;
mod loading;
mod messages;
mod stopping;
mod verdicts;
