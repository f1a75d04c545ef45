//! Version 1 of the API: its routes, and its description made from them.

mod campaigns;
mod case_filter;
mod cases;
mod control;
mod details;
mod events;
mod files;
mod history;
mod logs;
mod plan;
mod problems;
mod query;
mod questions;
mod runs;
mod series;
mod session;
mod tests;

use axum::Router;
use axum::response::IntoResponse;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::address::API;
use crate::app::App;
use crate::problem::Problem;
use crate::views::model;

/// The description as it is kept in `schemas/`: with the model's schemas in it.
const DESCRIPTION: &str = include_str!("../../../../schemas/openapi.json");

#[derive(OpenApi)]
#[openapi(
    info(
        title = "Robot Testing Framework",
        version = "1",
        description = "Live and past runs: what `rtf run --web` and `rtf serve` answer. \
                       See `spec/web.md`.",
        license(name = "Apache-2.0", identifier = "Apache-2.0"),
    ),
    components(schemas(Problem, model::Event)),
    modifiers(&Security),
    security((), ("token" = []), ("session" = [])),
)]
struct ApiDescription;

struct Security;

impl utoipa::Modify for Security {
    fn modify(&self, openapi: &mut utoipa::openapi::OpenApi) {
        use utoipa::openapi::security::{
            ApiKey, ApiKeyValue, HttpAuthScheme, HttpBuilder, SecurityScheme,
        };
        let components = openapi.components.get_or_insert_default();
        let token = HttpBuilder::new().scheme(HttpAuthScheme::Bearer).build();
        components.add_security_scheme("token", SecurityScheme::Http(token));
        let session = ApiKey::Cookie(ApiKeyValue::new("rtf-8080"));
        components.add_security_scheme("session", SecurityScheme::ApiKey(session));
    }
}

fn routes() -> OpenApiRouter<App> {
    let api = OpenApiRouter::new()
        .routes(routes!(session::server))
        .routes(routes!(session::open, session::close))
        .routes(routes!(runs::list))
        .routes(routes!(runs::run))
        .routes(routes!(runs::snapshot))
        .routes(routes!(plan::suites))
        .routes(routes!(plan::suite))
        .routes(routes!(plan::fixtures))
        .routes(routes!(plan::fixture))
        .routes(routes!(plan::hooks))
        .routes(routes!(plan::hook))
        .routes(routes!(tests::list))
        .routes(routes!(tests::test))
        .routes(routes!(cases::cases))
        .routes(routes!(details::test_messages))
        .routes(routes!(details::fixture_messages))
        .routes(routes!(details::hook_messages))
        .routes(routes!(details::measurements))
        .routes(routes!(series::series))
        .routes(routes!(details::attachments))
        .routes(routes!(details::stacks))
        .routes(routes!(questions::questions))
        .routes(routes!(details::test_output))
        .routes(routes!(details::fixture_output))
        .routes(routes!(details::hook_output))
        .routes(routes!(logs::log))
        .routes(routes!(files::file))
        .routes(routes!(files::journal))
        .routes(routes!(events::events))
        .routes(routes!(campaigns::campaign))
        .routes(routes!(history::runs))
        .routes(routes!(history::matrix))
        .routes(routes!(history::test))
        .routes(routes!(history::trend))
        .routes(routes!(history::campaigns))
        .routes(routes!(history::flaky))
        .routes(routes!(history::slow))
        .routes(routes!(history::compare))
        .routes(routes!(control::stop_run))
        .routes(routes!(control::stop_test))
        .routes(routes!(control::skip_suite))
        .routes(routes!(questions::answer))
        .routes(routes!(control::rerun));
    OpenApiRouter::with_openapi(ApiDescription::openapi()).nest(API, api)
}

/// The routes.
pub fn router() -> Router<App> {
    let (router, _) = routes().split_for_parts();
    let unknown = || async { Problem::not_found("there is no such route") };
    let description = || async {
        ([(axum::http::header::CONTENT_TYPE, "application/json")], DESCRIPTION).into_response()
    };
    router
        .route(&format!("{API}/openapi.json"), axum::routing::get(description))
        .route(&format!("{API}/{{*unknown}}"), axum::routing::any(unknown))
}

/// The description made from the code, with empty schemas for [`model::NAMES`].
///
/// # Errors
/// It cannot be written as JSON.
pub fn description() -> serde_json::Result<serde_json::Value> {
    let (_, openapi) = routes().split_for_parts();
    serde_json::to_value(openapi)
}
