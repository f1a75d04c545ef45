//! Numbers that no other run on this machine has.
//!
//! A lease is a socket that is bound to a name of the abstract namespace. The
//! kernel sees to it that nobody else can bind it, whoever they are, and frees
//! it when the last process that holds it is gone: no file is left behind, and
//! a runner that was killed blocks nothing. Names live in a network namespace,
//! as ports do.

use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use std::ops::RangeInclusive;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr as UnixAddr, UnixDatagram};

use rustix::io::Errno;
use rustix::net::{AddressFamily, SocketFlags, SocketType, bind, socket_with};

/// Below the ports that the kernel hands out by itself, above those that
/// services have by custom.
const PORTS: RangeInclusive<u16> = 20_000..=29_999;
/// With these, all ports of ROS 2's discovery lie below those that the kernel
/// hands out; 0 is everybody's.
const DOMAINS: RangeInclusive<u16> = 1..=101;

/// Why there is no number.
#[derive(Debug, thiserror::Error)]
pub enum LeaseError {
    /// Other runs have them all, or programs that are not rtf.
    #[error("every {kind} from {} to {} is in use", range.start(), range.end())]
    NoneLeft {
        /// What was wanted.
        kind: &'static str,
        /// Among which.
        range: RangeInclusive<u16>,
    },
    /// The system refused.
    #[error("{0}")]
    System(#[from] io::Error),
}

/// A number that is ours until this is dropped, here and in the guard.
#[derive(Debug)]
pub struct Lease {
    number: u16,
    socket: UnixDatagram,
}

impl Lease {
    /// The number.
    pub fn number(&self) -> u16 {
        self.number
    }

    /// Takes a number; `None` when somebody has it.
    fn take(kind: &str, number: u16) -> io::Result<Option<Self>> {
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

/// A TCP port that is free on all addresses. `seed` says where to begin.
pub fn port(seed: &str) -> Result<Lease, LeaseError> {
    first("port", PORTS, seed, is_free)
}

/// A domain of ROS 2.
pub fn domain(seed: &str) -> Result<Lease, LeaseError> {
    first("domain", DOMAINS, seed, |_| Ok(true))
}

fn first(
    kind: &'static str,
    range: RangeInclusive<u16>,
    seed: &str,
    fits: impl Fn(u16) -> io::Result<bool>,
) -> Result<Lease, LeaseError> {
    for number in from(range.clone(), seed) {
        if let Some(lease) = Lease::take(kind, number)?
            && fits(number)?
        {
            return Ok(lease);
        }
    }
    Err(LeaseError::NoneLeft { kind, range })
}

/// The numbers of a range, once around. Where it begins differs from run to
/// run: a port that was in use a moment ago is not given out again at once.
fn from(range: RangeInclusive<u16>, seed: &str) -> impl Iterator<Item = u16> {
    // FNV-1a: any hash will do that spreads.
    let hash = seed.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let length = usize::from(range.end() - range.start()) + 1;
    let start = usize::try_from(hash % length as u64).unwrap_or(0);
    range.cycle().skip(start).take(length)
}

/// Whether nobody listens there, or did a moment ago.
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
            // Nothing is known of the port when there are no descriptors left.
            Err(error @ (Errno::MFILE | Errno::NFILE | Errno::NOMEM | Errno::NOBUFS)) => {
                return Err(error.into());
            }
            // There may be no IPv6.
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
    fn a_number_is_leased_once_and_freed_by_its_drop() {
        let kind = format!("test-{}", std::process::id());
        let lease = Lease::take(&kind, 5).unwrap().unwrap();
        assert!(Lease::take(&kind, 5).unwrap().is_none());
        assert!(Lease::take(&kind, 6).unwrap().is_some());
        drop(lease);
        assert!(Lease::take(&kind, 5).unwrap().is_some());
    }

    #[test]
    fn two_leases_with_one_seed_differ() {
        let [one, two] = [port("seed").unwrap(), port("seed").unwrap()];
        assert_ne!(one.number(), two.number());
        assert!(PORTS.contains(&one.number()) && PORTS.contains(&two.number()));
    }

    #[test]
    fn a_port_on_which_somebody_listens_is_not_free() {
        for address in ["127.0.0.1:0", "0.0.0.0:0"] {
            let listener = TcpListener::bind(address).unwrap();
            let port = listener.local_addr().unwrap().port();
            assert!(!is_free(port).unwrap(), "{address}");
        }
    }

    #[test]
    fn every_number_comes_once_wherever_it_begins() {
        for seed in ["a", "b", "2026-11-21T06-30-12Z-1f3a.0"] {
            let mut numbers: Vec<_> = from(DOMAINS, seed).collect();
            numbers.sort_unstable();
            assert_eq!(numbers, DOMAINS.collect::<Vec<_>>(), "{seed}");
        }
    }

    #[test]
    fn when_all_are_taken_it_says_so() {
        let error = first("port", 20_000..=20_003, "seed", |_| Ok(false)).unwrap_err();
        assert_eq!(error.to_string(), "every port from 20000 to 20003 is in use");
    }

    /// Nothing is known of any port then.
    #[test]
    fn ports_that_cannot_be_tried_are_not_called_taken() {
        let full = |_| Err(Errno::MFILE.into());
        let error = first("port", 20_000..=20_003, "seed", full).unwrap_err();
        assert!(error.to_string().starts_with("Too many open files"), "{error}");
    }
}
