//! The threads that take samples, until the fixture is torn down.

use std::io::PipeWriter;
use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rtf_host::Session;
use rtf_model::TestId;
use rtf_model::protocol::{TestAttempt, TestReport};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::processes::FixtureProcesses;
use crate::program::Program;
use crate::recorder::Recorder;
use crate::recording::Recording;
use crate::settings::{ProcessSettings, Settings};
use crate::source_time::SampleTime;
use crate::test_run::SignalSample;

/// Samples are sent at this interval.
const SEND_INTERVAL: Duration = Duration::from_millis(100);

/// The shortest wait for the next sample of a recording.
const MIN_WAIT: Duration = Duration::from_millis(1);

/// The running threads and programs.
#[derive(Debug)]
pub(crate) struct Watch {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
    /// Closed to wake the thread that reads programs.
    stop: PipeWriter,
}

#[derive(Debug)]
struct Shared {
    session: Session,
    state: Mutex<WatchState>,
    has_ended: AtomicBool,
    /// Notified at the end, and when a test starts.
    ending: Condvar,
}

#[derive(Debug)]
struct WatchState {
    recorder: Recorder,
    programs: Vec<Program>,
    /// Why the fixture has collapsed.
    problem: Option<String>,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, WatchState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl WatchState {
    /// Reads one program; false if it is not usable any more, which is a collapse.
    fn read(&mut self, index: usize, session: &Session) -> bool {
        let result = self.programs[index].read(&mut self.recorder);
        let Err(problem) = result else { return true };
        if self.problem.is_none() {
            session.collapsed(&problem);
            self.problem = Some(problem);
        }
        false
    }

    /// Reads everything that the programs have written.
    fn drain(&mut self, session: &Session) {
        for index in 0..self.programs.len() {
            if self.problem.is_none() {
                self.read(index, session);
            }
        }
    }
}

impl Watch {
    /// Starts the programs and threads.
    ///
    /// # Errors
    /// A program or thread cannot be started.
    pub fn start(settings: &Arc<Settings>, session: &Session) -> Result<Self, String> {
        let recordings = settings.recordings.iter().map(Recording::read);
        let recordings = recordings.collect::<Result<_, _>>()?;
        let recorder = Recorder::new(Arc::clone(settings), recordings, session.clone());
        let all = settings.programs.iter().enumerate();
        let programs: Vec<Program> =
            all.map(|(index, program)| Program::start(index, program)).collect::<Result<_, _>>()?;
        let failed = |error: std::io::Error| error.to_string();
        let outputs = programs.iter().map(Program::descriptor).collect::<Result<Vec<_>, _>>();
        let outputs = outputs.map_err(failed)?;
        let (wake, stop) = std::io::pipe().map_err(failed)?;
        let state = Mutex::new(WatchState { recorder, programs, problem: None });
        let (has_ended, ending) = (AtomicBool::new(false), Condvar::new());
        let shared = Arc::new(Shared { session: session.clone(), state, has_ended, ending });
        let for_programs = Arc::clone(&shared);
        let mut threads = vec![std::thread::spawn(move || {
            read_programs(&for_programs, outputs, &wake.into());
        })];
        if !settings.processes.is_empty() {
            let (for_processes, settings) = (Arc::clone(&shared), Arc::clone(settings));
            threads.push(std::thread::spawn(move || measure(&for_processes, &settings)));
        }
        if !settings.recordings.is_empty() {
            let shared = Arc::clone(&shared);
            threads.push(std::thread::spawn(move || play_recordings(&shared)));
        }
        Ok(Self { shared, threads, stop })
    }

    /// Whether every program that has to has written a line.
    pub fn is_ready(&self) -> bool {
        let state = self.shared.state();
        let needs = |index: usize| state.recorder.settings().programs[index].wait;
        let mut programs = state.programs.iter().enumerate();
        programs.all(|(index, program)| !needs(index) || program.lines() > 0)
    }

    /// The programs that have not written a line, for which set-up waits.
    pub fn missing(&self) -> String {
        let state = self.shared.state();
        let settings = &state.recorder.settings().programs;
        let programs = settings.iter().zip(&state.programs);
        let missing = programs.filter(|(settings, program)| settings.wait && program.lines() == 0);
        let missing: Vec<_> =
            missing.map(|(settings, _)| format!("`{}`", settings.words.join(" "))).collect();
        missing.join(", ")
    }

    /// Whether the fixture has collapsed, which was reported.
    pub fn has_collapsed(&self) -> bool {
        self.shared.state().problem.is_some()
    }

    pub fn start_test(&self, test: &TestAttempt) -> Result<(), String> {
        let result = self.shared.state().recorder.start(test);
        self.shared.ending.notify_all();
        result
    }

    pub fn reported(&self, test: TestId, report: TestReport) {
        self.shared.state().recorder.reported(test, report);
    }

    pub fn finish_test(&self, test: TestId, was_stopped: bool) -> Result<(), String> {
        let mut state = self.shared.state();
        state.drain(&self.shared.session);
        state.recorder.finish(test, was_stopped)
    }

    /// Ends the threads and programs.
    pub fn stop(self) {
        {
            let state = self.shared.state();
            self.shared.has_ended.store(true, Ordering::Release);
            state.programs.iter().for_each(Program::ask_to_end);
        }
        self.shared.ending.notify_all();
        drop(self.stop);
        for thread in self.threads {
            drop(thread.join());
        }
        self.shared.state().programs.iter_mut().for_each(Program::end_or_kill);
    }
}

/// Reads the programs as soon as they write, and sends samples at an interval.
fn read_programs(shared: &Shared, outputs: Vec<OwnedFd>, wake: &OwnedFd) {
    let mut outputs: Vec<(usize, OwnedFd)> = outputs.into_iter().enumerate().collect();
    let mut next_send = Instant::now() + SEND_INTERVAL;
    while !shared.has_ended.load(Ordering::Acquire) {
        let mut polled = vec![PollFd::new(wake, PollFlags::IN)];
        polled.extend(outputs.iter().map(|(_, output)| PollFd::new(output, PollFlags::IN)));
        let timeout = next_send.saturating_duration_since(Instant::now());
        let timeout = Timespec::try_from(timeout).ok();
        if poll(&mut polled, timeout.as_ref()).is_err() {
            // Interrupted by a signal.
            continue;
        }
        let ready: Vec<bool> = polled[1..].iter().map(|it| !it.revents().is_empty()).collect();
        let mut ready = ready.into_iter();
        outputs.retain(|(index, _)| {
            !ready.next().unwrap_or_default() || shared.state().read(*index, &shared.session)
        });
        if Instant::now() >= next_send {
            next_send = Instant::now() + SEND_INTERVAL;
            shared.state().recorder.send();
        }
    }
}

/// Plays recordings while tests run.
fn play_recordings(shared: &Shared) {
    let mut state = shared.state();
    while !shared.has_ended.load(Ordering::Acquire) {
        let due = state.recorder.play().unwrap_or(SEND_INTERVAL);
        // Simulated time may be faster than real time.
        let most = if state.recorder.clock().is_simulated() { MIN_WAIT } else { SEND_INTERVAL };
        let wait = due.clamp(MIN_WAIT, most);
        let waited = shared.ending.wait_timeout(state, wait);
        state = waited.unwrap_or_else(PoisonError::into_inner).0;
    }
}

/// Measures the processes of fixtures, each at its interval.
fn measure(shared: &Shared, settings: &Settings) {
    let first_source = settings.programs.len();
    let mut measured: Vec<_> = settings
        .processes
        .iter()
        .map(|settings| (settings, FixtureProcesses::new(&settings.owner), Instant::now()))
        .collect();
    while !shared.has_ended.load(Ordering::Acquire) {
        for (index, (settings, processes, due)) in measured.iter_mut().enumerate() {
            if Instant::now() >= *due {
                *due += settings.every.max(due.elapsed());
                let value = processes.measure(settings.quantity);
                record(shared, first_source + index, settings, value);
            }
        }
        let next = measured.iter().map(|(_, _, due)| *due).min();
        let wait = next.map_or(SEND_INTERVAL, |due| due.saturating_duration_since(Instant::now()));
        let state = shared.state();
        if !shared.has_ended.load(Ordering::Acquire) {
            drop(shared.ending.wait_timeout(state, wait));
        }
    }
}

fn record(shared: &Shared, source: usize, settings: &ProcessSettings, value: Option<f64>) {
    let Some(value) = value else { return };
    let mut state = shared.state();
    let Some(written) = state.recorder.clock().now() else { return };
    let time = SampleTime { written: Some(written), arrival: Instant::now() };
    let signal = settings.signal;
    state.recorder.sample(SignalSample { source, signal, time, value });
}
