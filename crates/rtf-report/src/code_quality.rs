//! The report that GitLab shows in a merge request: `artifacts: reports:
//! codequality`, a subset of what Code Climate engines write.

use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;

use rtf_model::Record;
use serde::Serialize;

use crate::finding::{self, Finding, Rank, RepositoryLocation, Roots};
use crate::fnv;

#[derive(Serialize)]
struct Issue {
    description: String,
    check_name: String,
    fingerprint: String,
    severity: &'static str,
    location: IssueLocation,
}

#[derive(Serialize)]
struct IssueLocation {
    path: String,
    lines: LineRange,
}

#[derive(Serialize)]
struct LineRange {
    begin: u32,
}

/// Writes the report of a record. `repository` is the directory to which GitLab's file
/// names are relative; `None`: the run's. Findings without a location there are omitted
/// because GitLab refuses them.
///
/// # Errors
/// `out` cannot be written.
pub fn write(out: &mut dyn Write, record: &Record, repository: Option<&Path>) -> io::Result<()> {
    let mut seen = HashMap::new();
    let mut issues = Vec::new();
    for finding in finding::all(record, &Roots::new(record, repository)) {
        let Some(place) = finding.place.clone() else { continue };
        // GitLab shows only one issue per fingerprint.
        let number = seen.entry((finding.kind.clone(), finding.about.clone())).or_insert(0_u32);
        *number += 1;
        issues.push(issue(&finding, place, *number));
    }
    serde_json::to_writer_pretty(&mut *out, &issues)?;
    out.write_all(b"\n")
}

fn issue(finding: &Finding, place: RepositoryLocation, number: u32) -> Issue {
    let severity = match finding.rank {
        Rank::Unsafe => "blocker",
        Rank::Bench => "critical",
        Rank::Robot => "major",
        Rank::Warning => "minor",
    };
    // Without line and wording: moved code causes no new issue.
    let known = format!("{}\n{}\n{number}", finding.kind, finding.about);
    let description = match finding.text.starts_with(&finding.title) {
        true => finding.text.clone(),
        false => format!("{}: {}", finding.title, finding.text),
    };
    Issue {
        description,
        check_name: format!("rtf-{}", finding.kind),
        fingerprint: format!("{:032x}", fnv::hash(known.as_bytes())),
        severity,
        location: IssueLocation { path: place.file, lines: LineRange { begin: place.line.max(1) } },
    }
}
