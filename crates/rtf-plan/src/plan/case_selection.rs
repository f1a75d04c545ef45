//! The cases that a test runs, and the origin of their selection.

use std::borrow::Cow;
use std::collections::HashMap;

use rtf_model::protocol::CaseSelector;

use super::case_narrowing::{self, NarrowedCases};
use super::{ListedCase, TestPlan};

/// The cases that a test runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CaseSelection {
    /// The selectors, of which a case must match one; empty for all cases.
    pub selectors: Vec<CaseSelector>,
    /// The origin of the selectors.
    pub origin: CaseSelectionOrigin,
}

impl CaseSelection {
    /// Returns the selection of the cases of these names.
    pub(super) fn of_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let equals = |name: &str| CaseSelector::Equals(name.to_owned());
        let selectors = names.into_iter().map(equals).collect();
        Self { selectors, origin: CaseSelectionOrigin::Named }
    }

    /// Checks whether the host must be able to select cases.
    #[must_use]
    pub fn needs_support(&self) -> bool {
        !self.selectors.is_empty() && self.origin != CaseSelectionOrigin::Rerun
    }

    /// Returns the paths of the cases that must exist.
    pub fn required_paths(&self) -> impl Iterator<Item = &str> {
        let is_required = self.origin != CaseSelectionOrigin::Filter;
        self.paths().filter(move |_| is_required)
    }

    /// Returns the paths that it contains.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.selectors.iter().filter_map(|selector| match selector {
            CaseSelector::Equals(path) => Some(path.as_str()),
            CaseSelector::Contains(_) => None,
        })
    }
}

/// The origin of a selection of cases, which determines the reaction if the host cannot
/// select cases, or if the test has no such case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CaseSelectionOrigin {
    /// A filter: an error if the host cannot select cases.
    #[default]
    Filter,
    /// The user named the case: an error in both situations.
    Named,
    /// A rerun of failed cases: a host that cannot select cases runs all of them; a case
    /// that does not exist is an error.
    Rerun,
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
        let mut narrowed = case_narrowing::narrow(listed, &current, &selection.selectors);
        if selection.origin == CaseSelectionOrigin::Rerun {
            // The error of an unknown case is then the verdict of the test.
            narrowed.paths.append(&mut narrowed.unknown);
        }
        let paths = narrowed.paths.iter().map(String::as_str);
        self.select_cases(CaseSelection::of_names(paths));
        narrowed
    }
}
