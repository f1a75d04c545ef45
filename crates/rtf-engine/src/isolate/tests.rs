//! What is made of a plan, without taking anything.

use std::path::Path;
use std::sync::Arc;

use rtf_model::{SuiteId, SuiteNetwork, SuitePort, SuitePrepared, SuiteVariable};

use super::middleware::MiddlewareIds;
use super::{join_command, port_substitution};
use crate::run::machine::tests::world::{SECOND, suite};
use rtf_plan::plan::{
    FixtureBody, OwnMiddleware, Preparation, Probe, ProbeKind, ProbePlans, ProcessPlan, RemotePlan,
    SuitePlan,
};

fn ports() -> Vec<SuitePort> {
    [("gazebo-master", 20_001), ("ros-master", 20_002), ("sim", 20_003)]
        .map(|(name, port)| SuitePort { name: name.to_owned(), port })
        .to_vec()
}

fn variables(
    middleware: OwnMiddleware,
    written: &[(&str, &str)],
    user: &[(&str, &str)],
) -> Vec<String> {
    let mut plan = suite(1, 1);
    plan.isolate.middleware = middleware;
    plan.env = Arc::new(written.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect());
    let (ports, run_dir) = (ports(), tempfile::tempdir().expect("a directory"));
    let run_dir = run_dir.path();
    let own = MiddlewareIds { run: "RUN", run_dir, domain: Some(42), ports: &ports };
    let of_user = |name: &str| {
        user.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned())
    };
    let shown = |own: SuiteVariable| {
        let value = own.value.replace(&*run_dir.to_string_lossy(), "/run");
        format!("{}={value}{}", own.name, if own.inherited { " kept" } else { "" })
    };
    own.variables(&plan, of_user).into_iter().map(shown).collect()
}

#[test]
fn a_fixture_on_another_machine_is_found_by_ros_2() {
    let mut plan = plan_of("");
    plan.isolate.middleware = OwnMiddleware::Always;
    plan.env = Arc::default();
    let FixtureBody::Process(process) = &mut plan.fixtures[1].body else { panic!("a process") };
    let remote = RemotePlan { host: "pi@robot".to_owned(), ssh: vec!["ssh".to_owned()] };
    Arc::make_mut(process).remote = Some(remote);
    let own =
        MiddlewareIds { run: "RUN", run_dir: Path::new("/run"), domain: Some(42), ports: &ports() };
    let names: Vec<_> = own.variables(&plan, |_| None).into_iter().map(|own| own.name).collect();
    assert_eq!(names.len(), 6);
    assert!(!names.contains(&"ROS_AUTOMATIC_DISCOVERY_RANGE".to_owned()));
    assert!(!names.contains(&"ROS_HOSTNAME".to_owned()));
    assert!(!names.contains(&"ROS_LOG_DIR".to_owned()));
}

const ALL: [&str; 10] = [
    "ROS_DOMAIN_ID=42",
    "ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST",
    "ROS_MASTER_URI=http://127.0.0.1:20002",
    "ROS_HOSTNAME=localhost",
    "ROS_LOG_DIR=/run/logs/arm.ros",
    "YARP_NAMESPACE=/rtf42",
    "GZ_PARTITION=rtf-RUN-0",
    "IGN_PARTITION=rtf-RUN-0",
    "GAZEBO_MASTER_URI=http://127.0.0.1:20001",
    "FASTDDS_DEFAULT_PROFILES_FILE=/run/fastdds.xml",
];

#[test]
fn a_suite_has_middleware_of_its_own() {
    for middleware in [OwnMiddleware::UnlessSet, OwnMiddleware::Always] {
        assert_eq!(variables(middleware, &[], &[("ROS_MASTER_URI_OLD", "x")]), ALL);
    }
    // An empty variable names nothing.
    assert_eq!(variables(OwnMiddleware::UnlessSet, &[], &[("ROS_DOMAIN_ID", "")]), ALL);
}

#[test]
fn what_the_user_set_is_kept_unless_the_suite_wants_its_own() {
    let user = [("ROS_DOMAIN_ID", "7"), ("GZ_PARTITION", "lab")];
    let kept = variables(OwnMiddleware::UnlessSet, &[], &user);
    // A domain that is not ours may span machines: its range is left alone.
    let expected = [
        "ROS_DOMAIN_ID=7 kept",
        "ROS_MASTER_URI=http://127.0.0.1:20002",
        "ROS_HOSTNAME=localhost",
        "ROS_LOG_DIR=/run/logs/arm.ros",
        "YARP_NAMESPACE=/rtf42",
        "GZ_PARTITION=lab kept",
        "IGN_PARTITION=rtf-RUN-0",
        "GAZEBO_MASTER_URI=http://127.0.0.1:20001",
    ];
    assert_eq!(kept, expected);
    assert_eq!(variables(OwnMiddleware::Always, &[], &user), ALL);
}

#[test]
fn a_suite_that_starts_no_middleware_has_only_a_domain_of_ros_2() {
    let only = OwnMiddleware::Ros2UnlessSet;
    assert_eq!(variables(only, &[], &[]), [ALL[0], ALL[1], ALL[9]]);
    let user = [("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"), ("YARP_NAMESPACE", "/lab")];
    let kept = "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET kept";
    assert_eq!(variables(only, &[], &user), [ALL[0], kept, ALL[9]]);
}

/// Later releases warn about the former names.
#[test]
fn releases_of_ros_2_get_the_variables_that_they_know() {
    let release = |name| variables(OwnMiddleware::Ros2UnlessSet, &[], &[("ROS_DISTRO", name)]);
    let former = "FASTRTPS_DEFAULT_PROFILES_FILE=/run/fastdds.xml";
    assert_eq!(release("humble"), [ALL[0], "ROS_LOCALHOST_ONLY=1", ALL[9], former]);
    assert_eq!(release("jazzy"), [ALL[0], ALL[1], ALL[9], former]);
    assert_eq!(release("kilted"), [ALL[0], ALL[1], ALL[9]]);
}

#[test]
fn a_profile_of_the_suite_is_left_to_it() {
    let written = [("FASTDDS_DEFAULT_PROFILES_FILE", "mine.xml")];
    let left = variables(OwnMiddleware::Ros2UnlessSet, &written, &[("ROS_DISTRO", "humble")]);
    let former = "FASTRTPS_DEFAULT_PROFILES_FILE=/run/fastdds.xml";
    assert_eq!(left, [ALL[0], "ROS_LOCALHOST_ONLY=1", former]);
}

/// By the name of a robot's network the nodes of a master on this machine would
/// not be found; and with the user's own master that name is right.
#[test]
fn the_address_of_nodes_belongs_to_the_master() {
    let hostname = |variables: Vec<String>| {
        variables.into_iter().find(|variable| variable.starts_with("ROS_HOSTNAME"))
    };
    let name = ("ROS_HOSTNAME", "lab.local");
    let own = variables(OwnMiddleware::UnlessSet, &[], &[name]);
    assert_eq!(hostname(own), Some("ROS_HOSTNAME=localhost".to_owned()));
    let user = [("ROS_MASTER_URI", "http://robot:11311"), name];
    assert_eq!(hostname(variables(OwnMiddleware::UnlessSet, &[], &user)), None);
    assert_eq!(hostname(variables(OwnMiddleware::UnlessSet, &user[..1], &[])), None);
}

/// `shares_name_server` is for suites that start other middleware.
#[test]
fn a_suite_without_a_name_server_uses_that_of_the_user() {
    let mut plan = plan_of("");
    plan.env = Arc::default();
    plan.isolate.middleware = OwnMiddleware::UnlessSet;
    plan.isolate.shares_name_server = true;
    let run_dir = tempfile::tempdir().expect("a directory");
    let own =
        MiddlewareIds { run: "RUN", run_dir: run_dir.path(), domain: Some(42), ports: &ports() };
    let names: Vec<_> = own.variables(&plan, |_| None).into_iter().map(|own| own.name).collect();
    assert_eq!(names.len(), ALL.len() - 1, "{names:?}");
    assert!(!names.contains(&"YARP_NAMESPACE".to_owned()));
}

#[test]
fn what_the_suite_sets_itself_is_left_to_it() {
    let written = [("ROS_DOMAIN_ID", "3"), ("YARP_NAMESPACE", "/lab")];
    for middleware in [OwnMiddleware::UnlessSet, OwnMiddleware::Always] {
        let left = variables(middleware, &written, &[("ROS_DOMAIN_ID", "7")]);
        assert_eq!(left, [ALL[2], ALL[3], ALL[4], ALL[6], ALL[7], ALL[8]]);
    }
}

fn prepared() -> SuitePrepared {
    let variable = |name: &str, value: &str, kept| {
        let (name, value) = (name.to_owned(), value.to_owned());
        SuiteVariable { name, value, inherited: kept }
    };
    SuitePrepared {
        suite: SuiteId(0),
        network: None,
        ports: ports(),
        variables: vec![variable("A", "own", false), variable("B", "kept", true)],
        join_command: String::new(),
    }
}

/// A plan with the same text in every place where a port may stand.
fn plan_of(text: &str) -> SuitePlan {
    let mut plan = suite(2, 1);
    let env = vec![("V".to_owned(), text.to_owned()), ("A".to_owned(), "written".to_owned())];
    plan.settings.environment = text.to_owned();
    plan.env = Arc::new(env.clone());
    let probe = |kind| Probe { kind, every: SECOND, timeout: SECOND };
    plan.fixtures[1].body = FixtureBody::Process(Arc::new(ProcessPlan {
        command: vec!["sim".to_owned(), text.to_owned()],
        probes: ProbePlans {
            ready: vec![
                probe(ProbeKind::Tcp(text.to_owned())),
                probe(ProbeKind::Http(text.to_owned())),
                probe(ProbeKind::File(text.into())),
                probe(ProbeKind::Command(vec!["ask".to_owned(), text.to_owned()])),
            ],
            alive: vec![probe(ProbeKind::Tcp(text.to_owned()))],
            values: Vec::new(),
        },
        stop_signal: 15,
        stop_grace: SECOND,
        stop_codes: Vec::new(),
        remote: None,
    }));
    plan.fixtures[1].env = env.clone();
    let test = &mut plan.tests[0];
    test.env = env;
    test.plugin.param = text.to_owned();
    test.plugin.args = vec!["--port".to_owned(), text.to_owned()];
    plan.fixtures[0].body = FixtureBody::Plugin(test.plugin.clone());
    plan
}

#[test]
fn ports_are_filled_in_everywhere() {
    let mut plan = plan_of("${port:sim}, $${port:sim}, ${HOME}");
    port_substitution::substitute(&mut plan, Preparation::Done(prepared()));
    let filled = plan_of("20003, ${port:sim}, ${HOME}");
    assert_eq!(format!("{:?}", plan.fixtures), format!("{:?}", filled.fixtures));
    assert_eq!(format!("{:?}", plan.tests), format!("{:?}", filled.tests));
    assert_eq!(plan.settings.environment, filled.settings.environment);
    // What the suite sets comes last, and counts; what was kept is there already.
    let names: Vec<_> = plan.env.iter().map(|(name, value)| format!("{name}={value}")).collect();
    let expected = [
        "A=own",
        "RTF_PORT_GAZEBO_MASTER=20001",
        "RTF_PORT_ROS_MASTER=20002",
        "RTF_PORT_SIM=20003",
        "V=20003, ${port:sim}, ${HOME}",
        "A=written",
    ];
    assert_eq!(names, expected);
}

#[test]
fn a_suite_that_is_refused_keeps_its_texts() {
    let mut plan = plan_of("${port:sim}");
    port_substitution::substitute(&mut plan, Preparation::Refused("no".to_owned()));
    assert_eq!(plan.tests[0].plugin.param, "${port:sim}");
    assert_eq!(plan.preparation, Preparation::Refused("no".to_owned()));
}

#[test]
fn a_person_can_join_in() {
    let variable =
        SuiteVariable { name: "A".to_owned(), value: "a b".to_owned(), inherited: false };
    let ports = [SuitePort { name: "name-server".to_owned(), port: 20_000 }];
    let line = |network| join_command(network, &ports, std::slice::from_ref(&variable));
    let inside = |user_namespace| Some(SuiteNetwork { pid: 7, user_namespace });
    assert_eq!(line(None), "export A='a b' RTF_PORT_NAME_SERVER=20000");
    assert_eq!(
        line(inside(false)),
        "nsenter --target 7 --net env A='a b' RTF_PORT_NAME_SERVER=20000 ${SHELL:-sh}"
    );
    assert!(
        line(inside(true))
            .starts_with("nsenter --target 7 --user --preserve-credentials --net env A=")
    );
}
