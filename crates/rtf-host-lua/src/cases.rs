//! The functions of the host for cases, skipping, and parameters.

use mlua::{Lua, LuaString, Table};
use rtf_host::CaseEnd;
use rtf_model::Parameter;
use rtf_model::protocol::Plugin;

use crate::arguments::location;
use crate::session_function::add;

/// Adds `case_begin`, `case_end`, `plan_cases` and `skip` to the host's functions.
pub(crate) fn add_functions(lua: &Lua, host: &Table) -> mlua::Result<()> {
    type Start = (LuaString, Vec<Vec<LuaString>>, Option<LuaString>, Option<u32>);
    add(lua, host, "case_begin", |session, (name, parameters, file, line): Start| {
        let parameters = parameters.iter().filter_map(|pair| parameter(pair)).collect();
        let location = location(file.as_ref(), line);
        Ok(session.begin_case(name.to_string_lossy(), parameters, location))
    })?;
    add(lua, host, "case_end", |session, is_done: bool| {
        session.end_case(if is_done { CaseEnd::Done } else { CaseEnd::Stopped });
        Ok(())
    })?;
    add(lua, host, "plan_cases", |session, names: Vec<LuaString>| {
        session.plan_cases(names.iter().map(LuaString::to_string_lossy).collect());
        Ok(())
    })?;
    add(lua, host, "skip", |session, reason: LuaString| {
        session.skip(&reason.to_string_lossy());
        Ok(())
    })
}

fn parameter(pair: &[LuaString]) -> Option<Parameter> {
    let [name, value] = pair else { return None };
    Some(Parameter { name: name.to_string_lossy(), value: value.to_string_lossy() })
}

/// The test's values of a matrix, each as a pair.
pub(crate) fn parameters(lua: &Lua, plugin: &Plugin) -> mlua::Result<Table> {
    let pairs = plugin.parameters.iter().map(|own| [own.name.as_str(), own.value.as_str()]);
    lua.create_sequence_from(pairs)
}
