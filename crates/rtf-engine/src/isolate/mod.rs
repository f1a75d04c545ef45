//! What a suite gets for itself when it starts: a network namespace, ports, and
//! ids for its middleware. `spec/suite.md`, "Isolation", says what a user sees.
//!
//! - [`Prepared`]: all of it, for one suite; given back with its end.
//! - `lease`: numbers that no other run on this machine has.
//! - `middleware`: the environment variables.
//! - `fill`: puts what was given into the texts of a plan.
//!
//! Why it is like this: `docs/decisions/0009-isolation.md`.

mod fill;
mod lease;
mod middleware;
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

/// Whether a suite could have a network of its own here; else why not.
///
/// # Errors
/// What the system refuses.
pub async fn network_is_possible(spawner: &Spawner) -> Result<(), String> {
    let network = HeldNetwork::start(spawner).await.map_err(|error| error.to_string())?;
    network.end().await;
    Ok(())
}

/// Why a suite cannot have what it needs.
#[derive(Debug, thiserror::Error)]
enum RefusedError {
    #[error("cannot lease a number: {0}")]
    Lease(#[from] LeaseError),
    #[error("no network of its own: {0}")]
    Network(#[from] NetworkError),
}

/// A suite with all that it got for itself.
#[derive(Debug)]
pub struct Prepared<'p> {
    /// The plan, in which everything is filled in.
    pub plan: Cow<'p, SuitePlan>,
    network: Option<HeldNetwork>,
    leases: Vec<Lease>,
    locks: Vec<Lock>,
}

impl<'p> Prepared<'p> {
    /// Gets what a suite needs, unless the locks that it requires are held by
    /// somebody else. `run` is unique on this machine; `folder` is the run's.
    pub async fn get(
        plan: &'p SuitePlan,
        locks: Result<Vec<Lock>, String>,
        run: &str,
        folder: &Path,
        spawner: &Spawner,
    ) -> Self {
        let (plan, leases, network) = (Cow::Borrowed(plan), Vec::new(), None);
        let mut prepared = Self { plan, network, leases, locks: Vec::new() };
        match locks {
            Ok(locks) => prepared.locks = locks,
            Err(held) => {
                fill::fill(prepared.plan.to_mut(), Preparation::Refused(held));
                return prepared;
            }
        }
        let plan = prepared.plan.clone();
        let given = match prepared.acquire(&plan, run, folder, spawner).await {
            Ok(None) => return prepared,
            Ok(Some(given)) => Preparation::Done(given),
            Err(refused) => Preparation::Refused(refused.to_string()),
        };
        fill::fill(prepared.plan.to_mut(), given);
        prepared
    }

    async fn acquire(
        &mut self,
        plan: &SuitePlan,
        run: &str,
        folder: &Path,
        spawner: &Spawner,
    ) -> Result<Option<SuitePrepared>, RefusedError> {
        let wanted = &plan.isolate;
        let own = wanted.middleware != OwnMiddleware::No;
        if !own && !wanted.network && wanted.ports.is_empty() {
            return Ok(None);
        }
        let seed = format!("{run}.{}", plan.id);
        let mut ports = Vec::new();
        let always = middleware::PORTS.iter().copied().filter(|_| own);
        for name in always.chain(wanted.ports.iter().map(String::as_str)) {
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
            let own = middleware::Own { run, folder, domain: domain.number(), ports: &ports };
            variables = own.variables(plan, |name| std::env::var(name).ok());
            self.leases.push(domain);
        }
        if wanted.network {
            self.network = Some(HeldNetwork::start(spawner).await?);
        }
        let network = self
            .network
            .as_ref()
            .map(|held| SuiteNetwork { pid: held.pid, user_namespace: held.has_user_namespace });
        let join = join(network, &ports, &variables);
        Ok(Some(SuitePrepared { suite: plan.id, network, ports, variables, join_command: join }))
    }

    /// The network of its processes.
    #[must_use]
    pub fn network(&self) -> Option<Network> {
        self.network.as_ref().map(|held| held.network().clone())
    }

    /// The namespaces, and the process that holds them.
    #[must_use]
    pub fn held_network(&self) -> Option<&HeldNetwork> {
        self.network.as_ref()
    }

    /// What keeps others from what it requires.
    pub fn locks(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.locks.iter().map(AsFd::as_fd)
    }

    /// What keeps its numbers from other runs.
    pub fn leases(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.leases.iter().map(AsFd::as_fd)
    }

    /// Gives everything back.
    pub async fn give_back(self, spawner: &Spawner) {
        // Nothing of the suite is left that could use what is locked.
        self.locks.into_iter().for_each(Lock::release);
        if let Some(held) = self.network {
            let namespaces = held.network().namespaces().clone();
            held.end().await;
            // Its fork servers are in the namespace, too.
            spawner.stop_fork_servers(Some(namespaces)).await;
        }
    }
}

/// A command for a shell, with which a person joins in.
fn join(network: Option<SuiteNetwork>, ports: &[SuitePort], variables: &[SuiteVariable]) -> String {
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
