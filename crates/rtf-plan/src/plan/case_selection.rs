//! A selection of the cases of a test, and its origin.

use rtf_model::protocol::CaseSelector;

/// The cases that a test runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CaseSelection {
    /// The selectors, of which a case must match one; empty for all cases.
    pub selectors: Vec<CaseSelector>,
    pub origin: CaseSelectionOrigin,
}

impl CaseSelection {
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
