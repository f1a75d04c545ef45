//! The environment variables that isolate a suite's middleware.

use std::path::Path;

use rtf_model::{SuitePort, SuiteVariable};

use super::discovery;
use rtf_plan::plan::{FixtureBody, FixturePlan, OwnMiddleware, SuitePlan};

const ROS_MASTER: &str = "ros-master";
const GAZEBO_MASTER: &str = "gazebo-master";

/// The ports of every suite with isolated middleware.
pub const PORTS: [&str; 2] = [ROS_MASTER, GAZEBO_MASTER];

/// The variables for ROS 2: those of a suite that shares all other middleware.
const DOMAIN: &str = "ROS_DOMAIN_ID";
const RANGE: &str = "ROS_AUTOMATIC_DISCOVERY_RANGE";
const FORMER_RANGE: &str = "ROS_LOCALHOST_ONLY";
const ROS2: [&str; 3] = [DOMAIN, RANGE, FORMER_RANGE];
/// YARP's programs find their name server by its namespace.
const NAMESPACE: &str = "YARP_NAMESPACE";
/// The releases of ROS 2 without `RANGE`. Later ones warn about `FORMER_RANGE`.
const FORMER_RANGE_RELEASES: [&str; 3] = ["foxy", "galactic", "humble"];

/// The values of the variables.
#[derive(Clone, Copy, Debug)]
pub struct MiddlewareIds<'a> {
    pub run: &'a str,
    pub run_dir: &'a Path,
    /// The leased ROS 2 domain.
    pub domain: Option<u16>,
    pub ports: &'a [SuitePort],
}

/// Whether the suite uses a ROS 2 domain that it or the user's environment selects.
pub fn has_domain(plan: &SuitePlan, user: impl Fn(&str) -> Option<String>) -> bool {
    let keep = plan.isolate.middleware != OwnMiddleware::Always;
    is_written(plan, DOMAIN) || keep && user(DOMAIN).is_some_and(|value| !value.is_empty())
}

/// Whether the user's environment is that of one of these releases of ROS 2.
fn is_release(releases: &[&str], user: impl Fn(&str) -> Option<String>) -> bool {
    user("ROS_DISTRO").is_some_and(|release| releases.contains(&release.as_str()))
}

fn is_written(plan: &SuitePlan, name: &str) -> bool {
    plan.env.iter().any(|(known, _)| known == name)
}

/// Returns the variables of a test with a separate domain. `user` is the environment in which
/// the run was started.
pub fn of_test(
    domain: u16,
    run_dir: &Path,
    user: impl Fn(&str) -> Option<String>,
) -> Vec<SuiteVariable> {
    let (range, value) = range(&user);
    let ids = [(DOMAIN, domain.to_string()), (range, value)];
    let ids = ids.map(|(name, value)| private(name, value));
    ids.into_iter().chain(profile(run_dir, user)).collect()
}

fn private(name: &str, value: String) -> SuiteVariable {
    SuiteVariable { name: name.to_owned(), value, inherited: false }
}

/// The variable that limits discovery to this machine.
fn range(user: impl Fn(&str) -> Option<String>) -> (&'static str, String) {
    if is_release(&FORMER_RANGE_RELEASES, user) {
        (FORMER_RANGE, "1".to_owned())
    } else {
        (RANGE, "LOCALHOST".to_owned())
    }
}

/// The variables that name the profile of Fast DDS.
fn profile(run_dir: &Path, user: impl Fn(&str) -> Option<String>) -> Vec<SuiteVariable> {
    let Some(file) = discovery::write_profile(run_dir, &user) else { return Vec::new() };
    let is_former = is_release(&discovery::FORMER_RELEASES, &user);
    let former = is_former || user(discovery::FORMER_VARIABLE).is_some();
    let names = [(discovery::VARIABLE, true), (discovery::FORMER_VARIABLE, former)];
    let names = names.into_iter().filter(|(_, is_set)| *is_set);
    names.map(|(name, _)| private(name, file.to_string_lossy().into_owned())).collect()
}

impl MiddlewareIds<'_> {
    /// Returns the variables, except those that the suite sets. `user` is the environment in which
    /// the run was started.
    pub fn variables(
        &self,
        plan: &SuitePlan,
        user: impl Fn(&str) -> Option<String>,
    ) -> Vec<SuiteVariable> {
        let keep = plan.isolate.middleware != OwnMiddleware::Always;
        let is_ros2_only = plan.isolate.middleware == OwnMiddleware::Ros2UnlessSet;
        let kept = |name: &str| user(name).filter(|value| keep && !value.is_empty());
        let is_remote = |fixture: &FixturePlan| match &fixture.body {
            FixtureBody::Process(process) => process.remote.is_some(),
            FixtureBody::Plugin(_) | FixtureBody::Attached(_) => false,
        };
        let is_here = !plan.fixtures.iter().any(is_remote);
        let local_domain = !has_domain(plan, &user) && is_here;
        let own_master = kept("ROS_MASTER_URI").is_none() && !is_written(plan, "ROS_MASTER_URI");
        let local_master = own_master && is_here;
        let mut variables = Vec::new();
        for (name, value) in self.all(plan, &user) {
            let shares_name_server = plan.isolate.shares_name_server && name == NAMESPACE;
            let is_shared = shares_name_server || is_ros2_only && !ROS2.contains(&name);
            if is_written(plan, name) || is_shared {
                continue;
            }
            // The user's domain may span machines, and needs the user's range.
            let spans_machines = [RANGE, FORMER_RANGE].contains(&name) && !local_domain;
            if spans_machines && kept(name).is_none() {
                continue;
            }
            // The user's host name belongs to the user's master.
            let of_master = name == "ROS_HOSTNAME";
            if of_master && !local_master {
                continue;
            }
            // The directory does not exist on a remote machine.
            if name == "ROS_LOG_DIR" && !is_here {
                continue;
            }
            variables.push(match kept(name).filter(|_| !of_master) {
                Some(value) => SuiteVariable { name: name.to_owned(), value, inherited: true },
                None => private(name, value),
            });
        }
        if local_domain {
            let profile = profile(self.run_dir, &user).into_iter();
            let profile = profile.filter(|variable| !is_written(plan, &variable.name));
            variables.extend(profile);
        }
        variables
    }

    fn all(
        &self,
        plan: &SuitePlan,
        user: impl Fn(&str) -> Option<String>,
    ) -> Vec<(&'static str, String)> {
        let partition = format!("rtf-{}-{}", self.run, plan.id);
        let mut all = vec![
            range(user),
            ("ROS_MASTER_URI", self.address(ROS_MASTER)),
            // With an address instead of this name roscpp listens everywhere.
            ("ROS_HOSTNAME", "localhost".to_owned()),
            ("ROS_LOG_DIR", self.logs(plan)),
            ("GZ_PARTITION", partition.clone()),
            ("IGN_PARTITION", partition),
            ("GAZEBO_MASTER_URI", self.address(GAZEBO_MASTER)),
        ];
        if let Some(domain) = self.domain {
            all.insert(0, (DOMAIN, domain.to_string()));
            all.insert(5, (NAMESPACE, format!("/rtf{domain}")));
        }
        all
    }

    /// The directory for logs of nodes, named like the suite's other logs: `logs/arm.ros`.
    fn logs(&self, plan: &SuitePlan) -> String {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let name = if plan.name.chars().all(is_plain) {
            format!("{}.ros", plan.name)
        } else {
            format!("ros~s{}", plan.id)
        };
        self.run_dir.join("logs").join(name).to_string_lossy().into_owned()
    }

    fn address(&self, name: &str) -> String {
        let port = self.ports.iter().find(|own| own.name == name).map_or(0, |own| own.port);
        format!("http://127.0.0.1:{port}")
    }
}
