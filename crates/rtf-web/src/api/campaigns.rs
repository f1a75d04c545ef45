//! The results of campaigns.

use axum::extract::State;

use super::problems::Problems;
use super::query::At;
use crate::app::{App, JsonResult, JsonText, blocking};
use crate::campaign_report::CampaignReport;
use crate::problem::Problem;

/// The results of a campaign in the results directory, also while it runs.
#[utoipa::path(get, path = "/campaigns/{campaign}", tag = "campaigns", operation_id = "campaign",
    params(("campaign" = String, Path, description = "The name of its directory.")),
    responses((status = 200, body = CampaignReport), Problems))]
pub async fn campaign(State(app): State<App>, At(name): At<String>) -> JsonResult {
    let source = app.campaigns.clone();
    blocking(move || match source.report(&name) {
        Ok(Some(report)) => JsonText::of(&report),
        Ok(None) => Err(Problem::not_found("there is no such campaign")),
        Err(reason) => Err(Problem::new(axum::http::StatusCode::SERVICE_UNAVAILABLE, reason)),
    })
    .await
}
