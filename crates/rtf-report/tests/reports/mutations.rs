//! However a journal of a red run is damaged, it never reads as that of a green one.

use std::path::Path;

use crate::mutate::{Random, mutate};
use crate::support::*;
use rtf_report::console::{Console, ConsoleOptions};
use rtf_report::{Reporter, code_quality, github, journal, markdown, tap, text};

const MUTATIONS: u64 = 100_000;
/// One in so many is shown in every format.
const SHOWN: u64 = 100;
/// Longer journals are left out: they only take longer.
const LONGEST: usize = 5_000;
const THREADS: u64 = 2;

/// Journals of runs that are not green, and of those that are.
fn journals() -> (Vec<Vec<u8>>, Vec<Vec<u8>>) {
    let names = names().into_iter();
    let (green, red): (Vec<_>, Vec<_>) = names.partition(|name| record(name).is_green());
    let is_short = |journal: &Vec<u8>| journal.len() < LONGEST;
    let sealed_all =
        |names: Vec<String>| names.iter().map(|name| sealed(name)).filter(is_short).collect();
    (sealed_all(red), sealed_all(green))
}

fn show(journal: &[u8]) {
    let Ok(stored) = journal::read_from(Path::new("mutated"), journal) else { return };
    let record = stored.record;
    let paper = Paper::default();
    let mut console = Console::new(Box::new(paper.clone()), ConsoleOptions::default());
    console.finish(&record).unwrap();
    let said = paper.text();
    let mut reports = Vec::new();
    text::write(&mut reports, &record).unwrap();
    rtf_report::junit::write(&mut reports, &record, None).unwrap();
    tap::write(&mut reports, &record).unwrap();
    github::write(&mut reports, &record, None).unwrap();
    code_quality::write(&mut reports, &record, None).unwrap();
    let mut summary = Vec::new();
    markdown::write(&mut summary, &record, &markdown_options()).unwrap();
    assert!(summary.starts_with("## ❌".as_bytes()), "{}", String::from_utf8_lossy(&summary));
    assert_eq!(record.is_damaged(), said.contains("DAMAGED"), "{said}");
    assert!(!said.contains("PASSED"), "{said}");
}

fn check(number: u64, red: &[Vec<u8>], green: &[Vec<u8>]) {
    let mut random = Random::new(number);
    let original = &red[random.below(red.len())];
    let others = if random.below(2) == 0 { red } else { green };
    let other = &others[random.below(others.len())];
    let mutated = mutate(original, other, &mut random);
    if mutated == *original || mutated == *other {
        return;
    }
    if let Ok(stored) = journal::read_from(Path::new("mutated"), mutated.as_slice()) {
        let record = &stored.record;
        assert!(!record.is_green(), "mutation {number} reads as green");
        // What was cut off at its end is incomplete; everything else is damage.
        let is_noticed =
            record.is_damaged() || !record.is_complete() || original.starts_with(&mutated);
        assert!(is_noticed, "mutation {number} is not noticed");
    }
    if number.is_multiple_of(SHOWN) {
        show(&mutated);
    }
}

#[test]
fn no_mutation_of_a_red_journal_reads_as_green() {
    let (red, green) = journals();
    std::thread::scope(|scope| {
        for thread in 0..THREADS {
            let (red, green) = (&red, &green);
            let numbers = (thread..MUTATIONS).step_by(THREADS as usize);
            scope.spawn(move || numbers.for_each(|number| check(number, red, green)));
        }
    });
}
