//! Parses the replies of hosts.

use rtf_model::protocol::{Answer, Initialized, PROTOCOL_VERSION, Reply, RpcError};

pub fn parse_initialized(reply: Reply<serde_json::Value>) -> Result<Initialized, String> {
    let value = match reply {
        Reply::Result(value) => value,
        Reply::Error(error) => {
            return Err(format!(
                "it does not speak protocol {PROTOCOL_VERSION}: {}",
                error.message
            ));
        }
    };
    let initialized: Initialized = serde_json::from_value(value)
        .map_err(|error| format!("its answer to `initialize` is not understood: {error}"))?;
    if initialized.protocol == PROTOCOL_VERSION {
        Ok(initialized)
    } else {
        Err(format!("{} speaks protocol {}", initialized.host, initialized.protocol))
    }
}

/// Parses the reply to a request that calls plug-in code.
pub fn parse_answer(reply: Reply<serde_json::Value>) -> Result<Result<Answer, RpcError>, String> {
    match reply {
        Reply::Error(error) => Ok(Err(error)),
        Reply::Result(value) => serde_json::from_value(value)
            .map(Ok)
            .map_err(|error| format!("an answer is not understood: {error}")),
    }
}
