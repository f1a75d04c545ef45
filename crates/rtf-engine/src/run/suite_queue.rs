//! Decides which suite of a run starts next, if several may run in parallel.
//!
//! Suites start in the plan's order. A suite that requires a resource of a running suite is
//! skipped, so that it does not block others, and is the first candidate when that suite has
//! finished. (A suite whose resource belongs to another *run* starts and waits: the waiting
//! time is unknown, and its other locks would block suites of this run.)

use std::num::NonZeroUsize;

use rtf_plan::plan::SuitePlan;

/// The waiting and the running suites of a run.
#[derive(Debug)]
pub struct SuiteQueue<'p> {
    /// How many may run in parallel.
    jobs: NonZeroUsize,
    /// In the plan's order.
    waiting: Vec<&'p SuitePlan>,
    running: Vec<&'p SuitePlan>,
}

impl<'p> SuiteQueue<'p> {
    pub fn new(suites: &'p [SuitePlan], jobs: NonZeroUsize) -> Self {
        Self { jobs, waiting: suites.iter().collect(), running: Vec::new() }
    }

    /// Starts and returns the next suite, if one may run.
    pub fn next(&mut self) -> Option<&'p SuitePlan> {
        if self.running.len() >= self.jobs.get() {
            return None;
        }
        let index = self.waiting.iter().position(|suite| self.is_free(suite))?;
        let suite = self.waiting.remove(index);
        self.running.push(suite);
        Some(suite)
    }

    /// How many suites run one after the other, including the one that was just started, if all
    /// jobs are always used.
    pub fn remaining_rounds(&self) -> u32 {
        let left = (self.waiting.len() + 1).div_ceil(self.jobs.get());
        u32::try_from(left).unwrap_or(u32::MAX)
    }

    /// A suite has finished and released its resources.
    pub fn finished(&mut self, finished: &SuitePlan) {
        self.running.retain(|suite| suite.id != finished.id);
    }

    /// Whether no running suite occupies a resource that it requires.
    fn is_free(&self, suite: &SuitePlan) -> bool {
        suite.settings.requires.iter().all(|wanted| {
            let all = self.running.iter().flat_map(|suite| &suite.settings.requires);
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

    /// Suites that require these resources, each a name or `name/slots`.
    fn suites<const N: usize>(requires: [&str; N]) -> Vec<SuitePlan> {
        let resource = |word: &str| {
            let (name, slots) = word.split_once('/').unwrap_or((word, "1"));
            RequiredResource { name: name.to_owned(), slots: slots.parse().unwrap() }
        };
        (0..)
            .zip(requires)
            .map(|(id, words)| {
                let mut suite = SuitePlan { id: SuiteId(id), ..suite(0, 1) };
                suite.settings.requires = words.split_whitespace().map(resource).collect();
                suite
            })
            .collect()
    }

    fn start(queue: &mut SuiteQueue<'_>) -> Vec<u32> {
        std::iter::from_fn(|| queue.next()).map(|suite| suite.id.0).collect()
    }

    fn queue(suites: &[SuitePlan], jobs: usize) -> SuiteQueue<'_> {
        SuiteQueue::new(suites, NonZeroUsize::new(jobs).unwrap())
    }

    #[test]
    fn as_many_suites_as_jobs_start_in_the_plans_order() {
        let suites = suites(["", "", "", ""]);
        let mut queue = queue(&suites, 2);
        assert_eq!(start(&mut queue), [0, 1]);
        assert_eq!(queue.remaining_rounds(), 2);
        queue.finished(&suites[1]);
        assert_eq!(start(&mut queue), [2]);
        queue.finished(&suites[0]);
        queue.finished(&suites[2]);
        assert_eq!(start(&mut queue), [3]);
    }

    #[test]
    fn a_suite_that_requires_an_occupied_resource_is_skipped_and_then_the_first() {
        let suites = suites(["robot", "camera robot", "camera", "", ""]);
        let mut queue = queue(&suites, 3);
        assert_eq!(start(&mut queue), [0, 2, 3]);
        queue.finished(&suites[0]);
        // The camera is still occupied.
        assert_eq!(start(&mut queue), [4]);
        queue.finished(&suites[2]);
        assert_eq!(start(&mut queue), [1]);
    }

    #[test]
    fn as_many_suites_as_slots_share_a_resource() {
        let suites = suites(["arm/2", "arm/2", "arm/2", "arm"]);
        let mut queue = queue(&suites, 9);
        assert_eq!(start(&mut queue), [0, 1]);
        queue.finished(&suites[0]);
        assert_eq!(start(&mut queue), [2]);
        queue.finished(&suites[1]);
        assert!(start(&mut queue).is_empty());
        queue.finished(&suites[2]);
        assert_eq!(start(&mut queue), [3]);
    }
}
