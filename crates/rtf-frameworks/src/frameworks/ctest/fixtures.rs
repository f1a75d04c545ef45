//! The order of tests, and the tests that others need: `DEPENDS` and `FIXTURES_*`.

use std::collections::{HashMap, HashSet};

use super::properties::CTestCase;

/// Orders tests so that each follows those on which it depends; otherwise as listed.
///
/// # Errors
/// Tests depend on each other, with their names.
pub fn ordered(tests: Vec<CTestCase>) -> Result<Vec<CTestCase>, String> {
    let before = predecessors(&tests);
    let mut order = Vec::with_capacity(tests.len());
    let mut is_placed = vec![false; tests.len()];
    while order.len() < tests.len() {
        // The first test that may run now: the order of the list is kept as far as possible.
        let next = (0..tests.len())
            .find(|&index| !is_placed[index] && before[index].iter().all(|&it| is_placed[it]));
        let Some(next) = next else {
            let names = tests.iter().zip(&is_placed).filter(|(_, placed)| !**placed);
            let names: Vec<String> = names.map(|(test, _)| format!("`{}`", test.name)).collect();
            return Err(format!("these tests depend on each other: {}", names.join(", ")));
        };
        is_placed[next] = true;
        order.push(next);
    }
    let mut tests: Vec<Option<CTestCase>> = tests.into_iter().map(Some).collect();
    Ok(order.into_iter().filter_map(|index| tests[index].take()).collect())
}

/// For each test the indices of those that run before it.
fn predecessors(tests: &[CTestCase]) -> Vec<Vec<usize>> {
    let by_name: HashMap<&str, usize> =
        tests.iter().enumerate().map(|(index, test)| (test.name.as_str(), index)).collect();
    let set_ups = by_fixture(tests, |test| &test.sets_up);
    let users = by_fixture(tests, |test| &test.requires);
    let find = |map: &HashMap<&str, Vec<usize>>, fixtures: &[String]| {
        fixtures
            .iter()
            .flat_map(|it| map.get(it.as_str()).cloned().unwrap_or_default())
            .collect::<Vec<_>>()
    };
    let mut all = Vec::with_capacity(tests.len());
    for (index, test) in tests.iter().enumerate() {
        let named = test.depends.iter().filter_map(|name| by_name.get(name.as_str()).copied());
        let mut before: Vec<usize> = named.collect();
        before.extend(find(&set_ups, &test.requires));
        before.extend(find(&users, &test.cleans_up));
        before.extend(find(&set_ups, &test.cleans_up));
        before.retain(|it| *it != index);
        all.push(before);
    }
    all
}

fn by_fixture<'a>(
    tests: &'a [CTestCase],
    fixtures: impl Fn(&'a CTestCase) -> &'a [String],
) -> HashMap<&'a str, Vec<usize>> {
    let mut map: HashMap<&str, Vec<usize>> = HashMap::new();
    for (index, test) in tests.iter().enumerate() {
        // A disabled test does not take part in fixtures.
        for fixture in fixtures(test).iter().filter(|_| !test.disabled) {
            map.entry(fixture).or_default().push(index);
        }
    }
    map
}

/// The names of selected tests and of those that set up and clean up their fixtures.
pub fn with_fixtures<'a>(tests: &'a [CTestCase], selected: &HashSet<&str>) -> HashSet<&'a str> {
    let mut all: HashSet<&str> =
        tests.iter().map(|it| it.name.as_str()).filter(|name| selected.contains(name)).collect();
    loop {
        let included =
            tests.iter().filter(|test| all.contains(test.name.as_str()) && !test.disabled);
        let fixtures: HashSet<&String> = included.flat_map(|test| &test.requires).collect();
        let serves = |test: &&CTestCase| {
            !test.disabled
                && test.sets_up.iter().chain(&test.cleans_up).any(|it| fixtures.contains(it))
        };
        let count = all.len();
        all.extend(tests.iter().filter(serves).map(|test| test.name.as_str()));
        if all.len() == count {
            return all;
        }
    }
}

/// The fixtures that a test requires, each with the tests that set it up.
pub fn set_ups<'a>(
    tests: &'a [CTestCase],
    test: &'a CTestCase,
) -> impl Iterator<Item = (&'a str, &'a str)> {
    test.requires.iter().flat_map(move |fixture| {
        let sets_up = move |it: &&CTestCase| !it.disabled && it.sets_up.contains(fixture);
        tests.iter().filter(sets_up).map(move |it| (fixture.as_str(), it.name.as_str()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test(name: &str) -> CTestCase {
        CTestCase { name: name.to_owned(), ..CTestCase::default() }
    }

    fn names(tests: &[CTestCase]) -> Vec<&str> {
        tests.iter().map(|test| test.name.as_str()).collect()
    }

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn fixtures_and_dependencies_order_tests() {
        let tests = vec![
            CTestCase { cleans_up: words("db"), ..test("stop") },
            CTestCase { requires: words("db"), ..test("query") },
            CTestCase { depends: words("last missing"), ..test("first") },
            CTestCase { sets_up: words("db"), requires: words("net"), ..test("start") },
            CTestCase { sets_up: words("net"), ..test("link") },
            test("last"),
        ];
        let ordered = ordered(tests).unwrap();
        assert_eq!(names(&ordered), ["link", "start", "query", "stop", "last", "first"]);
        let selected = with_fixtures(&ordered, &HashSet::from(["query"]));
        let mut selected: Vec<&str> = selected.into_iter().collect();
        selected.sort_unstable();
        assert_eq!(selected, ["link", "query", "start", "stop"]);
        let query = ordered.iter().find(|it| it.name == "query").unwrap();
        assert_eq!(set_ups(&ordered, query).collect::<Vec<_>>(), [("db", "start")]);
    }

    #[test]
    fn disabled_tests_take_no_part_in_fixtures() {
        let tests = vec![
            CTestCase { requires: words("db"), ..test("query") },
            CTestCase { sets_up: words("db"), disabled: true, ..test("start") },
        ];
        let all = with_fixtures(&tests, &HashSet::from(["query"]));
        assert_eq!(all, HashSet::from(["query"]));
        assert_eq!(set_ups(&tests, &tests[0]).count(), 0);
    }

    #[test]
    fn circular_dependencies() {
        let tests = vec![
            CTestCase { depends: words("b"), ..test("a") },
            CTestCase { depends: words("a"), ..test("b") },
            test("c"),
        ];
        assert_eq!(ordered(tests).unwrap_err(), "these tests depend on each other: `a`, `b`");
        // CTest ignores a dependency of a test on itself.
        assert!(ordered(vec![CTestCase { depends: words("a"), ..test("a") }]).is_ok());
    }
}
