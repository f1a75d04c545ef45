//! The colours of the console. All information is also available without colours.

use anstyle::{AnsiColor, Style};
use rtf_model::Verdict;

use crate::explain::Tone;

pub(super) const BOLD: Style = Style::new().bold();
pub(super) const DIM: Style = Style::new().dimmed();
pub(super) const GOOD: Style = AnsiColor::Green.on_default().bold();
pub(super) const BAD: Style = AnsiColor::Red.on_default().bold();
pub(super) const LOUD: Style = AnsiColor::Yellow.on_default().bold();

pub(super) fn of_verdict(verdict: Verdict) -> Style {
    match verdict {
        Verdict::Passed => GOOD,
        Verdict::Skipped | Verdict::Interrupted => LOUD,
        _ => BAD,
    }
}

pub(super) fn of_tone(tone: Tone) -> Style {
    match tone {
        Tone::Bad => AnsiColor::Red.on_default(),
        Tone::Plain => Style::new(),
        Tone::Dim => DIM,
    }
}

/// The text between the codes that switch the style on and off.
pub(super) fn paint(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}
