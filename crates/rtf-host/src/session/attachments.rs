//! Files that tests attach: they are copied before the plug-in continues.

use std::path::{Path, PathBuf};

use rtf_model::protocol::Notification;
use rtf_model::{Attachment, PictureCheck};

use super::Session;
use crate::unix;

impl Session {
    /// Copies a file into the test's results. Afterwards the plug-in may change or remove
    /// the file.
    ///
    /// # Errors
    /// It cannot be copied.
    pub fn attach(&self, mut attachment: Attachment) -> std::io::Result<()> {
        attachment.case = self.0.cases.current();
        self.forward_attachment(attachment).map(|_| ())
    }

    /// Does the same with a picture, and has it compared with a stored one. The runner compares,
    /// so the plug-in does not learn the result.
    ///
    /// # Errors
    /// It cannot be copied.
    pub fn check_picture(
        &self,
        (name, picture): (String, String),
        check: PictureCheck,
    ) -> std::io::Result<()> {
        self.attach(Attachment {
            name,
            path: picture,
            picture: Some(Box::new(check)),
            ..Attachment::default()
        })
    }

    /// Does the same for a program that the host started, which knows the case. Returns the
    /// path of the copy.
    ///
    /// # Errors
    /// It cannot be copied.
    pub fn forward_attachment(&self, mut attachment: Attachment) -> std::io::Result<String> {
        let path = Path::new(&attachment.path);
        let mut source = unix::open_regular(path)?;
        // Without a directory, the runner copies the file as soon as it can.
        if let Some(copy) = self.next_copy(&attachment.name, path) {
            std::fs::create_dir_all(copy.parent().unwrap_or(&copy))?;
            std::io::copy(&mut source, &mut std::fs::File::create(&copy)?)?;
            attachment.path = copy.to_string_lossy().into_owned();
        }
        let copy = attachment.path.clone();
        self.notify(&Notification::Attached(attachment));
        Ok(copy)
    }

    /// The path for the copy of an attached file: `3-plot.png`. A name without an
    /// extension gets that of the file.
    fn next_copy(&self, name: &str, file: &Path) -> Option<PathBuf> {
        let safe = |c: char| if c.is_alphanumeric() || ".-_".contains(c) { c } else { '_' };
        let extension = Path::new(name).extension().is_none().then(|| file.extension()).flatten();
        let extension = extension.map(|own| format!(".{}", own.to_string_lossy()));
        let name: String =
            name.chars().chain(extension.iter().flat_map(|own| own.chars())).map(safe).collect();
        let mut state = self.state();
        state.attached += 1;
        let number = state.attached;
        state.attachments_dir.as_ref().map(|dir| dir.join(format!("{number}-{name}")))
    }

    pub(crate) fn set_attachments_dir(&self, dir: Option<&str>) {
        self.state().attachments_dir = dir.map(PathBuf::from);
    }
}
