//! The listed cases of a test that it runs: restricts them to those that a further selection
//! selects.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use rtf_model::protocol::CaseSelector;

use super::{CaseSelection, CaseSelectionOrigin, ListedCase, TestPlan};

#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct NarrowedCases {
    /// The paths of the selected cases, without duplicates.
    pub paths: Vec<String>,
    /// The paths that neither are nor contain a listed case, nor are in one.
    pub unknown: Vec<String>,
    /// The paths of listed cases that are not in the current selection.
    pub excluded: Vec<String>,
}

impl TestPlan {
    /// Returns the cases that it runs, if they are known before the run.
    #[must_use]
    pub fn known_cases(&self) -> Option<Vec<Cow<'_, ListedCase>>> {
        let listed = self.listed_cases()?;
        let Some(selected) = &self.cases else {
            return Some(listed.iter().map(Cow::Borrowed).collect());
        };
        let by_name: HashMap<&str, &ListedCase> =
            listed.iter().map(|case| (case.name.as_str(), case)).collect();
        let case = |path: &str| match by_name.get(path) {
            Some(case) => Cow::Borrowed(*case),
            None => Cow::Owned(ListedCase { name: path.to_owned(), ..ListedCase::default() }),
        };
        Some(selected.paths().map(case).collect())
    }

    /// Restricts a test with listed cases to those that a further selection selects, too.
    pub(crate) fn narrow_cases(&mut self, selection: CaseSelection) -> NarrowedCases {
        let listed = self.listed_cases().unwrap_or_default();
        let current: Vec<String> = match &self.cases {
            Some(cases) => cases.paths().map(str::to_owned).collect(),
            None => listed.iter().map(|case| case.name.clone()).collect(),
        };
        let mut narrowed = narrow(listed, &current, &selection.selectors);
        if selection.origin == CaseSelectionOrigin::Rerun {
            // The error of an unknown case is then the verdict of the test.
            narrowed.paths.append(&mut narrowed.unknown);
        }
        let paths = narrowed.paths.iter().map(String::as_str);
        self.select_cases(CaseSelection::of_names(paths));
        narrowed
    }
}

/// Returns the cases of the current selection that any of `selectors` selects.
///
/// A path selects the listed case of this name. If there is none, it selects the cases
/// below it, or is that of a case in a listed one: a section or a subtest, which no
/// framework lists.
fn narrow(listed: &[ListedCase], current: &[String], selectors: &[CaseSelector]) -> NarrowedCases {
    let cases = Cases {
        listed: listed.iter().map(|case| case.name.as_str()).collect(),
        current,
        current_set: current.iter().map(String::as_str).collect(),
    };
    let (mut narrowed, mut seen) = (NarrowedCases::default(), HashSet::new());
    for selector in selectors {
        let found = match selector {
            CaseSelector::Contains(text) => {
                current.iter().map(String::as_str).filter(|path| path.contains(text)).collect()
            }
            CaseSelector::Equals(path) => {
                let found = cases.of_path(path);
                if found.is_empty() && cases.is_known(path) {
                    narrowed.excluded.push(path.clone());
                } else if found.is_empty() {
                    narrowed.unknown.push(path.clone());
                }
                found
            }
        };
        let new = found.into_iter().filter(|path| seen.insert((*path).to_owned()));
        narrowed.paths.extend(new.map(str::to_owned));
    }
    narrowed
}

struct Cases<'a> {
    listed: HashSet<&'a str>,
    current: &'a [String],
    current_set: HashSet<&'a str>,
}

impl<'a> Cases<'a> {
    /// Returns the selected cases that a path names.
    fn of_path(&self, path: &'a str) -> Vec<&'a str> {
        if self.current_set.contains(path) {
            return vec![path];
        }
        let is_listed = self.listed.contains(path);
        if !is_listed && self.listed_parent(path).is_some_and(|it| self.current_set.contains(it)) {
            return vec![path];
        }
        let below = self.current.iter().map(String::as_str).filter(|case| is_in(case, path));
        below.filter(|case| !is_listed || !self.listed.contains(case)).collect()
    }

    fn is_known(&self, path: &str) -> bool {
        self.listed.contains(path)
            || self.listed_parent(path).is_some()
            || self.listed.iter().any(|case| is_in(case, path))
    }

    /// Returns the innermost listed case that contains the path.
    fn listed_parent<'p>(&self, path: &'p str) -> Option<&'p str> {
        let parents = path.rmatch_indices('/').map(|(at, _)| &path[..at]);
        parents.into_iter().find(|parent| self.listed.contains(parent))
    }
}

/// Checks whether the case `inner` is in the case or group `outer`.
fn is_in(inner: &str, outer: &str) -> bool {
    inner.strip_prefix(outer).is_some_and(|rest| rest.starts_with('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTED: [&str; 6] = [
        "Arm.Moves",
        "Speeds/Arm.Reaches/0",
        "Speeds/Arm.Reaches/1",
        "load",
        "load/slow",
        "a,b[\"c\"]",
    ];

    fn narrowed(current: &[&str], selectors: &[&str]) -> NarrowedCases {
        let listed =
            LISTED.map(|name| ListedCase { name: name.to_owned(), ..ListedCase::default() });
        let current: Vec<_> = current.iter().map(|path| (*path).to_owned()).collect();
        let selectors: Vec<_> = selectors
            .iter()
            .map(|text| match text.strip_prefix('~') {
                Some(text) => CaseSelector::Contains(text.to_owned()),
                None => CaseSelector::Equals((*text).to_owned()),
            })
            .collect();
        narrow(&listed, &current, &selectors)
    }

    fn paths(current: &[&str], selectors: &[&str]) -> Vec<String> {
        narrowed(current, selectors).paths
    }

    #[test]
    fn names_are_compared_literally() {
        assert_eq!(paths(&LISTED, &["Arm.Moves", "Arm.Moves"]), ["Arm.Moves"]);
        assert_eq!(paths(&LISTED, &["a,b[\"c\"]"]), ["a,b[\"c\"]"]);
        assert_eq!(paths(&LISTED, &["load"]), ["load"]);
        assert_eq!(paths(&LISTED, &["load/slow"]), ["load/slow"]);
        assert_eq!(paths(&LISTED, &["Speeds/Arm.Reaches/1"]), ["Speeds/Arm.Reaches/1"]);
    }

    #[test]
    fn a_group_selects_its_cases_and_a_section_is_in_a_case() {
        assert_eq!(paths(&LISTED, &["Speeds"]), LISTED[1..3]);
        assert_eq!(paths(&LISTED, &["Arm.Moves/up/slowly"]), ["Arm.Moves/up/slowly"]);
        assert_eq!(paths(&["Arm.Moves/up"], &["Arm.Moves"]), ["Arm.Moves/up"]);
        assert_eq!(paths(&["Arm.Moves/up"], &["~up"]), ["Arm.Moves/up"]);
    }

    #[test]
    fn only_selected_cases_remain() {
        assert_eq!(paths(&LISTED[..2], &["~Arm"]), LISTED[..2]);
        assert_eq!(paths(&LISTED[..2], &["~Arm", "Speeds"]), LISTED[..2]);
        let found = narrowed(
            &["Arm.Moves", "load"],
            &["load/slow", "load/slow/x", "Speeds", "Arm.Mvoes", "Arm"],
        );
        assert_eq!(found.paths, [""; 0]);
        assert_eq!(found.excluded, ["load/slow", "load/slow/x", "Speeds"]);
        assert_eq!(found.unknown, ["Arm.Mvoes", "Arm"]);
    }
}
