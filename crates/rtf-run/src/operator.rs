//! The person who can answer questions of tests: who is there, and the answers on the terminal of a
//! run or of a campaign.

use std::io::{self, IsTerminal, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rtf_engine::guard;
use rtf_engine::run::{Control, QuestionReply};
use rtf_model::{AnswerChannel, Question, Respondent};
use rtf_report::background_writer::BackgroundWriter;
use rtf_report::console::{AskedHere, Operator};
use rtf_report::escape;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::Pid;
use rustix::termios::{QueueSelector, tcflush, tcgetpgrp, tcsetpgrp};

use crate::campaign_operator;
use crate::control::ControlChannels;

/// The longest line that a terminal passes.
const LINE_BYTES: usize = 4096;

/// How often it is checked whether a question is still open.
const POLL: Timespec = Timespec { tv_sec: 0, tv_nsec: 200_000_000 };

/// How often a process in the background checks whether it has the terminal.
const BACKGROUND: Duration = Duration::from_millis(500);

/// Who can answer questions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attendance {
    /// Whether an operator can answer on the terminal.
    pub console: bool,
    /// Whether an operator can answer on the terminal of the campaign whose worker this is.
    pub campaign: bool,
    /// Why no operator can answer, if none can.
    pub unattended: Option<String>,
}

impl Attendance {
    /// No operator can answer, unless there is a page.
    pub fn on_page(has_page: bool, reason: &str) -> Self {
        let unattended = (!has_page).then(|| reason.to_owned());
        Self { console: false, campaign: false, unattended }
    }

    /// The questions of a worker are answered on the terminal of its campaign.
    pub fn of_campaign() -> Self {
        Self { console: false, campaign: true, unattended: None }
    }

    /// Finds out who can answer the questions of a run. `obstacle` is why the terminal of this process
    /// is not one of an operator.
    pub fn find(has_page: bool, obstacle: Option<&'static str>) -> Self {
        match obstacle.or_else(no_console) {
            None => Self { console: true, campaign: false, unattended: None },
            Some(reason) => {
                Self::on_page(has_page, &format!("{reason}, and there is no page (`--web`)"))
            }
        }
    }

    /// The test that is debugged has the terminal.
    pub fn without_terminal(self, has_page: bool) -> Self {
        if !self.console {
            return self;
        }
        Self::on_page(has_page, "the test has the terminal, and there is no page (`--web`)")
    }
}

/// Why an operator cannot answer on the terminal of this process.
fn no_console() -> Option<&'static str> {
    if is_ci(std::env::var("CI").ok().as_deref()) {
        Some("the variable `CI` is set")
    } else if !io::stdin().is_terminal() {
        Some("standard input is no terminal")
    } else if !io::stdout().is_terminal() || !io::stderr().is_terminal() {
        Some("the output goes to no terminal")
    } else {
        None
    }
}

/// Whether a variable `CI` has the value of a CI system.
fn is_ci(value: Option<&str>) -> bool {
    value.is_some_and(|value| !matches!(value, "" | "0" | "false"))
}

/// The question at the terminal.
#[derive(Default)]
struct Desk {
    current: Mutex<Option<AskedHere>>,
    changed: Condvar,
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, Option<AskedHere>> {
        self.current.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_current(&self, asked: &AskedHere) -> bool {
        self.lock().as_ref() == Some(asked)
    }
}

/// Takes what the operator types.
pub trait AnswerSink: Send {
    /// Passes an answer on.
    fn answer(&mut self, asked: &AskedHere, reply: QuestionReply);

    /// Shows why a line is no answer, and the prompt again.
    ///
    /// # Errors
    /// The terminal is gone.
    fn complain(&mut self, problem: &str) -> io::Result<()>;
}

/// The run of this process.
struct RunSink {
    control: Arc<ControlChannels>,
    out: BackgroundWriter,
}

impl AnswerSink for RunSink {
    fn answer(&mut self, asked: &AskedHere, reply: QuestionReply) {
        let control = Control::Answer { test: asked.test, reply };
        self.control.controls.send_modify(|controls| controls.push(control));
    }

    /// The prompt follows each line.
    fn complain(&mut self, problem: &str) -> io::Result<()> {
        writeln!(self.out, "{:13}{}", "", escape::line(problem))
    }
}

/// Who answers the questions of this run, if an operator can.
///
/// # Errors
/// A thread cannot be started.
pub fn of_run(
    attendance: &Attendance,
    control: &Arc<ControlChannels>,
    out: &BackgroundWriter,
) -> io::Result<Option<Operator>> {
    if attendance.campaign {
        return campaign_operator::start(control.clone()).map(Some);
    }
    if !attendance.console {
        return Ok(None);
    }
    guard::survive_terminal_stop()?;
    let sink = RunSink { control: control.clone(), out: out.clone() };
    start(Box::new(sink), guard_group()).map(Some)
}

/// Reads the answers in a thread that ends with the process. What is typed before a question is
/// shown is discarded: it answers another one. `guard` is the process group of the guard, if this
/// process has one.
///
/// # Errors
/// The thread cannot be started.
pub fn start(sink: Box<dyn AnswerSink>, guard: Option<Pid>) -> io::Result<Operator> {
    let desk = Arc::new(Desk::default());
    let reader = AnswerReader { desk: desk.clone(), sink, guard, by: user() };
    std::thread::Builder::new().name("answers".to_owned()).spawn(move || reader.run())?;
    Ok(Box::new(move |current: Option<AskedHere>| {
        if current.is_some() && foreground(guard) != Foreground::Other {
            let _ = tcflush(io::stdin(), QueueSelector::IFlush);
        }
        *desk.lock() = current;
        desk.changed.notify_all();
    }))
}

/// The user of this process, who answers on the console.
fn user() -> Respondent {
    Respondent { via: AnswerChannel::Console, who: Some(user_name()) }
}

/// The name of the user of this process: a record, not a signature.
pub fn user_name() -> String {
    let mut names = ["LOGNAME", "USER"].into_iter().filter_map(|name| std::env::var(name).ok());
    let number = || format!("user {}", rustix::process::getuid().as_raw());
    names.find(|name| !name.is_empty()).unwrap_or_else(number)
}

/// Which process group has the foreground of the terminal, and so may read from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Foreground {
    /// That of the guard, which the user started.
    Guard,
    /// That of this process, the runner.
    Runner,
    /// Another one: the run is in the background of a shell.
    Other,
}

/// The group of the guard, this process's parent.
fn guard_group() -> Option<Pid> {
    rustix::process::getpgid(rustix::process::getppid()).ok()
}

fn foreground(guard: Option<Pid>) -> Foreground {
    match tcgetpgrp(io::stdin()).ok() {
        Some(group) if group == rustix::process::getpgrp() => Foreground::Runner,
        group if group.is_some() && group == guard => Foreground::Guard,
        _ => Foreground::Other,
    }
}

/// The foreground of the terminal while this process reads an answer. The guard blocks SIGTTOU in
/// both processes. Ctrl-C then interrupts this process, which handles it like the guard.
struct BorrowedForeground(Option<Pid>);

impl BorrowedForeground {
    /// Takes it from the guard; `None` if that does not have it.
    fn take(guard: Option<Pid>) -> Option<Self> {
        let take = || tcsetpgrp(io::stdin(), rustix::process::getpgrp()).is_ok();
        let has = match foreground(guard) {
            Foreground::Runner => true,
            Foreground::Guard => take(),
            Foreground::Other => false,
        };
        has.then_some(Self(guard))
    }
}

impl Drop for BorrowedForeground {
    fn drop(&mut self) {
        if let (Foreground::Runner, Some(guard)) = (foreground(self.0), self.0) {
            // Fails if the terminal is gone.
            let _ = tcsetpgrp(io::stdin(), guard);
        }
    }
}

/// Takes the terminal back from a runner that has died while it read an answer.
pub fn recover_terminal(had_foreground: bool) {
    if had_foreground {
        guard::permit_background_output();
        let _ = tcsetpgrp(io::stdin(), rustix::process::getpgrp());
    }
}

/// Whether this process is in the foreground of its terminal.
pub fn has_foreground() -> bool {
    foreground(guard_group()) == Foreground::Runner
}

struct AnswerReader {
    desk: Arc<Desk>,
    sink: Box<dyn AnswerSink>,
    guard: Option<Pid>,
    by: Respondent,
}

/// What was read from the terminal.
#[derive(Debug, PartialEq, Eq)]
enum Typed {
    Line(String),
    /// Ctrl-D.
    End,
    /// The question has ended.
    Over,
}

impl AnswerReader {
    fn run(mut self) {
        loop {
            let asked = self.next();
            if self.answer(&asked).is_err() {
                // The terminal is gone.
                return;
            }
        }
    }

    /// Waits for a question.
    fn next(&self) -> AskedHere {
        let mut current = self.desk.lock();
        loop {
            match &*current {
                Some(asked) => return asked.clone(),
                None => {
                    let waited = self.desk.changed.wait(current);
                    current = waited.unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }

    /// Reads lines until one is an answer, or the question has ended.
    fn answer(&mut self, asked: &AskedHere) -> io::Result<()> {
        loop {
            let answer = match self.read(asked)? {
                Typed::Over => return Ok(()),
                Typed::End => None,
                Typed::Line(line) => match choose(&asked.question, &line) {
                    Ok(answer) => Some(answer),
                    Err(problem) => {
                        self.sink.complain(&problem)?;
                        continue;
                    }
                },
            };
            let question = asked.question.question;
            let reply = QuestionReply { question, answer, by: self.by.clone() };
            self.sink.answer(asked, reply);
            self.wait_for_end(asked);
            return Ok(());
        }
    }

    fn read(&self, asked: &AskedHere) -> io::Result<Typed> {
        let stdin = io::stdin();
        let mut borrowed = None;
        while self.desk.is_current(asked) {
            borrowed = borrowed.or_else(|| BorrowedForeground::take(self.guard));
            if borrowed.is_none() {
                std::thread::sleep(BACKGROUND);
                continue;
            }
            let mut ready = [PollFd::new(&stdin, PollFlags::IN)];
            match poll(&mut ready, Some(&POLL)) {
                Ok(0) | Err(rustix::io::Errno::INTR) => continue,
                Ok(_) => {}
                Err(error) => return Err(error.into()),
            }
            // The question may have ended while the line was typed.
            if !self.desk.is_current(asked) {
                break;
            }
            let mut bytes = [0; LINE_BYTES];
            return match rustix::io::read(&stdin, &mut bytes)? {
                0 => Ok(Typed::End),
                count => {
                    let line = String::from_utf8_lossy(&bytes[..count]);
                    Ok(Typed::Line(line.trim().to_owned()))
                }
            };
        }
        Ok(Typed::Over)
    }

    /// Waits until the run has taken the answer.
    fn wait_for_end(&self, asked: &AskedHere) {
        let is_open = |current: &mut Option<AskedHere>| current.as_ref() == Some(asked);
        drop(self.desk.changed.wait_while(self.desk.lock(), is_open));
    }
}

/// The answer that a line means: a choice, its number, or any text if there are no choices.
fn choose(question: &Question, line: &str) -> Result<String, String> {
    let choices = &question.choices;
    if line.is_empty() {
        return Err("type an answer; Ctrl-D declines to answer".to_owned());
    }
    if choices.is_empty() {
        let problem = question.answer_problem(line);
        return problem.map_or_else(|| Ok(line.to_owned()), |why| Err(format!("the answer {why}")));
    }
    let exact = choices.iter().find(|choice| *choice == line);
    let is_same = |choice: &&String| choice.to_lowercase() == line.to_lowercase();
    let mut same = choices.iter().filter(is_same);
    let only = same.next().filter(|_| same.next().is_none());
    let number = line.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let numbered = number.and_then(|index| choices.get(index));
    exact.or(only).or(numbered).cloned().ok_or_else(|| {
        format!(
            "`{line}` is none of {}, nor a number from 1 to {}",
            choices.join(", "),
            choices.len()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn question(choices: &[&str]) -> Question {
        let choices = choices.iter().map(|&choice| choice.to_owned()).collect();
        Question { question: 1, text: "?".to_owned(), choices, ..Question::default() }
    }

    #[test]
    fn a_line_is_a_choice_or_its_number() {
        let chosen = |choices: &[&str], line| choose(&question(choices), line).ok();
        let yes_no = &["yes", "no"];
        assert_eq!(chosen(yes_no, "no").as_deref(), Some("no"));
        assert_eq!(chosen(yes_no, "NO").as_deref(), Some("no"));
        assert_eq!(chosen(yes_no, "1").as_deref(), Some("yes"));
        for wrong in ["", "0", "3", "y", "-1"] {
            assert_eq!(chosen(yes_no, wrong), None, "{wrong:?}");
        }
        assert_eq!(chosen(&["3", "1"], "1").as_deref(), Some("1"), "a choice, not a number");
        assert_eq!(chosen(&["A", "a"], "a").as_deref(), Some("a"));
        assert_eq!(chosen(&["Ab", "aB"], "ab"), None, "it could be either");
    }

    #[test]
    fn any_line_is_a_text() {
        assert_eq!(choose(&question(&[]), "SN-17").as_deref(), Ok("SN-17"));
        assert!(choose(&question(&[]), "").is_err());
        assert!(choose(&question(&[]), "\u{1b}[A").is_err());
    }

    #[test]
    fn a_ci_system_sets_its_variable() {
        for (value, expected) in
            [(None, false), (Some(""), false), (Some("false"), false), (Some("true"), true)]
        {
            assert_eq!(is_ci(value), expected, "{value:?}");
        }
    }
}
