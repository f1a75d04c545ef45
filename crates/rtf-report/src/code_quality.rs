//! The report that GitLab shows in a merge request: `artifacts: reports:
//! codequality`, a subset of what Code Climate engines write.

use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;

use rtf_model::Record;
use serde::Serialize;

use crate::finding::{self, Finding, Rank, RepositoryLocation, Roots};

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
        fingerprint: format!("{:032x}", hash(known.as_bytes())),
        severity,
        location: IssueLocation { path: place.file, lines: LineRange { begin: place.line.max(1) } },
    }
}

/// FNV-1a with 128 bits, as its authors publish it: the same in every version
/// and on every machine, which a hash of the standard library is not.
fn hash(bytes: &[u8]) -> u128 {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    bytes.iter().fold(BASIS, |hash, byte| (hash ^ u128::from(*byte)).wrapping_mul(PRIME))
}

#[cfg(test)]
mod tests {
    use super::hash;

    /// From the list of the authors' test vectors.
    #[test]
    fn the_hash_is_the_published_one() {
        assert_eq!(hash(b""), 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
        assert_eq!(hash(b"a"), 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
    }
}
