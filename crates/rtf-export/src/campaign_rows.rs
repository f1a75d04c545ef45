//! The columns of campaigns and episodes.

use rtf_history::answers::EpisodeLine;
use rtf_history::entry::CampaignInfo;

use crate::rows::{Cell, CellType, Column, ExportRow, integer, maybe_text, text};

impl ExportRow for CampaignInfo {
    const TABLE: &'static str = "campaigns";

    fn columns() -> Vec<Column> {
        use CellType::{Flag, Integer, Number, Text, Time};
        vec![
            ("id", Text),
            ("directory", Text),
            ("name", Text),
            ("file", Text),
            ("suite_file", Text),
            ("started", Time),
            ("ended", Time),
            ("end", Text),
            ("commit", Text),
            ("branch", Text),
            ("dirty", Flag),
            ("author_time", Time),
            ("ci_job", Text),
            ("host", Text),
            ("profile", Text),
            ("set", Text),
            ("rtf", Text),
            ("seed", Integer),
            ("space", Text),
            ("claim", Number),
            ("rule", Text),
            ("confidence", Number),
            ("verdict", Text),
            ("planned", Integer),
            ("run", Integer),
            ("passed", Integer),
            ("failed", Integer),
            ("without_result", Integer),
            ("rate", Number),
            ("low", Number),
            ("high", Number),
        ]
    }

    fn cells(&self) -> Vec<Cell<'_>> {
        let rate = self.rate.as_ref();
        vec![
            text(&self.id),
            text(&self.directory),
            text(&self.name),
            text(&self.file),
            text(&self.suite_file),
            Cell::Time(Some(self.started)),
            Cell::Time(Some(self.ended)),
            text(self.end.as_str()),
            maybe_text(self.commit.as_ref()),
            maybe_text(self.branch.as_ref()),
            Cell::Flag(self.dirty),
            Cell::OffsetTime(self.author_time.as_deref()),
            maybe_text(self.ci_job.as_ref()),
            text(&self.host),
            maybe_text(self.profile.as_ref()),
            Cell::Text(Some(self.set.join(" ").into())),
            text(&self.rtf),
            integer(self.seed),
            text(&self.space),
            Cell::Number(Some(self.claim)),
            text(&self.rule),
            Cell::Number(Some(self.confidence)),
            text(&self.verdict),
            integer(self.planned),
            integer(self.run),
            integer(self.passed),
            integer(self.failed),
            integer(self.without_result),
            Cell::Number(rate.map(|it| it.value)),
            Cell::Number(rate.map(|it| it.low)),
            Cell::Number(rate.map(|it| it.high)),
        ]
    }
}

impl ExportRow for EpisodeLine {
    const TABLE: &'static str = "episodes";

    fn columns() -> Vec<Column> {
        use CellType::{Integer, Number, Text, Time};
        vec![
            ("campaign", Text),
            ("name", Text),
            ("started", Time),
            ("commit", Text),
            ("episode", Integer),
            ("seed", Integer),
            ("outcome", Text),
            ("reason", Text),
            ("duration", Number),
            ("parameters", Text),
        ]
    }

    fn cells(&self) -> Vec<Cell<'_>> {
        let pairs = self.parameters.iter().map(|(name, value)| format!("{name}={value}"));
        vec![
            text(&self.campaign),
            text(&self.name),
            Cell::Time(Some(self.started)),
            maybe_text(self.commit.as_ref()),
            integer(self.episode),
            integer(self.seed),
            text(&self.outcome),
            maybe_text(self.reason.as_ref()),
            Cell::Number(Some(self.duration)),
            Cell::Text(Some(pairs.collect::<Vec<_>>().join(" ").into())),
        ]
    }
}
