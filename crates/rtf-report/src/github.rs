//! Workflow commands of GitHub Actions, which annotate the
//! changed lines: `::error file=…,line=…,title=…::…`.

use std::io::{self, Write};
use std::path::Path;

use rtf_model::Record;

use crate::finding::{self, Finding, Rank, Roots};

/// Writes a command for each finding. `repository` is the directory to which
/// GitHub's file names are relative; `None`: the run's.
///
/// # Errors
/// `out` cannot be written.
pub fn write(out: &mut dyn Write, record: &Record, repository: Option<&Path>) -> io::Result<()> {
    for finding in finding::all(record, &Roots::new(record, repository)) {
        writeln!(out, "{}", command(&finding))?;
    }
    Ok(())
}

fn command(finding: &Finding) -> String {
    let level = match finding.rank {
        Rank::Unsafe | Rank::Bench | Rank::Robot => "error",
        Rank::Warning => "warning",
    };
    let mut properties = Vec::new();
    if let Some(place) = &finding.place {
        properties.push(format!("file={}", property(&place.file)));
        let numbers = [("line", place.line), ("col", place.column)];
        let known = numbers.into_iter().filter(|(_, number)| *number > 0);
        properties.extend(known.map(|(name, number)| format!("{name}={number}")));
    }
    properties.push(format!("title={}", property(&finding.title)));
    format!("::{level} {}::{}", properties.join(","), data(&finding.text))
}

/// The text after `::`: `%` first, or what follows would be escaped twice.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// A value before `::`, where `:` and `,` end it.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::RepositoryLocation;

    #[test]
    fn what_would_end_a_value_is_escaped() {
        let place = RepositoryLocation { file: "a,b:c.py".to_owned(), line: 3, column: 0 };
        let finding = Finding {
            rank: Rank::Robot,
            kind: "failed".to_owned(),
            about: "a/b".to_owned(),
            title: "50% :: ok".to_owned(),
            text: "100%\n::error::not a command\r".to_owned(),
            place: Some(place),
        };
        let expected = "::error file=a%2Cb%3Ac.py,line=3,title=50%25 %3A%3A ok::\
                        100%25%0A::error::not a command%0D";
        assert_eq!(command(&finding), expected);
    }
}
