//! Which run it is, and where it is started.

use std::num::NonZeroUsize;

use rtf_model::Origin;
use uuid::Uuid;

/// Describes this machine and the CI job, and makes up an identity for a run.
pub fn find() -> Origin {
    let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
    let cpus = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    Origin {
        id: Uuid::now_v7().to_string(),
        host,
        cpus: u32::try_from(cpus).unwrap_or(u32::MAX),
        load_percent: std::fs::read_to_string("/proc/loadavg")
            .ok()
            .and_then(|text| load_percent(&text, cpus)),
        ci_job: ci_job(&|name| std::env::var(name).ok().filter(|value| !value.is_empty())),
    }
}

/// The average load of the last minute in percent of all CPUs.
fn load_percent(loadavg: &str, cpus: usize) -> Option<u32> {
    let load: f64 = loadavg.split_whitespace().next()?.parse().ok()?;
    let percent = (load / cpus as f64 * 100.0).round();
    (0.0..=f64::from(u32::MAX)).contains(&percent).then_some(percent as u32)
}

/// The address of the CI job, without credentials.
fn ci_job(variable: &dyn Fn(&str) -> Option<String>) -> Option<String> {
    let github = || {
        let (server, repository) = (variable("GITHUB_SERVER_URL")?, variable("GITHUB_REPOSITORY")?);
        Some(format!("{server}/{repository}/actions/runs/{}", variable("GITHUB_RUN_ID")?))
    };
    let job = github().or_else(|| variable("CI_JOB_URL")).or_else(|| variable("BUILD_URL"))?;
    let Some((scheme, rest)) = job.split_once("://") else { return Some(job) };
    let (host, path) = rest.split_at(rest.find('/').unwrap_or(rest.len()));
    let host = host.rsplit_once('@').map_or(host, |(_, host)| host);
    Some(format!("{scheme}://{host}{path}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_load_is_relative_to_the_cpus() {
        assert_eq!(load_percent("1.50 0.20 0.10 1/200 300\n", 2), Some(75));
        assert_eq!(load_percent("0.00 0.20 0.10 1/200 300\n", 8), Some(0));
        for text in ["", "nan 0 0", "-1 0 0", "x"] {
            assert_eq!(load_percent(text, 2), None, "{text:?}");
        }
    }

    #[test]
    fn the_address_of_a_job_of_each_code_host() {
        let job = |variables: &[(&str, &str)]| {
            let find = |name: &str| {
                let found = variables.iter().find(|(known, _)| *known == name);
                found.map(|(_, value)| (*value).to_owned())
            };
            ci_job(&find)
        };
        let github = [
            ("GITHUB_SERVER_URL", "https://example.org"),
            ("GITHUB_REPOSITORY", "arm/tests"),
            ("GITHUB_RUN_ID", "7"),
        ];
        assert_eq!(job(&github).as_deref(), Some("https://example.org/arm/tests/actions/runs/7"));
        let gitlab = [("CI_JOB_URL", "https://user:secret@example.org/arm/-/jobs/7")];
        assert_eq!(job(&gitlab).as_deref(), Some("https://example.org/arm/-/jobs/7"));
        assert_eq!(job(&[("BUILD_URL", "http://ci/7")]).as_deref(), Some("http://ci/7"));
        assert_eq!(job(&[]), None);
    }
}
