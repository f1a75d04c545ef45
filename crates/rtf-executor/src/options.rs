//! The options of an executor: what is submitted where.

use std::collections::BTreeSet;

use rtf_cluster::Cluster;
use rtf_plan::plan::Plan;

/// A cluster, and the tasks for it.
pub struct ClusterOptions {
    pub cluster: Cluster,
    /// The number of tasks, from 1.
    pub shards: u32,
    /// Whether each resource that a suite requires is also requested from the scheduler.
    pub licenses: bool,
    /// Whether the job is printed instead of submitted.
    pub print: bool,
}

impl ClusterOptions {
    /// The names of the resources to request from the scheduler.
    pub fn resources(&self, plan: &Plan) -> Vec<String> {
        let suites = plan.suites.iter().filter(|_| self.licenses);
        let required = suites.flat_map(|suite| &suite.settings.requires);
        let names: BTreeSet<_> = required.map(|it| plain_name(&it.name)).collect();
        names.into_iter().collect()
    }
}

/// The name of a resource for a scheduler: `:` and other characters have a meaning.
fn plain_name(resource: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    resource.chars().map(|c| if is_plain(c) { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resources_have_plain_names() {
        assert_eq!(plain_name("robot:left-arm"), "robot_left-arm");
        assert_eq!(plain_name("a,b c"), "a_b_c");
    }
}
