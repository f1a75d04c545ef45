//! The text of a stored trajectory.

use std::fmt::Write as _;

use crate::{Thinned, Trajectory, TrajectoryError};

/// The media type of the text, as an attachment of a test.
pub const MEDIA_TYPE: &str = "text/vnd.rtf.trajectory";

const HEADER: &str = "# rtf trajectory 1";
/// The line before the points.
const COLUMNS: &str = "time,value";

/// A stored trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Names and texts of the comments: `signal`, `unit`, `run`, …, in order.
    pub fields: Vec<(String, String)>,
    pub trajectory: Trajectory,
    time_decimals: usize,
    decimals: usize,
}

/// Why a text is no stored trajectory.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParseError {
    #[error("line 1: expected `{HEADER}`")]
    Header,
    #[error("line {0}: expected a time and a value, separated by a comma")]
    Point(usize),
    #[error(transparent)]
    Points(#[from] TrajectoryError),
}

impl Reference {
    /// Creates a reference of thinned points.
    ///
    /// # Errors
    /// The points are no trajectory.
    pub fn new(fields: Vec<(String, String)>, thinned: &Thinned) -> Result<Self, TrajectoryError> {
        let trajectory = Trajectory::new(&thinned.points)?;
        let Thinned { time_decimals, decimals, .. } = *thinned;
        Ok(Self { fields, trajectory, time_decimals, decimals })
    }

    #[must_use]
    pub fn field(&self, name: &str) -> Option<&str> {
        let found = self.fields.iter().find(|(known, _)| known == name);
        found.map(|(_, text)| text.as_str())
    }

    /// Parses a text.
    ///
    /// # Errors
    /// A line is invalid.
    pub fn parse(text: &str) -> Result<Self, ParseError> {
        let mut fields = Vec::new();
        let mut points = Vec::new();
        let (mut time_decimals, mut decimals) = (0, 0);
        let mut lines = text.lines().map(str::trim_end).enumerate();
        if lines.next().is_none_or(|(_, line)| line != HEADER) {
            return Err(ParseError::Header);
        }
        for (index, line) in lines {
            if let Some(comment) = line.strip_prefix('#') {
                if let Some((name, text)) = comment.split_once(':') {
                    fields.push((name.trim().to_owned(), text.trim().to_owned()));
                }
                continue;
            }
            if line.is_empty() || line == COLUMNS {
                continue;
            }
            let invalid = || ParseError::Point(index + 1);
            let (time, value) = line.split_once(',').ok_or_else(invalid)?;
            let number = |text: &str| text.trim().parse::<f64>().map_err(|_| invalid());
            points.push((number(time)?, number(value)?));
            time_decimals = time_decimals.max(decimals_of(time));
            decimals = decimals.max(decimals_of(value));
        }
        let trajectory = Trajectory::new(&points)?;
        Ok(Self { fields, trajectory, time_decimals, decimals })
    }
}

fn decimals_of(number: &str) -> usize {
    number.trim().split_once('.').map_or(0, |(_, decimals)| decimals.len())
}

impl std::fmt::Display for Reference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = format!("{HEADER}\n");
        for (name, value) in &self.fields {
            // A text with line breaks would be several comments.
            let value = value.replace(char::is_control, " ");
            writeln!(text, "# {name}: {}", value.trim())?;
        }
        writeln!(text, "{COLUMNS}")?;
        let (time_decimals, decimals) = (self.time_decimals, self.decimals);
        for (time, value) in self.trajectory.points() {
            // No negative zero.
            let value = value + 0.0;
            writeln!(text, "{time:.time_decimals$},{value:.decimals$}")?;
        }
        f.write_str(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thin;

    #[test]
    fn a_text_is_read_as_it_was_written() {
        let trajectory = Trajectory::new(&[(1.0, -0.00001), (1.5, 2.0), (2.0, 0.125)]).unwrap();
        let fields = vec![
            ("signal".to_owned(), "q".to_owned()),
            ("unit".to_owned(), "rad".to_owned()),
            ("test".to_owned(), "a\nb: c\u{11}".to_owned()),
        ];
        let reference = Reference::new(fields, &thin(&trajectory, 0.01)).unwrap();
        let text = reference.to_string();
        assert_eq!(
            text,
            "# rtf trajectory 1\n# signal: q\n# unit: rad\n# test: a b: c\ntime,value\n\
             0.000,0.000\n0.500,2.000\n1.000,0.125\n"
        );
        let read = Reference::parse(&text).unwrap();
        assert_eq!(read.to_string(), text);
        assert_eq!(read.field("test"), Some("a b: c"));
        assert_eq!(read.field("none"), None);
    }

    #[test]
    fn invalid_texts_are_refused_with_their_line() {
        let error = |text: &str| Reference::parse(text).unwrap_err().to_string();
        assert_eq!(error("time,value\n"), "line 1: expected `# rtf trajectory 1`");
        let header = "# rtf trajectory 1\n\ntime,value\r\n";
        assert!(error(&format!("{header}0,1\n1\n")).starts_with("line 5: "));
        assert!(error(&format!("{header}0,x\n")).starts_with("line 4: "));
        assert_eq!(error(header), "it has no samples");
        assert_eq!(
            error(&format!("{header}0,1\n0,2\n")),
            "the time 0 s is not after the one before"
        );
        assert_eq!(error(&format!("{header}0,inf\n")), "the value at 0 s is not finite");
    }
}
