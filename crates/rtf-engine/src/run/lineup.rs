//! Which suite of a run begins next, when several may run side by side.
//!
//! Suites begin in the plan's order. One that requires what another suite of
//! this run has just now is passed over, and is the first to be looked at when
//! that one has ended: it does not take the place of a suite that could run.
//! (What another *run* has is waited for in the suite's place: nobody knows for
//! how long, and what is taken already would be kept from others meanwhile.)

use std::num::NonZeroUsize;

use rtf_plan::plan::SuitePlan;

/// The suites of a run that wait for their turn, and those that run.
#[derive(Debug)]
pub struct Lineup<'p> {
    /// How many may run at the same time.
    jobs: NonZeroUsize,
    /// In the plan's order.
    waiting: Vec<&'p SuitePlan>,
    running: Vec<&'p SuitePlan>,
}

impl<'p> Lineup<'p> {
    /// All of them wait.
    pub fn new(suites: &'p [SuitePlan], jobs: NonZeroUsize) -> Self {
        Self { jobs, waiting: suites.iter().collect(), running: Vec::new() }
    }

    /// The suite that begins now, if one may. It counts as running from now on.
    pub fn next(&mut self) -> Option<&'p SuitePlan> {
        if self.running.len() >= self.jobs.get() {
            return None;
        }
        let place = self.waiting.iter().position(|suite| self.is_free(suite))?;
        let suite = self.waiting.remove(place);
        self.running.push(suite);
        Some(suite)
    }

    /// How many turns there are from the suite that has just begun on, when
    /// always as many run as may.
    pub fn turns(&self) -> u32 {
        let left = (self.waiting.len() + 1).div_ceil(self.jobs.get());
        u32::try_from(left).unwrap_or(u32::MAX)
    }

    /// A suite has ended, and what it had is free again.
    pub fn ended(&mut self, ended: &SuitePlan) {
        self.running.retain(|suite| suite.id != ended.id);
    }

    /// Whether no suite of this run keeps it from what it requires.
    fn is_free(&self, suite: &SuitePlan) -> bool {
        suite.requires.iter().all(|wanted| {
            let all = self.running.iter().flat_map(|suite| &suite.requires);
            let taken = all.filter(|other| other.name == wanted.name).count();
            u32::try_from(taken).is_ok_and(|taken| taken < wanted.slots)
        })
    }
}

#[cfg(test)]
mod tests {
    use rtf_model::SuiteId;

    use super::*;
    use crate::run::machine::tests::world::suite;
    use rtf_plan::plan::RequiredResource;

    /// Suites that require these words, each a name or `name/slots`.
    fn suites<const N: usize>(requires: [&str; N]) -> Vec<SuitePlan> {
        let resource = |word: &str| {
            let (name, slots) = word.split_once('/').unwrap_or((word, "1"));
            RequiredResource { name: name.to_owned(), slots: slots.parse().unwrap() }
        };
        (0..)
            .zip(requires)
            .map(|(id, words)| {
                let requires = words.split_whitespace().map(resource).collect();
                SuitePlan { id: SuiteId(id), requires, ..suite(0, 1) }
            })
            .collect()
    }

    fn begin(lineup: &mut Lineup<'_>) -> Vec<u32> {
        std::iter::from_fn(|| lineup.next()).map(|suite| suite.id.0).collect()
    }

    fn lineup(suites: &[SuitePlan], jobs: usize) -> Lineup<'_> {
        Lineup::new(suites, NonZeroUsize::new(jobs).unwrap())
    }

    #[test]
    fn as_many_as_are_asked_for_begin_in_the_plans_order() {
        let suites = suites(["", "", "", ""]);
        let mut lineup = lineup(&suites, 2);
        assert_eq!(begin(&mut lineup), [0, 1]);
        assert_eq!(lineup.turns(), 2);
        lineup.ended(&suites[1]);
        assert_eq!(begin(&mut lineup), [2]);
        lineup.ended(&suites[0]);
        lineup.ended(&suites[2]);
        assert_eq!(begin(&mut lineup), [3]);
    }

    #[test]
    fn one_that_requires_what_another_has_is_passed_over_and_then_the_first() {
        let suites = suites(["robot", "camera robot", "camera", "", ""]);
        let mut lineup = lineup(&suites, 3);
        assert_eq!(begin(&mut lineup), [0, 2, 3]);
        lineup.ended(&suites[0]);
        // The camera is still taken.
        assert_eq!(begin(&mut lineup), [4]);
        lineup.ended(&suites[2]);
        assert_eq!(begin(&mut lineup), [1]);
    }

    #[test]
    fn as_many_have_one_of_a_kind_as_there_are() {
        let suites = suites(["arm/2", "arm/2", "arm/2", "arm"]);
        let mut lineup = lineup(&suites, 9);
        assert_eq!(begin(&mut lineup), [0, 1]);
        lineup.ended(&suites[0]);
        assert_eq!(begin(&mut lineup), [2]);
        lineup.ended(&suites[1]);
        assert!(begin(&mut lineup).is_empty());
        lineup.ended(&suites[2]);
        assert_eq!(begin(&mut lineup), [3]);
    }
}
