//! What this server is, and sessions of browsers.

use std::time::{Instant, SystemTime};

use axum::extract::rejection::JsonRejection;
use axum::extract::{ConnectInfo, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::problems::{ChangeProblems, Problems};
use crate::access::Who;
use crate::app::{App, JsonResult, JsonText, blocking};
use crate::connections::Peer;
use crate::problem::Problem;

/// What this server is.
#[derive(Debug, Serialize, ToSchema)]
pub struct Server {
    /// The version of the API.
    api: u32,
    /// The version of the runner.
    rtf: &'static str,
    /// `run` when it makes a run, `serve` when it shows the runs of others.
    mode: &'static str,
    /// The current run.
    #[serde(skip_serializing_if = "Option::is_none")]
    current: Option<String>,
    /// The run that can be stopped here.
    #[serde(skip_serializing_if = "Option::is_none")]
    controlled: Option<String>,
    /// Whether the token allows something here.
    control: bool,
    /// Whether failed tests can be rerun here.
    rerun: bool,
    /// Whether this request came with the token or a session.
    authorised: bool,
    /// Whether reading needs the token.
    token_to_read: bool,
    /// The remaining seconds of a server whose run has ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    lingers_s: Option<u64>,
    /// The server's time of day, in seconds since 1970.
    seconds: f64,
}

/// What this server is.
#[utoipa::path(get, path = "", tag = "server", responses((status = 200, body = Server), Problems))]
pub async fn server(State(app): State<App>, Extension(who): Extension<Who>) -> JsonResult {
    let authorised = who != Who::Nobody;
    let token_to_read = app.access.token_to_read();
    blocking(move || {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let tells = authorised || !token_to_read;
        let makes = app.role.own().is_some();
        JsonText::of(&Server {
            api: 1,
            rtf: env!("CARGO_PKG_VERSION"),
            mode: if makes { "run" } else { "serve" },
            current: app.runs.current().filter(|_| tells),
            controlled: app.role.controlled().filter(|_| tells),
            control: true,
            rerun: !makes,
            authorised,
            token_to_read,
            lingers_s: app
                .lingers
                .get()
                .map(|end| end.saturating_duration_since(Instant::now()).as_secs()),
            seconds: now.as_secs_f64(),
        })
    })
    .await
}

/// What opens a session.
#[derive(Deserialize, ToSchema)]
pub struct Opening {
    /// The token that was printed at the start.
    token: String,
}

/// Opens a session: sets its cookie.
#[utoipa::path(post, path = "/session", tag = "server", request_body = Opening,
    responses((status = 204), ChangeProblems))]
pub async fn open(
    State(app): State<App>,
    ConnectInfo(Peer(client)): ConnectInfo<Peer>,
    body: Result<Json<Opening>, JsonRejection>,
) -> Result<Response, Problem> {
    let Json(Opening { token }) = body.map_err(rejected)?;
    let Some(cookie) = app.access.open_session(client.ip(), &token).await else {
        return Err(Problem::new(StatusCode::UNAUTHORIZED, "this is not the token")
            .hint("it is part of the address that was printed at the start"));
    };
    Ok((StatusCode::NO_CONTENT, [(header::SET_COOKIE, cookie)]).into_response())
}

/// Ends the session of this browser.
#[utoipa::path(delete, path = "/session", tag = "server",
    responses((status = 204), ChangeProblems))]
pub async fn close(State(app): State<App>) -> Response {
    let cookie = app.access.closed_session();
    (StatusCode::NO_CONTENT, [(header::SET_COOKIE, cookie)]).into_response()
}

/// Why a body was not taken.
pub fn rejected(rejection: JsonRejection) -> Problem {
    // A body that is JSON and not what was asked for is a bad request, as any other.
    let status = match rejection.status() {
        StatusCode::UNPROCESSABLE_ENTITY => StatusCode::BAD_REQUEST,
        status => status,
    };
    Problem::new(status, rejection.body_text())
}
