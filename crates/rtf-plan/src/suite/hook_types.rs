//! The declarations of a plug-in and of a `<hook>`, before any name is resolved.

use std::time::Duration;

use rtf_model::Trigger;

use super::Spanned;

#[derive(Clone, Debug)]
pub struct DeclaredPlugin {
    pub name: Spanned<String>,
    pub plugin_type: Option<Spanned<String>>,
    pub param: String,
}

#[derive(Clone, Debug)]
pub struct DeclaredHook {
    pub name: Option<Spanned<String>>,
    /// Its triggers without duplicates; empty if all are unknown, which was reported.
    pub on: Vec<Trigger>,
    pub body: HookKind,
    /// Environment variables in addition to the suite's.
    pub env: Vec<(String, String)>,
    pub timeout: Option<Duration>,
}

#[derive(Clone, Debug)]
pub enum HookKind {
    /// A test plug-in.
    Plugin(DeclaredPlugin),
    /// A program and its arguments; empty if they are invalid, which was reported.
    Command(Spanned<Vec<String>>),
}
