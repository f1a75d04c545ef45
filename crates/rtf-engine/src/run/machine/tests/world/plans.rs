//! Default plans; each test changes the relevant part.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::{FixtureId, HookId, SuiteId, TestId, Trigger};

use super::SECOND;
use rtf_plan::plan::*;

pub fn suite(fixtures: usize, tests: usize) -> SuitePlan {
    SuitePlan {
        id: SuiteId(0),
        name: "arm".to_owned(),
        file: "arm.xml".to_owned(),
        folder: PathBuf::from("."),
        env: Arc::default(),
        isolate: Isolation::default(),
        preparation: Preparation::NotNeeded,
        settings: SuiteSettings::default(),
        clock: None,
        fixtures: (0..fixtures).map(fixture).collect(),
        hooks: Vec::new(),
        tests: (0..tests).map(test).collect(),
        episodes: Arc::default(),
        awaits_episodes: false,
        refers_to_values: false,
    }
}

fn plugin() -> PluginPlan {
    PluginPlan {
        plugin_type: "dll".into(),
        file: PathBuf::from("plugin.so"),
        param: String::new(),
        args: Vec::new(),
        host: Arc::new(HostPlan {
            command: vec!["host".to_owned()],
            env: Vec::new(),
            forks: false,
        }),
    }
}

fn fixture(index: usize) -> FixturePlan {
    FixturePlan {
        id: FixtureId(u32::try_from(index).unwrap()),
        name: format!("fixture{index}"),
        depends: index.checked_sub(1).into_iter().collect(),
        body: FixtureBody::Plugin(plugin()),
        env: Vec::new(),
        limits: FixtureLimits {
            setup: 10 * SECOND,
            check: SECOND,
            notify: 2 * SECOND,
            teardown: 3 * SECOND,
        },
        reset: None,
        restarts: 1,
        restart_delay: Duration::ZERO,
        check_every: None,
        provides: Vec::new(),
    }
}

/// A hook that is a command.
pub fn hook(index: usize, on: &[Trigger]) -> HookPlan {
    HookPlan {
        id: HookId(u32::try_from(index).unwrap()),
        name: format!("hook{index}"),
        on: on.to_vec(),
        body: HookBody::Command(vec!["park".to_owned()]),
        env: Vec::new(),
        timeout: 4 * SECOND,
    }
}

fn test(index: usize) -> TestPlan {
    let limits = TestLimits {
        load: 10 * SECOND,
        setup: 10 * SECOND,
        run: 5 * SECOND,
        teardown: 3 * SECOND,
        slow: 2 * SECOND,
        grace: SECOND,
    };
    TestPlan {
        learn: Vec::new(),
        learned: Vec::new(),
        id: TestId(u32::try_from(index).unwrap()),
        name: format!("test{index}"),
        line: 0,
        plugin: plugin(),
        env: Vec::new(),
        limits: Arc::new(limits),
        settings: TestSettings::default(),
        tags: Vec::new(),
        combination: None,
        expected: None,
        slots: None,
        cases: None,
        cases_in_programs: None,
        was: None,
    }
}
