//! The columns of campaigns and episodes.

use rtf_history::answers::EpisodeLine;
use rtf_history::entry::CampaignInfo;

use crate::rows::CellType::{Flag, Integer, Number, Text, Time};
use crate::rows::{Cell, Column, ExportRow, integer, maybe_text, text};

impl ExportRow for CampaignInfo {
    const TABLE: &'static str = "campaigns";
    const COLUMNS: &'static [Column<Self>] = &[
        ("id", Text, |it| text(&it.id)),
        ("directory", Text, |it| text(&it.directory)),
        ("name", Text, |it| text(&it.name)),
        ("file", Text, |it| text(&it.file)),
        ("suite_file", Text, |it| text(&it.suite_file)),
        ("started", Time, |it| Cell::Time(Some(it.started))),
        ("ended", Time, |it| Cell::Time(Some(it.ended))),
        ("end", Text, |it| text(it.end.as_str())),
        ("commit", Text, |it| maybe_text(it.commit.as_ref())),
        ("branch", Text, |it| maybe_text(it.branch.as_ref())),
        ("dirty", Flag, |it| Cell::Flag(it.dirty)),
        ("author_time", Time, |it| Cell::OffsetTime(it.author_time.as_deref())),
        ("ci_job", Text, |it| maybe_text(it.ci_job.as_ref())),
        ("host", Text, |it| text(&it.host)),
        ("profile", Text, |it| maybe_text(it.profile.as_ref())),
        ("set", Text, |it| Cell::Text(Some(it.set.join(" ").into()))),
        ("rtf", Text, |it| text(&it.rtf)),
        ("seed", Integer, |it| integer(it.seed)),
        ("space", Text, |it| text(&it.space)),
        ("claim", Number, |it| Cell::Number(Some(it.claim))),
        ("rule", Text, |it| text(&it.rule)),
        ("confidence", Number, |it| Cell::Number(Some(it.confidence))),
        ("verdict", Text, |it| text(&it.verdict)),
        ("planned", Integer, |it| integer(it.planned)),
        ("run", Integer, |it| integer(it.run)),
        ("passed", Integer, |it| integer(it.passed)),
        ("failed", Integer, |it| integer(it.failed)),
        ("without_result", Integer, |it| integer(it.without_result)),
        ("rate", Number, |it| Cell::Number(it.rate.map(|rate| rate.value))),
        ("low", Number, |it| Cell::Number(it.rate.map(|rate| rate.low))),
        ("high", Number, |it| Cell::Number(it.rate.map(|rate| rate.high))),
    ];
}

impl ExportRow for EpisodeLine {
    const TABLE: &'static str = "episodes";
    const COLUMNS: &'static [Column<Self>] = &[
        ("campaign", Text, |it| text(&it.campaign)),
        ("name", Text, |it| text(&it.name)),
        ("started", Time, |it| Cell::Time(Some(it.started))),
        ("commit", Text, |it| maybe_text(it.commit.as_ref())),
        ("episode", Integer, |it| integer(it.episode)),
        ("seed", Integer, |it| integer(it.seed)),
        ("outcome", Text, |it| text(&it.outcome)),
        ("reason", Text, |it| maybe_text(it.reason.as_ref())),
        ("duration", Number, |it| Cell::Number(Some(it.duration))),
        ("parameters", Text, |it| Cell::Text(Some(assignments(it).into()))),
    ];
}

/// The parameters of an episode, as `NAME=VALUE`.
fn assignments(episode: &EpisodeLine) -> String {
    let pairs = episode.parameters.iter().map(|(name, value)| format!("{name}={value}"));
    pairs.collect::<Vec<_>>().join(" ")
}
