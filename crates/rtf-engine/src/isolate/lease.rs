//! Leases of ports and ids, exclusive on this machine.
//!
//! A lease is a socket bound to a name of the abstract namespace. No other process, of any
//! user, can bind that name until the last process that holds the socket has ended: no file
//! is left behind, and a killed runner blocks nothing. Names belong to a network namespace, as
//! ports do.

use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use std::ops::RangeInclusive;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr as UnixAddr, UnixDatagram};

use rustix::io::Errno;
use rustix::net::{AddressFamily, SocketFlags, SocketType, bind, socket_with};

/// Below the kernel's ephemeral ports, above the usual ports of services.
const PORTS: RangeInclusive<u16> = 20_000..=29_999;
/// The ROS 2 domains whose discovery ports are below the ephemeral ports; 0 is the default of
/// all users.
const DOMAINS: RangeInclusive<u16> = 1..=101;

/// Why no number can be leased.
#[derive(Debug, thiserror::Error)]
pub enum LeaseError {
    /// Other runs or programs use them all.
    #[error("every {kind} from {} to {} is in use", range.start(), range.end())]
    NoneLeft {
        /// What the number is for.
        kind: &'static str,
        range: RangeInclusive<u16>,
    },
    /// The system refused.
    #[error("{0}")]
    System(#[from] io::Error),
}

/// A number that is leased until this value is dropped, here and in the guard.
#[derive(Debug)]
pub struct Lease {
    number: u16,
    socket: UnixDatagram,
}

impl Lease {
    pub fn number(&self) -> u16 {
        self.number
    }

    /// Leases a number; `None` if it is in use.
    fn try_new(kind: &str, number: u16) -> io::Result<Option<Self>> {
        let address = UnixAddr::from_abstract_name(format!("rtf/{kind}/{number}"))?;
        match UnixDatagram::bind_addr(&address) {
            Ok(socket) => Ok(Some(Self { number, socket })),
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl AsFd for Lease {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.socket.as_fd()
    }
}

/// Leases a TCP port that is free on all addresses. `seed` selects the first candidate.
pub fn port(seed: &str) -> Result<Lease, LeaseError> {
    lease_first("port", PORTS, seed, is_free)
}

/// Leases a ROS 2 domain.
pub fn domain(seed: &str) -> Result<Lease, LeaseError> {
    lease_first("domain", DOMAINS, seed, |_| Ok(true))
}

fn lease_first(
    kind: &'static str,
    range: RangeInclusive<u16>,
    seed: &str,
    fits: impl Fn(u16) -> io::Result<bool>,
) -> Result<Lease, LeaseError> {
    for number in candidates(range.clone(), seed) {
        if let Some(lease) = Lease::try_new(kind, number)?
            && fits(number)?
        {
            return Ok(lease);
        }
    }
    Err(LeaseError::NoneLeft { kind, range })
}

/// Returns the numbers of a range. The first one differs from run to run, so that a port is not
/// reused immediately.
fn candidates(range: RangeInclusive<u16>, seed: &str) -> impl Iterator<Item = u16> {
    // FNV-1a; any hash that distributes well will do.
    let hash = seed.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let length = usize::from(range.end() - range.start()) + 1;
    let start = usize::try_from(hash % length as u64).unwrap_or(0);
    range.cycle().skip(start).take(length)
}

/// Whether no process listens on the port, or did a moment ago.
fn is_free(port: u16) -> io::Result<bool> {
    let any = [
        (AddressFamily::INET, SocketAddr::from((Ipv4Addr::UNSPECIFIED, port))),
        (AddressFamily::INET6, SocketAddr::from((Ipv6Addr::UNSPECIFIED, port))),
    ];
    for (family, address) in any {
        let bound = socket_with(family, SocketType::STREAM, SocketFlags::CLOEXEC, None)
            .and_then(|socket| bind(&socket, &address));
        match bound {
            Ok(()) => {}
            Err(Errno::ADDRINUSE) => return Ok(false),
            // Out of descriptors or memory: the state of the port is unknown.
            Err(error @ (Errno::MFILE | Errno::NFILE | Errno::NOMEM | Errno::NOBUFS)) => {
                return Err(error.into());
            }
            // The machine may lack IPv6.
            Err(_) if family == AddressFamily::INET6 => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    #[test]
    fn a_number_is_leased_once_and_released_by_its_drop() {
        let kind = format!("test-{}", std::process::id());
        let lease = Lease::try_new(&kind, 5).unwrap().unwrap();
        assert!(Lease::try_new(&kind, 5).unwrap().is_none());
        assert!(Lease::try_new(&kind, 6).unwrap().is_some());
        drop(lease);
        assert!(Lease::try_new(&kind, 5).unwrap().is_some());
    }

    #[test]
    fn two_leases_with_one_seed_differ() {
        let [one, two] = [port("seed").unwrap(), port("seed").unwrap()];
        assert_ne!(one.number(), two.number());
        assert!(PORTS.contains(&one.number()) && PORTS.contains(&two.number()));
    }

    #[test]
    fn a_port_with_a_listener_is_not_free() {
        for address in ["127.0.0.1:0", "0.0.0.0:0"] {
            let listener = TcpListener::bind(address).unwrap();
            let port = listener.local_addr().unwrap().port();
            assert!(!is_free(port).unwrap(), "{address}");
        }
    }

    #[test]
    fn every_number_is_a_candidate_once_for_any_seed() {
        for seed in ["a", "b", "2026-11-21T06-30-12Z-1f3a.0"] {
            let mut numbers: Vec<_> = candidates(DOMAINS, seed).collect();
            numbers.sort_unstable();
            assert_eq!(numbers, DOMAINS.collect::<Vec<_>>(), "{seed}");
        }
    }

    #[test]
    fn a_range_without_free_numbers_is_an_error() {
        let error = lease_first("port", 20_000..=20_003, "seed", |_| Ok(false)).unwrap_err();
        assert_eq!(error.to_string(), "every port from 20000 to 20003 is in use");
    }

    #[test]
    fn ports_whose_state_is_unknown_are_not_reported_as_in_use() {
        let full = |_| Err(Errno::MFILE.into());
        let error = lease_first("port", 20_000..=20_003, "seed", full).unwrap_err();
        assert!(error.to_string().starts_with("Too many open files"), "{error}");
    }
}
