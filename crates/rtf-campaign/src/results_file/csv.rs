//! A CSV file with a row for each episode.

use std::collections::BTreeSet;

use csv::{Position, ReaderBuilder, StringRecord, Trim};
use rtf_model::Parameter;

use super::{ResultsProblem, ResultsProblemKind as Kind};
use crate::comparison::ComparedEpisode;

/// Columns with this prefix are parameters, also if their values are numbers.
const PARAMETER: &str = "param:";
const EPISODE: &str = "episode";
const SEED: &str = "seed";
const OUTCOME: &str = "outcome";
const SUCCESS: &str = "success";

/// A row, and the byte where the previous one ends.
type Row = (usize, StringRecord);

/// Reads the text of a file.
///
/// # Errors
/// It is not such a file: the first problem.
pub fn read(text: &str) -> Result<Vec<ComparedEpisode>, ResultsProblem> {
    let text = text.trim_start_matches('\u{feff}');
    read_rows(text).map_err(|(start, kind)| kind.at(line(text, start)))
}

fn read_rows(text: &str) -> Result<Vec<ComparedEpisode>, (usize, Kind)> {
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        // The lengths are checked here.
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for record in reader.records() {
        let record =
            record.map_err(|error| (byte(error.position()), Kind::NotCsv(error.to_string())))?;
        rows.push((byte(record.position()), record));
    }
    let Some(((start, names), rows)) = rows.split_first() else {
        return Err((0, Kind::NoEpisodes));
    };
    let header = Header::new(names).map_err(|kind| (*start, kind))?;
    if rows.is_empty() {
        return Err((*start, Kind::NoEpisodes));
    }
    let is_ragged = |(_, row): &&Row| row.len() != names.len();
    if let Some((start, row)) = rows.iter().find(is_ragged) {
        return Err((*start, Kind::Ragged { found: row.len(), expected: names.len() }));
    }
    let others = others(names, rows);
    let mut known = BTreeSet::new();
    let episode = |(start, row): &Row| {
        let episode = header.episode(row, &others).map_err(|kind| (*start, kind))?;
        match known.insert(episode.id) {
            true => Ok(episode),
            false => Err((*start, Kind::RepeatedEpisode(episode.id))),
        }
    };
    rows.iter().map(episode).collect()
}

fn byte(position: Option<&Position>) -> usize {
    position.and_then(|it| usize::try_from(it.byte()).ok()).unwrap_or_default()
}

/// The line of a row, after blank ones.
fn line(text: &str, start: usize) -> u64 {
    let before = text.get(start..).unwrap_or_default();
    let blank = before.len() - before.trim_start().len();
    let lines = text.get(..start + blank).unwrap_or_default().matches('\n').count();
    lines as u64 + 1
}

/// The places of the columns with a meaning.
struct Header {
    episode: usize,
    seed: Option<usize>,
    result: (usize, &'static str),
}

impl Header {
    fn new(names: &StringRecord) -> Result<Self, Kind> {
        let mut known = BTreeSet::new();
        if let Some(repeated) = names.iter().find(|name| !known.insert(*name)) {
            return Err(Kind::RepeatedColumn(repeated.to_owned()));
        }
        let place = |wanted: &str| names.iter().position(|name| name == wanted);
        let result = match (place(OUTCOME), place(SUCCESS)) {
            (Some(_), Some(_)) => return Err(Kind::BothResults),
            (Some(at), None) => (at, OUTCOME),
            (None, Some(at)) => (at, SUCCESS),
            (None, None) => return Err(Kind::MissingColumn("`outcome` or `success`")),
        };
        let episode = place(EPISODE).ok_or(Kind::MissingColumn("`episode`"))?;
        Ok(Self { episode, seed: place(SEED), result })
    }

    fn episode(&self, row: &StringRecord, others: &[Other<'_>]) -> Result<ComparedEpisode, Kind> {
        let whole = |at: usize, column: &'static str| {
            let found = row[at].to_owned();
            let expected = "a whole number from 0";
            found.parse().map_err(|_| Kind::InvalidValue { column, found, expected })
        };
        let (at, column) = self.result;
        let mut episode = ComparedEpisode {
            id: whole(self.episode, EPISODE)?,
            passed: passed(column, &row[at])?,
            ..ComparedEpisode::default()
        };
        if let Some(at) = self.seed.filter(|at| !row[*at].is_empty()) {
            episode.seed = Some(whole(at, SEED)?);
        }
        for Other { at, name, is_measurement } in others {
            match (is_measurement, row[*at].parse::<f64>()) {
                (false, _) => {
                    let (name, value) = ((*name).to_owned(), row[*at].to_owned());
                    episode.parameters.push(Parameter { name, value });
                }
                (true, Ok(value)) if value.is_finite() => {
                    let key = (String::new(), (*name).to_owned(), String::new());
                    episode.values.insert(key, value);
                }
                (true, _) => {}
            }
        }
        Ok(episode)
    }
}

fn passed(column: &'static str, found: &str) -> Result<Option<bool>, Kind> {
    let text = found.to_ascii_lowercase();
    let invalid = |expected| Kind::InvalidValue { column, found: found.to_owned(), expected };
    match (column, text.as_str()) {
        (_, "") | (OUTCOME, "error" | "collapsed") => Ok(None),
        (OUTCOME, "passed") | (SUCCESS, "true" | "1" | "1.0") => Ok(Some(true)),
        (OUTCOME, "failed") | (SUCCESS, "false" | "0" | "0.0") => Ok(Some(false)),
        (OUTCOME, _) => Err(invalid("passed, failed, error, collapsed, or nothing")),
        _ => Err(invalid("true, false, 1, 0, or nothing")),
    }
}

/// A column without a fixed meaning.
struct Other<'a> {
    at: usize,
    name: &'a str,
    /// All values are numbers or empty; otherwise it is a parameter.
    is_measurement: bool,
}

fn others<'a>(names: &'a StringRecord, rows: &[Row]) -> Vec<Other<'a>> {
    let fixed = [EPISODE, SEED, OUTCOME, SUCCESS];
    let others = names.iter().enumerate().filter(|(_, name)| !fixed.contains(name));
    let other = |(at, name): (usize, &'a str)| {
        let is_number = |(_, row): &Row| row[at].is_empty() || row[at].parse::<f64>().is_ok();
        match name.strip_prefix(PARAMETER) {
            Some(name) => Other { at, name, is_measurement: false },
            None => Other { at, name, is_measurement: rows.iter().all(is_number) },
        }
    };
    others.map(other).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> String {
        let problem = read(text).unwrap_err();
        format!("{}: {problem}", problem.line)
    }

    #[test]
    fn columns_are_results_parameters_or_measurements() {
        let text = "\u{feff}episode, success, seed, param:payload, surface, time, notes\n\
            0, True, 17, 1.5, wood, 2.25,\n\
            1, 0, 18, 0.5, ice, , slipped\n\
            2,,,1,\"ice, wet\",nan,\n";
        let found = read(text).unwrap();
        let results: Vec<_> = found.iter().map(|it| (it.id, it.seed, it.passed)).collect();
        let expected = [(0, Some(17), Some(true)), (1, Some(18), Some(false)), (2, None, None)];
        assert_eq!(results, expected);
        let parameters = |episode: &ComparedEpisode| -> String {
            let pairs = episode.parameters.iter().map(|it| format!("{}={};", it.name, it.value));
            pairs.collect()
        };
        assert_eq!(parameters(&found[1]), "payload=0.5;surface=ice;notes=slipped;");
        assert_eq!(parameters(&found[2]), "payload=1;surface=ice, wet;notes=;");
        let values: Vec<_> = found.iter().flat_map(|it| it.values.values()).collect();
        assert_eq!(values, [&2.25], "the others are missing");
    }

    #[test]
    fn problems_have_their_line() {
        for (text, expected) in [
            ("", "1: there are no episodes"),
            ("episode,outcome\n", "1: there are no episodes"),
            ("id,outcome\n1,passed\n", "1: the header has no column `episode`"),
            ("episode\n1\n", "1: the header has no column `outcome` or `success`"),
            ("episode,outcome,success\n", "1: the header has both `outcome` and `success`"),
            ("episode,outcome,t,t\n", "1: the header has the column `t` twice"),
            ("episode,outcome\n1,passed\n2\n", "3: the row has 1 of 2 columns"),
            ("episode,outcome\n1,passed\n\n1,failed\n", "4: episode 1 occurs twice"),
            (
                "episode,outcome\n1,passed\n-2,failed\n",
                "3: `-2` in the column `episode`, expected a whole number from 0",
            ),
            (
                "episode,outcome\n1,success\n",
                "2: `success` in the column `outcome`, expected passed, failed, error, collapsed, or nothing",
            ),
            (
                "episode,success\n1,passed\n",
                "2: `passed` in the column `success`, expected true, false, 1, 0, or nothing",
            ),
        ] {
            assert_eq!(problem(text), expected, "{text}");
        }
        assert!(read("episode\n1\n").unwrap_err().kind.hint().contains("episode,seed,outcome"));
    }
}
