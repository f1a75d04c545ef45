//! Files that tests attached, in the directories of the runs and of the merged run.

use std::path::{Component, Path, PathBuf};

use rtf_model::EventKind;

use super::MergeInput;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachedFile {
    /// The directory of the run in which it was attached.
    pub dir: PathBuf,
    /// The path in that directory.
    pub source: String,
    /// The path in the directory of the merged run.
    pub target: String,
}

impl AttachedFile {
    /// The file that an event of a run attaches, if it is in the run's attachments and kept.
    /// `part` is the run's place, from 0.
    pub(super) fn of(part: usize, run: &MergeInput, kind: &EventKind) -> Option<Self> {
        let EventKind::Attached { attachment, .. } = kind else { return None };
        if attachment.omitted {
            return None;
        }
        let dir = run.journal.parent().unwrap_or(Path::new(".")).to_owned();
        let target = attachment_path(part, &attachment.path)?;
        Some(Self { dir, source: attachment.path.clone(), target })
    }

    /// Where it is; `None` if it is missing. Refuses links to files outside of the attachments:
    /// the run may come from another machine.
    #[must_use]
    pub fn resolve(&self) -> Option<PathBuf> {
        let attachments = self.dir.join("attachments").canonicalize().ok()?;
        let file = self.dir.join(&self.source).canonicalize().ok()?;
        (file.starts_with(attachments) && file.is_file()).then_some(file)
    }
}

/// The path of an attachment in the merged run, relative to the run directories
/// of both; `None` if `path` is not in a run's attachments.
/// `part` is the run's place, from 0.
#[must_use]
pub fn attachment_path(part: usize, path: &str) -> Option<String> {
    let rest = Path::new(path).strip_prefix("attachments").ok()?;
    let plain = rest.components().all(|part| matches!(part, Component::Normal(_)));
    let rest = rest.to_str().filter(|rest| plain && !rest.is_empty())?;
    Some(format!("attachments/part-{}/{rest}", part + 1))
}
