//! The default limits; `spec/suite.md` lists them.

use std::time::Duration;

use super::{FixtureLimits, TestLimits};

pub(crate) const TEST: TestLimits = TestLimits {
    load: Duration::from_secs(30),
    setup: Duration::from_secs(60),
    run: Duration::from_secs(300),
    teardown: Duration::from_secs(30),
    slow: Duration::from_secs(60),
    grace: Duration::from_secs(2),
};

pub(crate) const FIXTURE: FixtureLimits = FixtureLimits {
    setup: Duration::from_secs(60),
    check: Duration::from_secs(5),
    notify: Duration::from_secs(10),
    teardown: Duration::from_secs(30),
};

/// The maximum number of restarts of a fixture after a collapse.
pub(super) const RESTARTS: u32 = 3;

/// The delay before the first of them.
pub(super) const RESTART_DELAY: Duration = Duration::from_millis(100);

/// The limit of a hook.
pub(crate) const HOOK: Duration = Duration::from_secs(30);
