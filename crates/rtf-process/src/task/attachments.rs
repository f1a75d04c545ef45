//! Stores the files that a process attaches in the run's directory.

use std::path::{Component, Path};

use rtf_model::protocol::Notification;
use rtf_model::{Attachment, Question};
use tokio::sync::mpsc;

use super::file_copy::{self, FileCopy};
use super::{ProcessCommand, ProcessEvent, ProcessTask};

impl ProcessTask {
    /// Returns a directory of the run as an absolute path.
    pub(super) fn absolute(&self, dir: &str) -> String {
        self.context.run_dir.join(dir).to_string_lossy().into_owned()
    }

    /// Reports an attachment with its path relative to the run's directory, and copies the
    /// file if the host did not. A picture of a test is compared. The process's later messages and its deadlines wait for
    /// the copy.
    pub(super) async fn store_attachment(&mut self, attachment: Attachment) {
        if attachment.picture.is_some() && !self.is_test() {
            let why =
                format!("it compares the picture `{}`, which only tests can", attachment.name);
            return self.report(ProcessEvent::Attached(Err(why))).await;
        }
        let relative = &self.job.attachments_dir;
        let dir = self.context.run_dir.join(relative);
        let working_dir = self.job.launch.request.working_dir.clone().unwrap_or_default();
        let source = working_dir.join(&attachment.path);
        let copy = path_in(&dir, &source);
        let is_copied = copy.is_some();
        let name = copy.unwrap_or_else(|| attachment.name.chars().map(replace_unsafe).collect());
        let reported_path = attachment.path.clone();
        let attachment =
            Attachment { path: format!("{relative}/{name}"), omitted: false, ..attachment };
        let picture = self.picture_job(&attachment);
        let started = match (is_copied, picture) {
            (true, None) => file_copy::open(&source).map(|_| None),
            (true, Some(picture)) => file_copy::open(&source).and_then(|_| {
                let compare = move || Ok(picture.run());
                FileCopy::start_job(attachment.clone(), &reported_path, compare).map(Some)
            }),
            (false, picture) => {
                let from = (reported_path.as_str(), source);
                let compare = move || picture.map(|it| it.run()).unwrap_or_default();
                FileCopy::start(attachment.clone(), from, (dir.join(&name), compare)).map(Some)
            }
        };
        match started {
            Ok(None) => self.report_attachment(attachment, &reported_path, Ok(())).await,
            Ok(Some(copy)) => {
                self.copy = Some(copy);
                self.report(ProcessEvent::Throttled).await;
            }
            Err(error) => self.report_attachment(attachment, &reported_path, Err(error)).await,
        }
    }

    /// Makes the path of a question's picture relative to the run's directory. Only a file in
    /// the directory for attachments is a picture.
    pub(super) fn with_picture(&self, mut question: Question) -> Question {
        let relative = &self.job.attachments_dir;
        let dir = self.context.run_dir.join(relative);
        question.picture = question.picture.take().and_then(|path| {
            let name = Path::new(&path).strip_prefix(&dir).ok()?.to_str()?;
            let is_name = !name.is_empty() && !name.contains('/') && name != "..";
            is_name.then(|| format!("{relative}/{name}"))
        });
        question
    }

    /// Reports the copied attachment and the results of its job, and delivers the messages held
    /// back.
    pub(super) async fn copy_finished(&mut self, result: std::io::Result<Vec<Notification>>) {
        let Some(copy) = self.copy.take() else { return };
        if !self.throttle.is_throttled {
            self.report(ProcessEvent::Resumed).await;
        }
        let (result, reports) = match result {
            Ok(reports) => (Ok(()), reports),
            Err(error) => (Err(error), Vec::new()),
        };
        self.report_attachment(copy.attachment.clone(), &copy.reported_path, result).await;
        for report in reports {
            let event = match report {
                Notification::Attached(attachment) => ProcessEvent::Attached(Ok(attachment)),
                other => ProcessEvent::Notified(other),
            };
            self.report(event).await;
        }
        self.deliver().await;
    }

    async fn report_attachment(
        &mut self,
        attachment: Attachment,
        reported_path: &str,
        result: std::io::Result<()>,
    ) {
        let result = result
            .map(|()| attachment)
            .map_err(|error| format!("`{reported_path}` cannot be attached: {error}"));
        self.report(ProcessEvent::Attached(result)).await;
    }

    /// Abandons the current copy: the process is being stopped.
    pub(super) async fn abandon_copy(&mut self) {
        let why = "it was not copied before the process was stopped";
        self.copy_finished(Err(std::io::Error::other(why))).await;
    }

    /// The process has ended: waits for the copies, unless it is stopped.
    pub(super) async fn finish_copies(
        &mut self,
        commands: &mut mpsc::UnboundedReceiver<ProcessCommand>,
    ) {
        while let Some(copy) = &mut self.copy {
            tokio::select! {
                biased;
                Some(command) = commands.recv() => match command {
                    // It is refused later, because the process has ended.
                    ProcessCommand::Assign(assignment) => self.assign(assignment),
                    command => self.throttle.is_stopping |= command.stops(),
                },
                result = copy.wait() => self.copy_finished(result).await,
            }
            if self.throttle.is_stopping {
                self.abandon_copy().await;
            }
        }
    }
}

/// The path of a file relative to a directory that contains it.
fn path_in(dir: &Path, file: &Path) -> Option<String> {
    let path = file.strip_prefix(dir).ok()?;
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    (is_inside && path.file_name().is_some()).then(|| path.to_string_lossy().into_owned())
}

pub(super) fn replace_unsafe(character: char) -> char {
    if character.is_alphanumeric() || matches!(character, '.' | '-' | '_') {
        character
    } else {
        '_'
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::path_in;

    #[test]
    fn only_files_below_a_directory_have_a_path_in_it() {
        let found = |file: &str| path_in(Path::new("/run/attachments"), Path::new(file));
        assert_eq!(found("/run/attachments/1-a.txt").as_deref(), Some("1-a.txt"));
        assert_eq!(
            found("/run/attachments/1-bag/metadata.yaml").as_deref(),
            Some("1-bag/metadata.yaml")
        );
        for outside in
            ["/run/attachments", "/run/attachments/../events.jsonl", "/run/a.txt", "a.txt"]
        {
            assert_eq!(found(outside), None, "{outside}");
        }
    }
}
