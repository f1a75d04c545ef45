//! The person who can answer questions of tests: who is there, and the answers on the terminal of a
//! run or of a campaign.

use std::io::{self, Write};
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
use rustix::termios::{QueueSelector, tcflush};

pub use self::attendance::Attendance;
use self::foreground::{BorrowedForeground, Foreground, foreground, guard_group};
pub use self::foreground::{has_foreground, recover_terminal};
use crate::control::ControlChannels;

mod attendance;
pub mod campaign;
mod foreground;

/// The longest line that a terminal passes.
const LINE_BYTES: usize = 4096;

/// How often it is checked whether a question is still open.
const POLL: Timespec = Timespec { tv_sec: 0, tv_nsec: 200_000_000 };

/// How often a process in the background checks whether it has the terminal.
const BACKGROUND: Duration = Duration::from_millis(500);

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
        return campaign::start(control.clone()).map(Some);
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
}
