//! The functions for the episodes of a test with slots.
#![expect(unsafe_code, reason = "called by foreign code with its pointers")]

use std::cell::RefCell;
use std::ffi::{c_int, c_void};
use std::time::Duration;

use rtf_host::{EpisodeResult, TakenEpisode};
use rtf_model::{Episode, EpisodeEnd, Message, MessageKind, Outcome, Parameter};

use super::context;
use crate::abi::{
    RTF_DONE, RTF_EPISODE_ERROR, RTF_EPISODE_FAILED, RTF_EPISODE_PASSED, RTF_EPISODE_TIMED_OUT,
    RTF_REFUSED, RTF_STOPPED, rtf_episode, rtf_episode_end, rtf_parameter, rtf_slots, rtf_text,
};
use crate::conversion::{location, text};

thread_local! {
    /// The episode that this thread has taken last, with entries that refer to its parameters.
    static TAKEN: RefCell<Option<(Episode, Vec<rtf_parameter>)>> = const { RefCell::new(None) };
}

pub(super) unsafe extern "C" fn slots(context: *mut c_void, slots: *mut rtf_slots) -> i32 {
    // SAFETY: the context is that of the table.
    let Some(own) = unsafe { self::context(context) }.session.slots() else { return RTF_REFUSED };
    let max_time = own.max_time_us.map_or(Duration::ZERO, Duration::from_micros);
    let filled = rtf_slots {
        size: size_of::<rtf_slots>(),
        slots: own.slots,
        reserved: 0,
        max_steps: own.max_steps.unwrap_or(0),
        max_time: max_time.as_secs_f64(),
    };
    // SAFETY: the pointer is valid by spec/plugin-abi.md.
    unsafe { fill(slots, &filled) };
    RTF_DONE
}

pub(super) unsafe extern "C" fn take_episode(
    context: *mut c_void,
    wait: c_int,
    episode: *mut rtf_episode,
) -> i32 {
    // SAFETY: the context is that of the table.
    let taken = match unsafe { self::context(context) }.session.take_episode(wait != 0) {
        TakenEpisode::Started(taken) => taken,
        TakenEpisode::None => return RTF_REFUSED,
        TakenEpisode::Stopped => return RTF_STOPPED,
    };
    let entry =
        |own: &Parameter| rtf_parameter { name: borrow(&own.name), value: borrow(&own.value) };
    let parameters: Vec<rtf_parameter> = taken.parameters.iter().map(entry).collect();
    let filled = rtf_episode {
        size: size_of::<rtf_episode>(),
        id: taken.id,
        seed: taken.seed,
        reserved: 0,
        parameters: parameters.as_ptr(),
        parameter_count: parameters.len(),
    };
    // SAFETY: the pointer is valid by spec/plugin-abi.md.
    unsafe { fill(episode, &filled) };
    TAKEN.set(Some((taken, parameters)));
    RTF_DONE
}

pub(super) unsafe extern "C" fn enter_episode(context: *mut c_void, id: u64) -> i32 {
    // SAFETY: the context is that of the table.
    done(unsafe { self::context(context) }.session.enter_episode(id))
}

pub(super) unsafe extern "C" fn leave_episode(context: *mut c_void, id: u64) -> i32 {
    // SAFETY: the context is that of the table.
    done(unsafe { self::context(context) }.session.leave_episode(id))
}

pub(super) unsafe extern "C" fn finish_episode(
    context: *mut c_void,
    id: u64,
    end: *const rtf_episode_end,
) -> i32 {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    let (session, end, location) = unsafe {
        let end = &*end;
        (&self::context(context).session, end, location(end.file, end.line))
    };
    // SAFETY: the same.
    let (reason, observed) = unsafe { (text(end.reason), text(end.first_observation)) };
    let outcome = match end.outcome {
        RTF_EPISODE_PASSED => Outcome::Passed,
        RTF_EPISODE_FAILED => Outcome::Failed,
        RTF_EPISODE_ERROR => Outcome::Error,
        RTF_EPISODE_TIMED_OUT => Outcome::TimedOut,
        other => {
            let text = format!("episode {id} has the unknown outcome {other}");
            session.message(Message::new(MessageKind::Error, text, location));
            return RTF_STOPPED;
        }
    };
    let time = Duration::try_from_secs_f64(end.time).ok();
    let end = EpisodeEnd {
        steps: u64::try_from(end.steps).ok(),
        time_us: time.and_then(|time| u64::try_from(rounded_micros(time)).ok()),
        first_observation: Some(observed).filter(|text| !text.is_empty()),
    };
    done(session.finish_episode(id, EpisodeResult { outcome, reason, end, location }))
}

/// Microseconds, to the nearest one: sums of times of steps are not exact.
fn rounded_micros(time: Duration) -> u128 {
    (time.as_nanos() + 500) / 1000
}

fn done(is_done: bool) -> i32 {
    if is_done { RTF_DONE } else { RTF_STOPPED }
}

fn borrow(text: &str) -> rtf_text {
    rtf_text { data: text.as_ptr().cast(), length: text.len() }
}

/// Fills a structure of a plug-in, whose version may be another one: only fields within its size,
/// which it keeps.
///
/// # Safety
/// `target` begins with its size in bytes, all of which can be written; `T` does, too.
unsafe fn fill<T>(target: *mut T, filled: &T) {
    // SAFETY: the caller's promise.
    unsafe {
        let size = *target.cast::<usize>();
        let start = size_of::<usize>();
        let count = size.min(size_of::<T>()).saturating_sub(start);
        let source = std::ptr::from_ref(filled).cast::<u8>().add(start);
        std::ptr::copy_nonoverlapping(source, target.cast::<u8>().add(start), count);
    }
}
