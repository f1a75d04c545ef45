//! The value of a sampled parameter for a candidate.

use rtf_statistics::RandomStream;
use rtf_statistics::random::normal_quantile;

use super::sobol::Sobol;
use crate::file::{Design, Distribution};

/// The greatest number below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

#[derive(Debug)]
pub(super) struct Sampler<'a> {
    distribution: &'a Distribution,
    source: UnitSource,
}

/// Random numbers between 0 and 1, both excluded.
#[derive(Debug)]
enum UnitSource {
    Independent(RandomStream),
    LatinHypercube { values: RandomStream, parts: Box<ShuffledParts> },
    Sobol { points: Sobol, shift: u32 },
}

/// The parts of a Latin hypercube in random order.
#[derive(Debug)]
struct ShuffledParts {
    random: RandomStream,
    /// The round for which they are shuffled.
    round: Option<u64>,
    order: Vec<u32>,
}

/// A value: its text, and its number if it is one.
pub(super) type Value = (String, Option<f64>);

impl<'a> Sampler<'a> {
    /// A sampler for the parameter `name` of a campaign with this seed. A Sobol sequence takes the
    /// next dimension; `None` if there is none. A Latin hypercube has `episodes` parts.
    pub fn new(
        (name, design, distribution): (&str, Design, &'a Distribution),
        (seed, episodes): (u64, u32),
        dimensions: &mut usize,
    ) -> Option<Self> {
        let source = match design {
            Design::Independent => UnitSource::Independent(RandomStream::new(seed, "value", name)),
            Design::LatinHypercube => UnitSource::LatinHypercube {
                values: RandomStream::new(seed, "value", name),
                parts: Box::new(ShuffledParts {
                    random: RandomStream::new(seed, "permutation", name),
                    round: None,
                    order: (0..episodes).collect(),
                }),
            },
            Design::Sobol => {
                let points = Sobol::new(*dimensions)?;
                *dimensions += 1;
                let bits = RandomStream::new(seed, "shift", name).bits(0);
                UnitSource::Sobol { points, shift: (bits >> 32) as u32 }
            }
        };
        Some(Self { distribution, source })
    }

    pub fn value(&mut self, candidate: u64) -> Value {
        let unit = self.source.unit(candidate);
        let number = match self.distribution {
            Distribution::Choice { values } => return word(values, unit),
            Distribution::Uniform { low, high } => low + unit * (high - low),
            Distribution::Normal { mean, deviation } => mean + deviation * normal_quantile(unit),
        };
        (text_of(number), Some(number))
    }
}

/// The shortest text of a finite number; of two equally near ones, the one with an even last digit.
/// The standard library does not define which one it prints.
pub(crate) fn text_of(number: f64) -> String {
    // Without the sign of a negative zero. Finite numbers always serialise.
    let text = serde_json::to_string(&(number + 0.0)).unwrap_or_default();
    let text = text.strip_suffix(".0").unwrap_or(&text);
    text.replace("e+", "e")
}

/// The number that a word is, for constraints.
pub(crate) fn number_of(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an index below the number of words"
)]
fn word(words: &[String], unit: f64) -> Value {
    let word = words.get((unit * words.len() as f64) as usize).cloned().unwrap_or_default();
    let number = number_of(&word);
    (word, number)
}

impl UnitSource {
    fn unit(&mut self, candidate: u64) -> f64 {
        match self {
            Self::Independent(values) => values.unit(candidate),
            Self::LatinHypercube { values, parts } => {
                let part = f64::from(parts.part(candidate));
                #[expect(clippy::cast_precision_loss, reason = "at most a million episodes")]
                ((part + values.unit(candidate)) / parts.order.len() as f64).min(BELOW_ONE)
            }
            Self::Sobol { points, shift } => {
                let point = u64::from(points.point(candidate) ^ *shift);
                #[expect(clippy::cast_precision_loss, reason = "33 bits")]
                ((2 * point + 1) as f64 / (1_u64 << 33) as f64)
            }
        }
    }
}

impl ShuffledParts {
    fn part(&mut self, candidate: u64) -> u32 {
        let count = (self.order.len() as u64).max(1);
        let (round, index) = (candidate / count, candidate % count);
        if self.round != Some(round) {
            shuffle(&mut self.order, &mut self.random, round * count);
            self.round = Some(round);
        }
        let part = usize::try_from(index).ok().and_then(|index| self.order.get(index));
        part.copied().unwrap_or_default()
    }
}

/// Shuffles 0, 1, … by the method of Fisher and Yates, with the random numbers from `start` on.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an index below the number of episodes"
)]
pub(super) fn shuffle(order: &mut [u32], random: &mut RandomStream, start: u64) {
    order.iter_mut().zip(0..).for_each(|(part, index)| *part = index);
    for index in (1..order.len()).rev() {
        let other = random.unit(start + index as u64) * (index + 1) as f64;
        order.swap(index, other as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::text_of;

    #[test]
    fn texts_of_numbers() {
        for (number, text) in [
            (0.1, "0.1"),
            (-0.0, "0"),
            (2.0, "2"),
            (1e-5, "0.00001"),
            (1.5e-7, "1.5e-7"),
            (9_007_199_254_740_993.0, "9007199254740992"),
            (-6_316_248_478_467_561.0 / 4.0, "-1579062119616890.2"),
            (1e16, "1e16"),
            (-2.5e300, "-2.5e300"),
            (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
        ] {
            assert_eq!(text_of(number), text);
        }
    }
}
