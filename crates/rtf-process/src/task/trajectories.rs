//! Compares the signals of a test with stored trajectories. The comparison runs in a thread, as the
//! copy of an attachment does: the test's later messages and its deadlines wait for it.

use std::path::PathBuf;

use rtf_golden::{Comparison, Deviation, MEDIA_TYPE, Reference, Trajectory, thin};
use rtf_model::protocol::Notification;
use rtf_model::{
    Alignment, Attachment, Measurement, Message, MessageKind, Phase, Samples, TrajectoryCheck,
    format_rounded,
};

use super::attachments::replace_unsafe;
use super::file_copy::FileCopy;
use super::references::{open_reference, outside_of_suite};
use super::{ProcessEvent, ProcessTask};

/// The most samples of a test that are kept for comparisons: 16 MB.
const MAX_SAMPLES: usize = 1_000_000;

/// The longest stored trajectory, in bytes.
const MAX_REFERENCE_BYTES: u64 = 64 * 1024 * 1024;

/// The part of the tolerance by which a stored trajectory may differ from the samples.
const THINNING: f64 = 0.1;

/// The part of the tolerance to which values are rounded in messages.
const SHOWN_PART: f64 = 0.01;

/// The part of the reference's duration by which times may differ without `band`.
const DEFAULT_BAND: f64 = 0.1;

/// The samples that a test has taken so far.
#[derive(Debug, Default)]
pub(super) struct SampledSignals {
    signals: Vec<SampledSignal>,
    count: usize,
}

#[derive(Debug)]
struct SampledSignal {
    name: String,
    unit: String,
    points: Vec<(f64, Option<f64>)>,
}

/// The trajectory of a signal.
#[derive(Debug)]
struct SampledTrajectory {
    trajectory: Trajectory,
    /// The time of its first sample.
    start: f64,
    unit: String,
}

impl SampledSignals {
    fn add(&mut self, samples: &Samples) {
        self.count += samples.points.len();
        if self.count > MAX_SAMPLES {
            self.signals.clear();
            return;
        }
        let known = self.signals.iter_mut().find(|signal| signal.name == samples.name);
        match known {
            Some(signal) => signal.points.extend(&samples.points),
            None => self.signals.push(SampledSignal {
                name: samples.name.clone(),
                unit: samples.unit.clone(),
                points: samples.points.clone(),
            }),
        }
    }

    /// The trajectory of a signal and its unit, or why there is none.
    fn trajectory(&self, name: &str) -> Result<SampledTrajectory, String> {
        if self.count > MAX_SAMPLES {
            return Err(format!("the test took more than {MAX_SAMPLES} samples"));
        }
        let Some(signal) = self.signals.iter().find(|signal| signal.name == name) else {
            return Err("the test has not sampled this signal".to_owned());
        };
        let mut points: Vec<(f64, f64)> = Vec::with_capacity(signal.points.len());
        for (time, value) in &signal.points {
            let value = value.unwrap_or(f64::NAN);
            // Of several samples at one time, the last one counts.
            match points.last_mut() {
                Some(last) if last.0 == *time => last.1 = value,
                _ => points.push((*time, value)),
            }
        }
        let trajectory = Trajectory::new(&points).map_err(|error| error.to_string())?;
        let start = points.first().map_or(0.0, |(time, _)| *time);
        Ok(SampledTrajectory { trajectory, start, unit: signal.unit.clone() })
    }
}

impl ProcessTask {
    /// Keeps the samples of the test.
    pub(super) fn record_samples(&mut self, notification: &Notification) {
        match notification {
            // A host can run several tests.
            Notification::Phase { phase: Phase::Setup } => {
                self.samples = SampledSignals::default();
                self.trajectories.clear();
                self.pictures.clear();
            }
            Notification::Sampled(samples) => self.samples.add(samples),
            _ => {}
        }
    }

    /// Compares a signal, attaches it as a candidate for the stored trajectory, and reports the
    /// result.
    pub(super) async fn check_trajectory(&mut self, check: TrajectoryCheck) {
        let relative = &self.job.attachments_dir;
        let name: String = check.name.chars().map(replace_unsafe).collect();
        self.trajectories.push(check.name.clone());
        let file = format!("{name}-{}.trajectory.csv", self.trajectories.len());
        let earlier = self.trajectories.iter().filter(|other| **other == check.name).count();
        let label = match earlier {
            1 => format!("trajectory/{}", check.name),
            number => format!("trajectory/{}#{number}", check.name),
        };
        let attachment = Attachment {
            name: format!("trajectory {}", check.name),
            path: format!("{relative}/{file}"),
            media_type: MEDIA_TYPE.to_owned(),
            case: check.case,
            ..Attachment::default()
        };
        let candidate = self.context.run_dir.join(relative).join(&file);
        let working_dir = self.job.launch.request.working_dir.clone().unwrap_or_default();
        let run =
            self.context.run_dir.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let started = self.samples.trajectory(&check.name).and_then(|sampled| {
            let job =
                TrajectoryJob { check: check.clone(), sampled, label, working_dir, candidate, run };
            let reported = attachment.path.clone();
            FileCopy::start_job(attachment, &reported, move || job.run())
                .map_err(|error| error.to_string())
        });
        match started {
            Ok(copy) => {
                self.copy = Some(copy);
                self.report(ProcessEvent::Throttled).await;
            }
            Err(why) => {
                let text = format!("trajectory `{}` cannot be checked: {why}", check.name);
                let message = message(&check, MessageKind::Error, text);
                self.report(ProcessEvent::Notified(message)).await;
            }
        }
    }
}

fn message(check: &TrajectoryCheck, kind: MessageKind, text: String) -> Notification {
    let location = check.location.clone();
    Notification::Message(Message { case: check.case, ..Message::new(kind, text, location) })
}

/// A comparison in its thread.
struct TrajectoryJob {
    check: TrajectoryCheck,
    sampled: SampledTrajectory,
    /// The prefix of measurements and signals.
    label: String,
    working_dir: PathBuf,
    candidate: PathBuf,
    /// The name of the run.
    run: String,
}

impl TrajectoryJob {
    /// Writes the candidate, and returns what the test reports.
    fn run(&self) -> std::io::Result<Vec<Notification>> {
        let error = |why: String| {
            let text = format!("trajectory `{}` cannot be checked: {why}", self.check.name);
            vec![message(&self.check, MessageKind::Error, text)]
        };
        if let Some(why) = self.invalid_arguments() {
            // An attachment that does not exist would be a second error.
            self.write_candidate(1e-9)?;
            return Ok(error(why));
        }
        self.write_candidate(self.check.tolerance * THINNING)?;
        let reference = match self.reference() {
            Ok(reference) => reference,
            Err(why) => return Ok(error(why)),
        };
        if let Some(unit) = reference.field("unit")
            && unit != self.sampled.unit
        {
            let why =
                format!("its unit is `{}`, that of the reference `{unit}`", self.sampled.unit);
            return Ok(error(why));
        }
        Ok(self.compare(&reference.trajectory))
    }

    fn invalid_arguments(&self) -> Option<String> {
        let TrajectoryCheck { tolerance, band, reference, .. } = &self.check;
        if !(tolerance.is_finite() && *tolerance > 0.0) {
            return Some(format!("the tolerance is {tolerance}, expected a number above 0"));
        }
        if band.is_some_and(|band| !(band.is_finite() && band >= 0.0)) {
            return Some("the band is not a number of seconds".to_owned());
        }
        outside_of_suite(reference)
    }

    fn write_candidate(&self, error: f64) -> std::io::Result<()> {
        let thinned = thin(&self.sampled.trajectory, error);
        let mut fields = vec![("signal".to_owned(), self.check.name.clone())];
        fields.push(("unit".to_owned(), self.sampled.unit.clone()));
        fields.push(("tolerance".to_owned(), self.check.tolerance.to_string()));
        fields.push(("reference".to_owned(), self.check.reference.clone()));
        if self.check.align == Alignment::Dtw {
            fields.push(("align".to_owned(), "dtw".to_owned()));
            let band = self.check.band.unwrap_or(self.sampled.trajectory.duration() * DEFAULT_BAND);
            fields.push(("band".to_owned(), band.to_string()));
        }
        let reference = Reference::new(fields, &thinned).map_err(std::io::Error::other)?;
        std::fs::create_dir_all(self.candidate.parent().unwrap_or(&self.candidate))?;
        std::fs::write(&self.candidate, reference.to_string())
    }

    fn reference(&self) -> Result<Reference, String> {
        let name = &self.check.reference;
        let file = open_reference(&self.working_dir, name, ("trajectory", &self.run))?;
        let mut text = String::new();
        let mut limited = std::io::Read::take(file, MAX_REFERENCE_BYTES);
        std::io::Read::read_to_string(&mut limited, &mut text)
            .map_err(|error| format!("cannot read `{name}`: {error}"))?;
        Reference::parse(&text).map_err(|error| format!("`{name}` is not a trajectory: {error}"))
    }

    fn compare(&self, expected: &Trajectory) -> Vec<Notification> {
        let TrajectoryCheck { name, reference, tolerance, align, band, .. } = &self.check;
        let compared = match align {
            Alignment::Time => Some(rtf_golden::by_time(&self.sampled.trajectory, expected)),
            Alignment::Dtw => {
                let band = band.unwrap_or(expected.duration() * DEFAULT_BAND);
                rtf_golden::by_warp(&self.sampled.trajectory, expected, band)
            }
        };
        let Some(Comparison { rms, worst, aligned }) = compared else {
            let (got, wanted) = (self.sampled.trajectory.duration(), expected.duration());
            let text = format!(
                "trajectory `{name}` takes {} s, the reference `{reference}` {} s: their difference \
                 is more than the band",
                format_rounded(got),
                format_rounded(wanted)
            );
            return vec![message(&self.check, MessageKind::Failure, text)];
        };
        let text = |what: &str| {
            let Deviation { time, got, expected } = worst;
            let decimals = (-(tolerance * SHOWN_PART).log10()).ceil().clamp(0.0, 12.0) as usize;
            let with_unit =
                |value: f64| format!("{:.decimals$} {}", value + 0.0, self.sampled.unit);
            format!(
                "trajectory `{name}` {what} `{reference}`: it is {}, the reference {} at {} s, \
                 {} apart (tolerance {}, RMS {})",
                with_unit(got).trim_end(),
                with_unit(expected).trim_end(),
                format_rounded(time),
                with_unit(worst.size()).trim_end(),
                format_rounded(*tolerance),
                format_rounded(rms)
            )
        };
        let result = if worst.size() <= *tolerance {
            message(&self.check, MessageKind::Check, text("follows"))
        } else {
            message(&self.check, MessageKind::Failure, text("leaves the tube around"))
        };
        let sides = [
            self.side("low", aligned.iter().map(|it| (it.time, it.low - tolerance))),
            self.side("high", aligned.iter().map(|it| (it.time, it.high + tolerance))),
        ];
        let measured = [self.measured("worst", worst.size()), self.measured("rms", rms)];
        sides.into_iter().chain(measured).chain([result]).collect()
    }

    /// A side of the tube, as a signal: plots show it with the trajectory.
    fn side(&self, what: &str, points: impl Iterator<Item = (f64, f64)>) -> Notification {
        let start = self.sampled.start;
        Notification::Sampled(Samples {
            name: format!("{}/{what}", self.label),
            unit: self.sampled.unit.clone(),
            location: self.check.location.clone(),
            case: self.check.case,
            points: points.map(|(time, value)| (start + time, Some(value))).collect(),
            ..Samples::default()
        })
    }

    fn measured(&self, what: &str, value: f64) -> Notification {
        Notification::Measured(Measurement {
            name: format!("{}/{what}", self.label),
            value: Some(value).filter(|value| value.is_finite()),
            unit: self.sampled.unit.clone(),
            location: self.check.location.clone(),
            case: self.check.case,
            ..Measurement::default()
        })
    }
}
