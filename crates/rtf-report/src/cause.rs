//! Shortens reasons that repeat why a fixture is broken.

use rtf_model::Record;

/// Cuts the cause from a reason that names a broken fixture, because the cause is reported
/// with the fixture. Other reasons are unchanged.
pub(crate) fn short<'a>(record: &Record, reason: &'a str) -> &'a str {
    let broken = record.fixtures.iter().filter(|fixture| fixture.broken.is_some());
    let heads = broken.map(|fixture| format!("fixture `{}` is broken", fixture.plan.name));
    let mut cuts = heads.filter_map(|head| {
        let rest = reason.strip_prefix(head.as_str())?;
        rest.starts_with(": ").then_some(&reason[..head.len()])
    });
    cuts.next().unwrap_or(reason)
}

#[cfg(test)]
mod tests {
    use rtf_model::{Event, EventKind, FixtureId, FixturePlanned, Micros, SuiteId};

    use super::*;

    #[test]
    fn only_the_cause_of_a_fixture_that_is_broken_is_left_out() {
        let mut record = Record::default();
        for (seq, name) in [(0, "sim"), (1, "arm")] {
            let (fixture, suite) = (FixtureId(seq), SuiteId(0));
            let (name, plugin_type) = (name.to_owned(), "process".to_owned());
            let plan = FixturePlanned { fixture, suite, name, plugin_type };
            let (seq, at) = (seq.into(), Micros::default());
            record.apply(&Event { seq, at, kind: EventKind::FixturePlanned(plan) });
        }
        let (fixture, reason) = (FixtureId(0), "no display".to_owned());
        let kind = EventKind::FixtureBroken { fixture, reason };
        record.apply(&Event { seq: 2, at: Micros::default(), kind });
        for (reason, told) in [
            ("fixture `sim` is broken: no display", "fixture `sim` is broken"),
            ("fixture `sim` is broken", "fixture `sim` is broken"),
            ("fixture `arm` is broken: no display", "fixture `arm` is broken: no display"),
            ("stopped by SIGINT", "stopped by SIGINT"),
        ] {
            assert_eq!(short(&record, reason), told);
        }
    }
}
