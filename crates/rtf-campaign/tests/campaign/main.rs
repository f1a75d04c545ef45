//! Campaign files → episodes: golden lists, properties, problems with their positions, the
//! schema, and judgements.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::cast_precision_loss,
    reason = "a test ends there; counts are far below 2^53"
)]

mod comparisons;
mod golden;
mod judgements;
mod made_comparisons;
mod problems;
mod properties;
mod schema;

use std::path::Path;

use rtf_campaign::episodes::Resolution;
use rtf_campaign::{Campaign, EpisodeList};
use rtf_model::Diagnostic;
use rtf_plan::suite::{SourceMap, SourceText};

/// The claim of campaigns whose claim does not matter.
const CLAIM: &str = r#"<claim require="rate >= 0.9" confidence="0.95"/>"#;

/// The problems of a file, and its list of episodes.
fn read(text: &str, dir: &Path) -> (Option<EpisodeList>, Vec<Diagnostic>) {
    let source = SourceText::new("campaign.xml", text);
    let mut problems = Vec::new();
    let list = rtf_campaign::parse(&source, &mut problems).and_then(|campaign| {
        let mut sources = SourceMap::default();
        let mut resolution =
            Resolution { dir, source: &source, problems: &mut problems, sources: &mut sources };
        rtf_campaign::resolve(&campaign, &mut resolution)
    });
    (list, problems)
}

/// The episodes of a valid campaign with these attributes and children.
#[track_caller]
fn episodes(attributes: &str, children: &str) -> EpisodeList {
    let text = format!("<campaign suite=\"s.xml\" {attributes}>{children}{CLAIM}</campaign>");
    let (list, problems) = read(&text, Path::new("."));
    assert_eq!(problems, [], "{text}");
    list.expect("a list")
}

/// A valid campaign.
#[track_caller]
fn campaign(attributes: &str, children: &str) -> Campaign {
    let text = format!("<campaign suite=\"s.xml\" {attributes}>{children}</campaign>");
    let mut problems = Vec::new();
    let campaign = rtf_campaign::parse(&SourceText::new("campaign.xml", text), &mut problems);
    assert_eq!(problems, []);
    campaign.expect("a campaign")
}

/// The numbers of a parameter.
fn numbers(list: &EpisodeList, name: &str) -> Vec<f64> {
    let value = |episode: &rtf_model::Episode| {
        let parameter = episode.parameters.iter().find(|parameter| parameter.name == name);
        parameter.expect("the parameter").value.parse().expect("a number")
    };
    list.episodes.iter().map(value).collect()
}
