//! Calls the functions in a loaded plug-in's table.
#![expect(unsafe_code, reason = "calling foreign code")]

use std::ffi::{CString, NulError, c_char, c_int, c_void};
use std::path::Path;
use std::sync::Once;

use rtf_host::{HostPlugin, LoadError, PluginKind, Session, Step, StepEnd, TestNotification};
use rtf_model::protocol::{
    Initialized, PROTOCOL_VERSION, Plugin, StackSupport, Subscription, TestAttempt,
};

use crate::abi::{RTF_DONE, RTF_REFUSED, RTF_STOPPED, rtf_plugin_table, rtf_test, rtf_text};
use crate::host_table;
use crate::library::{self, Lookup, PluginTable};

/// The native host with at most one plug-in.
#[derive(Debug)]
pub(crate) struct NativeHost {
    session: Session,
    loaded: Option<LoadedPlugin>,
}

#[derive(Debug)]
struct LoadedPlugin {
    table: &'static rtf_plugin_table,
    this: *mut c_void,
    args: Vec<*mut c_char>,
}

impl NativeHost {
    pub(crate) fn new(session: Session) -> Self {
        Self { session, loaded: None }
    }
}

/// Nearly every plug-in needs it, and loading it takes longer than everything else. It is
/// loaded with local symbols, so that other plug-ins do not notice it.
const CPP_RUNTIME: &str = "libstdc++.so.6";

/// Prepares a fork server.
pub(crate) fn prepare() {
    library::preload(CPP_RUNTIME, Lookup::Now);
}

impl HostPlugin for NativeHost {
    fn describe(&self) -> Initialized {
        let host = concat!("native ", env!("CARGO_PKG_VERSION")).to_owned();
        let stack = StackSupport::None;
        Initialized {
            protocol: PROTOCOL_VERSION,
            host,
            stack,
            supports_shared: true,
            selects_cases: true,
            runs_episodes: true,
        }
    }

    fn idle(&mut self) {
        static PRELOADED: Once = Once::new();
        // Forks inherit it from their server.
        PRELOADED.call_once(|| library::preload(CPP_RUNTIME, Lookup::Lazy));
    }

    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError> {
        let failed = |message: String| LoadError { message, location: None };
        let table =
            PluginTable::load(Path::new(&plugin.file)).and_then(|table| table.require(kind));
        let table = table.map_err(|error| failed(format!("`{}` {error}", plugin.file)))?.0;
        let args = arguments(plugin)
            .map_err(|_| failed("an argument holds a zero byte, which C cannot".to_owned()))?;
        let host = host_table::for_plugin(&self.session, plugin);
        // SAFETY: the table was examined; the host's table is never freed.
        let this = table.create.map_or(std::ptr::null_mut(), |create| unsafe { create(host) });
        if this.is_null() {
            return Err(failed(format!("`{}` could not be created", plugin.file)));
        }
        self.loaded = Some(LoadedPlugin { table, this, args });
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        self.loaded.as_mut().map_or(StepEnd::Stopped, |loaded| loaded.step(step))
    }

    fn subscriptions(&self) -> Vec<Subscription> {
        let Some(LoadedPlugin { table, .. }) = &self.loaded else { return Vec::new() };
        let started = table.test_started.map(|_| Subscription::TestStarted);
        let finished = table.test_finished.map(|_| Subscription::TestFinished);
        started.into_iter().chain(finished).collect()
    }

    fn notify(&mut self, notification: TestNotification<'_>) -> StepEnd {
        self.loaded.as_mut().map_or(StepEnd::Stopped, |loaded| loaded.notify(notification))
    }

    fn unload(&mut self) -> StepEnd {
        if let Some(loaded) = self.loaded.take()
            && let Some(destroy) = loaded.table.destroy
        {
            // SAFETY: `this` is what `create` made, and is used no more.
            unsafe { destroy(loaded.this) };
        }
        StepEnd::Done
    }
}

impl LoadedPlugin {
    fn step(&mut self, step: Step) -> StepEnd {
        let code = if step == Step::Setup {
            let count = c_int::try_from(self.args.len() - 1).unwrap_or(c_int::MAX);
            let args = self.args.as_mut_ptr();
            // SAFETY: `this` is what `create` made; `args` ends with a null.
            self.table.setup.map(|setup| unsafe { setup(self.this, count, args) })
        } else {
            let function = match step {
                Step::Setup | Step::Run => self.table.run,
                Step::Check => self.table.check,
                Step::TearDown => self.table.tear_down,
            };
            // SAFETY: `this` is what `create` made.
            function.map(|function| unsafe { function(self.this) })
        };
        end_of(code.unwrap_or(RTF_DONE))
    }

    fn notify(&mut self, notification: TestNotification<'_>) -> StepEnd {
        let (function, test, verdict, reason) = match notification {
            TestNotification::Started(starts) => (self.table.test_started, &starts.test, "", ""),
            // Never subscribed to.
            TestNotification::Ended(_) => return StepEnd::Done,
            TestNotification::Finished(ends) => {
                let reason = ends.reason.as_deref().unwrap_or_default();
                (self.table.test_finished, &ends.test, ends.verdict.as_str(), reason)
            }
        };
        let test = test_of(test, verdict, reason);
        // SAFETY: `this` is what `create` made; `test` lives until the call returns.
        let code = function.map(|function| unsafe { function(self.this, &raw const test) });
        end_of(code.unwrap_or(RTF_DONE))
    }
}

fn end_of(code: i32) -> StepEnd {
    match code {
        RTF_DONE => StepEnd::Done,
        RTF_REFUSED => StepEnd::Refused,
        RTF_STOPPED => StepEnd::Stopped,
        other => StepEnd::Broken(format!("the plug-in returned unknown status {other}"), None),
    }
}

fn test_of(test: &TestAttempt, verdict: &str, reason: &str) -> rtf_test {
    let text = |text: &str| rtf_text { data: text.as_ptr().cast(), length: text.len() };
    rtf_test {
        size: size_of::<rtf_test>(),
        id: test.id.0,
        repetition: test.repetition,
        attempt: test.attempt,
        reserved: 0,
        name: text(&test.name),
        verdict: text(verdict),
        reason: text(reason),
    }
}

/// The arguments as `main` gets them: the name, the arguments, a null. They are never
/// freed, because the plug-in may keep pointers to them.
fn arguments(plugin: &Plugin) -> Result<Vec<*mut c_char>, NulError> {
    let texts = std::iter::once(&plugin.name).chain(&plugin.args);
    let texts: Vec<CString> =
        texts.map(|text| CString::new(text.as_str())).collect::<Result<_, _>>()?;
    let pointers = texts.into_iter().map(CString::into_raw);
    Ok(pointers.chain([std::ptr::null_mut()]).collect())
}
