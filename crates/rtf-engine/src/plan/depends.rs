//! `depends`: which fixtures have to stand before which, and the order in
//! which they can be set up.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rtf_model::Diagnostic;

use crate::suite::{Fixture, Source, Span, Spanned, nearest};

/// A fixture in the order of set-up.
pub(super) struct Turn {
    /// Its place in the file.
    pub fixture: usize,
    /// The places, in the order of set-up, of those that it depends on.
    pub depends: Vec<usize>,
}

/// That a fixture depends on another one.
#[derive(Clone, Copy, Debug)]
struct Link {
    on: usize,
    span: Span,
    /// Whether the file says it, or the lack of `depends` does.
    written: bool,
}

/// The fixtures that each fixture depends on.
struct Graph<'a> {
    names: &'a [String],
    links: Vec<Vec<Link>>,
}

/// Puts the fixtures in an order in which each comes after those that it
/// depends on; where that leaves a choice, in the order of the file.
pub(super) fn order(
    fixtures: &[Fixture],
    names: &[String],
    source: &Source,
    problems: &mut Vec<Diagnostic>,
) -> Vec<Turn> {
    let links = (0..fixtures.len())
        .map(|place| {
            links(fixtures, names, place, &mut |problem, span| {
                problems.push(problem.label(source.label(span, "")));
            })
        })
        .collect();
    let mut graph = Graph { names, links };
    let mut order = graph.sort();
    while let Some(cycle) = graph.cycle(&order) {
        problems.push(graph.in_a_circle(&cycle, source));
        graph.cut(&cycle);
        order = graph.sort();
    }
    let mut turns = vec![0; order.len()];
    for (turn, fixture) in order.iter().enumerate() {
        turns[*fixture] = turn;
    }
    let turn = |fixture: usize| {
        let mut depends: Vec<_> = graph.links[fixture].iter().map(|link| turns[link.on]).collect();
        depends.sort_unstable();
        Turn { fixture, depends }
    };
    order.into_iter().map(turn).collect()
}

/// What the fixture at `place` depends on. One that does not say depends on
/// the one before it, so that fixtures without `depends` are set up one after
/// the other.
fn links(
    fixtures: &[Fixture],
    names: &[String],
    place: usize,
    report: &mut dyn FnMut(Diagnostic, Span),
) -> Vec<Link> {
    let fixture = &fixtures[place];
    let Some(wanted) = &fixture.depends else {
        let before = place.checked_sub(1);
        return before
            .map(|on| Link { on, span: fixture.span, written: false })
            .into_iter()
            .collect();
    };
    let mut links: Vec<Link> = Vec::new();
    for name in wanted {
        match names.iter().position(|known| *known == name.value) {
            Some(on) if on == place => {
                let message = format!("the fixture `{}` depends on itself", name.value);
                report(Diagnostic::error("circular-dependency", message), name.span);
            }
            Some(on) if links.iter().any(|link| link.on == on) => {}
            Some(on) => links.push(Link { on, span: name.span, written: true }),
            None => report(unknown(name, names, place), name.span),
        }
    }
    links
}

fn unknown(name: &Spanned<String>, names: &[String], place: usize) -> Diagnostic {
    let message = format!("there is no fixture `{}`", name.value);
    let problem = Diagnostic::error("unknown-dependency", message);
    let others = names.iter().enumerate().filter(|(other, _)| *other != place);
    match nearest(&name.value, others.map(|(_, name)| name.as_str())) {
        Some(known) => problem.hint(format!("did you mean `{known}`?")),
        None => problem,
    }
}

impl Graph<'_> {
    /// The order of set-up, without those that wait for each other.
    fn sort(&self) -> Vec<usize> {
        let mut waits_for: Vec<usize> = self.links.iter().map(Vec::len).collect();
        let mut dependents = vec![Vec::new(); self.links.len()];
        for (fixture, links) in self.links.iter().enumerate() {
            links.iter().for_each(|link| dependents[link.on].push(fixture));
        }
        let free = (0..self.links.len()).filter(|fixture| waits_for[*fixture] == 0);
        let mut free: BinaryHeap<_> = free.map(Reverse).collect();
        let mut order = Vec::with_capacity(self.links.len());
        while let Some(Reverse(fixture)) = free.pop() {
            order.push(fixture);
            for dependent in &dependents[fixture] {
                waits_for[*dependent] -= 1;
                if waits_for[*dependent] == 0 {
                    free.push(Reverse(*dependent));
                }
            }
        }
        order
    }

    /// Fixtures that wait for each other, each with its link to the next one
    /// and the last one with that to the first; `None` when all are in `order`.
    fn cycle(&self, order: &[usize]) -> Option<Vec<(usize, Link)>> {
        let mut seen = vec![None; self.links.len()];
        let mut waits = vec![true; self.links.len()];
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
            // What waits does so for another one that waits.
            let link = *self.links[fixture].iter().find(|link| waits[link.on])?;
            path.push((fixture, link));
            fixture = link.on;
        }
    }

    /// Takes out what the file says about a cycle, so that others are found.
    fn cut(&mut self, cycle: &[(usize, Link)]) {
        for (fixture, cut) in cycle {
            self.links[*fixture].retain(|link| !(link.written && link.on == cut.on));
        }
    }

    fn in_a_circle(&self, cycle: &[(usize, Link)], source: &Source) -> Diagnostic {
        /// Of a long circle only the ends are named.
        const NAMED: usize = 8;
        let name = |fixture: usize| format!("`{}`", self.names[fixture]);
        let mut names: Vec<_> = cycle.iter().map(|(fixture, _)| name(*fixture)).collect();
        names.push(names[0].clone());
        if names.len() > NAMED {
            let left_out = names.len() - NAMED;
            names.splice(NAMED / 2..NAMED / 2 + left_out, [format!("… {left_out} more …")]);
        }
        let message = format!("fixtures depend on each other in a circle: {}", names.join(" → "));
        let mut problem = Diagnostic::error("circular-dependency", message);
        // What is written can be changed: it comes first.
        let (written, made_up): (Vec<_>, Vec<_>) = cycle.iter().partition(|(_, link)| link.written);
        for (fixture, link) in written.iter().take(NAMED) {
            let text = format!("{} depends on {}", name(*fixture), name(link.on));
            problem = problem.label(source.label(link.span, &text));
        }
        let Some((fixture, link)) = made_up.first() else { return problem };
        let text = format!("without `depends`, it depends on {}, the one before it", name(link.on));
        problem
            .label(source.label(link.span, &text))
            .hint(format!("if {} needs no other fixture, give it `depends=\"\"`", name(*fixture)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Graph, Link};
    use crate::suite::Span;

    /// Up to 12 fixtures with any links between two different ones.
    fn links() -> impl Strategy<Value = Vec<Vec<Link>>> {
        let link = (any::<prop::sample::Index>(), any::<bool>());
        let links = prop::collection::vec(link, 0..3);
        prop::collection::vec(links, 1..12).prop_map(|drawn| {
            let count = drawn.len();
            let of = |place: usize, drawn: &[(prop::sample::Index, bool)]| {
                let mut links: Vec<Link> = Vec::new();
                for (index, written) in drawn {
                    // What is not written goes to the one before.
                    let on = if *written { index.index(count) } else { place.wrapping_sub(1) };
                    if on < count && on != place && links.iter().all(|known| known.on != on) {
                        links.push(Link { on, span: Span::default(), written: *written });
                    }
                }
                links
            };
            drawn.iter().enumerate().map(|(place, drawn)| of(place, drawn)).collect()
        })
    }

    proptest! {
        #[test]
        fn an_order_is_right_or_there_is_a_circle(links in links()) {
            let names: Vec<_> = (0..links.len()).map(|place| place.to_string()).collect();
            let mut graph = Graph { names: &names, links };
            let mut order = graph.sort();
            while let Some(cycle) = graph.cycle(&order) {
                for (index, (fixture, link)) in cycle.iter().enumerate() {
                    prop_assert_eq!(link.on, cycle[(index + 1) % cycle.len()].0);
                    prop_assert!(graph.links[*fixture].iter().any(|known| known.on == link.on));
                }
                prop_assert!(cycle.iter().any(|(_, link)| link.written));
                graph.cut(&cycle);
                order = graph.sort();
            }
            prop_assert_eq!(order.len(), names.len());
            for (turn, fixture) in order.iter().enumerate() {
                let earlier = |link: &Link| order[..turn].contains(&link.on);
                prop_assert!(graph.links[*fixture].iter().all(earlier));
            }
        }
    }
}
