//! The cases of the running test: their numbers, the open ones on each thread, and the
//! selected ones.

mod episodes;
mod error;

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError, RwLock};

use rtf_model::protocol::{CaseSelector, EpisodeSlots, Notification};
use rtf_model::{CaseId, CaseStart, Outcome, Phase};
use rustix::process::{Pid, getpid};

pub use self::episodes::EpisodeResult;
use self::episodes::OpenEpisode;
pub(crate) use self::error::CaseError;

/// How the body of a case ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaseEnd {
    /// It returned.
    Done,
    /// An assertion, an error or a skip that it reported ended it, or a stop request did.
    Stopped,
}

/// Maximum number of planned names in a line: a line of the protocol has a limit.
const NAMES_IN_LINE: usize = 4096;

/// Numbers the attempts of this process: a thread that outlives its test must not report
/// cases in the next one.
static ATTEMPTS: AtomicU64 = AtomicU64::new(1);

thread_local! {
    /// The open cases of this thread, the innermost last.
    static OPEN: RefCell<Vec<OpenCase>> = const { RefCell::new(Vec::new()) };
    /// The attempt that this thread runs; 0 on all other threads.
    static RUNS: Cell<u64> = const { Cell::new(0) };
}

struct OpenCase {
    attempt: u64,
    /// In a forked child: the case in which the test forked.
    case: Option<CaseId>,
    /// The thread has entered this episode, which is no case of the thread alone.
    episode: Option<u64>,
    path: String,
    skip_reason: Option<String>,
    has_problem: bool,
}

impl OpenCase {
    fn new(attempt: u64, case: Option<CaseId>, path: String) -> Self {
        Self { attempt, case, episode: None, path, skip_reason: None, has_problem: false }
    }
}

/// What does not change while a case starts.
#[derive(Debug, Default)]
struct AttemptSettings {
    attempt: u64,
    phase: Option<Phase>,
    selectors: Vec<CaseSelector>,
    /// With slots, the top-level cases are episodes.
    slots: Option<EpisodeSlots>,
}

impl AttemptSettings {
    fn selects(&self, path: &str) -> bool {
        self.selectors.is_empty() || self.selectors.iter().any(|wanted| wanted.selects(path))
    }

    fn may_plan_or_skip(&self) -> bool {
        matches!(self.phase, Some(Phase::Setup | Phase::Run))
    }
}

/// The cases of the present attempt.
#[derive(Debug)]
pub(crate) struct Cases {
    /// The process that reports cases: a forked child does not.
    process: Pid,
    /// Read-locked while a case starts, so that no case starts in another phase.
    settings: RwLock<AttemptSettings>,
    /// Number of started cases. Locked while a start is sent: the numbers arrive in order.
    started: Mutex<u32>,
    /// Number of open cases, so that a message of a test without cases costs nothing.
    open: AtomicU32,
    /// The innermost open case of the thread that runs the test; 0: none.
    main_case: AtomicU32,
    /// Whether a stop request left a case open: the runner finishes all that are open.
    is_abandoned: AtomicBool,
    episodes: Mutex<HashMap<u64, OpenEpisode>>,
}

impl Default for Cases {
    fn default() -> Self {
        Self {
            process: getpid(),
            settings: RwLock::default(),
            started: Mutex::new(0),
            open: AtomicU32::new(0),
            main_case: AtomicU32::new(0),
            is_abandoned: AtomicBool::new(false),
            episodes: Mutex::default(),
        }
    }
}

impl Cases {
    /// Begins an attempt, which the calling thread runs.
    pub(crate) fn begin_attempt(&self, selectors: &[CaseSelector], slots: Option<EpisodeSlots>) {
        let attempt = ATTEMPTS.fetch_add(1, Ordering::Relaxed);
        RUNS.set(attempt);
        with_open(Vec::clear);
        *self.started.lock().unwrap_or_else(PoisonError::into_inner) = 0;
        self.open.store(0, Ordering::Relaxed);
        self.main_case.store(0, Ordering::Relaxed);
        self.is_abandoned.store(false, Ordering::Relaxed);
        self.episodes().clear();
        let mut settings = self.settings.write().unwrap_or_else(PoisonError::into_inner);
        let selectors = selectors.to_vec();
        *settings = AttemptSettings { attempt, phase: None, selectors, slots };
    }

    /// Ends the attempt: its threads report no more cases.
    pub(crate) fn end_attempt(&self) {
        let mut settings = self.settings.write().unwrap_or_else(PoisonError::into_inner);
        *settings = AttemptSettings::default();
        self.open.store(0, Ordering::Relaxed);
    }

    /// The test enters a phase. Waits for cases that are starting on other threads.
    pub(crate) fn set_phase(&self, phase: Phase) {
        self.settings.write().unwrap_or_else(PoisonError::into_inner).phase = Some(phase);
    }

    /// The case of a message of this thread.
    pub(crate) fn current(&self) -> Option<CaseId> {
        if self.open.load(Ordering::Relaxed) == 0 {
            return None;
        }
        let attempt = self.settings().attempt;
        with_innermost(attempt, |open| open.case).unwrap_or_else(|| self.main_case())
    }

    /// Starts a case on this thread, and returns whether it runs.
    pub(crate) fn begin(
        &self,
        mut start: CaseStart,
        is_stopping: bool,
        send: impl FnOnce(&Notification) -> bool,
    ) -> Result<bool, CaseError> {
        let settings = self.settings();
        if settings.phase != Some(Phase::Run) {
            return Err(CaseError::OutsideRun);
        }
        let (parent, path) = self.nest(&settings, &start.name);
        if !settings.selects(&path) {
            return Ok(false);
        }
        let opened = |case| OpenCase::new(settings.attempt, case, path);
        if self.is_forked_child() {
            self.push(opened(parent.or_else(|| self.main_case())));
            return Ok(true);
        }
        if settings.slots.is_some() && parent.is_none() {
            return Err(CaseError::OutsideEpisode);
        }
        if is_stopping {
            return Ok(false);
        }
        let mut started = self.started.lock().unwrap_or_else(PoisonError::into_inner);
        let case = CaseId(*started + 1);
        (start.case, start.parent) = (case, parent);
        if !send(&Notification::CaseStarted(start)) {
            return Err(CaseError::TooLong);
        }
        *started = case.0;
        drop(started);
        self.push(opened(Some(case)));
        Ok(true)
    }

    /// Finishes the innermost case of this thread.
    pub(crate) fn end(
        &self,
        end: CaseEnd,
        is_stopping: bool,
        send: impl Fn(&Notification) -> bool,
    ) -> Result<(), CaseError> {
        let is_case = |last: &mut OpenCase| last.episode.is_none();
        let closed = with_open(|open| open.pop_if(is_case)).flatten().ok_or(CaseError::NotOpen)?;
        let settings = self.settings();
        if closed.attempt != settings.attempt {
            return Ok(());
        }
        self.is_abandoned.fetch_or(is_stopping, Ordering::Relaxed);
        let is_sent = !self.is_forked_child() && !self.is_abandoned.load(Ordering::Relaxed);
        if let (Some(case), true) = (closed.case, is_sent) {
            let (outcome, reason) = match (closed.skip_reason, end) {
                (Some(reason), _) => (Some(Outcome::Skipped), Some(reason)),
                (None, CaseEnd::Stopped) if !closed.has_problem => {
                    (Some(Outcome::Error), Some("the case stopped without a reason".to_owned()))
                }
                _ => (None, None),
            };
            let finished = |reason| {
                let (duration_us, rerun, episode) = (None, false, None);
                Notification::CaseFinished { case, outcome, reason, duration_us, rerun, episode }
            };
            if !send(&finished(reason)) {
                send(&finished(None));
            }
        }
        self.open.fetch_sub(1, Ordering::Relaxed);
        with_innermost(closed.attempt, |outer| outer.has_problem |= closed.has_problem);
        self.update_main_case(closed.attempt);
        Ok(())
    }

    /// Announces top-level cases.
    pub(crate) fn plan(
        &self,
        mut names: Vec<String>,
        send: impl Fn(&Notification) -> bool,
    ) -> Result<(), CaseError> {
        let settings = self.settings();
        if !settings.may_plan_or_skip() {
            return Err(CaseError::PlannedElsewhere);
        }
        names.retain(|name| settings.selects(name));
        if self.is_forked_child() {
            return Ok(());
        }
        let mut parts = names.chunks(NAMES_IN_LINE).map(<[String]>::to_vec);
        let all_sent = parts.all(|names| send(&Notification::CasesPlanned { names }));
        if all_sent { Ok(()) } else { Err(CaseError::TooLong) }
    }

    /// Skips the innermost case of this thread. Returns whether the test is skipped instead,
    /// because the thread has no open case.
    pub(crate) fn skip(&self, reason: &str) -> Result<bool, CaseError> {
        let settings = self.settings();
        let skip_case = |open: &mut OpenCase| open.skip_reason = Some(reason.to_owned());
        if with_innermost(settings.attempt, skip_case).is_some() {
            return Ok(false);
        }
        if settings.may_plan_or_skip() { Ok(true) } else { Err(CaseError::SkippedElsewhere) }
    }

    /// Records a problem that this thread reported.
    pub(crate) fn record_problem(&self) {
        if self.open.load(Ordering::Relaxed) > 0 {
            with_innermost(self.settings().attempt, |open| open.has_problem = true);
        }
    }

    /// Whether this process was forked by the plug-in: it reports no cases and provides no
    /// values.
    pub(crate) fn may_ask(&self) -> bool {
        self.settings().may_plan_or_skip()
    }

    pub(crate) fn is_forked_child(&self) -> bool {
        getpid() != self.process
    }

    /// The innermost case of this thread, and the path of a case in it.
    fn nest(&self, settings: &AttemptSettings, name: &str) -> (Option<CaseId>, String) {
        let outer = with_innermost(settings.attempt, |outer| {
            (outer.case, format!("{}/{name}", outer.path))
        });
        outer.unwrap_or_else(|| (None, name.to_owned()))
    }

    fn push(&self, opened: OpenCase) {
        let (attempt, case) = (opened.attempt, opened.case);
        with_open(|open| open.push(opened));
        self.open.fetch_add(1, Ordering::Relaxed);
        self.set_main_case(attempt, case);
    }

    fn set_main_case(&self, attempt: u64, case: Option<CaseId>) {
        if RUNS.get() == attempt {
            self.main_case.store(case.map_or(0, |case| case.0), Ordering::Relaxed);
        }
    }

    fn main_case(&self) -> Option<CaseId> {
        let case = self.main_case.load(Ordering::Relaxed);
        (case > 0).then_some(CaseId(case))
    }

    fn settings(&self) -> std::sync::RwLockReadGuard<'_, AttemptSettings> {
        self.settings.read().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Calls a function with this thread's open cases. Without them, the thread is ending.
fn with_open<R>(call: impl FnOnce(&mut Vec<OpenCase>) -> R) -> Option<R> {
    OPEN.try_with(|open| call(&mut open.borrow_mut())).ok()
}

/// Calls a function with this thread's innermost case of the attempt, if there is one.
fn with_innermost<R>(attempt: u64, call: impl FnOnce(&mut OpenCase) -> R) -> Option<R> {
    with_open(|open| open.last_mut().filter(|open| open.attempt == attempt).map(call)).flatten()
}
