//! [`Campaign`] → [`EpisodeList`].
//!
//! A candidate is a numbered set of values for all parameters. Those that meet the constraints
//! are the episodes.

mod directions;
mod list;
pub(crate) mod sampler;
mod sobol;
pub(crate) mod space;
mod trials;

use std::path::Path;

use rtf_model::{Diagnostic, Episode, Parameter};
use rtf_plan::suite::{SourceMap, SourceText};
use rtf_statistics::RandomStream;

pub use list::EpisodeList;
use space::{MAX_COMBINATIONS, Space};

use crate::Campaign;

/// The most candidates for each episode. With more, hardly any candidate meets the constraints.
const MAX_CANDIDATES: u64 = 1000;

/// What [`resolve`] reads and writes besides the campaign.
#[derive(Debug)]
pub struct Resolution<'a> {
    /// The directory of the campaign file, to which CSV files are relative.
    pub dir: &'a Path,
    pub source: &'a SourceText,
    pub problems: &'a mut Vec<Diagnostic>,
    pub sources: &'a mut SourceMap,
}

impl Resolution<'_> {
    fn report(&mut self, problem: Diagnostic) {
        self.problems.push(problem);
    }
}

/// Makes the list of episodes. `None` if there is an error, which is reported.
#[must_use]
pub fn resolve(campaign: &Campaign, resolution: &mut Resolution<'_>) -> Option<EpisodeList> {
    let mut space = Space::new(campaign, resolution)?;
    // Without a number of episodes, each combination is one.
    let (wanted, most) = match campaign.episodes {
        Some(episodes) => (u64::from(episodes), u64::from(episodes) * MAX_CANDIDATES),
        None => (space.combinations, space.combinations),
    };
    if let Some(episodes) = campaign.episodes
        && u64::from(episodes) < space.combinations
    {
        let combinations = space.combinations;
        let message = format!("only {episodes} of {combinations} combinations have an episode");
        let problem = resolution.source.warning("few-episodes", campaign.span, message);
        resolution.report(problem.hint("use `choice` for a random selection"));
    }
    let mut seeds = SeedStream::new(campaign.seed);
    let mut list = EpisodeList::default();
    for candidate in 0..most {
        if list.episodes.len() as u64 == wanted {
            break;
        }
        let values = space.candidate(candidate);
        if !space.allows(campaign, &values) {
            continue;
        }
        let names = space.names.iter().cloned();
        let parameters =
            names.zip(values).map(|(name, (value, _))| Parameter { name, value }).collect();
        let seed = seeds.seed(candidate);
        list.episodes.push(Episode::new(list.episodes.len() as u64 + 1, seed, parameters));
    }
    let is_enough = match campaign.episodes {
        Some(_) => list.episodes.len() as u64 == wanted,
        None => !list.episodes.is_empty(),
    };
    if !is_enough {
        report_constraints(campaign, resolution, (list.episodes.len(), most));
        return None;
    }
    match campaign.versions() {
        Some(versions) => trials::of_blocks(list, versions, (campaign, resolution)),
        None => Some(list),
    }
}

/// The seeds of candidates.
#[derive(Debug)]
pub struct SeedStream(RandomStream);

impl SeedStream {
    /// Those of a campaign with this seed.
    #[must_use]
    pub fn new(campaign: u64) -> Self {
        Self(RandomStream::new(campaign, "seed", ""))
    }

    /// The seed of a candidate, numbered from 0: below 2³¹.
    pub fn seed(&mut self, candidate: u64) -> u32 {
        (self.0.bits(candidate) >> 33) as u32
    }
}

fn report_constraints(
    campaign: &Campaign,
    resolution: &mut Resolution<'_>,
    (found, candidates): (usize, u64),
) {
    let message = format!("only {found} of {candidates} candidates meet the constraints");
    let labels = campaign.constraints.iter().map(|it| resolution.source.label(it.span, ""));
    let problem = Diagnostic::error("narrow-constraints", message);
    let problem = labels.fold(problem, Diagnostic::label);
    let hint = format!("choose parameters so that more than one of {MAX_CANDIDATES} meets them");
    resolution.report(problem.hint(hint));
}

/// Reports more combinations than a list may have.
fn report_size(campaign: &Campaign, resolution: &mut Resolution<'_>) {
    let message = format!("the campaign has more than {MAX_COMBINATIONS} combinations");
    let problem = resolution.source.error("too-many-combinations", campaign.span, message);
    resolution.report(problem.hint("sample some parameters: `distribution=\"choice\"`"));
}
