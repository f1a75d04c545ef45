//! Reaches Lua code that does not come back by itself.
//!
//! Another thread must not touch a Lua state. What Lua allows is what its own
//! interpreter does on Ctrl-C: a signal handler *on the thread that runs Lua*
//! sets a hook, and Lua calls the hook before its next instruction. There the
//! stack is sent, or the stop is raised. Code that hangs inside a C function,
//! or in a coroutine that was made before, is not reached: a debugger is, and
//! after the grace the runner's force.
#![expect(unsafe_code, reason = "a signal handler and a hook speak to Lua through its C interface")]

use std::ffi::{CStr, c_char, c_int};
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use std::time::Duration;

use mlua::{Lua, ffi};
use rtf_host::Session;

use crate::sdk;

/// A plug-in that looks at `rtf.interrupted()` gets this long to end by itself
/// before an error ends what it does.
const POLITE: Duration = Duration::from_millis(500);

/// A plug-in may catch that error: it comes again after this time.
const AGAIN: Duration = Duration::from_millis(100);

/// Ignored by whoever does not expect it, and restarted system calls make it
/// invisible to C modules.
const SIGNAL: c_int = libc::SIGURG;

static STATE: AtomicPtr<ffi::lua_State> = AtomicPtr::new(ptr::null_mut());
static WANTS_STACK: AtomicBool = AtomicBool::new(false);
static WANTS_STOP: AtomicBool = AtomicBool::new(false);
static WATCH: OnceLock<Watch> = OnceLock::new();

struct Watch {
    session: Session,
    lua_thread: libc::pthread_t,
}

unsafe extern "C" {
    /// `$LuaVersion: Lua 5.4.9  Copyright …`, from Lua's `lapi.c`.
    static lua_ident: c_char;
}

/// Makes the calling thread the one that runs Lua.
pub(crate) fn start(session: &Session) {
    // SAFETY: returns the calling thread's own id.
    let lua_thread = unsafe { libc::pthread_self() };
    WATCH.get_or_init(|| Watch { session: session.clone(), lua_thread });
    // SAFETY: an all-zero sigaction is a valid one, and the handler does only
    // what may be done in a signal handler.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        action.sa_sigaction = on_signal as extern "C" fn(c_int) as libc::sighandler_t;
        action.sa_flags = libc::SA_RESTART;
        libc::sigaction(SIGNAL, &raw const action, ptr::null_mut());
    }
}

/// Makes a state the one that is watched from now on.
pub(crate) fn look_at(lua: &Lua) {
    // SAFETY: only the pointer is taken, nothing is done with the state.
    let state = unsafe { lua.exec_raw::<()>((), |state| STATE.store(state, Ordering::Release)) };
    debug_assert!(state.is_ok(), "taking a pointer cannot fail");
}

/// The state is about to be closed.
pub(crate) fn forget_state() {
    STATE.store(ptr::null_mut(), Ordering::Release);
}

/// Sends the stack of the code that runs, before its next instruction.
pub(crate) fn ask_for_stack() {
    WANTS_STACK.store(true, Ordering::Release);
    interrupt_lua();
}

/// Writes what C's buffers still hold: Lua prints through them.
pub(crate) fn flush_output() {
    // SAFETY: null means all output streams; they are locked while written.
    unsafe { libc::fflush(ptr::null_mut()) };
}

/// The version of the embedded Lua: `5.4.9`.
pub(crate) fn lua_release() -> String {
    // SAFETY: Lua defines it as an array of characters that ends with a zero.
    let ident = unsafe { CStr::from_ptr(&raw const lua_ident) }.to_string_lossy();
    ident.split_whitespace().nth(2).unwrap_or("5.4").to_owned()
}

/// The plug-in was asked to stop: ends what it does when it does not. Called on
/// the thread that reads the channel, which no signal reaches; nor does one reach
/// the thread that this starts.
pub(crate) fn insist(session: &Session) {
    let session = session.clone();
    let insist = move || {
        std::thread::sleep(POLITE);
        while session.interrupted() {
            WANTS_STOP.store(true, Ordering::Release);
            interrupt_lua();
            std::thread::sleep(AGAIN);
        }
        WANTS_STOP.store(false, Ordering::Release);
    };
    let thread = std::thread::Builder::new().name("rtf-insist".to_owned()).stack_size(64 * 1024);
    // Without the thread, the runner's force ends the plug-in.
    drop(thread.spawn(insist));
}

fn interrupt_lua() {
    if let Some(watch) = WATCH.get() {
        // SAFETY: the main thread, which lives as long as the process.
        unsafe { libc::pthread_kill(watch.lua_thread, SIGNAL) };
    }
}

extern "C" fn on_signal(_signal: c_int) {
    let state = STATE.load(Ordering::Acquire);
    if !state.is_null() {
        let events = ffi::LUA_MASKCALL | ffi::LUA_MASKRET | ffi::LUA_MASKCOUNT;
        // SAFETY: Lua lets a signal handler set a hook on the thread that runs
        // the state; the state is forgotten before it is closed.
        unsafe { ffi::lua_sethook(state, Some(hook), events, 1) };
    }
}

/// Called by Lua on its own thread, before an instruction of the plug-in.
///
/// Nothing in it has a destructor when Lua's error leaves it.
unsafe extern "C-unwind" fn hook(state: *mut ffi::lua_State, _event: *mut ffi::lua_Debug) {
    // SAFETY: Lua calls a hook with a valid state and 20 free stack slots.
    unsafe { ffi::lua_sethook(state, None, 0, 0) };
    let Some(watch) = WATCH.get() else { return };
    if WANTS_STACK.swap(false, Ordering::AcqRel) {
        // SAFETY: as above; nothing that was pushed stays.
        let text = unsafe { traceback(state) };
        watch.session.stack(text);
    }
    if watch.session.interrupted() && WANTS_STOP.swap(false, Ordering::AcqRel) {
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
