//! Placeholders for plans whose events were lost with damaged lines of a journal,
//! so that later suites, fixtures and tests keep their ids.

use super::{FixtureRecord, HookRecord, SuiteRecord, TestRecord};
use crate::{
    FixtureId, FixturePlanned, HookId, HookPlanned, SuiteId, SuitePlanned, TestId, TestPlanned,
};

/// In a larger gap, the number itself is taken to be damaged.
const LARGEST: u32 = 1000;

/// Whether the plans between the expected and the actual number may have
/// been lost.
pub(crate) fn is_likely(expected: u32, actual: u32) -> bool {
    actual.checked_sub(expected).is_some_and(|missing| missing <= LARGEST)
}

/// Adds an entry with this id after those that are missing. Returns the new ids: none when the
/// entry does not fit there.
pub(super) fn add<T>(
    list: &mut Vec<T>,
    id: u32,
    entry: T,
    missing: impl Fn(u32) -> T,
) -> std::ops::Range<u32> {
    let known = list.len() as u32;
    if !is_likely(known, id) {
        return 0..0;
    }
    list.extend((known..id).map(missing));
    list.push(entry);
    known..id.saturating_add(1)
}

pub(super) fn suite(index: u32) -> SuiteRecord {
    SuiteRecord::new(SuitePlanned {
        suite: SuiteId(index),
        name: format!("unknown-suite-{index}"),
        parallel: 1,
        ..SuitePlanned::default()
    })
}

pub(super) fn fixture(index: u32, suite: SuiteId) -> FixtureRecord {
    FixtureRecord::new(FixturePlanned {
        fixture: FixtureId(index),
        suite,
        name: format!("unknown-fixture-{index}"),
        ..FixturePlanned::default()
    })
}

pub(super) fn hook(index: u32, suite: SuiteId) -> HookRecord {
    HookRecord::new(HookPlanned {
        hook: HookId(index),
        suite,
        name: format!("unknown-hook-{index}"),
        ..HookPlanned::default()
    })
}

pub(super) fn test(index: u32, suite: SuiteId) -> TestRecord {
    TestRecord::new(TestPlanned {
        test: TestId(index),
        suite,
        name: format!("unknown-test-{index}"),
        repetitions: 1,
        ..TestPlanned::default()
    })
}
