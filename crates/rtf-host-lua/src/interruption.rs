//! Interrupts Lua code that runs: to send its stack, or to stop it.
//!
//! Another thread must not touch a Lua state. As in Lua's own interpreter on Ctrl-C, a
//! signal handler *on the thread that runs Lua* sets a hook, and Lua calls the hook before
//! its next instruction. This does not work for code that hangs inside a C function or in
//! a coroutine that was created before: the runner kills such a test.
#![expect(unsafe_code, reason = "a signal handler and a hook speak to Lua through its C interface")]

use std::ffi::{CStr, c_char, c_int};
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use std::time::Duration;

use mlua::{Lua, ffi};
use rtf_host::Session;

use crate::sdk;

/// A plug-in that polls `rtf.interrupted()` has this time to end by itself, before an error
/// ends its function.
const STOP_GRACE: Duration = Duration::from_millis(500);

/// A plug-in may catch that error: the interval at which it is raised again.
const STOP_INTERVAL: Duration = Duration::from_millis(100);

/// Ignored by default; C modules do not notice it, because system calls are restarted.
const SIGNAL: c_int = libc::SIGURG;

static STATE: AtomicPtr<ffi::lua_State> = AtomicPtr::new(ptr::null_mut());
static WANTS_STACK: AtomicBool = AtomicBool::new(false);
static WANTS_STOP: AtomicBool = AtomicBool::new(false);
static TARGET: OnceLock<InterruptTarget> = OnceLock::new();

struct InterruptTarget {
    session: Session,
    lua_thread: libc::pthread_t,
}

unsafe extern "C" {
    /// `$LuaVersion: Lua 5.4.9  Copyright …`, from Lua's `lapi.c`.
    static lua_ident: c_char;
}

/// Registers the calling thread as the one that runs Lua.
pub(crate) fn start(session: &Session) {
    // SAFETY: returns the calling thread's own id.
    let lua_thread = unsafe { libc::pthread_self() };
    TARGET.get_or_init(|| InterruptTarget { session: session.clone(), lua_thread });
    // SAFETY: an all-zero sigaction is valid, and the handler is async-signal-safe.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        action.sa_sigaction = on_signal as extern "C" fn(c_int) as libc::sighandler_t;
        action.sa_flags = libc::SA_RESTART;
        libc::sigaction(SIGNAL, &raw const action, ptr::null_mut());
    }
}

/// Sets the state that can be interrupted.
pub(crate) fn set_state(lua: &Lua) {
    // SAFETY: stores the pointer, and does nothing with the state.
    let state = unsafe { lua.exec_raw::<()>((), |state| STATE.store(state, Ordering::Release)) };
    debug_assert!(state.is_ok(), "taking a pointer cannot fail");
}

/// Called before the state is closed.
pub(crate) fn clear_state() {
    STATE.store(ptr::null_mut(), Ordering::Release);
}

/// Sends the stack of the code that runs, before its next instruction.
pub(crate) fn request_stack() {
    WANTS_STACK.store(true, Ordering::Release);
    interrupt_lua();
}

/// The version of the embedded Lua: `5.4.9`.
pub(crate) fn lua_release() -> String {
    // SAFETY: Lua defines it as an array of characters that ends with a zero.
    let ident = unsafe { CStr::from_ptr(&raw const lua_ident) }.to_string_lossy();
    ident.split_whitespace().nth(2).unwrap_or("5.4").to_owned()
}

/// Ends the plug-in's function if it does not end by itself after a stop request. Called on
/// the thread that reads the channel, which blocks all signals, as does the new thread.
pub(crate) fn stop_later(session: &Session) {
    let session = session.clone();
    let stop = move || {
        std::thread::sleep(STOP_GRACE);
        while session.interrupted() {
            WANTS_STOP.store(true, Ordering::Release);
            interrupt_lua();
            std::thread::sleep(STOP_INTERVAL);
        }
        WANTS_STOP.store(false, Ordering::Release);
    };
    let thread = std::thread::Builder::new().name("rtf-stop".to_owned()).stack_size(64 * 1024);
    // Without the thread, the runner kills the plug-in.
    drop(thread.spawn(stop));
}

fn interrupt_lua() {
    if let Some(target) = TARGET.get() {
        // SAFETY: the main thread exists as long as the process.
        unsafe { libc::pthread_kill(target.lua_thread, SIGNAL) };
    }
}

extern "C" fn on_signal(_signal: c_int) {
    let state = STATE.load(Ordering::Acquire);
    if !state.is_null() {
        let events = ffi::LUA_MASKCALL | ffi::LUA_MASKRET | ffi::LUA_MASKCOUNT;
        // SAFETY: Lua lets a signal handler set a hook on the thread that runs
        // the state; the pointer is cleared before the state is closed.
        unsafe { ffi::lua_sethook(state, Some(hook), events, 1) };
    }
}

/// Called by Lua on its own thread, before an instruction of the plug-in.
///
/// Nothing in it has a destructor when Lua's error leaves it.
unsafe extern "C-unwind" fn hook(state: *mut ffi::lua_State, _event: *mut ffi::lua_Debug) {
    // SAFETY: Lua calls a hook with a valid state and 20 free stack slots.
    unsafe { ffi::lua_sethook(state, None, 0, 0) };
    let Some(target) = TARGET.get() else { return };
    if WANTS_STACK.swap(false, Ordering::AcqRel) {
        // SAFETY: as above; it leaves the Lua stack unchanged.
        let text = unsafe { traceback(state) };
        target.session.stack(text);
    }
    if target.session.interrupted() && WANTS_STOP.swap(false, Ordering::AcqRel) {
        // SAFETY: as above; `lua_error` does not return, and no value here
        // needs to be dropped.
        unsafe {
            ffi::lua_getfield(state, ffi::LUA_REGISTRYINDEX, sdk::STOP.as_ptr());
            ffi::lua_error(state);
        }
    }
}

/// # Safety
/// `state` is valid and has free stack slots.
unsafe fn traceback(state: *mut ffi::lua_State) -> String {
    // SAFETY: the caller's promise; the string lives until it is popped.
    unsafe {
        ffi::luaL_traceback(state, state, ptr::null(), 0);
        let text = ffi::lua_tostring(state, -1);
        let text = if text.is_null() { c"" } else { CStr::from_ptr(text) };
        let text = text.to_string_lossy().into_owned();
        ffi::lua_pop(state, 1);
        text
    }
}
