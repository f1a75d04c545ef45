//! Files that a process attaches, in the run's folder.

use rtf_model::{Attachment, Source};
use tokio::sync::mpsc;

use super::copy::{self, Copy};
use super::{Order, Task};
use crate::run::machine::{HostId, HostInput};

impl Task {
    /// The folder for what this process attaches, relative to the run's.
    pub(super) fn attachments_dir(&self) -> String {
        attachments_dir(self.job.source, self.job.host)
    }

    /// Names an attached file relative to the run's folder. A host that did not copy it
    /// there itself has it copied now: what it tells next waits for that, and so do its
    /// deadlines.
    pub(super) async fn keep(&mut self, attachment: Attachment) {
        let folder = self.attachments_dir();
        let own = self.shared.run_folder.join(&folder);
        let work = self.job.launch.request.folder.clone().unwrap_or_default();
        let source = work.join(&attachment.path);
        let is_copied = source.parent() == Some(own.as_path());
        let name = match (is_copied, source.file_name()) {
            (true, Some(name)) => name.to_string_lossy().into_owned(),
            _ => attachment.name.chars().map(safe).collect(),
        };
        let given = attachment.path.clone();
        let attachment = Attachment { path: format!("{folder}/{name}"), ..attachment };
        let begun = if is_copied {
            copy::open(&source).map(|_| None)
        } else {
            Copy::begin(attachment.clone(), (&given, source), own.join(&name)).map(Some)
        };
        match begun {
            Ok(None) => self.kept(attachment, &given, Ok(())).await,
            Ok(Some(copy)) => {
                self.copy = Some(copy);
                self.tell(HostInput::Throttled(self.job.source)).await;
            }
            Err(error) => self.kept(attachment, &given, Err(error)).await,
        }
    }

    /// The copy has ended: what was told behind it is delivered.
    pub(super) async fn copy_ended(&mut self, copied: std::io::Result<()>) {
        let Some(copy) = self.copy.take() else { return };
        if !self.throttle.is_throttled {
            self.tell(HostInput::Resumed).await;
        }
        self.kept(copy.attachment.clone(), &copy.given, copied).await;
        self.deliver().await;
    }

    async fn kept(&mut self, attachment: Attachment, given: &str, copied: std::io::Result<()>) {
        let kept = copied
            .map(|()| attachment)
            .map_err(|error| format!("`{given}` cannot be attached: {error}"));
        self.tell(HostInput::Attached(kept)).await;
    }

    /// What is being copied is not waited for: the process is being stopped.
    pub(super) async fn give_copy_up(&mut self) {
        let why = "it was not copied before the process was stopped";
        self.copy_ended(Err(std::io::Error::other(why))).await;
    }

    /// The process has ended: waits for the files that it attached, unless it is stopped.
    pub(super) async fn finish_copies(&mut self, orders: &mut mpsc::UnboundedReceiver<Order>) {
        while let Some(copy) = &mut self.copy {
            tokio::select! {
                biased;
                Some(order) = orders.recv() => match order {
                    // It is refused afterwards: the process is gone.
                    Order::ServeNext(next) => self.serve_next(next).await,
                    order => self.throttle.is_stopping |= order.stops(),
                },
                copied = copy.wait() => self.copy_ended(copied).await,
            }
            if self.throttle.is_stopping {
                self.give_copy_up().await;
            }
        }
    }
}

/// The folder for what a process attaches while it has this id.
pub(super) fn attachments_dir(source: Source, host: HostId) -> String {
    match source {
        Source::Test(id) => format!("attachments/{id}/{}", host.0),
        Source::Fixture(id) => format!("attachments/fixture-{id}/{}", host.0),
        Source::Hook(id) => format!("attachments/hook-{id}/{}", host.0),
    }
}

fn safe(character: char) -> char {
    if character.is_alphanumeric() || matches!(character, '.' | '-' | '_') {
        character
    } else {
        '_'
    }
}
