//! The envelope of JSON-RPC 2.0: messages, replies and errors.

use serde::{Deserialize, Serialize};

/// A JSON-RPC message, one per line. `id` with `method` is a request, `method`
/// alone a notification, `id` alone an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RpcMessage<T> {
    /// Always `2.0`.
    pub jsonrpc: String,
    /// The request's number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<u64>,
    /// The message.
    #[serde(flatten)]
    pub body: T,
}

impl<T> RpcMessage<T> {
    /// A message with or without a number.
    #[must_use]
    pub fn new(id: Option<u64>, body: T) -> Self {
        Self { jsonrpc: "2.0".to_owned(), id, body }
    }
}

/// The body of an answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Reply<T> {
    /// The request was carried out.
    Result(T),
    /// The request was refused.
    Error(RpcError),
}

/// A JSON-RPC error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RpcError {
    /// One of the codes of [`protocol`](super), or another of JSON-RPC 2.0.
    pub code: i32,
    /// The error message.
    pub message: String,
}
