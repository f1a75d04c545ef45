//! The smallest change from nominal parameters that fails.
//!
//! Delta debugging (A. Zeller, R. Hildebrandt, *Simplifying and Isolating Failure-Inducing Input*,
//! IEEE Transactions on Software Engineering 28(2), 2002: *ddmin*) selects the parameters, and
//! bisection their numbers.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::episodes::sampler::number_of;

/// Bisection ends when the distance between a value that fails and one that does not is this
/// part of the distance between the episode's and the nominal value.
const PRECISION: f64 = 1.0 / 64.0;

/// A parameter of an episode that fails.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    pub name: String,
    pub nominal: String,
    /// The value of the episode.
    pub value: String,
    /// Whether values between these two are possible.
    pub is_real: bool,
}

/// A parameter with which an episode fails.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ShrunkChange {
    pub name: String,
    pub nominal: String,
    /// A value that fails, with the values of the other changes.
    pub value: String,
    /// A value, nearest to it, that does not fail with the same values of the others.
    pub passes: String,
}

/// The result of [`shrink`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shrunk {
    /// The episode does not fail when it runs again.
    NotReproduced,
    /// It fails with these changes, all other parameters being nominal; without changes, if it
    /// fails with nominal parameters.
    Changes(Vec<ShrunkChange>),
}

/// Finds the smallest change that fails. `fails` runs an episode with these values of all
/// parameters; it is never called twice with the same ones.
///
/// # Errors
/// That of `fails`.
pub fn shrink<E>(
    changes: &[Change],
    fails: impl FnMut(&[String]) -> Result<bool, E>,
) -> Result<Shrunk, E> {
    let mut search = Search { changes, fails, known: BTreeMap::new() };
    let all: Vec<usize> = (0..changes.len()).collect();
    if !search.fails_with(&all)? {
        return Ok(Shrunk::NotReproduced);
    }
    let is_changed = |index: &usize| changes[*index].value != changes[*index].nominal;
    let set = search.smallest_set(all.into_iter().filter(is_changed).collect())?;
    search.smallest_values(&set).map(Shrunk::Changes)
}

struct Search<'a, F> {
    changes: &'a [Change],
    fails: F,
    known: BTreeMap<Vec<String>, bool>,
}

impl<E, F: FnMut(&[String]) -> Result<bool, E>> Search<'_, F> {
    fn fails(&mut self, values: &[String]) -> Result<bool, E> {
        if let Some(known) = self.known.get(values) {
            return Ok(*known);
        }
        let fails = (self.fails)(values)?;
        self.known.insert(values.to_vec(), fails);
        Ok(fails)
    }

    /// The values of the episode for the parameters in `set`; the others are nominal.
    fn values(&self, set: &[usize]) -> Vec<String> {
        let value = |(index, change): (usize, &Change)| match set.contains(&index) {
            true => change.value.clone(),
            false => change.nominal.clone(),
        };
        self.changes.iter().enumerate().map(value).collect()
    }

    fn fails_with(&mut self, set: &[usize]) -> Result<bool, E> {
        let values = self.values(set);
        self.fails(&values)
    }

    /// *ddmin*: a part of `set` that fails, and does not fail without any one of its elements.
    fn smallest_set(&mut self, mut set: Vec<usize>) -> Result<Vec<usize>, E> {
        if set.is_empty() || self.fails_with(&[])? {
            return Ok(Vec::new());
        }
        let mut count = 2;
        while set.len() > 1 {
            let parts: Vec<Vec<usize>> =
                set.chunks(set.len().div_ceil(count)).map(<[usize]>::to_vec).collect();
            if let Some(part) = self.first_that_fails(&parts)? {
                (set, count) = (part, 2);
                continue;
            }
            let without = |part: &Vec<usize>| -> Vec<usize> {
                set.iter().copied().filter(|index| !part.contains(index)).collect()
            };
            let rests: Vec<Vec<usize>> = parts.iter().map(without).collect();
            if let Some(rest) = self.first_that_fails(&rests)? {
                (set, count) = (rest, parts.len().saturating_sub(1).max(2));
            } else if parts.len() < set.len() {
                count = (2 * count).min(set.len());
            } else {
                break;
            }
        }
        Ok(set)
    }

    fn first_that_fails(&mut self, sets: &[Vec<usize>]) -> Result<Option<Vec<usize>>, E> {
        for set in sets {
            if self.fails_with(set)? {
                return Ok(Some(set.clone()));
            }
        }
        Ok(None)
    }

    /// Moves the values of `set` towards the nominal ones, one after the other, until each has a
    /// neighbour that passes with the present values of the others.
    fn smallest_values(&mut self, set: &[usize]) -> Result<Vec<ShrunkChange>, E> {
        let mut values = self.values(set);
        let nominal = |index: &usize| (*index, self.changes[*index].nominal.clone());
        let mut passing: BTreeMap<usize, String> = set.iter().map(nominal).collect();
        loop {
            let before = values.clone();
            for &index in set {
                if let Some(passes) = passing.remove(&index)
                    && let Some(passes) = self.bisect(&mut values, index, passes)?
                {
                    passing.insert(index, passes);
                }
            }
            if values == before {
                return Ok(self.result(&values, &passing));
            }
        }
    }

    /// Moves one value towards a value that has passed. Returns its neighbour that passes, if it
    /// is not nominal now.
    fn bisect(
        &mut self,
        values: &mut [String],
        index: usize,
        mut passes: String,
    ) -> Result<Option<String>, E> {
        let change = &self.changes[index];
        if self.fails_if(values, index, &passes)? {
            // It has passed with other values of the other parameters.
            values[index] = passes;
            passes = change.nominal.clone();
            if values[index] == passes || self.fails_if(values, index, &passes)? {
                values[index] = passes;
                return Ok(None);
            }
        }
        while let Some(middle) = between(&passes, &values[index], change) {
            match self.fails_if(values, index, &middle)? {
                true => values[index] = middle,
                false => passes = middle,
            }
        }
        Ok(Some(passes))
    }

    fn fails_if(&mut self, values: &[String], index: usize, value: &str) -> Result<bool, E> {
        let mut values = values.to_vec();
        value.clone_into(&mut values[index]);
        self.fails(&values)
    }

    fn result(&self, values: &[String], passing: &BTreeMap<usize, String>) -> Vec<ShrunkChange> {
        let changed = passing.iter().map(|(index, passes)| (&self.changes[*index], index, passes));
        let shrunk = |(change, index, passes): (&Change, &usize, &String)| ShrunkChange {
            name: change.name.clone(),
            nominal: change.nominal.clone(),
            value: values[*index].clone(),
            passes: passes.clone(),
        };
        changed.map(shrunk).collect()
    }
}

/// A number about half-way between two others, with few decimals; `None` if they are near enough.
fn between(passes: &str, fails: &str, change: &Change) -> Option<String> {
    if !change.is_real {
        return None;
    }
    let (low, high) = (number_of(passes)?, number_of(fails)?);
    let whole = (number_of(&change.value)? - number_of(&change.nominal)?).abs();
    let distance = (high - low).abs();
    if distance <= whole * PRECISION {
        return None;
    }
    let middle = low + (high - low) / 2.0;
    let is_near =
        |text: &String| number_of(text).is_some_and(|it| (it - middle).abs() < distance / 4.0);
    let decimals = (0..17).map(|decimals| format!("{middle:.decimals$}"));
    let text = decimals.filter(is_near).map(|text| plain(&text)).next();
    text.or_else(|| Some(middle.to_string())).filter(|text| text != passes && text != fails)
}

/// Without a negative zero.
fn plain(text: &str) -> String {
    let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'.' | b'0'));
    if is_zero { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use proptest::prelude::*;

    use super::*;

    fn real(name: &str, nominal: f64, value: f64) -> Change {
        let (nominal, value) = (nominal.to_string(), value.to_string());
        Change { name: name.to_owned(), nominal, value, is_real: true }
    }

    fn word(name: &str, nominal: &str, value: &str) -> Change {
        let [name, nominal, value] = [name, nominal, value].map(str::to_owned);
        Change { name, nominal, value, is_real: false }
    }

    /// The result, and the number of runs.
    fn run(changes: &[Change], mut fails: impl FnMut(&[String]) -> bool) -> (Shrunk, usize) {
        let mut runs = 0;
        let shrunk = shrink(changes, |values| {
            runs += 1;
            Ok::<_, Infallible>(fails(values))
        });
        let Ok(shrunk) = shrunk;
        (shrunk, runs)
    }

    fn numbers(values: &[String]) -> Vec<f64> {
        values.iter().map(|value| value.parse().expect("a number")).collect()
    }

    #[test]
    fn the_number_that_fails_is_found() {
        let changes = [real("payload", 0.25, 0.9), real("friction", 0.1, 0.3)];
        let (shrunk, runs) = run(&changes, |values| numbers(values)[0] >= 0.537);
        let Shrunk::Changes(found) = shrunk else { panic!("it fails") };
        let [found] = found.as_slice() else { panic!("{found:?}") };
        let [value, passes] = [&found.value, &found.passes].map(|it| it.parse::<f64>().unwrap());
        assert!(passes < 0.537 && value >= 0.537 && value - passes < 0.65 / 64.0, "{found:?}");
        assert!(found.value.len() <= 6 && runs <= 12, "{found:?} after {runs} runs");
    }

    #[test]
    fn words_and_numbers_together() {
        let changes =
            [word("surface", "steel", "ice"), real("noise", 0.0, 1.0), real("speed", 1.0, -3.0)];
        let fails = |values: &[String]| values[0] == "ice" && numbers(&values[2..])[0] < -1.0;
        let (Shrunk::Changes(found), _) = run(&changes, fails) else { panic!("it fails") };
        let names: Vec<_> = found.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["surface", "speed"]);
        assert_eq!((found[0].value.as_str(), found[0].passes.as_str()), ("ice", "steel"));
    }

    #[test]
    fn the_ends() {
        let changes = [real("a", 0.0, 1.0)];
        assert_eq!(run(&changes, |_| false), (Shrunk::NotReproduced, 1));
        assert_eq!(run(&changes, |_| true), (Shrunk::Changes(Vec::new()), 2));
        assert_eq!(run(&[], |_| true), (Shrunk::Changes(Vec::new()), 1));
        assert_eq!(run(&[real("a", 1.0, 1.0)], |_| true).0, Shrunk::Changes(Vec::new()));
    }

    proptest! {
        /// Any predicate, also one that is not monotone: what is found fails, and each
        /// of its neighbours passes.
        #[test]
        fn what_is_found_was_tested(
            table in prop::collection::vec(any::<bool>(), 512),
            values in prop::collection::vec(-8i32..8, 1..6),
        ) {
            let change = |(index, value): (usize, &i32)| {
                real(&index.to_string(), 0.0, f64::from(*value) / 2.0)
            };
            let changes: Vec<Change> = values.iter().enumerate().map(change).collect();
            let fails = |values: &[String]| {
                let weighted = numbers(values).into_iter().zip(1u8..);
                let sum: f64 = weighted.map(|(value, weight)| value * f64::from(weight)).sum();
                table[(sum.abs() * 37.0) as usize % 512]
            };
            let (shrunk, runs) = run(&changes, fails);
            prop_assert!(runs <= 200, "{runs} runs");
            if let Shrunk::Changes(found) = shrunk {
                let mut smallest: Vec<String> = changes.iter().map(|it| it.nominal.clone()).collect();
                let index = |it: &ShrunkChange| it.name.parse::<usize>().expect("an index");
                found.iter().for_each(|it| smallest[index(it)].clone_from(&it.value));
                prop_assert!(fails(&smallest));
                for it in &found {
                    let mut neighbour = smallest.clone();
                    neighbour[index(it)].clone_from(&it.passes);
                    prop_assert!(!fails(&neighbour));
                }
            }
        }
    }
}
