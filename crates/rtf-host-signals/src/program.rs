//! A program that writes samples.

use std::io::{ErrorKind, Read};
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdout};
use std::time::{Duration, Instant};

use rtf_model::SignalTime;
use rustix::process::{Pid, Signal, kill_process_group};

use crate::command::{self, shown};
use crate::line;
use crate::recorder::Recorder;
use crate::settings::ProgramSettings;
use crate::source_time::SampleTime;
use crate::test_run::SignalSample;

/// The longest line, its end included.
const LINE_LIMIT: usize = 64 * 1024;
/// How much is read at a time.
const CHUNK: usize = 64 * 1024;
/// How much is read before other programs are.
const READ_LIMIT: usize = 16 * CHUNK;
/// How much of an invalid line is shown.
const SHOWN: usize = 200;
/// The largest difference between the suite's clock and the first time of a program.
const CLOCK_TOLERANCE_SECS: f64 = 60.0;
/// How long a program may take to end after SIGTERM.
const GRACE: Duration = Duration::from_secs(2);
/// How long a program may take to end after it has closed its output.
const EXIT_WAIT: Duration = Duration::from_millis(200);
/// The interval of polls for its end.
const POLL: Duration = Duration::from_millis(2);

/// A running program.
#[derive(Debug)]
pub(crate) struct Program {
    /// The index of the program, which is that of its source.
    index: usize,
    child: Child,
    output: ChildStdout,
    /// The begin of a line that is not complete.
    rest: Vec<u8>,
    chunk: Vec<u8>,
    values: Vec<Option<f64>>,
    lines: u64,
}

impl Program {
    /// Starts a program.
    ///
    /// # Errors
    /// Why it cannot be started.
    pub fn start(index: usize, settings: &ProgramSettings) -> Result<Self, String> {
        let failed = |error: std::io::Error| format!("{}: {error}", shown(&settings.words));
        let mut command = command::of(&settings.words)?;
        rtf_host::reset_signals(&mut command);
        let mut child = command.process_group(0).spawn().map_err(failed)?;
        let output = child.stdout.take().ok_or("the program has no output")?;
        rustix::io::ioctl_fionbio(&output, true).map_err(|error| failed(error.into()))?;
        Ok(Self {
            index,
            child,
            output,
            rest: Vec::new(),
            chunk: vec![0; CHUNK],
            values: vec![None; settings.count],
            lines: 0,
        })
    }

    /// Its output, for a thread that waits for it.
    ///
    /// # Errors
    /// There are too many descriptors.
    pub fn descriptor(&self) -> std::io::Result<std::os::fd::OwnedFd> {
        Ok(rustix::io::fcntl_dupfd_cloexec(&self.output, 3)?)
    }

    /// The number of lines that were read.
    pub fn lines(&self) -> u64 {
        self.lines
    }

    /// Reads what it has written, without waiting. Passes complete lines to the recorder.
    ///
    /// # Errors
    /// It ended, or wrote something else.
    pub fn read(&mut self, recorder: &mut Recorder) -> Result<(), String> {
        let mut total = 0;
        while total < READ_LIMIT {
            let count = match self.output.read(&mut self.chunk) {
                Ok(0) => return Err(self.end(recorder)),
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(self.describe(recorder, &error.to_string())),
            };
            total += count;
            self.take_lines(count, recorder)?;
        }
        Ok(())
    }

    fn take_lines(&mut self, count: usize, recorder: &mut Recorder) -> Result<(), String> {
        let arrival = Instant::now();
        let chunk = std::mem::take(&mut self.chunk);
        let mut text = &chunk[..count];
        let mut result = Ok(());
        while let (Some(end), Ok(())) = (text.iter().position(|byte| *byte == b'\n'), &result) {
            result = if self.rest.is_empty() {
                self.take_line(&text[..end], arrival, recorder)
            } else {
                let mut line = std::mem::take(&mut self.rest);
                line.extend_from_slice(&text[..end]);
                self.take_line(&line, arrival, recorder)
            };
            text = &text[end + 1..];
        }
        self.rest.extend_from_slice(text);
        if self.rest.len() > LINE_LIMIT {
            let what = format!("wrote a line of more than {LINE_LIMIT} bytes");
            result = result.and(Err(self.describe(recorder, &what)));
        }
        self.chunk = chunk;
        result
    }

    fn take_line(
        &mut self,
        line: &[u8],
        arrival: Instant,
        recorder: &mut Recorder,
    ) -> Result<(), String> {
        let text = String::from_utf8_lossy(line);
        if text.trim().is_empty() {
            return Ok(());
        }
        let time = recorder.settings().programs[self.index].time;
        let parsed = line::parse(&text, time != SignalTime::Arrival, &mut self.values);
        let written = parsed.map_err(|expected| {
            let shown: String = text.trim().chars().take(SHOWN).collect();
            self.describe(recorder, &format!("wrote `{shown}`, {expected}"))
        })?;
        self.lines += 1;
        if let (Some(written), SignalTime::Clock, 1) = (written, time, self.lines) {
            self.check_clock(written, recorder)?;
        }
        let time = SampleTime { written, arrival };
        let first = recorder.settings().programs[self.index].first_signal;
        for (offset, value) in self.values.iter().enumerate() {
            if let Some(value) = *value {
                let (source, signal) = (self.index, first + offset);
                recorder.sample(SignalSample { source, signal, time, value });
            }
        }
        Ok(())
    }

    /// Refuses times of another clock.
    fn check_clock(&self, written: f64, recorder: &Recorder) -> Result<(), String> {
        let Some(now) = recorder.clock().now() else { return Ok(()) };
        if (written - now).abs() <= CLOCK_TOLERANCE_SECS {
            return Ok(());
        }
        let clock = recorder.clock().description();
        let hint = &recorder.settings().programs[self.index].other_clock;
        let what = format!(
            "wrote the time {written}, but its times have to be {clock} (now {now:.3}); {hint}"
        );
        Err(self.describe(recorder, &what))
    }

    fn end(&mut self, recorder: &Recorder) -> String {
        let what = match self.exit_within(EXIT_WAIT) {
            Some(status) => format!("ended with {status}"),
            None => "closed its output".to_owned(),
        };
        self.describe(recorder, &what)
    }

    fn describe(&self, recorder: &Recorder, what: &str) -> String {
        let settings = &recorder.settings().programs[self.index];
        let names: Vec<_> = recorder.settings().signals[settings.first_signal..]
            .iter()
            .take(settings.count)
            .map(|signal| format!("`{}`", signal.name))
            .collect();
        format!("the program of {} {what}: {}", names.join(", "), shown(&settings.words))
    }

    fn exit_within(&mut self, limit: Duration) -> Option<String> {
        let deadline = Instant::now() + limit;
        loop {
            if let Ok(Some(status)) = self.child.try_wait() {
                return Some(status.to_string());
            }
            if Instant::now() >= deadline {
                return None;
            }
            std::thread::sleep(POLL);
        }
    }

    /// Asks the program to end.
    pub fn ask_to_end(&self) {
        self.signal(Signal::TERM);
    }

    /// Waits for its end, and kills it if it does not end.
    pub fn end_or_kill(&mut self) {
        if self.exit_within(GRACE).is_none() {
            self.signal(Signal::KILL);
            drop(self.child.wait());
        }
    }

    fn signal(&self, signal: Signal) {
        let pid = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw);
        // It fails if all of its processes have ended.
        let _ = pid.map(|pid| kill_process_group(pid, signal));
    }
}
