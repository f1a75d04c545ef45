//! Lists and parameters in columns of text.

/// The JSON of a value; empty if it has none, which no stored type is.
pub(super) fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}
