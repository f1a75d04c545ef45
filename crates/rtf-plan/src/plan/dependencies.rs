//! `depends`: the dependencies between fixtures, and the order of their set-up.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rtf_model::Diagnostic;

use crate::suite::{DeclaredFixture, SourceText, Span, Spanned};
use crate::wording::suggest;

pub(super) struct SetupStep {
    /// The index of the fixture in the file.
    pub fixture: usize,
    /// The earlier steps that set up its dependencies.
    pub depends: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
struct Dependency {
    /// The index of the other fixture in the file.
    on: usize,
    span: Span,
    /// Whether the file contains it; otherwise `depends` is missing.
    explicit: bool,
}

struct DependencyGraph<'a> {
    names: &'a [String],
    dependencies: Vec<Vec<Dependency>>,
}

/// Orders the fixtures so that each comes after its dependencies, otherwise in
/// the order of the file.
pub(super) fn setup_order(
    fixtures: &[DeclaredFixture],
    names: &[String],
    source: &SourceText,
    problems: &mut Vec<Diagnostic>,
) -> Vec<SetupStep> {
    let dependencies = (0..fixtures.len())
        .map(|index| {
            resolve(fixtures, names, index, &mut |problem, span| {
                problems.push(problem.label(source.label(span, "")));
            })
        })
        .collect();
    let mut graph = DependencyGraph { names, dependencies };
    let mut order = graph.sort();
    while let Some(cycle) = graph.cycle(&order) {
        problems.push(graph.diagnose(&cycle, source));
        graph.cut(&cycle);
        order = graph.sort();
    }
    let mut steps = vec![0; order.len()];
    for (step, fixture) in order.iter().enumerate() {
        steps[*fixture] = step;
    }
    let step = |fixture: usize| {
        let mut depends: Vec<_> =
            graph.dependencies[fixture].iter().map(|dependency| steps[dependency.on]).collect();
        depends.sort_unstable();
        SetupStep { fixture, depends }
    };
    order.into_iter().map(step).collect()
}

/// Resolves the dependencies of one fixture. Without `depends`, it depends on
/// the fixture before it, so that such fixtures are set up one after the other.
fn resolve(
    fixtures: &[DeclaredFixture],
    names: &[String],
    index: usize,
    report: &mut dyn FnMut(Diagnostic, Span),
) -> Vec<Dependency> {
    let fixture = &fixtures[index];
    let Some(depends) = &fixture.depends else {
        let previous = index.checked_sub(1);
        let implicit = |on| Dependency { on, span: fixture.span, explicit: false };
        return previous.map(implicit).into_iter().collect();
    };
    let mut dependencies: Vec<Dependency> = Vec::new();
    for name in depends {
        match names.iter().position(|known| *known == name.value) {
            Some(on) if on == index => {
                let message = format!("the fixture `{}` depends on itself", name.value);
                report(Diagnostic::error("circular-dependency", message), name.span);
            }
            Some(on) if dependencies.iter().any(|known| known.on == on) => {}
            Some(on) => dependencies.push(Dependency { on, span: name.span, explicit: true }),
            None => report(unknown(name, names, index), name.span),
        }
    }
    dependencies
}

fn unknown(name: &Spanned<String>, names: &[String], index: usize) -> Diagnostic {
    let message = format!("there is no fixture `{}`", name.value);
    let problem = Diagnostic::error("unknown-dependency", message);
    let others = names.iter().enumerate().filter(|(other, _)| *other != index);
    suggest(problem, &name.value, others.map(|(_, name)| name.as_str()))
}

impl DependencyGraph<'_> {
    /// Returns the order of set-up, without the fixtures that wait for a cycle.
    fn sort(&self) -> Vec<usize> {
        let mut unmet: Vec<usize> = self.dependencies.iter().map(Vec::len).collect();
        let mut dependents = vec![Vec::new(); self.dependencies.len()];
        for (fixture, dependencies) in self.dependencies.iter().enumerate() {
            dependencies.iter().for_each(|dependency| dependents[dependency.on].push(fixture));
        }
        let free = (0..self.dependencies.len()).filter(|fixture| unmet[*fixture] == 0);
        let mut free: BinaryHeap<_> = free.map(Reverse).collect();
        let mut order = Vec::with_capacity(self.dependencies.len());
        while let Some(Reverse(fixture)) = free.pop() {
            order.push(fixture);
            for dependent in &dependents[fixture] {
                unmet[*dependent] -= 1;
                if unmet[*dependent] == 0 {
                    free.push(Reverse(*dependent));
                }
            }
        }
        order
    }

    /// Returns a cycle: its fixtures, each with the dependency on the next one.
    /// `None` if all fixtures are in `order`.
    fn cycle(&self, order: &[usize]) -> Option<Vec<(usize, Dependency)>> {
        let mut seen = vec![None; self.dependencies.len()];
        let mut waits = vec![true; self.dependencies.len()];
        order.iter().for_each(|fixture| waits[*fixture] = false);
        let mut path = Vec::new();
        let mut fixture = waits.iter().position(|waits| *waits)?;
        loop {
            if let Some(start) = seen[fixture].replace(path.len()) {
                let mut cycle = path.split_off(start);
                let first = cycle.iter().enumerate().min_by_key(|(_, (fixture, _))| *fixture);
                let first = first.map_or(0, |(index, _)| index);
                cycle.rotate_left(first);
                return Some(cycle);
            }
            // Each waiting fixture depends on another waiting one.
            let dependency = *self.dependencies[fixture].iter().find(|it| waits[it.on])?;
            path.push((fixture, dependency));
            fixture = dependency.on;
        }
    }

    /// Removes the explicit dependencies of a cycle, so that further cycles are found.
    fn cut(&mut self, cycle: &[(usize, Dependency)]) {
        for (fixture, cut) in cycle {
            self.dependencies[*fixture].retain(|known| !(known.explicit && known.on == cut.on));
        }
    }

    fn diagnose(&self, cycle: &[(usize, Dependency)], source: &SourceText) -> Diagnostic {
        /// The maximum number of fixtures that the message names.
        const MAX_NAMES: usize = 8;
        let name = |fixture: usize| format!("`{}`", self.names[fixture]);
        let mut names: Vec<_> = cycle.iter().map(|(fixture, _)| name(*fixture)).collect();
        names.push(names[0].clone());
        if names.len() > MAX_NAMES {
            let omitted = names.len() - MAX_NAMES;
            let gap = [format!("… {omitted} more …")];
            names.splice(MAX_NAMES / 2..MAX_NAMES / 2 + omitted, gap);
        }
        let message = format!("fixtures depend on each other in a circle: {}", names.join(" → "));
        let mut problem = Diagnostic::error("circular-dependency", message);
        // Explicit dependencies come first: the user can change them.
        let (explicit, implicit): (Vec<_>, Vec<_>) =
            cycle.iter().partition(|(_, dependency)| dependency.explicit);
        for (fixture, dependency) in explicit.iter().take(MAX_NAMES) {
            let text = format!("{} depends on {}", name(*fixture), name(dependency.on));
            problem = problem.label(source.label(dependency.span, &text));
        }
        let Some((fixture, dependency)) = implicit.first() else { return problem };
        let previous = name(dependency.on);
        let text = format!("without `depends`, it depends on {previous}, the one before it");
        problem
            .label(source.label(dependency.span, &text))
            .hint(format!("if {} needs no other fixture, give it `depends=\"\"`", name(*fixture)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Dependency, DependencyGraph};
    use crate::suite::Span;

    /// Up to 12 fixtures with any dependencies between two different ones.
    fn dependencies() -> impl Strategy<Value = Vec<Vec<Dependency>>> {
        let dependency = (any::<prop::sample::Index>(), any::<bool>());
        let of_one = prop::collection::vec(dependency, 0..3);
        prop::collection::vec(of_one, 1..12).prop_map(|drawn| {
            let count = drawn.len();
            let convert = |index: usize, drawn: &[(prop::sample::Index, bool)]| {
                let mut found: Vec<Dependency> = Vec::new();
                for (target, explicit) in drawn {
                    // An implicit dependency is on the fixture before.
                    let on = if *explicit { target.index(count) } else { index.wrapping_sub(1) };
                    if on < count && on != index && found.iter().all(|known| known.on != on) {
                        found.push(Dependency { on, span: Span::default(), explicit: *explicit });
                    }
                }
                found
            };
            drawn.iter().enumerate().map(|(index, drawn)| convert(index, drawn)).collect()
        })
    }

    proptest! {
        #[test]
        fn cutting_all_cycles_leaves_a_valid_order(dependencies in dependencies()) {
            let names: Vec<_> = (0..dependencies.len()).map(|index| index.to_string()).collect();
            let mut graph = DependencyGraph { names: &names, dependencies };
            let mut order = graph.sort();
            while let Some(cycle) = graph.cycle(&order) {
                for (index, (fixture, dependency)) in cycle.iter().enumerate() {
                    prop_assert_eq!(dependency.on, cycle[(index + 1) % cycle.len()].0);
                    prop_assert!(graph.dependencies[*fixture].iter().any(|known| known.on == dependency.on));
                }
                prop_assert!(cycle.iter().any(|(_, dependency)| dependency.explicit));
                graph.cut(&cycle);
                order = graph.sort();
            }
            prop_assert_eq!(order.len(), names.len());
            for (step, fixture) in order.iter().enumerate() {
                let is_earlier = |it: &Dependency| order[..step].contains(&it.on);
                prop_assert!(graph.dependencies[*fixture].iter().all(is_earlier));
            }
        }
    }
}
