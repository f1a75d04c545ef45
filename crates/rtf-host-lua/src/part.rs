//! The parts of the SDK that are written in Lua: compiled once in a process, and,
//! where hosts are forked, once for all of them.

use std::sync::OnceLock;

use mlua::chunk::ChunkMode;
use mlua::{FromLuaMulti, IntoLuaMulti, Lua};

/// The name under which `guard.lua` knows the SDK's own code.
const CHUNK: &str = "=rtf";

/// A file of `sdk/lua/src`, or a line.
pub(crate) struct Part {
    source: &'static str,
    compiled: OnceLock<Vec<u8>>,
}

impl Part {
    pub(crate) const fn new(source: &'static str) -> Self {
        Self { source, compiled: OnceLock::new() }
    }

    /// Runs it in a state; what it returns.
    pub(crate) fn run<R: FromLuaMulti>(
        &self,
        lua: &Lua,
        args: impl IntoLuaMulti,
    ) -> mlua::Result<R> {
        if let Some(code) = self.compiled.get() {
            return lua.load(code.as_slice()).set_mode(ChunkMode::Binary).call(args);
        }
        let function = lua.load(self.source).set_name(CHUNK).into_function()?;
        // With the numbers of its lines: `guard.lua` tells where an error is from.
        self.compiled.get_or_init(|| function.dump(false));
        function.call(args)
    }
}
