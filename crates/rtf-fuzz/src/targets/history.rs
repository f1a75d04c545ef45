//! Addresses of histories.

use rtf_history::Location;

const PASSWORD: &str = "Xq7-correct-horse";

/// An address: it never shows its password.
pub fn check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // libFuzzer finds texts with which the target compares.
    if text.contains(PASSWORD) {
        return;
    }
    check_address(text);
    // The same with a password, before what follows the user, and as an option.
    check_address(&format!("postgres://me:{PASSWORD}@{text}"));
    check_address(&format!("{text}?password={PASSWORD}"));
    check_address(&format!("{text}&password={PASSWORD}"));
}

fn check_address(address: &str) {
    let shown = match Location::postgres(address) {
        Ok(location) => {
            assert!(location.file().is_none());
            format!("{location} {location:?}")
        }
        Err(error) => format!("{error} {error:?}"),
    };
    assert!(!shown.contains(PASSWORD), "`{address}` is shown as `{shown}`");
}
