//! Values of fixtures: from Lua to JSON and back.

use mlua::serde::SerializeOptions;
use mlua::{Lua, LuaSerdeExt, LuaString, Table, Value as LuaValue};
use rtf_model::protocol::Plugin;
use serde_json::{Map, Number, Value};

use crate::session_function::add;

/// A table that contains itself has no end. The runner reads at most 127 levels.
const MAX_DEPTH: usize = 100;

/// Adds `provide` to the host's functions. It returns the problem, if there is one.
pub(crate) fn add_functions(lua: &Lua, host: &Table) -> mlua::Result<()> {
    add(lua, host, "provide", |session, (name, value): (LuaString, LuaValue)| {
        let name = name.to_string_lossy();
        Ok(match json(&value, 0) {
            Ok(value) => {
                session.provide(name, value);
                None
            }
            Err(problem) => Some(format!("the value of `{name}` {problem}")),
        })
    })
}

/// The values that the plug-in can read, each as a pair.
pub(crate) fn values(lua: &Lua, plugin: &Plugin) -> mlua::Result<Table> {
    let nil_for_null = SerializeOptions::new()
        .set_array_metatable(false)
        .serialize_none_to_null(false)
        .serialize_unit_to_null(false);
    let pairs = lua.create_table()?;
    for own in &plugin.fixture_values {
        let pair = lua.create_table()?;
        pair.push(own.name.as_str())?;
        pair.push(lua.to_value_with(&own.value, nil_for_null)?)?;
        pairs.push(pair)?;
    }
    Ok(pairs)
}

/// The JSON of a Lua value, or why it has none.
fn json(value: &LuaValue, depth: usize) -> Result<Value, String> {
    match value {
        LuaValue::Boolean(truth) => Ok((*truth).into()),
        LuaValue::Integer(number) => Ok((*number).into()),
        LuaValue::Number(number) => Number::from_f64(*number)
            .map(Value::Number)
            .ok_or_else(|| "is not a finite number".to_owned()),
        LuaValue::String(text) => Ok(text.to_string_lossy().into()),
        LuaValue::Table(_) if depth == MAX_DEPTH => {
            Err(format!("has more than {MAX_DEPTH} levels of tables"))
        }
        LuaValue::Table(table) if table.raw_len() > 0 => list(table, depth),
        LuaValue::Table(table) => object(table, depth),
        other => Err(format!("is or contains a {}", other.type_name())),
    }
}

fn list(table: &Table, depth: usize) -> Result<Value, String> {
    let length = table.raw_len();
    if table.pairs::<LuaValue, LuaValue>().count() != length {
        return Err("contains a table that is neither a list without holes nor has only strings \
                    as keys"
            .to_owned());
    }
    let entry = |index| {
        let entry = table.raw_get(index).map_err(|error| error.to_string())?;
        json(&entry, depth + 1)
    };
    (1..=length).map(entry).collect()
}

fn object(table: &Table, depth: usize) -> Result<Value, String> {
    let mut object = Map::new();
    for pair in table.pairs::<LuaValue, LuaValue>() {
        let (key, value) = pair.map_err(|error| error.to_string())?;
        let LuaValue::String(key) = key else {
            return Err(format!("contains a table with a {} as key", key.type_name()));
        };
        object.insert(key.to_string_lossy(), json(&value, depth + 1)?);
    }
    Ok(Value::Object(object))
}
