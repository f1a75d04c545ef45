//! A Lua state with its libraries and the SDK, for one plug-in.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use mlua::{Function, Lua, Table, ffi};
use rtf_host::Session;
use rtf_model::protocol::Plugin;

use crate::sdk::{self, InstalledSdk};
use crate::search_path;

/// A state that no plug-in has used. It may be prepared before a fork.
pub(crate) struct PluginState {
    lua: Lua,
    sdk: InstalledSdk,
    process: u32,
}

impl PluginState {
    /// Prepares everything that is the same for all plug-ins.
    pub(crate) fn new() -> mlua::Result<Self> {
        // SAFETY: robot drivers are C modules, as trusted as the plug-in itself.
        #[expect(unsafe_code, reason = "plug-ins may load C modules")]
        let lua = unsafe { Lua::unsafe_new() };
        // None of this is garbage.
        lua.gc_stop();
        for table in ["TestCase", "FixtureManager"] {
            lua.globals().set(table, lua.create_table()?)?;
        }
        let sdk = sdk::install(&lua)?;
        sdk::inherit_predecessor(&lua, &lua.globals().get("TestCase")?)?;
        Ok(Self { lua, sdk, process: std::process::id() })
    }

    /// Assigns the state to a plug-in. Returns the function that calls the plug-in.
    pub(crate) fn assign(
        self,
        session: &Session,
        plugin: &Plugin,
    ) -> mlua::Result<(Lua, Function)> {
        let Self { lua, sdk, process } = self;
        if process != std::process::id() {
            seed_random(&lua)?;
        }
        search_path::extend(&lua, Path::new(&plugin.file))?;
        sdk.assign(&lua, session, plugin)?;
        restart_collector(&lua)?;
        Ok((lua, sdk.call))
    }
}

/// Starts the garbage collector as it is after a collection, which would find nothing: it begins
/// when as much again is in use, Lua's default.
fn restart_collector(lua: &Lua) -> mlua::Result<()> {
    lua.gc_restart();
    let kib = i32::try_from(lua.used_memory() / 1024).unwrap_or(i32::MAX);
    // SAFETY: a step of a negative size does nothing but lower the collector's debt.
    #[expect(unsafe_code, reason = "mlua has no function for it")]
    unsafe {
        lua.exec_raw((), |state| {
            ffi::lua_gc(state, ffi::LUA_GCSTEP, -kib);
        })
    }
}

/// Forks inherit one state: without a new seed, all would get the same random numbers.
fn seed_random(lua: &Lua) -> mlua::Result<()> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let math: Table = lua.globals().get("math")?;
    let seed: Function = math.get("randomseed")?;
    seed.call((i64::from(now.subsec_nanos()), i64::from(std::process::id())))
}
