//! Files that a process attaches, in the run's folder.

use rtf_model::{Attachment, Source};

use super::Task;
use crate::run::machine::HostId;

impl Task {
    /// The folder for what this process attaches, relative to the run's.
    pub(super) fn keep_folder(&self) -> String {
        keep_folder(self.job.source, self.job.host)
    }

    /// Names an attached file relative to the run's folder. A host that did not
    /// copy it there itself has it copied now.
    pub(super) async fn keep(&self, attachment: Attachment) -> Result<Attachment, String> {
        let folder = self.keep_folder();
        let own = self.shared.run_folder.join(&folder);
        let work = self.job.launch.request.folder.clone().unwrap_or_default();
        let source = work.join(&attachment.path);
        let cannot =
            |error: std::io::Error| format!("`{}` cannot be attached: {error}", attachment.path);
        let copied = source.parent() == Some(own.as_path());
        let name = match (copied, source.file_name()) {
            (true, Some(name)) => name.to_string_lossy().into_owned(),
            _ => attachment.name.chars().map(safe).collect(),
        };
        if copied {
            tokio::fs::metadata(&source).await.map_err(cannot)?;
        } else {
            tokio::fs::create_dir_all(&own).await.map_err(cannot)?;
            tokio::fs::copy(&source, own.join(&name)).await.map_err(cannot)?;
        }
        Ok(Attachment { path: format!("{folder}/{name}"), ..attachment })
    }
}

/// The folder for what a process attaches while it has this id.
pub(super) fn keep_folder(source: Source, host: HostId) -> String {
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
