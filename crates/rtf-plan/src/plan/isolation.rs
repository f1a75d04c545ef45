//! The private resources of a suite: the rules of "Isolation" in `spec/suite.md`.

use super::{Isolation, OwnMiddleware};
use crate::suite::{
    ClockSource, DeclaredMiddleware, DeclaredSourceKind, DeclaredSuite, FixtureKind,
    SignalMiddleware,
};

/// The fixture manager that starts a YARP name server.
const YARP_SERVER: &str = "yarpserver";
/// The fixture manager that uses a YARP name server and starts none.
const YARP_MANAGER: &str = "yarpmanager";
/// The fixture managers that start middleware. Recorders use existing middleware.
const STARTING_MIDDLEWARE: [&str; 5] =
    ["roscore", "roslaunch", YARP_SERVER, "ros2launch", "orocos"];

/// What a suite's fixtures have to do with middleware.
#[derive(Clone, Copy, Debug, Default)]
struct FixtureUse {
    /// They start some of it, or programs that may.
    starts: bool,
    /// They start a YARP name server, or programs that may.
    starts_name_server: bool,
    needs_name_server: bool,
    /// One of them is outside of the suite, and cannot know the ids of private middleware.
    is_outside: bool,
}

impl FixtureUse {
    /// A user's plug-in may start middleware or use an existing one: as in 2.x, its suite shares
    /// a running master or name server. One with the name of a shipped fixture manager is
    /// expected to do the same.
    fn of(suite: &DeclaredSuite) -> Self {
        let mut found = Self::default();
        for fixture in &suite.fixtures {
            match &fixture.body {
                FixtureKind::Attached(_) => found.is_outside = true,
                FixtureKind::Process(process) if process.host.is_some() => found.is_outside = true,
                FixtureKind::Process(_) => {
                    found.starts = true;
                    found.starts_name_server = true;
                }
                FixtureKind::Plugin(plugin) if plugin.plugin_type.is_none() => {
                    let name = plugin.name.value.as_str();
                    found.starts |= STARTING_MIDDLEWARE.contains(&name);
                    found.starts_name_server |= name == YARP_SERVER;
                    found.needs_name_server |= name == YARP_MANAGER;
                }
                FixtureKind::Plugin(_) => {}
            }
        }
        found
    }
}

/// Plans which resources are private.
pub(super) fn plan(suite: &DeclaredSuite) -> Isolation {
    let network = suite.isolate.network;
    let fixtures = FixtureUse::of(suite);
    let middleware = match suite.isolate.middleware {
        Some(DeclaredMiddleware::Own) => OwnMiddleware::Always,
        Some(DeclaredMiddleware::Shared) => OwnMiddleware::No,
        // A private network cannot reach shared middleware.
        None if network => OwnMiddleware::Always,
        None if fixtures.is_outside || reads_running_robot(suite) => OwnMiddleware::No,
        None if fixtures.starts => OwnMiddleware::UnlessSet,
        // ROS 2 has no server, and each test may start nodes.
        None => OwnMiddleware::Ros2UnlessSet,
    };
    let shares_name_server = middleware == OwnMiddleware::UnlessSet
        && fixtures.needs_name_server
        && !fixtures.starts_name_server;
    Isolation { network, middleware, shares_name_server, ports: suite.isolate.ports.clone() }
}

/// Whether the suite waits for messages of ROS 2, and has no fixture that could send them.
fn reads_running_robot(suite: &DeclaredSuite) -> bool {
    let has_topics = suite.signals.iter().any(|source| {
        let ros2 = SignalMiddleware::Ros2;
        matches!(&source.kind, DeclaredSourceKind::Topic { middleware, .. } if *middleware == ros2)
    });
    let has_clock = suite.clock.as_ref().is_some_and(|clock| clock.source == ClockSource::Ros2);
    suite.fixtures.is_empty() && (has_topics || has_clock)
}
