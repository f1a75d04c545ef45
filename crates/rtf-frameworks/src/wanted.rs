//! The top-level cases that the runner wants.

use std::collections::HashSet;

use rtf_model::protocol::CaseSelector;

/// The selectors of a request, for many names.
#[derive(Clone, Debug, Default)]
pub struct WantedCases {
    /// Paths, each of which selects also the cases in it and around it.
    paths: HashSet<String>,
    /// Names that select only themselves.
    names: HashSet<String>,
    /// The paths of all cases around one of `paths`.
    outer_paths: HashSet<String>,
    texts: Vec<String>,
    all: bool,
}

impl WantedCases {
    /// The cases that these selectors want; all, if there is none. A path that is the name
    /// of a `listed` case wants only this case: names can contain slashes.
    #[must_use]
    pub fn new<'a>(selectors: &[CaseSelector], listed: impl Iterator<Item = &'a str>) -> Self {
        let listed: HashSet<&str> = listed.collect();
        let mut wanted = Self { all: selectors.is_empty(), ..Self::default() };
        for selector in selectors {
            match selector {
                CaseSelector::Equals(path) if listed.contains(path.as_str()) => {
                    wanted.names.insert(path.clone());
                }
                CaseSelector::Equals(path) => {
                    wanted.outer_paths.extend(outer_paths(path).map(str::to_owned));
                    wanted.paths.insert(path.clone());
                }
                CaseSelector::Contains(text) => wanted.texts.push(text.clone()),
            }
        }
        wanted
    }

    #[must_use]
    pub fn includes(&self, name: &str) -> bool {
        self.all
            || self.names.contains(name)
            || self.paths.contains(name)
            || self.outer_paths.contains(name)
            || outer_paths(name).any(|outer| self.paths.contains(outer))
            || self.texts.iter().any(|text| name.contains(text.as_str()))
    }

    #[must_use]
    pub fn is_all(&self) -> bool {
        self.all
    }
}

/// The paths of the cases that could contain the one with this path.
fn outer_paths(path: &str) -> impl Iterator<Item = &str> {
    path.match_indices('/').map(|(end, _)| &path[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn included(paths: &[&str], listed: &[&str], names: &[&str]) -> Vec<String> {
        let selectors: Vec<_> =
            paths.iter().map(|path| CaseSelector::Equals((*path).to_owned())).collect();
        let wanted = WantedCases::new(&selectors, listed.iter().copied());
        let names = names.iter().filter(|name| wanted.includes(name));
        names.map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn a_listed_name_is_only_itself() {
        let listed = ["load", "load/slow", "Speeds/Arm.Reaches/0"];
        assert_eq!(included(&["load"], &listed, &listed), ["load"]);
        assert_eq!(included(&["load/slow"], &listed, &listed), ["load/slow"]);
        assert_eq!(included(&[], &listed, &listed), listed);
    }

    #[test]
    fn another_path_is_also_what_is_in_it_and_around_it() {
        let listed = ["Arm moves", "tests/a.py::x", "tests/b.py::x", "tests2/a.py::x"];
        assert_eq!(included(&["Arm moves/elbow"], &listed, &listed), ["Arm moves"]);
        assert_eq!(included(&["tests"], &listed, &listed), ["tests/a.py::x", "tests/b.py::x"]);
        assert_eq!(included(&["tests"], &[], &["tests", "tests/b"]), ["tests", "tests/b"]);
    }

    #[test]
    fn a_text_is_anywhere_in_the_name() {
        let text = CaseSelector::Contains("eac".to_owned());
        let wanted = WantedCases::new(&[text], std::iter::empty());
        assert!(wanted.includes("Reaches") && !wanted.includes("Moves") && !wanted.is_all());
    }
}
