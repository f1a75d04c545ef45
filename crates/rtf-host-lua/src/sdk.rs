//! The table `rtf` for plug-ins: the Lua code in `sdk/lua` and the functions of the host
//! that it calls; and the tables of the predecessor.

use std::ffi::CStr;
use std::path::PathBuf;

use mlua::{Function, Lua, LuaString, Table, Value};
use rtf_host::Session;
use rtf_model::protocol::{MonitorDeclaration, Plugin};
use rtf_model::{Attachment, PictureCheck};

use crate::arguments::{
    MeasureArgs, MessageArgs, QuestionArgs, SampleArgs, Trajectory, duration, inquiry, location,
    measurement, message, sample,
};
use crate::cases;
use crate::chunk::SdkChunk;
use crate::clock::Clock;
use crate::faults;
use crate::fixture_values;
use crate::session_function::add;

/// The name in Lua's registry of the value that unwinds a step.
pub(crate) const STOP: &CStr = c"rtf.stop";

// A crash must not lose printed lines with the buffer.
static LINES: SdkChunk = SdkChunk::new("io.stdout:setvbuf('line')");
static TEXT: SdkChunk = SdkChunk::new(include_str!("../../../sdk/lua/src/text.lua"));
static NEAR: SdkChunk = SdkChunk::new(include_str!("../../../sdk/lua/src/near.lua"));
static GUARD: SdkChunk = SdkChunk::new(include_str!("../../../sdk/lua/src/guard.lua"));
static FAULT: SdkChunk = SdkChunk::new(include_str!("../../../sdk/lua/src/fault.lua"));
static RTF: SdkChunk = SdkChunk::new(include_str!("../../../sdk/lua/src/rtf.lua"));
static PREDECESSOR: SdkChunk = SdkChunk::new(include_str!("../../../sdk/lua/src/predecessor.lua"));

/// The SDK in a state that has no plug-in yet.
pub(crate) struct InstalledSdk {
    /// Calls a function of the plug-in and returns how it ended.
    pub(crate) call: Function,
    /// The host's functions, and the plug-in's name, parameters and values of fixtures.
    host: Table,
}

/// Installs the table `rtf`.
pub(crate) fn install(lua: &Lua) -> mlua::Result<InstalledSdk> {
    LINES.run::<()>(lua, ())?;
    let stop = stop_value(lua)?;
    let text: Table = TEXT.run(lua, ())?;
    let near: Table = NEAR.run(lua, &text)?;
    let guard: Table = GUARD.run(lua, (&text, &stop))?;
    let host = functions(lua)?;
    let fault: Function = FAULT.run(lua, (&host, &guard, &stop))?;
    let rtf: Table = RTF.run(lua, (&host, near, text, &guard, stop))?;
    rtf.set("fault", fault)?;
    lua.globals().set("rtf", &rtf)?;
    let predecessor: Table = PREDECESSOR.run(lua, &rtf)?;
    for name in ["robottestingframework", "RTF"] {
        lua.globals().set(name, &predecessor)?;
    }
    // For `local rtf = require("rtf")`.
    let package: Table = lua.globals().get("package")?;
    package.get::<Table>("loaded")?.set("rtf", rtf)?;
    Ok(InstalledSdk { call: guard.get("call")?, host })
}

impl InstalledSdk {
    /// Assigns the state to a plug-in and its session.
    pub(crate) fn assign(&self, lua: &Lua, session: &Session, plugin: &Plugin) -> mlua::Result<()> {
        lua.set_app_data(session.clone());
        lua.set_app_data(plugin.clone());
        self.host.set("plugin", about(lua, plugin)?)
    }
}

/// Makes the predecessor's functions available in a plug-in's table `TestCase`.
pub(crate) fn inherit_predecessor(lua: &Lua, table: &Table) -> mlua::Result<()> {
    let meta = lua.create_table()?;
    meta.set("__index", lua.globals().get::<Table>("robottestingframework")?)?;
    table.set_metatable(Some(meta))
}

/// The unique value that unwinds a step. Its text is for plug-ins that catch it.
fn stop_value(lua: &Lua) -> mlua::Result<Table> {
    let meta = lua.create_table()?;
    meta.set("__name", "rtf.stop")?;
    meta.set("__tostring", lua.create_function(|_, ()| Ok("this step of the plug-in has ended"))?)?;
    let stop = lua.create_table()?;
    stop.set_metatable(Some(meta))?;
    lua.set_named_registry_value(&STOP.to_string_lossy(), &stop)?;
    Ok(stop)
}

fn about(lua: &Lua, plugin: &Plugin) -> mlua::Result<Table> {
    let about = lua.create_table()?;
    about.set("name", plugin.name.as_str())?;
    about.set("param", plugin.param.as_str())?;
    about.set("environment", plugin.environment.as_str())?;
    about.set("repetition", plugin.repetition)?;
    about.set("parameters", cases::parameters(lua, plugin)?)?;
    about.set("fixture_values", fixture_values::values(lua, plugin)?)?;
    Ok(about)
}

fn functions(lua: &Lua) -> mlua::Result<Table> {
    let host = lua.create_table()?;
    let clock = Clock::new();
    let is_simulated = clock.is_simulated();
    host.set("seconds", lua.create_function(move |_, ()| Ok(clock.seconds()))?)?;
    host.set("is_simulated", lua.create_function(move |_, ()| Ok(is_simulated))?)?;
    add(lua, &host, "message", |session, args: MessageArgs| {
        session.message(message(args)?);
        Ok(())
    })?;
    add(
        lua,
        &host,
        "measure",
        |session, args: MeasureArgs| Ok(session.measure(measurement(args))),
    )?;
    add(lua, &host, "sample", |session, args: SampleArgs| Ok(sample(session, args)))?;
    add(lua, &host, "trajectory", |session, checked: Trajectory| {
        session.check_trajectory(checked.0);
        Ok(())
    })?;
    add(lua, &host, "picture", |session, check: PictureArgs| Ok(check_picture(session, check)))?;
    add(lua, &host, "monitor", |session, declared: MonitorArgs| Ok(monitor(session, &declared)))?;
    add(lua, &host, "attach", |session, file: AttachArgs| Ok(attach(session, file)))?;
    add(lua, &host, "collapsed", |session, reason: LuaString| {
        session.collapsed(&reason.to_string_lossy());
        Ok(())
    })?;
    add(lua, &host, "wait", |session, seconds: f64| Ok(session.wait(duration(seconds))))?;
    add(lua, &host, "ask", |session, args: QuestionArgs| Ok(session.ask(inquiry(args))))?;
    faults::add_functions(lua, &host)?;
    cases::add_functions(lua, &host)?;
    fixture_values::add_functions(lua, &host)?;
    add(lua, &host, "interrupted", |session, (): ()| Ok(session.interrupted()))?;
    Ok(host)
}

/// The absolute path of an existing file.
fn existing(path: &LuaString) -> Result<PathBuf, String> {
    let path = path.to_string_lossy();
    let full = std::path::absolute(&path).unwrap_or_else(|_| PathBuf::from(&path));
    let is_there = full.exists();
    is_there.then(|| full.clone()).ok_or(format!("there is no file `{}` to attach", full.display()))
}

/// Sends a file with its absolute path; returns the problem, if there is one.
fn send_file(
    path: &LuaString,
    send: impl FnOnce(PathBuf) -> std::io::Result<()>,
) -> Option<String> {
    let full = match existing(path) {
        Ok(full) => full,
        Err(problem) => return Some(problem),
    };
    let sent = send(full.clone());
    sent.err().map(|error| format!("`{}` cannot be attached: {error}", full.display()))
}

/// `path, name, media_type`
type AttachArgs = (LuaString, Option<LuaString>, Option<LuaString>);

/// Attaches a file; returns the problem, if there is one.
fn attach(session: &Session, (path, name, media_type): AttachArgs) -> Option<String> {
    let text = |text: LuaString| text.to_string_lossy();
    send_file(&path, |full| {
        let own_name = || full.file_name().map(|name| name.to_string_lossy().into_owned());
        session.attach(Attachment {
            name: name.map(text).or_else(own_name).unwrap_or_default(),
            path: full.to_string_lossy().into_owned(),
            media_type: media_type.map(text).unwrap_or_default(),
            ..Attachment::default()
        })
    })
}

/// `name, picture, reference, tolerance, file, line`
type PictureArgs = (LuaString, LuaString, LuaString, f64, Option<LuaString>, Option<u32>);

/// Attaches a picture that is compared; returns the problem, if there is one.
fn check_picture(
    session: &Session,
    (name, picture, reference, tolerance, file, line): PictureArgs,
) -> Option<String> {
    let reference = reference.to_string_lossy();
    let check = PictureCheck { reference, tolerance, location: location(file.as_ref(), line) };
    send_file(&picture, |full| {
        let path = full.to_string_lossy().into_owned();
        session.check_picture((name.to_string_lossy(), path), check)
    })
}

/// `formula, name, severity, file, line`
type MonitorArgs = (LuaString, LuaString, LuaString, Option<LuaString>, Option<u32>);

/// Declares a monitor; returns why it cannot.
fn monitor(
    session: &Session,
    (formula, name, severity, file, line): &MonitorArgs,
) -> Option<String> {
    let texts = [formula, name, severity].map(LuaString::to_string_lossy);
    let place = location(file.as_ref(), *line);
    match MonitorDeclaration::new(&texts[0], &texts[1], &texts[2], place) {
        Ok(declared) => {
            session.monitor(declared);
            None
        }
        Err(problem) => Some(problem),
    }
}

/// A Lua string, even if it is not UTF-8; `None` for any other value.
pub(crate) fn text_of(value: &Value) -> Option<String> {
    value.as_string().map(LuaString::to_string_lossy)
}
