//! The real server on loopback, over journals that the tests write.

#![expect(clippy::expect_used, clippy::unwrap_used, reason = "what cannot go on fails its test")]

mod cases;
mod client;
mod damaged;
mod episodes;
mod files;
mod fixture_values;
mod history;
mod limits;
mod metrics;
mod reading;
mod security;
mod streams;
mod tls;
mod world;
