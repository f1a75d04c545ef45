//! A Lua state with its libraries and the SDK, ready for a plug-in.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use mlua::{Function, Lua, Table};
use rtf_host::Session;
use rtf_model::protocol::Plugin;

use crate::sdk::{self, Installed};
use crate::search;

/// A state that no plug-in has seen. It may be made before a fork.
pub(crate) struct State {
    lua: Lua,
    sdk: Installed,
    process: u32,
}

impl State {
    /// Makes all that is the same for every plug-in.
    pub(crate) fn new() -> mlua::Result<Self> {
        // SAFETY: C modules are what robots' drivers come as; they are trusted as
        // much as any plug-in.
        #[expect(unsafe_code, reason = "plug-ins may load C modules")]
        let lua = unsafe { Lua::unsafe_new() };
        // Nothing of all this is garbage, nor is it looked for.
        lua.gc_stop();
        for table in ["TestCase", "FixtureManager"] {
            lua.globals().set(table, lua.create_table()?)?;
        }
        let sdk = sdk::install(&lua)?;
        sdk::lend_predecessor(&lua, &lua.globals().get("TestCase")?)?;
        Ok(Self { lua, sdk, process: std::process::id() })
    }

    /// Makes it a plug-in's; the function by which the plug-in is called.
    pub(crate) fn dedicate(
        self,
        session: &Session,
        plugin: &Plugin,
    ) -> mlua::Result<(Lua, Function)> {
        let Self { lua, sdk, process } = self;
        if process != std::process::id() {
            shuffle(&lua)?;
        }
        search::extend(&lua, Path::new(&plugin.file))?;
        sdk.dedicate(&lua, session, plugin)?;
        lua.gc_restart();
        Ok((lua, sdk.call))
    }
}

/// All copies of a state would get the same random numbers.
fn shuffle(lua: &Lua) -> mlua::Result<()> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let math: Table = lua.globals().get("math")?;
    let seed: Function = math.get("randomseed")?;
    seed.call((i64::from(now.subsec_nanos()), i64::from(std::process::id())))
}
