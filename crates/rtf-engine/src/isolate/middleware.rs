//! The environment variables that isolate a suite's middleware.

use std::path::Path;

use rtf_model::{SuitePort, SuiteVariable};

use rtf_plan::plan::{FixtureBody, FixturePlan, OwnMiddleware, SuitePlan};

const ROS_MASTER: &str = "ros-master";
const GAZEBO_MASTER: &str = "gazebo-master";

/// The ports of every suite with isolated middleware.
pub const PORTS: [&str; 2] = [ROS_MASTER, GAZEBO_MASTER];

/// The values of the variables.
#[derive(Clone, Copy, Debug)]
pub struct MiddlewareIds<'a> {
    pub run: &'a str,
    /// The run's directory.
    pub run_dir: &'a Path,
    /// The leased ROS 2 domain.
    pub domain: u16,
    /// The suite's ports.
    pub ports: &'a [SuitePort],
}

impl MiddlewareIds<'_> {
    /// Returns the variables, except those that the suite sets. `user` is the environment in which
    /// the run was started.
    pub fn variables(
        &self,
        plan: &SuitePlan,
        user: impl Fn(&str) -> Option<String>,
    ) -> Vec<SuiteVariable> {
        let keep = plan.isolate.middleware == OwnMiddleware::UnlessSet;
        let written = |name: &str| plan.env.iter().any(|(known, _)| known == name);
        let user = |name: &str| user(name).filter(|value| keep && !value.is_empty());
        let own_domain = user("ROS_DOMAIN_ID").is_none() && !written("ROS_DOMAIN_ID");
        let is_remote = |fixture: &FixturePlan| match &fixture.body {
            FixtureBody::Process(process) => process.remote.is_some(),
            FixtureBody::Plugin(_) | FixtureBody::Attached(_) => false,
        };
        let is_here = !plan.fixtures.iter().any(is_remote);
        let local_domain = own_domain && is_here;
        let own_master = user("ROS_MASTER_URI").is_none() && !written("ROS_MASTER_URI");
        let local_master = own_master && is_here;
        let mut variables = Vec::new();
        for (name, value) in self.all(plan) {
            // The user's domain may span machines, and needs the user's range.
            let spans_machines = name == "ROS_AUTOMATIC_DISCOVERY_RANGE" && !local_domain;
            if written(name) || (spans_machines && user(name).is_none()) {
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
            let name = name.to_owned();
            variables.push(match user(&name).filter(|_| !of_master) {
                Some(value) => SuiteVariable { name, value, inherited: true },
                None => SuiteVariable { name, value, inherited: false },
            });
        }
        variables
    }

    fn all(&self, plan: &SuitePlan) -> [(&'static str, String); 9] {
        let partition = format!("rtf-{}-{}", self.run, plan.id);
        [
            ("ROS_DOMAIN_ID", self.domain.to_string()),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST".to_owned()),
            ("ROS_MASTER_URI", self.address(ROS_MASTER)),
            // With an address instead of this name roscpp listens everywhere.
            ("ROS_HOSTNAME", "localhost".to_owned()),
            ("ROS_LOG_DIR", self.logs(plan)),
            ("YARP_NAMESPACE", format!("/rtf{}", self.domain)),
            ("GZ_PARTITION", partition.clone()),
            ("IGN_PARTITION", partition),
            ("GAZEBO_MASTER_URI", self.address(GAZEBO_MASTER)),
        ]
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
