//! The declarations of a plug-in and of a `<hook>`, before any name is resolved.

use std::time::Duration;

use rtf_model::Trigger;

use super::Spanned;

/// A reference to a plug-in.
#[derive(Clone, Debug)]
pub struct DeclaredPlugin {
    /// The plug-in's name.
    pub name: Spanned<String>,
    /// The plug-in's type.
    pub plugin_type: Option<Spanned<String>>,
    /// The parameter string.
    pub param: String,
}

#[derive(Clone, Debug)]
pub struct DeclaredHook {
    pub name: Option<Spanned<String>>,
    /// Its triggers without duplicates; empty if all are unknown, which was reported.
    pub on: Vec<Trigger>,
    /// The plug-in or command.
    pub body: HookKind,
    /// Environment variables in addition to the suite's.
    pub env: Vec<(String, String)>,
    /// The limit.
    pub timeout: Option<Duration>,
}

#[derive(Clone, Debug)]
pub enum HookKind {
    /// A test plug-in.
    Plugin(DeclaredPlugin),
    /// A program and its arguments; empty if they are invalid, which was reported.
    Command(Spanned<Vec<String>>),
}
