//! The events of a run as they happen, as server-sent events.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::sse::{KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{self, StreamExt};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use super::problems::Problems;
use super::query::{At, Number, QueryParams};
use crate::app::App;
use crate::feed::{Details, Feed};
use crate::problem::Problem;

/// How long nothing is sent at most.
const SILENCE: Duration = Duration::from_secs(1);

/// Which events.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct EventQuery {
    /// The number of the first event; the next one to come when it is left out.
    #[param(value_type = Option<u64>, maximum = 9_007_199_254_740_991_i64)]
    from: Option<Number>,
    /// Whose messages, measurements and outputs: `all`, `none`, or a list like
    /// `test:3,fixture:0,hook:1`.
    #[param(
        pattern = "^(all|none|(test|fixture|hook):[0-9]{1,9}(,(test|fixture|hook):[0-9]{1,9})*)$"
    )]
    details: Option<String>,
}

/// Where a stream that was cut continues.
#[derive(IntoParams)]
#[into_params(parameter_in = Header)]
#[expect(dead_code, reason = "read from the headers; this describes it")]
pub struct Resumed {
    /// The last event that was seen.
    #[param(rename = "last-event-id", required = false, maximum = 9_007_199_254_740_991_i64)]
    last_event_id: u64,
}

/// One message of a stream.
#[derive(ToSchema)]
#[expect(dead_code, reason = "axum writes it; this describes it")]
pub struct Sent {
    /// The number of the event.
    id: String,
    /// `message` (not written), `progress`, `resync` or `end`.
    #[schema(required = false)]
    event: String,
    /// JSON: of a `message` an `Event`, of the others see `spec/web.md`.
    #[schema(content_media_type = "application/json")]
    data: String,
}

/// The events of a run as they happen.
#[utoipa::path(get, path = "/runs/{run}/events", tag = "events",
    params(("run" = String, Path), EventQuery, Resumed),
    responses(
        (status = 200, content_type = "text/event-stream", body = Sent),
        (status = 204, description = "the run is over, and nothing follows"),
        Problems))]
pub async fn events(
    State(app): State<App>,
    At(run): At<String>,
    QueryParams(which): QueryParams<EventQuery>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let details = Details::parse(which.details.as_deref().unwrap_or("all"))?;
    let from = match headers.get("last-event-id").map(last_event) {
        Some(last) => Some(last?.saturating_add(1)),
        None => which.from.map(|Number(from)| from),
    };
    let place = app.streams.clone().try_acquire_owned().map_err(|_| {
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "there are too many event streams")
    })?;
    let runs = app.runs.clone();
    let opened = app.with_run(run, move |run| {
        let feed = Feed::open(run.clone(), from, details)?;
        Ok(feed.map(|feed| (feed, runs.is_own(run))))
    });
    let Some((mut feed, is_own)) = opened.await? else {
        return Ok(StatusCode::NO_CONTENT.into_response());
    };
    feed.listen(is_own.then(|| app.grown.clone()), app.ending.clone());
    let batches = stream::unfold(feed, |mut feed| async move {
        let batch = feed.next().await?;
        Some((batch, feed))
    });
    let events = batches.flat_map(|batch| stream::iter(batch.into_iter().map(Ok::<_, Infallible>)));
    // The place is given back when the client has gone.
    let events = events.map(move |event| {
        let _ = &place;
        event
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::new().interval(SILENCE)).into_response())
}

/// The number in `Last-Event-ID`.
fn last_event(value: &HeaderValue) -> Result<u64, Problem> {
    let number = value.to_str().ok().and_then(|id| id.parse().ok());
    let number = number.and_then(|number: u64| Number::try_from(number).ok());
    let bad = || Problem::bad_request("`Last-Event-ID` is no number of an event");
    number.map(|Number(last)| last).ok_or_else(bad)
}
