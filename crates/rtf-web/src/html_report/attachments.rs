//! The attachments of a report: small ones are in it, large ones next to it.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rtf_model::Attachment;
use rtf_report::output_file;

use crate::address::encoded;
use crate::attached_file::{ServedType, is_attachment};
use crate::index::AttachmentInfo;
use crate::regular_file;

/// Larger attachments are next to the report.
const EMBEDDED_BYTES: u64 = 512 << 10;

/// The maximum size of all attachments in the report.
const ALL_EMBEDDED_BYTES: u64 = 32 << 20;

/// Where the attachments of a report are.
#[derive(Debug)]
pub struct AttachmentFiles {
    /// The run directory.
    run: PathBuf,
    large: LargeFiles,
    embedded: u64,
}

/// The place of large attachments.
#[derive(Debug)]
enum LargeFiles {
    /// The report is in the run directory: they are where they are.
    RunDirectory,
    /// They are copied to this directory.
    Copies { directory: PathBuf, name: String },
    /// Standard output.
    Nowhere,
}

impl AttachmentFiles {
    /// The attachments of the run with this journal, for a report at `output`.
    pub fn new(journal: &Path, output: Option<&Path>) -> Self {
        let run = parent(journal);
        let large = output.and_then(|path| copies(path, &run)).unwrap_or(LargeFiles::Nowhere);
        Self { run, large, embedded: 0 }
    }

    /// The address of an attachment in the report; empty if the report omits it.
    ///
    /// # Errors
    /// It cannot be read, or cannot be copied.
    pub fn url(&mut self, attachment: &Attachment) -> io::Result<String> {
        let path = &*attachment.path;
        // Tests are not trusted: a path may be anything, and a file may have become a link.
        let opened = is_attachment(path).then(|| regular_file::open(&self.run, Path::new(path)));
        let Some(Ok(mut file)) = opened else { return Ok(String::new()) };
        let length = file.metadata()?.len();
        let is_small = length <= EMBEDDED_BYTES && self.embedded + length <= ALL_EMBEDDED_BYTES;
        if is_small {
            self.embedded += length;
            let mut content = Vec::new();
            file.take(EMBEDDED_BYTES).read_to_end(&mut content)?;
            return Ok(data_url(attachment, &content));
        }
        match &self.large {
            LargeFiles::Nowhere => Ok(String::new()),
            LargeFiles::RunDirectory => Ok(encoded(path)),
            LargeFiles::Copies { directory, name } => {
                let below = path.split_once('/').map_or(path, |(_, below)| below);
                copy(&mut file, &directory.join(below))?;
                Ok(encoded(&format!("{name}/{below}")))
            }
        }
    }
}

fn parent(file: &Path) -> PathBuf {
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    parent.unwrap_or(Path::new(".")).to_owned()
}

/// Where large attachments of a report at `output` are.
fn copies(output: &Path, run: &Path) -> Option<LargeFiles> {
    // A pipe or a terminal has no directory for files. `/dev/stdout` has none either, even if it
    // is a file.
    let is_stream = std::fs::metadata(output).is_ok_and(|found| !found.is_file());
    if is_stream || output.starts_with("/dev") {
        return None;
    }
    let directory = parent(output);
    let is_run = run.canonicalize().ok().zip(directory.canonicalize().ok());
    if is_run.is_some_and(|(run, directory)| run == directory) {
        return Some(LargeFiles::RunDirectory);
    }
    let name = format!("{}_files", output.file_stem()?.to_string_lossy());
    Some(LargeFiles::Copies { directory: directory.join(&name), name })
}

fn copy(file: &mut File, path: &Path) -> io::Result<()> {
    let copied = output_file::write("an attachment of the report", path, |out| {
        io::copy(file, out).map(drop)
    });
    copied.map_err(io::Error::other)
}

fn data_url(attachment: &Attachment, content: &[u8]) -> String {
    let info = AttachmentInfo::of(attachment);
    let media_type = ServedType::of(&attachment.path, Some(&info)).content_type();
    format!("data:{media_type};base64,{}", STANDARD.encode(content))
}
