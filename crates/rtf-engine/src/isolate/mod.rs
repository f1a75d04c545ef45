//! The exclusive resources of a suite: a network namespace, ports, and ids for its middleware.
//! See `spec/suite.md`, "Isolation", and the rationale in `docs/decisions/0009-isolation.md`.
//!
//! - [`PreparedSuite`]: all resources of one suite, until its end.
//! - `lease`: numbers that are exclusive on this machine.
//! - `middleware`: the environment variables.
//! - `port_substitution`: completes the texts of a plan.

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
        let mut prepared = Self { plan, network, leases, locks: Vec::new() };
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
        let own = isolate.middleware != OwnMiddleware::No;
        if !own && !isolate.network && isolate.ports.is_empty() {
            return Ok(None);
        }
        let seed = format!("{run}.{}", plan.id);
        let mut ports = Vec::new();
        let always = middleware::PORTS.iter().copied().filter(|_| own);
        for name in always.chain(isolate.ports.iter().map(String::as_str)) {
            if ports.iter().all(|known: &SuitePort| known.name != name) {
                let lease = lease::port(&seed)?;
                let port = lease.number();
                ports.push(SuitePort { name: name.to_owned(), port });
                self.leases.push(lease);
            }
        }
        ports.sort_by(|a, b| a.name.cmp(&b.name));
        let mut variables = Vec::new();
        if own {
            let domain = lease::domain(&seed)?;
            let own =
                middleware::MiddlewareIds { run, run_dir, domain: domain.number(), ports: &ports };
            variables = own.variables(plan, |name| std::env::var(name).ok());
            self.leases.push(domain);
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

    /// Returns the network of its processes.
    pub fn network(&self) -> Option<Network> {
        self.network.as_ref().map(|held| held.network().clone())
    }

    /// Returns the network with its holder.
    pub fn held_network(&self) -> Option<&HeldNetwork> {
        self.network.as_ref()
    }

    /// Returns the descriptors of its locks.
    pub fn locks(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.locks.iter().map(AsFd::as_fd)
    }

    /// Returns the descriptors of its leases.
    pub fn leases(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.leases.iter().map(AsFd::as_fd)
    }

    /// Releases all resources.
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
