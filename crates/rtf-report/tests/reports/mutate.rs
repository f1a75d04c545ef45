//! Journals that are damaged at random, as disks, editors and tests damage them.

/// Pseudo-random numbers (SplitMix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// A number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    fn bytes(&mut self, longest: usize) -> Vec<u8> {
        let length = 1 + self.below(longest);
        (0..length).map(|_| self.next() as u8).collect()
    }

    fn range(&mut self, end: usize, longest: usize) -> std::ops::Range<usize> {
        let start = self.below(end);
        start..end.min(start + 1 + self.below(longest))
    }
}

/// Words of a journal, and what would turn a red run into a green one.
const WORDS: [(&str, &str); 12] = [
    ("failed", "passed"),
    ("crashed", "passed"),
    ("timed-out", "passed"),
    ("collapsed", "ready"),
    ("\"error\"", "\"passed\""),
    ("interrupted", "passed"),
    ("skipped", "passed"),
    ("problem", "proble_"),
    ("interrupted", "interrupte_"),
    ("runner-died", "run-finished"),
    ("fixture-broken", "fixture-ready"),
    ("\"test\":1", "\"test\":0"),
];

/// Damages a journal in one to three places; `other` is another journal.
pub fn mutate(journal: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = journal.to_vec();
    for _ in 0..1 + random.below(3) {
        if bytes.is_empty() {
            break;
        }
        match random.below(4) {
            0 => change_bytes(&mut bytes, random),
            1 => change_blocks(&mut bytes, other, random),
            2 => change_lines(&mut bytes, other, random),
            _ => change_words(&mut bytes, random),
        }
    }
    bytes
}

fn change_bytes(bytes: &mut Vec<u8>, random: &mut Random) {
    let place = random.below(bytes.len());
    match random.below(4) {
        0 => bytes[place] ^= 1 << random.below(8),
        1 => bytes[place] = random.next() as u8,
        2 => drop(bytes.splice(place..place, random.bytes(20))),
        _ => drop(bytes.drain(random.range(bytes.len(), 200))),
    }
}

fn change_blocks(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let block = random.range(bytes.len(), 1000);
    match random.below(5) {
        0 => bytes[block].fill(0),
        1 => bytes.truncate(block.start),
        2 => {
            let copy = bytes[block].to_vec();
            let place = random.below(bytes.len());
            bytes.splice(place..place, copy);
        }
        3 => {
            let end = block.end.min(other.len());
            bytes.splice(block.start.min(end)..end, other[block.start.min(end)..end].to_vec());
        }
        _ => bytes.extend_from_slice(&other[random.below(other.len())..]),
    }
}

fn change_lines(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let mut lines: Vec<_> =
        bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    let others: Vec<_> = other.split_inclusive(|byte| *byte == b'\n').collect();
    let (line, another) = (random.below(lines.len()), random.below(lines.len()));
    match random.below(6) {
        0 => drop(lines.remove(line)),
        1 => lines.insert(line, lines[line].clone()),
        2 => lines.swap(line, another),
        3 => drop(lines.drain(random.range(lines.len(), 10))),
        4 => lines[line] = others[line.min(others.len() - 1)].to_vec(),
        _ => lines.insert(line, others[random.below(others.len())].to_vec()),
    }
    *bytes = lines.concat();
}

fn change_words(bytes: &mut Vec<u8>, random: &mut Random) {
    let (word, instead) = WORDS[random.below(WORDS.len())];
    let places: Vec<_> =
        (0..bytes.len()).filter(|at| bytes[*at..].starts_with(word.as_bytes())).collect();
    if !places.is_empty() {
        let place = places[random.below(places.len())];
        bytes.splice(place..place + word.len(), instead.bytes());
    }
}
