//! Faults that a test injects and removes.

use mlua::{Lua, LuaString, Table};
use rtf_host::{FaultRequest, Session};
use rtf_model::protocol::Plugin;

use crate::arguments::location;

/// `verb, name, file, line`
type FaultArgs = (String, LuaString, Option<LuaString>, Option<u32>);

/// Adds `fault` to the host's functions. It returns whether that is done.
pub(crate) fn add_functions(lua: &Lua, host: &Table) -> mlua::Result<()> {
    let fault = lua.create_function(|lua, (verb, name, file, line): FaultArgs| {
        let session = lua.app_data_ref::<Session>().map(|session| session.clone());
        let plugin = lua.app_data_ref::<Plugin>();
        let (Some(session), Some(plugin)) = (session, plugin) else {
            return Err(mlua::Error::runtime("there is no runner"));
        };
        let request = match verb.as_str() {
            "inject" => FaultRequest::Inject,
            _ => FaultRequest::Remove,
        };
        let place = location(file.as_ref(), line);
        Ok(session.fault(&plugin, request, &name.to_string_lossy(), place))
    })?;
    host.set("fault", fault)
}
