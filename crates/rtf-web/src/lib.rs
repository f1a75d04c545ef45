//! Live and past runs in a browser: a page, an API, a stream of events.
//!
//! Nothing but journals is read, also of the run that goes on; see `spec/web.md`.
//! [`Bound::serve`] serves on a thread of its own. A request finds its run in
//! [`runs`], which follows the run's journal with an [`index`]: a lean
//! [`rtf_model::Record`] and the places of what it does not keep. [`api`] makes
//! answers of it, [`feed`] a stream. [`access`] stands before all of it.
//!
//! The run pays for none of this: its only part here is [`Live`], which tells
//! that the journal has grown.

mod access;
mod api;
mod app;
mod below;
mod connections;
mod feed;
mod index;
mod legacy;
mod live;
mod page;
mod problem;
mod role;
mod runs;
mod server;
mod stream_file;
mod tls;

pub use access::{TokenError, WrongToken};
pub use api::{description, model};
pub use connections::Limits;
pub use live::Live;
pub use role::{Control, NotStarted, Past, Role, Starter};
pub use server::{Bound, Ender, ServeError, Served, Server, Settings};
pub use tls::TlsError;
