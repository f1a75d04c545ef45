//! The operator of a worker is at the terminal of `rtf campaign run`. Standard input of the worker is
//! a socket: lines of JSON with the question that can be answered, and with answers.

use std::io::{self, BufRead as _, BufReader, Read, Write as _};
use std::os::fd::AsFd as _;
use std::os::unix::net::UnixStream;
use std::sync::Arc;

use rtf_engine::run::{Control, QuestionReply};
use rtf_model::{Respondent, TestId};
use rtf_report::console::{AskedHere, Operator};
use serde::{Deserialize, Serialize};

use crate::control::ControlChannels;

/// Makes a run end when its standard input closes, a socket over which its questions are answered.
pub const OPERATOR_ON_STDIN: &str = "--operator-on-stdin";

/// An answer for a worker.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CampaignAnswer {
    pub test: TestId,
    pub question: u32,
    /// Missing if the operator declines to answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer: Option<String>,
    pub by: Respondent,
}

/// In a worker: passes its questions on, and reads the answers in a thread that ends with the
/// process.
///
/// # Errors
/// The thread cannot be started.
pub fn start(control: Arc<ControlChannels>) -> io::Result<Operator> {
    let mut socket = UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?);
    let answers = BufReader::new(socket.try_clone()?);
    let read = move || {
        for line in answers.lines().map_while(Result::ok) {
            let Ok(answer) = serde_json::from_str(&line) else { continue };
            let CampaignAnswer { test, question, answer, by } = answer;
            let reply = QuestionReply { question, answer, by };
            let control_answer = Control::Answer { test, reply };
            control.controls.send_modify(|controls| controls.push(control_answer));
        }
    };
    std::thread::Builder::new().name("answers".to_owned()).spawn(read)?;
    Ok(Box::new(move |current: Option<AskedHere>| {
        // Without the campaign, the guard ends the run.
        let _ = serde_json::to_string(&current).map(|line| writeln!(socket, "{line}"));
    }))
}

/// In a campaign: the questions of a worker.
#[derive(Debug)]
pub struct WorkerQuestions {
    /// Does not block.
    socket: UnixStream,
    /// What has been read of a line.
    partial: Vec<u8>,
    current: Option<AskedHere>,
}

impl WorkerQuestions {
    /// The questions, and the standard input of the worker.
    ///
    /// # Errors
    /// The system refused.
    pub fn open() -> io::Result<(Self, UnixStream)> {
        let (socket, theirs) = UnixStream::pair()?;
        socket.set_nonblocking(true)?;
        Ok((Self { socket, partial: Vec::new(), current: None }, theirs))
    }

    /// The question that can be answered now.
    pub fn current(&mut self) -> Option<&AskedHere> {
        // What has arrived; at the end of the worker, nothing more does.
        let _ = self.socket.read_to_end(&mut self.partial);
        while let Some(end) = self.partial.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.partial.drain(..=end).collect();
            self.current = serde_json::from_slice(&line).unwrap_or_default();
        }
        self.current.as_ref()
    }

    /// Passes an answer to the worker, which may have ended.
    pub fn answer(&mut self, answer: &CampaignAnswer) {
        let _ = serde_json::to_string(answer).map(|line| writeln!(self.socket, "{line}"));
    }
}

#[cfg(test)]
mod tests {
    use rtf_model::Question;

    use super::*;

    #[test]
    fn the_last_complete_line_is_the_question_that_can_be_answered() {
        let (mut questions, mut worker) = WorkerQuestions::open().expect("a socket");
        assert_eq!(questions.current(), None);
        let question =
            Question { question: 3, text: "Did it?\nReally?".to_owned(), ..Question::default() };
        let asked = AskedHere {
            test: TestId(2),
            name: "fold/Outcome".to_owned(),
            episode: Some(7),
            picture: None,
            question,
        };
        let line = serde_json::to_string(&Some(&asked)).expect("a line");
        let (first, rest) = line.split_at(20);
        worker.write_all(first.as_bytes()).expect("written");
        assert_eq!(questions.current(), None, "the line is not complete");
        worker.write_all(format!("{rest}\n").as_bytes()).expect("written");
        assert_eq!(questions.current(), Some(&asked));
        worker.write_all(b"null\n").expect("written");
        assert_eq!(questions.current(), None, "it has ended");
        drop(worker);
        assert_eq!(questions.current(), None);
    }
}
