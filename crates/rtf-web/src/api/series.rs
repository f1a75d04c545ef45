//! The signals that one attempt of a test sampled: in numbers, and as curves that
//! are drawn. The samples themselves are in the journal.

use std::ops::ControlFlow;

use axum::extract::State;
use rtf_model::{EventKind, Samples};
use serde::Deserialize;
use utoipa::IntoParams;

use super::details::{DetailQuery, Path3};
use super::problems::Problems;
use super::query::{At, QueryParams};
use crate::app::{App, JsonResult, JsonText};
use crate::problem::Problem;
use crate::views::{SignalList, Signals};

/// Which samples, and which part of the curves. The numbers are always those of the whole signal.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Window {
    /// Only those of this case and of the cases that it contains.
    #[param(maximum = 4_294_967_295_i64)]
    case: Option<u32>,
    /// Points from this time on, in seconds.
    from: Option<f64>,
    /// Points up to this time, in seconds.
    to: Option<f64>,
}

impl Window {
    fn check(self) -> Result<Self, Problem> {
        let is_number = |time: Option<f64>| time.is_none_or(f64::is_finite);
        if is_number(self.from) && is_number(self.to) {
            return Ok(self);
        }
        Err(Problem::bad_request("`from` and `to` are no window: expected finite numbers"))
    }

    /// The samples in the window.
    fn of(self, mut samples: Samples) -> Samples {
        let (from, to) = (self.from.unwrap_or(f64::MIN), self.to.unwrap_or(f64::MAX));
        samples.points.retain(|(at, _)| (from..=to).contains(at));
        samples
    }
}

/// The signals that an attempt of a test sampled.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/series",
    tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), Window),
    responses((status = 200, body = Signals), Problems))]
pub async fn series(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(window): QueryParams<Window>,
) -> JsonResult {
    let window = window.check()?;
    let part = DetailQuery::samples_of(test, number).in_case(window.case);
    app.with_run(run, move |run| {
        let mut all = SignalList::default();
        part.each(run, |event, _| {
            if let EventKind::Sampled { samples, .. } = event.kind {
                all.add_samples(samples, |samples| window.of(samples));
            }
            ControlFlow::Continue(())
        })?;
        let series = all.into_signals();
        JsonText::of(&Signals { series })
    })
    .await
}
