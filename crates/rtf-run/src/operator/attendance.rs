//! Who can answer the questions of tests.

use std::io::{self, IsTerminal as _};

/// Who can answer questions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attendance {
    /// Whether an operator can answer on the terminal.
    pub console: bool,
    /// Whether an operator can answer on the terminal of the campaign whose worker this is.
    pub campaign: bool,
    /// Why no operator can answer, if none can.
    pub unattended: Option<String>,
}

impl Attendance {
    /// No operator can answer, unless there is a page.
    pub fn on_page(has_page: bool, reason: &str) -> Self {
        let unattended = (!has_page).then(|| reason.to_owned());
        Self { console: false, campaign: false, unattended }
    }

    /// The questions of a worker are answered on the terminal of its campaign.
    pub fn of_campaign() -> Self {
        Self { console: false, campaign: true, unattended: None }
    }

    /// Finds out who can answer the questions of a run. `obstacle` is why the terminal of this process
    /// is not one of an operator.
    pub fn find(has_page: bool, obstacle: Option<&'static str>) -> Self {
        match obstacle.or_else(no_console) {
            None => Self { console: true, campaign: false, unattended: None },
            Some(reason) => {
                Self::on_page(has_page, &format!("{reason}, and there is no page (`--web`)"))
            }
        }
    }

    /// The test that is debugged has the terminal.
    pub fn without_terminal(self, has_page: bool) -> Self {
        if !self.console {
            return self;
        }
        Self::on_page(has_page, "the test has the terminal, and there is no page (`--web`)")
    }
}

/// Why an operator cannot answer on the terminal of this process.
fn no_console() -> Option<&'static str> {
    if is_ci(std::env::var("CI").ok().as_deref()) {
        Some("the variable `CI` is set")
    } else if !io::stdin().is_terminal() {
        Some("standard input is no terminal")
    } else if !io::stdout().is_terminal() || !io::stderr().is_terminal() {
        Some("the output goes to no terminal")
    } else {
        None
    }
}

/// Whether a variable `CI` has the value of a CI system.
fn is_ci(value: Option<&str>) -> bool {
    value.is_some_and(|value| !matches!(value, "" | "0" | "false"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ci_system_sets_its_variable() {
        for (value, expected) in
            [(None, false), (Some(""), false), (Some("false"), false), (Some("true"), true)]
        {
            assert_eq!(is_ci(value), expected, "{value:?}");
        }
    }
}
