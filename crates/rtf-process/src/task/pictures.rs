//! Compares attached pictures of a test with stored ones, in the thread of the attachment.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use rtf_golden::{MAX_PICTURE_BYTES, Picture, PictureDifference};
use rtf_model::protocol::Notification;
use rtf_model::{Attachment, Measurement, Message, MessageKind, PictureCheck, format_rounded};

use super::ProcessTask;
use super::references::{open_reference, outside_of_suite};

/// A comparison in its thread.
pub(super) struct PictureJob {
    /// The attached picture, with its path relative to the run's directory.
    attachment: Attachment,
    check: PictureCheck,
    /// The prefix of the measurement.
    label: String,
    working_dir: PathBuf,
    run_dir: PathBuf,
}

impl ProcessTask {
    /// The comparison of an attachment, if it is a picture of a test.
    pub(super) fn picture_job(&mut self, attachment: &Attachment) -> Option<PictureJob> {
        let check = attachment.picture.as_deref()?.clone();
        self.pictures.push(attachment.name.clone());
        let earlier = self.pictures.iter().filter(|other| **other == attachment.name).count();
        let label = match earlier {
            1 => format!("picture/{}", attachment.name),
            number => format!("picture/{}#{number}", attachment.name),
        };
        Some(PictureJob {
            attachment: attachment.clone(),
            check,
            label,
            working_dir: self.job.launch.request.working_dir.clone().unwrap_or_default(),
            run_dir: self.context.run_dir.clone(),
        })
    }
}

impl PictureJob {
    /// Compares, and returns what the test reports.
    pub(super) fn run(&self) -> Vec<Notification> {
        self.compare().unwrap_or_else(|why| {
            let text = format!("picture `{}` cannot be compared: {why}", self.attachment.name);
            vec![self.message(MessageKind::Error, text)]
        })
    }

    fn compare(&self) -> Result<Vec<Notification>, String> {
        let PictureCheck { reference: file, tolerance, .. } = &self.check;
        if !(tolerance.is_finite() && *tolerance >= 0.0) {
            return Err(format!("the tolerance is {tolerance}, expected a number of at least 0"));
        }
        if let Some(why) = outside_of_suite(file) {
            return Err(why);
        }
        let path = self.run_dir.join(&self.attachment.path);
        let unreadable = |error| format!("cannot read it: {error}");
        let got = read(super::file_copy::open(&path).map_err(unreadable)?)?;
        let got = Picture::decode(&got).map_err(|error| error.to_string())?;
        let run = self.run_dir.file_name().unwrap_or_default().to_string_lossy();
        let stored = open_reference(&self.working_dir, file, ("picture", &run))?;
        let damaged = |why: String| format!("the reference `{file}`: {why}");
        let bytes = read(stored).map_err(damaged)?;
        let expected = Picture::decode(&bytes).map_err(|error| damaged(error.to_string()))?;
        let difference =
            PictureDifference::of(&got, &expected).map_err(|error| error.to_string())?;
        let mut reports = Vec::new();
        if difference.size > 0.0 {
            let drawn = difference.picture(&expected).map_err(|error| error.to_string())?;
            let kind = (expected.ending(), expected.media_type());
            reports.push(self.attach("reference", kind, &bytes)?);
            reports.push(self.attach("difference", ("png", "image/png"), &drawn)?);
        }
        reports.push(self.measured(difference.size));
        reports.push(self.judged(&difference));
        Ok(reports)
    }

    fn judged(&self, difference: &PictureDifference) -> Notification {
        let PictureCheck { reference, tolerance, .. } = &self.check;
        let (name, (x, y)) = (&self.attachment.name, difference.worst);
        let numbers = format!(
            "difference {} (tolerance {})",
            format_rounded(difference.size),
            format_rounded(*tolerance)
        );
        if difference.size <= *tolerance {
            let text = format!("picture `{name}` resembles `{reference}`: {numbers}");
            return self.message(MessageKind::Check, text);
        }
        let text = format!(
            "picture `{name}` differs from `{reference}`: {numbers}, most around column {x}, row {y}"
        );
        self.message(MessageKind::Failure, text)
    }

    /// Writes a file next to the picture.
    fn attach(
        &self,
        what: &str,
        (ending, media_type): (&str, &str),
        bytes: &[u8],
    ) -> Result<Notification, String> {
        let path = Path::new(&self.attachment.path);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let path = path.with_file_name(format!("{stem}-{what}.{ending}"));
        std::fs::write(self.run_dir.join(&path), bytes)
            .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
        Ok(Notification::Attached(Attachment {
            name: format!("{} {what}", self.attachment.name),
            path: path.to_string_lossy().into_owned(),
            media_type: media_type.to_owned(),
            case: self.attachment.case,
            ..Attachment::default()
        }))
    }

    fn measured(&self, difference: f64) -> Notification {
        Notification::Measured(Measurement {
            name: format!("{}/difference", self.label),
            value: Some(difference),
            location: self.check.location.clone(),
            case: self.attachment.case,
            ..Measurement::default()
        })
    }

    fn message(&self, kind: MessageKind, text: String) -> Notification {
        let (location, case) = (self.check.location.clone(), self.attachment.case);
        Notification::Message(Message { case, ..Message::new(kind, text, location) })
    }
}

fn read(file: File) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut limited = file.take(MAX_PICTURE_BYTES + 1);
    limited.read_to_end(&mut bytes).map_err(|error| format!("cannot read it: {error}"))?;
    match bytes.len() as u64 {
        size if size > MAX_PICTURE_BYTES => {
            Err(format!("it is larger than {} MiB", MAX_PICTURE_BYTES / 1024 / 1024))
        }
        _ => Ok(bytes),
    }
}
