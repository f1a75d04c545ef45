//! A recording, whose samples are played in each test.

use std::io::{BufRead, BufReader};

use crate::command::{self, shown};
use crate::line;
use crate::settings::RecordingSettings;

/// The most samples of a recording, which are kept in memory.
const LIMIT: usize = 20_000_000;

/// The samples of a recording.
#[derive(Debug, Default)]
pub(crate) struct Recording {
    samples: Vec<RecordedSample>,
}

/// A sample; its time is in seconds since the start of the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RecordedSample {
    pub time: f64,
    /// The index of the signal.
    pub signal: usize,
    pub value: f64,
}

impl Recording {
    /// Runs the program that reads the recording, to its end.
    ///
    /// # Errors
    /// It failed, or wrote something else than samples.
    pub fn read(settings: &RecordingSettings) -> Result<Self, String> {
        let command = shown(&settings.words);
        let mut reading = command::of(&settings.words)?;
        let failed = |error: std::io::Error| format!("{command}: {error}");
        let mut child = reading.spawn().map_err(failed)?;
        let output = child.stdout.take().ok_or("the program has no output")?;
        let samples = samples(BufReader::new(output), settings);
        // A program that still writes ends by SIGPIPE.
        let status = child.wait().map_err(failed)?;
        let samples = samples.map_err(|problem| format!("{problem}: {command}"))?;
        if !status.success() {
            return Err(format!("the recording cannot be read: {command} ended with {status}"));
        }
        Ok(Self { samples })
    }

    /// The sample with this index, if it is due.
    pub fn sample(&self, index: usize, elapsed: f64) -> Option<RecordedSample> {
        self.samples.get(index).copied().filter(|sample| sample.time <= elapsed)
    }
}

fn samples(
    output: impl BufRead,
    settings: &RecordingSettings,
) -> Result<Vec<RecordedSample>, String> {
    let mut values = vec![None; settings.count];
    let mut samples = Vec::new();
    for text in output.lines() {
        let text = text.map_err(|error| error.to_string())?;
        let time = line::parse(&text, true, &mut values)
            .map_err(|expected| format!("the program wrote `{text}`, {expected}"))?
            .unwrap_or_default();
        for (offset, value) in values.iter().enumerate() {
            let signal = settings.first_signal + offset;
            samples.extend(value.map(|value| RecordedSample { time, signal, value }));
        }
        if samples.len() > LIMIT {
            return Err(format!("the recording has more than {LIMIT} samples"));
        }
    }
    samples.sort_by(|one, other| one.time.total_cmp(&other.time));
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(script: &str, count: usize) -> RecordingSettings {
        let words = ["sh", "-c", script].map(str::to_owned).to_vec();
        RecordingSettings { words, first_signal: 2, count }
    }

    #[test]
    fn samples_are_in_the_order_of_their_times() {
        let recording = Recording::read(&settings("echo 0.5 1 -; echo 0 - nan; echo 0.5 - 3", 2));
        let recording = recording.unwrap();
        let at = |index| recording.sample(index, 0.5).map(|it| (it.time, it.signal, it.value));
        assert!(at(0).is_some_and(|(time, signal, value)| {
            (time, signal, value.is_nan()) == (0.0, 3, true)
        }));
        assert_eq!(at(1), Some((0.5, 2, 1.0)));
        assert_eq!(at(2), Some((0.5, 3, 3.0)));
        assert_eq!(at(3), None);
        assert_eq!(recording.sample(1, 0.4), None);
    }

    #[test]
    fn problems_of_the_program_are_reported() {
        for (script, problem) in [
            ("exit 3", "cannot be read: `sh -c exit 3` ended with exit status: 3"),
            ("echo 1 x", "the program wrote `1 x`, expected a time and 1 value"),
        ] {
            let error = Recording::read(&settings(script, 1)).unwrap_err();
            assert!(error.contains(problem), "{error}");
        }
    }
}
