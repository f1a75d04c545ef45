//! Questions of the plug-in to an operator.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::PoisonError;
use std::time::Duration;

use rtf_model::protocol::{Notification, QuestionEnd};
use rtf_model::{Attachment, Location, Question};

use super::{Session, SessionState};

/// A question of a plug-in.
#[derive(Clone, Debug, Default)]
pub struct Inquiry {
    pub text: String,
    /// The possible answers; without them, the answer is any line of text.
    pub choices: Vec<String>,
    /// The answer if no operator answers.
    pub default: Option<String>,
    pub timeout: Duration,
    /// The path of a PNG or JPEG file.
    pub picture: Option<String>,
    /// Where in the plug-in it is asked.
    pub location: Option<Location>,
}

impl Session {
    /// Asks an operator, and waits. `None` after a stop request, and without an answer, which it
    /// has reported as an error: the plug-in then leaves the step.
    #[must_use]
    pub fn ask(&self, inquiry: Inquiry) -> Option<String> {
        let location = inquiry.location.clone();
        match self.try_ask(inquiry) {
            Ok(answer) => answer,
            Err(problem) => {
                self.error(problem, location);
                None
            }
        }
    }

    fn try_ask(&self, inquiry: Inquiry) -> Result<Option<String>, String> {
        if !self.0.cases.may_ask() {
            return Err("questions are allowed in `setup` and `run` of a test only".to_owned());
        }
        if self.0.cases.is_forked_child() {
            return Err("a process that the plug-in forked cannot ask".to_owned());
        }
        let picture = inquiry.picture.map(|path| self.attach_picture(&path)).transpose()?;
        let Inquiry { text, choices, default, timeout, location, .. } = inquiry;
        let question = self.next_question();
        let (case, timeout_ms) = (self.0.cases.current(), milliseconds(timeout));
        let asked =
            Question { question, text, choices, default, timeout_ms, picture, location, case };
        self.notify(&Notification::QuestionAsked(asked));
        let Some(QuestionEnd { answer, problem, .. }) = self.wait_for_end(question) else {
            return Ok(None);
        };
        match (answer, problem) {
            (Some(answer), _) => Ok(Some(answer)),
            (None, problem) => Err(problem.unwrap_or_else(|| "no answer".to_owned())),
        }
    }

    fn next_question(&self) -> u32 {
        let mut state = self.state();
        state.last_question += 1;
        let question = state.last_question;
        state.questions.insert(question, None);
        question
    }

    /// Waits for the end of a question; `None` after a stop request.
    fn wait_for_end(&self, question: u32) -> Option<QuestionEnd> {
        let is_open = |state: &mut SessionState| {
            state.stop_reason.is_none() && matches!(state.questions.get(&question), Some(None))
        };
        let waited = self.0.changed.wait_while(self.state(), is_open);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner);
        state.questions.remove(&question).flatten()
    }

    /// The runner reports the end of a question.
    pub(crate) fn end_question(&self, end: &QuestionEnd) {
        if let Some(open) = self.state().questions.get_mut(&end.question) {
            *open = Some(end.clone());
        }
        self.0.changed.notify_all();
    }

    /// Attaches a picture, and returns the path of the copy.
    fn attach_picture(&self, path: &str) -> Result<String, String> {
        let attach = || -> std::io::Result<Option<String>> {
            let Some(media_type) = picture_type(Path::new(path))? else { return Ok(None) };
            let name = Path::new(path).file_name();
            let attachment = Attachment {
                name: name.map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
                path: path.to_owned(),
                media_type: media_type.to_owned(),
                case: self.0.cases.current(),
                ..Attachment::default()
            };
            self.forward_attachment(attachment).map(Some)
        };
        match attach() {
            Ok(Some(copy)) => Ok(copy),
            Ok(None) => Err(format!("the picture `{path}` is neither PNG nor JPEG")),
            Err(error) => Err(format!("the picture `{path}` cannot be attached: {error}")),
        }
    }
}

/// The media type of a picture, by its first bytes; `None` for another file.
fn picture_type(path: &Path) -> std::io::Result<Option<&'static str>> {
    let mut start = Vec::new();
    let file: File = crate::unix::open_regular(path)?;
    file.take(8).read_to_end(&mut start)?;
    Ok(if start == b"\x89PNG\r\n\x1a\n" {
        Some("image/png")
    } else if start.starts_with(b"\xff\xd8\xff") {
        Some("image/jpeg")
    } else {
        None
    })
}

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
