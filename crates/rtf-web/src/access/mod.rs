//! Who may do what: the token, sessions of browsers, and the two headers that
//! tell where a request comes from and what it believes to speak to.
//!
//! [`guard`] stands before every route.

mod host;
mod secret;

use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

pub use host::{Hosts, machine};
pub use secret::{Secret, TokenError};

use crate::api::ROOT;
use crate::app::App;
use crate::problem::Problem;

/// The largest body of a request: a token and some room.
const BODY: usize = 4096;

/// Who makes a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who {
    /// Nobody that is known.
    Nobody,
    /// A program with the token.
    Token,
    /// A browser with a session.
    Session,
}

/// Who may do what.
#[derive(Debug)]
pub struct Access {
    token: Secret,
    session: Secret,
    cookie: String,
    hosts: Hosts,
    /// Whether reading needs the token, too.
    remote: bool,
    tls: bool,
}

impl Access {
    /// The rules of a server.
    ///
    /// # Errors
    /// The system has no random bytes.
    pub fn new(token: Secret, hosts: Hosts, remote: bool, tls: bool) -> Result<Self, TokenError> {
        let cookie = format!("rtf-{}", hosts.port());
        Ok(Self { token, session: Secret::random()?, cookie, hosts, remote, tls })
    }

    /// Whether reading needs the token.
    #[must_use]
    pub fn token_to_read(&self) -> bool {
        self.remote
    }

    /// Who makes the request with these headers.
    #[must_use]
    pub fn who(&self, headers: &HeaderMap) -> Who {
        let text = |value: &HeaderValue| value.to_str().ok().map(str::to_owned);
        let bearer = headers.get(header::AUTHORIZATION).and_then(text);
        let bearer = bearer.as_deref().and_then(|value| value.strip_prefix("Bearer "));
        if bearer.is_some_and(|token| self.token.is(token.trim())) {
            return Who::Token;
        }
        let cookies = headers.get_all(header::COOKIE).iter().filter_map(text);
        let mut pairs = cookies.flat_map(|line| {
            line.split(';').map(|pair| pair.trim().to_owned()).collect::<Vec<_>>()
        });
        let is_ours = |pair: String| {
            pair.split_once('=')
                .is_some_and(|(name, value)| name == self.cookie && self.session.is(value))
        };
        if pairs.any(is_ours) { Who::Session } else { Who::Nobody }
    }

    /// The cookie of a session, for whoever has the token.
    #[must_use]
    pub fn open_session(&self, token: &str) -> Option<HeaderValue> {
        self.token.is(token).then(|| self.cookie(self.session.text(), ""))
    }

    /// The cookie that ends a session.
    #[must_use]
    pub fn closed_session(&self) -> HeaderValue {
        self.cookie("", "; Max-Age=0")
    }

    fn cookie(&self, value: &str, more: &str) -> HeaderValue {
        let secure = if self.tls { "; Secure" } else { "" };
        let cookie =
            format!("{}={value}; HttpOnly; SameSite=Strict; Path=/{secure}{more}", self.cookie);
        HeaderValue::from_str(&cookie).unwrap_or(HeaderValue::from_static("rtf="))
    }

    fn check(&self, request: &Request) -> Result<(), Problem> {
        let headers = request.headers();
        let host = self.hosts.check(request.uri(), headers)?;
        let path = request.uri().path();
        let who = self.who(headers);
        if !request.method().is_safe() {
            self.check_change(request, &host, who)?;
        }
        let is_open = path == ROOT || is_session(path) || !is_data(path);
        if self.remote && who == Who::Nobody && !is_open {
            return Err(unauthorised("reading from beyond this machine needs the token"));
        }
        Ok(())
    }

    fn check_change(&self, request: &Request, host: &str, who: Who) -> Result<(), Problem> {
        let headers = request.headers();
        let foreign = || {
            let detail = "a page of another origin may not change anything here";
            Problem::new(StatusCode::FORBIDDEN, detail)
        };
        match headers.get(header::ORIGIN) {
            Some(origin) if !host::is_origin_of(origin, host, self.tls) => return Err(foreign()),
            Some(_) => {}
            // Browsers always tell; a cookie alone proves nothing.
            None if who == Who::Session => return Err(foreign()),
            None => {}
        }
        let site = headers.get("sec-fetch-site").map(HeaderValue::as_bytes);
        if site.is_some_and(|site| site != b"same-origin" && site != b"none") {
            return Err(foreign());
        }
        let path = request.uri().path();
        if who == Who::Nobody && !is_session(path) && is_data(path) && is_known(request.method()) {
            return Err(unauthorised("control needs the token"));
        }
        let length = headers.get(header::CONTENT_LENGTH).and_then(|l| l.to_str().ok());
        let has_body = length.is_some_and(|length| length != "0")
            || headers.contains_key(header::TRANSFER_ENCODING);
        let kind = headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
        let is_json = |kind: &str| {
            kind.split(';')
                .next()
                .is_some_and(|k| k.trim().eq_ignore_ascii_case("application/json"))
        };
        // A form of another site cannot send JSON without asking first.
        if (has_body || kind.is_some()) && !kind.is_some_and(is_json) {
            let detail = "a body is taken as `application/json` only";
            return Err(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, detail));
        }
        if length.and_then(|length| length.parse::<usize>().ok()).is_some_and(|l| l > BODY) {
            return Err(Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "the body is too long"));
        }
        Ok(())
    }
}

fn unauthorised(detail: &str) -> Problem {
    let hint = "send `Authorization: Bearer TOKEN`, or open a session; the token is part of the \
                address that was printed at the start";
    Problem::new(StatusCode::UNAUTHORIZED, detail).hint(hint)
}

fn is_session(path: &str) -> bool {
    path.strip_prefix(ROOT) == Some("/session")
}

/// Methods that some route has; the others are refused by all.
fn is_known(method: &Method) -> bool {
    [Method::POST, Method::DELETE].contains(method)
}

/// Whether this path may lead to what was tested; the page itself holds none of it.
fn is_data(path: &str) -> bool {
    path.starts_with("/api/v1") && !path.ends_with("/openapi.json")
        || path.starts_with("/status")
        || path.starts_with("/update")
}

/// Lets through what is allowed.
pub async fn guard(State(app): State<App>, request: Request<Body>, next: Next) -> Response {
    match app.access.check(&request) {
        Ok(()) => next.run(request).await,
        Err(problem) => problem.into_response(),
    }
}
