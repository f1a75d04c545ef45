//! Loads a plug-in into a separate Lua state and calls its functions.

use std::path::Path;

use mlua::{Function, IntoLua, Lua, MultiValue, Table, Value};
use rtf_host::{
    HostPlugin, LoadError, PluginKind, Reaction, Session, Step, StepEnd, TestNotification,
    flush_output,
};
use rtf_model::Location;
use rtf_model::protocol::{
    Initialized, PROTOCOL_VERSION, Plugin, StackSupport, Subscription, TestAttempt,
};

use crate::source::{CompiledFiles, Style};
use crate::state::PluginState;
use crate::{interruption, sdk, source};

/// The functions of a fixture; it has at least one of them.
const FIXTURE: [&str; 5] = ["setup", "check", "testStarted", "testFinished", "tearDown"];

/// The Lua host with at most one plug-in.
pub(crate) struct LuaHost {
    session: Session,
    /// A state that was prepared before there was a plug-in for it.
    ready: Option<PluginState>,
    files: CompiledFiles,
    loaded: Option<LoadedScript>,
}

struct LoadedScript {
    lua: Lua,
    /// `guard.call`: calls a function and returns how it ended.
    call: Function,
    table: Table,
    style: Style,
    args: Vec<String>,
    param: String,
}

impl LuaHost {
    pub(crate) fn new(session: Session, ready: Option<PluginState>) -> Self {
        Self { session, ready, files: CompiledFiles::default(), loaded: None }
    }
}

impl HostPlugin for LuaHost {
    fn describe(&self) -> Initialized {
        let host = format!("lua {}", interruption::lua_release());
        let stack = StackSupport::Message;
        Initialized {
            protocol: PROTOCOL_VERSION,
            host,
            stack,
            supports_shared: true,
            selects_cases: true,
            runs_episodes: false,
        }
    }

    fn idle(&mut self) {
        if self.ready.is_none() {
            // `load` reports an error.
            self.ready = PluginState::new().ok();
        }
    }

    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError> {
        let state = self.ready.take().map_or_else(PluginState::new, Ok);
        let state = state.and_then(|state| state.assign(&self.session, plugin));
        let (lua, call) = state.map_err(unexpected)?;
        interruption::set_state(&lua);
        let compiled = match plugin.is_last {
            true => source::compile(&lua, Path::new(&plugin.file), &plugin.file)?,
            false => self.files.compile(&lua, &plugin.file)?,
        };
        match ended(call.call((compiled.chunk,))) {
            StepEnd::Done | StepEnd::Refused => {}
            StepEnd::Stopped => {
                let message = format!("`{}` stopped while it was loaded", plugin.file);
                return Err(LoadError { message, location: None });
            }
            StepEnd::Broken(message, location) => return Err(LoadError { message, location }),
        }
        let table = table(&lua, kind, &plugin.file)?;
        if compiled.style == Style::Predecessor && table.metatable().is_none() {
            // The plug-in has replaced the table.
            sdk::inherit_predecessor(&lua, &table).map_err(unexpected)?;
        }
        let (style, args, param) = (compiled.style, plugin.args.clone(), plugin.param.clone());
        self.loaded = Some(LoadedScript { lua, call, table, style, args, param });
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        let Some(loaded) = &self.loaded else { return StepEnd::Stopped };
        let end =
            loaded.step(step).unwrap_or_else(|error| StepEnd::Broken(error.to_string(), None));
        // The output belongs before the answer.
        flush_output();
        end
    }

    fn subscriptions(&self) -> Vec<Subscription> {
        let has = |name: &str| {
            let table = self.loaded.as_ref().map(|loaded| &loaded.table);
            table.is_some_and(|table| matches!(table.get(name), Ok(Value::Function(_))))
        };
        let started = has("testStarted").then_some(Subscription::TestStarted);
        let finished = has("testFinished").then_some(Subscription::TestFinished);
        started.into_iter().chain(finished).collect()
    }

    fn notify(&mut self, notification: TestNotification<'_>) -> StepEnd {
        let Some(loaded) = &self.loaded else { return StepEnd::Stopped };
        let end = loaded
            .notify(notification)
            .unwrap_or_else(|error| StepEnd::Broken(error.to_string(), None));
        flush_output();
        end
    }

    fn unload(&mut self) -> StepEnd {
        interruption::clear_state();
        self.loaded = None;
        StepEnd::Done
    }

    fn stack_dumper(&self) -> Option<Reaction> {
        Some(Box::new(|_| interruption::request_stack()))
    }

    fn stopper(&self) -> Option<Reaction> {
        Some(Box::new(interruption::stop_later))
    }
}

impl LoadedScript {
    fn step(&self, step: Step) -> mlua::Result<StepEnd> {
        let function: Value = self.table.get(step.name())?;
        if function.is_nil() {
            return Ok(StepEnd::Done);
        }
        let mut args = MultiValue::from_iter([function]);
        if step == Step::Setup {
            args.push_back(match self.style {
                Style::Present => self.args.clone().into_lua(&self.lua)?,
                Style::Predecessor => self.param.as_str().into_lua(&self.lua)?,
            });
        }
        let result = self.call.call(args);
        if step == Step::Setup && self.style == Style::Predecessor && returned_nothing(&result) {
            return Ok(StepEnd::Broken(
                "setup returned nothing, it has to return true".into(),
                None,
            ));
        }
        let end = ended(result);
        // Only `setup` and `check` can return false.
        let can_refuse = matches!(step, Step::Setup | Step::Check);
        Ok(if end == StepEnd::Refused && !can_refuse { StepEnd::Done } else { end })
    }

    /// Calls `testStarted(test)` or `testFinished(test, verdict, reason)`.
    fn notify(&self, notification: TestNotification<'_>) -> mlua::Result<StepEnd> {
        let function: Value = self.table.get(notification.name())?;
        if function.is_nil() {
            return Ok(StepEnd::Done);
        }
        let mut args = MultiValue::from_iter([function]);
        match notification {
            TestNotification::Started(starts) => args.push_back(self.test(&starts.test)?),
            // Never subscribed to.
            TestNotification::Ended(_) => return Ok(StepEnd::Done),
            TestNotification::Finished(ends) => {
                args.push_back(self.test(&ends.test)?);
                args.push_back(ends.verdict.as_str().into_lua(&self.lua)?);
                args.push_back(ends.reason.as_deref().unwrap_or_default().into_lua(&self.lua)?);
            }
        }
        Ok(ended(self.call.call(args)))
    }

    fn test(&self, test: &TestAttempt) -> mlua::Result<Value> {
        let table = self.lua.create_table()?;
        table.set("id", test.id.0)?;
        table.set("name", test.name.as_str())?;
        table.set("repetition", test.repetition)?;
        table.set("attempt", test.attempt)?;
        Ok(Value::Table(table))
    }
}

/// Finds the plug-in's table and checks that it has a function to call.
fn table(lua: &Lua, kind: PluginKind, file: &str) -> Result<Table, LoadError> {
    let failed = |message: String| LoadError { message, location: None };
    let global = |name: &str| lua.globals().get::<Value>(name).map_err(unexpected);
    let (name, other, functions) = match kind {
        PluginKind::Test => ("TestCase", "FixtureManager", &["run"][..]),
        PluginKind::Fixture => ("FixtureManager", "TestCase", &FIXTURE[..]),
    };
    let value = global(name)?;
    let Some(table) = value.as_table() else {
        let type_name = value.type_name();
        let message = format!("`{name}` of `{file}` is no table of functions, but: {type_name}");
        return Err(failed(message));
    };
    for function in functions {
        if !table.get::<Value>(*function).map_err(unexpected)?.is_nil() {
            return Ok(table.clone());
        }
    }
    let filled = global(other)?.as_table().is_some_and(|table| !table.is_empty());
    let hint = if filled { format!("; it has a `{other}`") } else { String::new() };
    Err(failed(format!("`{file}` defines no function `{name}.{}`{hint}", functions[0])))
}

/// The results of `guard.call`: `done, value`, `stopped`, or
/// `broken, text, file, line`.
type Called = mlua::Result<(String, Value, Value, Value)>;

/// For the predecessor, this was a failure.
fn returned_nothing(called: &Called) -> bool {
    matches!(called, Ok((word, Value::Nil, ..)) if word == "done")
}

fn ended(result: Called) -> StepEnd {
    let (word, first, file, line) = match result {
        Ok(result) => result,
        Err(error) => return StepEnd::Broken(error.to_string(), None),
    };
    match word.as_str() {
        "done" if first == Value::Boolean(false) => StepEnd::Refused,
        "done" => StepEnd::Done,
        "stopped" => StepEnd::Stopped,
        _ => {
            let line = line.as_u32().unwrap_or(0);
            let location = sdk::text_of(&file).map(|file| Location { file, line });
            StepEnd::Broken(sdk::text_of(&first).unwrap_or_default(), location)
        }
    }
}

/// An error of Lua itself (out of memory) while the host prepares a state.
fn unexpected(error: mlua::Error) -> LoadError {
    LoadError { message: error.to_string(), location: None }
}
