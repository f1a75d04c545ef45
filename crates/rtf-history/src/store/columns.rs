//! The results and points of a run, packed: what answers over many runs read of each.
//!
//! A run has one row with blobs. Answers over thousands of runs would otherwise read
//! millions of rows, of which decoding alone takes seconds. The format: numbers are LEB128,
//! ids ascend and are stored as differences, floating-point numbers are little-endian and NaN
//! for unknown ones. A third blob has the hashes of the sources of the results.

use std::collections::HashMap;

use rtf_model::Verdict;

use crate::entry::{NumberSummary, ResultEntry};

/// A result of a test, as answers over many runs need it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PackedResult {
    /// The row of the test.
    pub test: i64,
    pub verdict: Verdict,
    pub is_flaky: bool,
    /// The position of its robot in [`PackedResults::robots`].
    pub robot: usize,
    pub duration_us: Option<i64>,
    /// The hash of its sources.
    pub source: Option<u64>,
}

impl PackedResult {
    pub fn new(test: i64, result: &ResultEntry) -> Self {
        let ResultEntry { verdict, is_flaky, duration_us, .. } = *result;
        let source = result.source_hash.as_ref();
        let source = source.and_then(|hash| u64::from_str_radix(hash, 16).ok());
        Self { test, verdict, is_flaky, robot: 0, duration_us, source }
    }
}

/// A point of a series, as answers over many runs need it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PackedPoint {
    /// The row of the series.
    pub series: i64,
    pub value: Option<f64>,
    /// Number of values outside the limits.
    pub outside: u64,
    /// The smallest and the largest accepted value.
    pub limits: [Option<f64>; 2],
}

/// Packs the results of a run.
#[derive(Debug, Default)]
pub(super) struct ResultPacker {
    robots: Vec<String>,
    results: Vec<PackedResult>,
}

impl ResultPacker {
    pub fn add(&mut self, mut result: PackedResult, robot: &str) {
        let known = self.robots.iter().position(|known| known == robot);
        result.robot = known.unwrap_or(self.robots.len());
        if known.is_none() {
            self.robots.push(robot.to_owned());
        }
        self.results.push(result);
    }

    /// The results, and their sources.
    pub fn finish(mut self) -> (Vec<u8>, Vec<u8>) {
        self.results.sort_by_key(|result| result.test);
        let sources = self.sources();
        let mut blob = Vec::with_capacity(16 + 8 * self.results.len());
        push(&mut blob, self.robots.len() as u64);
        for robot in &self.robots {
            push(&mut blob, robot.len() as u64);
            blob.extend_from_slice(robot.as_bytes());
        }
        let mut ids = 0;
        for result in &self.results {
            push_id(&mut blob, &mut ids, result.test);
            push(&mut blob, (result.verdict as u64) << 1 | u64::from(result.is_flaky));
            push(&mut blob, result.robot as u64);
            let micros = result.duration_us.and_then(|micros| u64::try_from(micros).ok());
            push(&mut blob, micros.map_or(0, |micros| micros + 1));
        }
        (blob, sources)
    }

    /// The different hashes, and for each result the position of its hash, from 1, or 0.
    fn sources(&self) -> Vec<u8> {
        let (mut positions, mut hashes) = (HashMap::new(), Vec::new());
        for source in self.results.iter().filter_map(|result| result.source) {
            positions.entry(source).or_insert_with(|| {
                hashes.push(source);
                hashes.len() as u64
            });
        }
        let mut blob = Vec::with_capacity(8 + 8 * hashes.len() + self.results.len());
        push(&mut blob, hashes.len() as u64);
        hashes.iter().for_each(|hash| blob.extend_from_slice(&hash.to_le_bytes()));
        for result in &self.results {
            let position = result.source.and_then(|source| positions.get(&source));
            push(&mut blob, position.copied().unwrap_or_default());
        }
        blob
    }
}

/// Packs the points of a run.
#[derive(Debug, Default)]
pub(super) struct PointPacker(Vec<(i64, NumberSummary)>);

impl PointPacker {
    pub fn add(&mut self, series: i64, summary: &NumberSummary) {
        self.0.push((series, *summary));
    }

    pub fn finish(mut self) -> Vec<u8> {
        self.0.sort_by_key(|(series, _)| *series);
        let bits = |number: Option<f64>| number.unwrap_or(f64::NAN).to_bits();
        let limits_of = |summary: &NumberSummary| [bits(summary.low), bits(summary.high)];
        let mut positions = HashMap::new();
        let mut limits = Vec::new();
        for (_, summary) in &self.0 {
            positions.entry(limits_of(summary)).or_insert_with_key(|pair| {
                limits.push(*pair);
                limits.len() as u64 - 1
            });
        }
        let mut blob = Vec::with_capacity(32 + 12 * self.0.len());
        push(&mut blob, limits.len() as u64);
        limits.iter().flatten().for_each(|bits| blob.extend_from_slice(&bits.to_le_bytes()));
        let mut ids = 0;
        for (series, summary) in &self.0 {
            push_id(&mut blob, &mut ids, *series);
            push(&mut blob, positions.get(&limits_of(summary)).copied().unwrap_or_default());
            push(&mut blob, summary.outside);
            blob.extend_from_slice(&bits(summary.value).to_le_bytes());
        }
        blob
    }
}

/// Appends the difference to the previous id.
fn push_id(blob: &mut Vec<u8>, previous: &mut i64, id: i64) {
    push(blob, id.wrapping_sub(*previous).cast_unsigned());
    *previous = id;
}

fn push(blob: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        blob.push(number as u8 | 0x80);
        number >>= 7;
    }
    blob.push(number as u8);
}

/// Reads the results of a run, in the order of their tests. Ends early if the blob is damaged.
#[derive(Debug)]
pub(crate) struct PackedResults<'a> {
    bytes: Bytes<'a>,
    pub robots: Vec<&'a str>,
    /// The hashes of the sources.
    pub sources: Vec<u64>,
    source_bytes: Bytes<'a>,
    id: i64,
}

impl<'a> PackedResults<'a> {
    /// Results, and the blob of their sources, which may be empty.
    pub fn new(blob: &'a [u8], sources: &'a [u8]) -> Self {
        let (mut bytes, mut source_bytes) = (Bytes(blob), Bytes(sources));
        let (mut robots, mut sources) = (Vec::new(), Vec::new());
        for _ in 0..source_bytes.number().unwrap_or_default() {
            let Some(hash) = source_bytes.hash() else { break };
            sources.push(hash);
        }
        for _ in 0..bytes.number().unwrap_or_default() {
            let Some(robot) = bytes.text() else { break };
            robots.push(robot);
        }
        Self { bytes, robots, sources, source_bytes, id: 0 }
    }
}

impl Iterator for PackedResults<'_> {
    type Item = PackedResult;

    fn next(&mut self) -> Option<PackedResult> {
        self.id = self.bytes.id(self.id)?;
        let verdict = self.bytes.number()?;
        let robot = usize::try_from(self.bytes.number()?).ok()?;
        let duration_us = self.bytes.number()?.checked_sub(1);
        let source = self.source_bytes.number().and_then(|position| position.checked_sub(1));
        let source = source.and_then(|position| self.sources.get(usize::try_from(position).ok()?));
        Some(PackedResult {
            test: self.id,
            verdict: *Verdict::ALL.get((verdict >> 1) as usize)?,
            is_flaky: verdict & 1 == 1,
            robot,
            duration_us: duration_us.and_then(|micros| i64::try_from(micros).ok()),
            source: source.copied(),
        })
    }
}

/// Reads the points of a run, in the order of their series. Ends early if the blob is damaged.
#[derive(Debug)]
pub(crate) struct PackedPoints<'a> {
    bytes: Bytes<'a>,
    limits: Vec<[Option<f64>; 2]>,
    id: i64,
}

impl<'a> PackedPoints<'a> {
    pub fn new(blob: &'a [u8]) -> Self {
        let mut bytes = Bytes(blob);
        let mut limits = Vec::new();
        for _ in 0..bytes.number().unwrap_or_default() {
            let (Some(low), Some(high)) = (bytes.float(), bytes.float()) else { break };
            limits.push([low, high]);
        }
        Self { bytes, limits, id: 0 }
    }
}

impl Iterator for PackedPoints<'_> {
    type Item = PackedPoint;

    fn next(&mut self) -> Option<PackedPoint> {
        self.id = self.bytes.id(self.id)?;
        let limits = *self.limits.get(usize::try_from(self.bytes.number()?).ok()?)?;
        let outside = self.bytes.number()?;
        Some(PackedPoint { series: self.id, value: self.bytes.float()?, outside, limits })
    }
}

#[derive(Debug)]
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn number(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let (byte, rest) = self.0.split_first()?;
            self.0 = rest;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    fn id(&mut self, previous: i64) -> Option<i64> {
        Some(previous.wrapping_add(self.number()?.cast_signed()))
    }

    /// `Some(None)` is an unknown number.
    #[expect(clippy::option_option, reason = "the end, and an unknown number")]
    fn float(&mut self) -> Option<Option<f64>> {
        let number = f64::from_bits(self.hash()?);
        Some((!number.is_nan()).then_some(number))
    }

    /// A number of 8 bytes.
    fn hash(&mut self) -> Option<u64> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u64::from_le_bytes(*bytes))
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = usize::try_from(self.number()?).ok()?;
        let (text, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        str::from_utf8(text).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn results_are_read_as_they_were_packed() {
        let robots = ["", "robot:icub", "", "robot:icub gpu"];
        let verdicts = Verdict::ALL.into_iter().cycle();
        let durations = [None, Some(0), Some(1), Some(i64::MAX)];
        let mut packer = ResultPacker::default();
        let mut expected = Vec::new();
        for (index, verdict) in verdicts.take(20).enumerate() {
            let (robot, duration_us) = (robots[index % 4], durations[index % 3]);
            let test = 1_000_000_i64 << index;
            let is_flaky = index % 5 == 0;
            let source = [None, Some(7), Some(u64::MAX), Some(7)][index % 4];
            let result = PackedResult { test, verdict, is_flaky, robot: 0, duration_us, source };
            packer.add(result, robot);
            expected.push((test, verdict, is_flaky, robot, (duration_us, source)));
        }
        // The order in which they are added does not matter.
        packer.results.reverse();
        let (blob, sources) = packer.finish();
        let mut reader = PackedResults::new(&blob, &sources);
        let robots = reader.robots.clone();
        let found: Vec<_> = reader
            .by_ref()
            .map(|it| {
                (it.test, it.verdict, it.is_flaky, robots[it.robot], (it.duration_us, it.source))
            })
            .collect();
        assert_eq!(found, expected);
        // An earlier version stored no sources.
        let without = PackedResults::new(&blob, &[]);
        assert!(without.zip(&found).all(|(it, found)| it.test == found.0 && it.source.is_none()));
    }

    #[test]
    fn the_numbers_of_verdicts_do_not_change() {
        // They are stored: add new verdicts at the end.
        let words = Verdict::ALL.map(Verdict::as_str);
        let stored = ["passed", "failed", "error", "crashed", "timed-out", "collapsed", "skipped"];
        assert_eq!(words[..7], stored);
        assert_eq!(words[7], "interrupted");
        assert_eq!(Verdict::ALL.map(|verdict| verdict as usize), [0, 1, 2, 3, 4, 5, 6, 7]);
    }

    proptest! {
        #[test]
        fn points_are_read_as_they_were_packed(
            points in prop::collection::btree_map(
                any::<u32>(),
                (any::<Option<f64>>(), any::<u64>(), any::<Option<f32>>(), any::<bool>()),
                0..60,
            ),
        ) {
            let finite = |value: Option<f64>| value.filter(|value| !value.is_nan());
            let mut packer = PointPacker::default();
            let mut expected = Vec::new();
            for (series, (value, outside, low, is_bounded)) in points {
                let (series, value) = (i64::from(series), finite(value));
                let low = finite(low.map(f64::from));
                let high = is_bounded.then_some(1.5);
                let summary = NumberSummary { value, outside, low, high, ..Default::default() };
                packer.add(series, &summary);
                expected.push(PackedPoint { series, value, outside, limits: [low, high] });
            }
            let blob = packer.finish();
            prop_assert_eq!(PackedPoints::new(&blob).collect::<Vec<_>>(), expected);
        }

        #[test]
        fn damaged_blobs_end_early(blob in prop::collection::vec(any::<u8>(), 0..200)) {
            prop_assert!(PackedResults::new(&blob, &blob).count() <= blob.len());
            prop_assert!(PackedPoints::new(&blob).count() <= blob.len());
        }
    }
}
