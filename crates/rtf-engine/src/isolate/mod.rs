//! The exclusive resources of a suite: a network namespace, ports, and ids for its middleware.
//! See `spec/suite.md`, "Isolation", and the rationale in `docs/decisions/0009-isolation.md`.
//!
//! - [`PreparedSuite`]: all resources of one suite, until its end.
//! - `discovery`: with which interval ROS 2 nodes announce themselves.
//! - `lease`: numbers that are exclusive on this machine.
//! - `middleware`: the environment variables.
//! - `port_substitution`: completes the texts of a plan.

mod discovery;
mod lease;
mod middleware;
mod port_substitution;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::os::fd::{AsFd, BorrowedFd};
use std::path::Path;

use rtf_model::{SuiteNetwork, SuitePort, SuitePrepared, SuiteVariable};

use crate::locks::Lock;
use lease::{Lease, LeaseError};
use rtf_plan::plan::{OwnMiddleware, Preparation, SuitePlan};
use rtf_process::network::{HeldNetwork, Network, NetworkError};
use rtf_process::spawner::Spawner;

/// Checks that this machine permits private networks.
///
/// # Errors
/// The reason why it does not.
pub async fn check_network(spawner: &Spawner) -> Result<(), String> {
    let network = HeldNetwork::start(spawner).await.map_err(|error| error.to_string())?;
    network.end().await;
    Ok(())
}

/// Why a suite cannot get its resources.
#[derive(Debug, thiserror::Error)]
enum PreparationError {
    #[error("cannot lease a number: {0}")]
    Lease(#[from] LeaseError),
    #[error("no network of its own: {0}")]
    Network(#[from] NetworkError),
}

/// A suite with its exclusive resources.
#[derive(Debug)]
pub struct PreparedSuite<'p> {
    /// The completed plan.
    pub plan: Cow<'p, SuitePlan>,
    network: Option<HeldNetwork>,
    leases: Vec<Lease>,
    locks: Vec<Lock>,
    /// The variables for tests with separate domains, as many as can run at once.
    test_domains: Vec<Vec<(String, String)>>,
}

impl<'p> PreparedSuite<'p> {
    /// Acquires the resources of a suite, unless its locks are refused. `run` is unique on this
    /// machine; `run_dir` is the run's directory.
    pub async fn prepare(
        plan: &'p SuitePlan,
        locks: Result<Vec<Lock>, String>,
        run: &str,
        run_dir: &Path,
        spawner: &Spawner,
    ) -> Self {
        let (plan, leases, network) = (Cow::Borrowed(plan), Vec::new(), None);
        let (locks_taken, test_domains) = (Vec::new(), Vec::new());
        let mut prepared = Self { plan, network, leases, locks: locks_taken, test_domains };
        match locks {
            Ok(locks) => prepared.locks = locks,
            Err(held) => {
                port_substitution::substitute(prepared.plan.to_mut(), Preparation::Refused(held));
                return prepared;
            }
        }
        let plan = prepared.plan.clone();
        let preparation = match prepared.acquire(&plan, run, run_dir, spawner).await {
            Ok(None) => return prepared,
            Ok(Some(resources)) => Preparation::Done(resources),
            Err(refused) => Preparation::Refused(refused.to_string()),
        };
        port_substitution::substitute(prepared.plan.to_mut(), preparation);
        prepared
    }

    async fn acquire(
        &mut self,
        plan: &SuitePlan,
        run: &str,
        run_dir: &Path,
        spawner: &Spawner,
    ) -> Result<Option<SuitePrepared>, PreparationError> {
        let isolate = &plan.isolate;
        let user = |name: &str| std::env::var(name).ok();
        let (is_private, needs_domain) = match isolate.middleware {
            OwnMiddleware::No => (false, false),
            OwnMiddleware::Ros2UnlessSet => (false, !middleware::has_domain(plan, user)),
            OwnMiddleware::UnlessSet | OwnMiddleware::Always => (true, true),
        };
        let seed = format!("{run}.{}", plan.id);
        self.lease_test_domains(plan, &seed, run_dir)?;
        if !needs_domain && !isolate.network && isolate.ports.is_empty() {
            return Ok(None);
        }
        let always = middleware::PORTS.iter().copied().filter(|_| is_private);
        let names = always.chain(isolate.ports.iter().map(String::as_str));
        let ports = self.lease_ports(names, &seed)?;
        let mut variables = Vec::new();
        if needs_domain {
            let domain = match lease::domain(&seed) {
                // Most of these suites do not speak ROS 2.
                Err(LeaseError::NoneLeft { .. }) if !is_private => None,
                domain => Some(domain?),
            };
            let number = domain.as_ref().map(Lease::number);
            let ids = middleware::MiddlewareIds { run, run_dir, domain: number, ports: &ports };
            variables = ids.variables(plan, user);
            self.leases.extend(domain);
        }
        if isolate.network {
            self.network = Some(HeldNetwork::start(spawner).await?);
        }
        let network = self
            .network
            .as_ref()
            .map(|held| SuiteNetwork { pid: held.pid, user_namespace: held.has_user_namespace });
        let join_command = join_command(network, &ports, &variables);
        Ok(Some(SuitePrepared { suite: plan.id, network, ports, variables, join_command }))
    }

    /// Leases a domain for each of the tests with separate domains that can run at once.
    fn lease_test_domains(
        &mut self,
        plan: &SuitePlan,
        seed: &str,
        run_dir: &Path,
    ) -> Result<(), LeaseError> {
        let tests = plan.tests.iter().filter(|test| test.settings.own_domain);
        for _ in tests.take(plan.settings.parallel as usize) {
            let domain = lease::domain(seed)?;
            let user = |name: &str| std::env::var(name).ok();
            let variables = middleware::of_test(domain.number(), run_dir, user);
            let variables = variables.into_iter().map(|variable| (variable.name, variable.value));
            self.test_domains.push(variables.collect());
            self.leases.push(domain);
        }
        Ok(())
    }

    pub fn test_domains(&self) -> Vec<Vec<(String, String)>> {
        self.test_domains.clone()
    }

    /// Leases a port for each name, sorted by name.
    fn lease_ports<'n>(
        &mut self,
        names: impl Iterator<Item = &'n str>,
        seed: &str,
    ) -> Result<Vec<SuitePort>, LeaseError> {
        let mut ports = Vec::new();
        for name in names {
            if ports.iter().all(|known: &SuitePort| known.name != name) {
                let lease = lease::port(seed)?;
                let port = lease.number();
                ports.push(SuitePort { name: name.to_owned(), port });
                self.leases.push(lease);
            }
        }
        ports.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(ports)
    }

    pub fn network(&self) -> Option<Network> {
        self.network.as_ref().map(|held| held.network().clone())
    }

    pub fn held_network(&self) -> Option<&HeldNetwork> {
        self.network.as_ref()
    }

    pub fn locks(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.locks.iter().map(AsFd::as_fd)
    }

    pub fn leases(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.leases.iter().map(AsFd::as_fd)
    }

    pub async fn release(self, spawner: &Spawner) {
        // No process of the suite is left that could use a locked resource.
        self.locks.into_iter().for_each(Lock::release);
        if let Some(held) = self.network {
            let namespaces = held.network().namespaces().clone();
            held.end().await;
            // Its fork servers are in the namespace, too.
            spawner.stop_fork_servers(Some(namespaces)).await;
        }
    }
}

/// Returns a shell command with which a user joins the suite's environment.
fn join_command(
    network: Option<SuiteNetwork>,
    ports: &[SuitePort],
    variables: &[SuiteVariable],
) -> String {
    let ports = ports.iter().map(|own| (SuitePort::variable(&own.name), own.port.to_string()));
    let ids = variables.iter().map(|own| (own.name.clone(), own.value.clone()));
    let words = ids.chain(ports).map(|(name, value)| {
        let value = shell_words::quote(&value);
        format!("{name}={value}")
    });
    let words = words.collect::<Vec<_>>().join(" ");
    match network {
        None => format!("export {words}"),
        Some(SuiteNetwork { pid, user_namespace }) => {
            let user = if user_namespace { "--user --preserve-credentials " } else { "" };
            format!("nsenter --target {pid} {user}--net env {words} ${{SHELL:-sh}}")
        }
    }
}
