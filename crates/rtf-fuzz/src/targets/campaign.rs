//! Campaign files and their constraints.

use std::path::Path;

use rtf_campaign::Campaign;
use rtf_campaign::episodes::Resolution;
use rtf_plan::suite::{SourceMap, SourceText};

use super::labels;

/// Longer lists take too long for a target.
const EPISODES: u32 = 50;

/// A campaign file.
pub fn check(data: &[u8]) {
    labels::check(data, |source, problems| {
        let campaign = rtf_campaign::parse(source, problems);
        let is_accepted = campaign.is_some();
        if let Some(campaign) = campaign.filter(|it| it.episodes.is_some_and(|n| n <= EPISODES)) {
            check_episodes(&campaign, source);
        }
        is_accepted
    });
}

/// The condition of a constraint on two parameters.
pub fn check_constraint(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let text: String = text.chars().filter(|c| *c >= ' ').collect();
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let file = format!(
        "<campaign suite=\"a.xml\" seed=\"1\" episodes=\"4\">\
         <parameter name=\"n\" distribution=\"grid\" values=\"1 2\"/>\
         <parameter name=\"x\" distribution=\"uniform\" low=\"-1\" high=\"1\"/>\
         <constraint require=\"{text}\"/>\
         <claim require=\"rate >= 0.9\" confidence=\"0.9\"/></campaign>"
    );
    check(file.as_bytes());
}

/// Episodes are the same each time, are numbered, and meet the constraints.
fn check_episodes(campaign: &Campaign, source: &SourceText) {
    let list = || {
        let (mut problems, mut sources) = (Vec::new(), SourceMap::default());
        let (problems, sources) = (&mut problems, &mut sources);
        // A file: nothing can be in it.
        let dir = Path::new("/dev/null");
        rtf_campaign::resolve(campaign, &mut Resolution { dir, source, problems, sources })
    };
    let Some(episodes) = list() else { return };
    assert_eq!(list().as_ref(), Some(&episodes), "another list");
    for (episode, id) in episodes.episodes.iter().zip(1..) {
        assert_eq!(episode.id, id);
        let is_met = rtf_campaign::ranges::meet_constraints(campaign, &episode.parameters);
        assert!(is_met, "episode {id} does not meet the constraints");
    }
    let stored = rtf_campaign::EpisodeList::from_json_lines(&episodes.to_json_lines());
    assert_eq!(stored.ok(), Some(episodes), "stored and read");
}
