//! The signals that one attempt of a test sampled: in numbers, and as curves that
//! are drawn. The samples themselves are in the journal.

use axum::extract::State;
use rtf_model::{Curve, EventKind, Series, Source, TestId};

use super::asked::{At, Page};
use super::details::{Answer, Part, Path3};
use super::problems::Problems;
use super::types::{Signal, Signals};
use crate::app::{App, JsonText};

/// The signals that an attempt of a test sampled.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/series",
    tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path)),
    responses((status = 200, body = Signals), Problems))]
pub async fn series(State(app): State<App>, At((run, test, number)): Path3) -> Answer {
    let page = Page { after: None, limit: None };
    let part = Part { source: Source::Test(TestId(test)), number, kind: "sampled", page };
    app.with_run(run, move |run| {
        let mut all: Vec<(Series, Curve)> = Vec::new();
        part.each(run, |event| {
            let EventKind::Sampled { samples, .. } = event.kind else { return };
            match all.iter_mut().find(|(series, _)| series.name == samples.name) {
                Some((series, curve)) => {
                    series.extend(&samples);
                    curve.extend(&samples);
                }
                None => {
                    let mut curve = Curve::default();
                    curve.extend(&samples);
                    all.push((Series::new(&samples), curve));
                }
            }
        })?;
        let series = all.into_iter().map(|(series, curve)| Signal::of(series, &curve)).collect();
        JsonText::of(&Signals { series })
    })
    .await
}
