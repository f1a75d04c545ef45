//! The routes of a server and the state of their handlers.

use std::net::SocketAddr;
use std::sync::{Arc, OnceLock};

use axum::body::Body;
use axum::extract::{ConnectInfo, Request};
use axum::response::Response;
use axum::routing::get;
use axum::{Router, middleware};
use tokio::sync::{Semaphore, watch};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::{CompressionLayer, CompressionLevel};
use tower_service::Service as _;

use crate::access::{self, Access, AccessLog, Hosts, Rules, Secret};
use crate::app::{App, STREAMS};
use crate::connections::{Limits, Peer};
use crate::runs::Runs;
use crate::service::{ServeError, Service};
use crate::{api, legacy, metrics, page};

/// The state of all handlers, and what changes it.
pub struct Prepared {
    pub app: App,
    /// Becomes true when the server shuts down.
    pub ending: watch::Sender<bool>,
    /// Changes when the journal of the own run has grown.
    pub grown: watch::Sender<u64>,
}

impl Prepared {
    /// The state of a server.
    ///
    /// # Errors
    /// The thread that reports wrong tokens cannot be started, or there are no random bytes.
    pub fn new(
        (token, hosts, rules): (Secret, Hosts, Rules),
        limits: Limits,
        service: Service<'_>,
    ) -> Result<Self, ServeError> {
        let Service { results, history, campaigns, metrics, role, commands, wrong_token } = service;
        let log = AccessLog::start(wrong_token).map_err(ServeError::Start)?;
        let access = Access::new(token, hosts, rules, log)?;
        let (ending, ends) = watch::channel(false);
        let (grown, grows) = watch::channel(0);
        let app = App {
            runs: Arc::new(Runs::new(results, role.own().map(str::to_owned))),
            history,
            campaigns,
            metrics,
            access: Arc::new(access),
            role,
            commands,
            grown: grows,
            ending: ends,
            streams: Arc::new(Semaphore::new(STREAMS)),
            lingers: Arc::new(OnceLock::new()),
            files: Arc::new(Semaphore::new(limits.files())),
        };
        Ok(Self { app, ending, grown })
    }
}

/// The routes of a server that has no connections.
#[derive(Debug)]
pub struct Routes {
    pub(crate) router: Router,
    pub token: String,
    /// The address for the header `Host`.
    pub address: SocketAddr,
    /// Keep event streams open.
    pub(crate) _senders: (watch::Sender<bool>, watch::Sender<u64>),
}

impl Routes {
    pub async fn answer(&self, client: SocketAddr, mut request: Request<Body>) -> Response {
        request.extensions_mut().insert(ConnectInfo(Peer(client)));
        match self.router.clone().call(request).await {
            Ok(response) => response,
            Err(never) => match never {},
        }
    }
}

/// All routes, behind the check of access.
pub fn router(app: App) -> Router {
    let guard = middleware::from_fn_with_state(app.access.clone(), access::guard);
    api::router()
        .route("/status", get(legacy::status))
        .route("/update", get(legacy::update))
        .route("/api/docs", get(page::docs))
        .route("/metrics", get(metrics::metrics))
        .fallback_service(get(page::page))
        .layer(CompressionLayer::new().quality(CompressionLevel::Fastest))
        .layer(guard)
        .layer(CatchPanicLayer::new())
        .layer(middleware::from_fn(page::headers))
        .with_state(app)
}
