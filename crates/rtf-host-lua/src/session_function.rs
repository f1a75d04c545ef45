//! Functions of the session for Lua.

use mlua::{IntoLuaMulti, Lua, Table};
use rtf_host::Session;

/// Adds a function of the session.
pub(crate) fn add<A, R>(
    lua: &Lua,
    host: &Table,
    name: &str,
    call: impl Fn(&Session, A) -> mlua::Result<R> + mlua::MaybeSend + 'static,
) -> mlua::Result<()>
where
    A: mlua::FromLuaMulti,
    R: IntoLuaMulti,
{
    let function = lua.create_function(move |lua, args| {
        let session = lua.app_data_ref::<Session>().map(|session| session.clone());
        call(&session.ok_or_else(|| mlua::Error::runtime("there is no runner"))?, args)
    })?;
    host.set(name, function)
}
