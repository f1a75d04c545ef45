//! Lua code of the SDK, compiled once per process (a fork server compiles it for all forks).

use std::sync::OnceLock;

use mlua::chunk::ChunkMode;
use mlua::{FromLuaMulti, IntoLuaMulti, Lua};

/// The name by which `guard.lua` recognizes the SDK's code.
const NAME: &str = "=rtf";

/// A file of `sdk/lua/src`, or a line.
pub(crate) struct SdkChunk {
    source: &'static str,
    compiled: OnceLock<Vec<u8>>,
}

impl SdkChunk {
    pub(crate) const fn new(source: &'static str) -> Self {
        Self { source, compiled: OnceLock::new() }
    }

    /// Runs it in a state and returns its results.
    pub(crate) fn run<R: FromLuaMulti>(
        &self,
        lua: &Lua,
        args: impl IntoLuaMulti,
    ) -> mlua::Result<R> {
        if let Some(code) = self.compiled.get() {
            return lua.load(code.as_slice()).set_mode(ChunkMode::Binary).call(args);
        }
        let function = lua.load(self.source).set_name(NAME).into_function()?;
        // Keeps the line numbers, which `guard.lua` needs.
        self.compiled.get_or_init(|| function.dump(false));
        function.call(args)
    }
}
