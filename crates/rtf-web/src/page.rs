//! The page: what was built in `web/`, embedded. A build without it says how to
//! get it.

use std::borrow::Cow;

use axum::extract::Request;
use axum::http::{HeaderValue, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{Html, IntoResponse, Response};
use rust_embed::{EmbeddedFile, RustEmbed};

use crate::header::insert;
use crate::problem::Problem;

#[derive(RustEmbed)]
#[folder = "../../web/dist"]
#[allow_missing = true]
struct Dist;

/// What pages may load: only what comes from here.
const POLICY: &str = "default-src 'self'; img-src 'self' data:; object-src 'none'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The same for the API's description, whose viewer writes styles as it goes.
const DOCS_POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; \
                           img-src 'self' data:; object-src 'none'; base-uri 'none'; \
                           form-action 'none'; frame-ancestors 'none'";

const VIEWER: &str = "rapidoc-min.js";

const UNBUILT: &str = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">\
<title>Robot Testing Framework</title>\n<h1>This build has no page</h1>\n\
<p>Build it with <code>make web</code> in the sources of rtf, then build <code>rtf</code> again.</p>\n\
<p>The API is all there: <a href=\"/api/v1\">/api/v1</a>, described in \
<a href=\"/api/v1/openapi.json\">/api/v1/openapi.json</a>.</p>\n</html>\n";

const DOCS: &str = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">\
<meta name=\"viewport\" content=\"width=device-width\"><title>API of the Robot Testing Framework</title>\n\
<script type=\"module\" src=\"/rapidoc-min.js\"></script>\n\
<rapi-doc spec-url=\"/api/v1/openapi.json\" render-style=\"read\" load-fonts=\"false\" \
allow-authentication=\"true\" show-header=\"false\"></rapi-doc>\n</html>\n";

const BARE_DOCS: &str = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">\
<title>API of the Robot Testing Framework</title>\n<p>This build has no viewer. The description is \
<a href=\"/api/v1/openapi.json\">/api/v1/openapi.json</a>.</p>\n</html>\n";

/// The page as a report, without data; see [`crate::html_report`].
const REPORT: &str = "report.html";

/// The page as a report, if it was built.
pub fn report_template() -> Option<Cow<'static, [u8]>> {
    Dist::get(REPORT).map(|file| file.data)
}

/// The page, or a file of it.
pub async fn page(uri: Uri) -> Response {
    let path = uri.path().trim_start_matches('/');
    let name = if path.is_empty() { "index.html" } else { path };
    match Dist::get(name).filter(|_| name != REPORT) {
        Some(file) => asset(name, file),
        None if path.is_empty() => Html(UNBUILT).into_response(),
        None => Problem::not_found("there is no such page").into_response(),
    }
}

fn asset(name: &str, file: EmbeddedFile) -> Response {
    let kind = mime_guess::from_path(name).first_or_octet_stream();
    let text = matches!(kind.type_().as_str(), "text") || kind.subtype() == "javascript";
    let kind = if text { format!("{kind}; charset=utf-8") } else { kind.to_string() };
    // The names of assets change with what they hold.
    let keep = name.starts_with("assets/");
    let keep = if keep { "public, max-age=31536000, immutable" } else { "no-cache" };
    let mut response = file.data.into_response();
    let headers = response.headers_mut();
    insert(headers, header::CONTENT_TYPE, &kind);
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static(keep));
    response
}

/// The API's description, to browse.
pub async fn docs() -> Response {
    let viewer = Dist::get(VIEWER).is_some();
    let mut response = Html(if viewer { DOCS } else { BARE_DOCS }).into_response();
    let policy = HeaderValue::from_static(DOCS_POLICY);
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
    response
}

/// The headers of every answer.
pub async fn headers(request: Request, next: Next) -> Response {
    let is_api = request.uri().path().starts_with("/api/");
    let mut response = next.run(request).await;
    if response.status() == StatusCode::METHOD_NOT_ALLOWED {
        let problem = Problem::new(response.status(), "this route has no such method");
        let allowed = response.headers_mut().remove(header::ALLOW);
        response = problem.into_response();
        response.headers_mut().extend(allowed.map(|allowed| (header::ALLOW, allowed)));
    }
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::CACHE_CONTROL, if is_api { "no-store" } else { "no-cache" }),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ] {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    }
    response
}
