//! The variable that lets programs in Python write their output at once. Written to a pipe, it
//! would wait in a buffer: readiness that is read from the output would never arrive.

const VARIABLE: &str = "PYTHONUNBUFFERED";

/// Returns the variable, unless the user's environment has it, perhaps without a value. Variables
/// of the suite that follow it take precedence.
pub fn variable() -> Option<(String, String)> {
    let is_set = std::env::var_os(VARIABLE).is_some();
    (!is_set).then(|| (VARIABLE.to_owned(), "1".to_owned()))
}
