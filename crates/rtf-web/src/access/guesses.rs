//! Slows down those who guess the token: after a wrong one, the next attempts of
//! the same client wait, one after the other. A right token waits only then.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::Mutex as AsyncMutex;

/// How long the attempt after a wrong one waits; doubled after each further one.
const FIRST_DELAY: Duration = Duration::from_millis(125);
/// How long an attempt waits at most.
const LONGEST_DELAY: Duration = Duration::from_secs(1);
/// How long wrong tokens of a client are remembered.
const REMEMBERED: Duration = Duration::from_secs(60);
/// How many clients are remembered.
const CLIENTS: usize = 1024;

/// The attempts of all clients.
#[derive(Debug, Default)]
pub struct Guesses(Mutex<HashMap<IpAddr, Arc<AsyncMutex<Wrong>>>>);

/// The wrong tokens of one client.
#[derive(Debug, Default)]
struct Wrong {
    count: u64,
    last: Option<Instant>,
}

impl Wrong {
    /// The time of the next attempt. Old wrong tokens are forgotten.
    fn due(&mut self, now: Instant) -> Option<Instant> {
        if self.last.is_none_or(|last| now.saturating_duration_since(last) > REMEMBERED) {
            *self = Self::default();
        }
        let doubled = u32::try_from(self.count).unwrap_or(u32::MAX).saturating_sub(1).min(8);
        let delay = FIRST_DELAY.saturating_mul(1 << doubled).min(LONGEST_DELAY);
        self.last.map(|last| last + delay)
    }

    /// Counts a wrong token; returns the recent number.
    fn add(&mut self, now: Instant) -> u64 {
        self.last = Some(now);
        self.count += 1;
        self.count
    }
}

impl Guesses {
    /// Checks an attempt after its delay. The error is the number of wrong
    /// tokens that this client has sent recently.
    pub async fn attempt(
        &self,
        client: IpAddr,
        is_right: impl FnOnce() -> bool,
    ) -> Result<(), u64> {
        let wrong = self.of(client);
        let mut wrong = wrong.lock().await;
        if let Some(due) = wrong.due(Instant::now()) {
            tokio::time::sleep_until(due.into()).await;
        }
        if is_right() { Ok(()) } else { Err(wrong.add(Instant::now())) }
    }

    fn of(&self, client: IpAddr) -> Arc<AsyncMutex<Wrong>> {
        let mut clients = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if clients.len() >= CLIENTS {
            // Clients with a pending attempt are kept; the others start over.
            clients.retain(|_, wrong| Arc::strong_count(wrong) > 1);
        }
        clients.entry(network_of(client)).or_default().clone()
    }
}

/// One client may have all the addresses of an IPv6 network.
fn network_of(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => Ipv6Addr::from_bits(address.to_bits() >> 64 << 64).into(),
        address => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_wrong_token_makes_the_next_attempt_wait_up_to_a_second() {
        let (mut wrong, mut now) = (Wrong::default(), Instant::now());
        assert_eq!(wrong.due(now), None, "the first attempt does not wait");
        for (count, wanted) in (1..).zip([125, 250, 500, 1000, 1000, 1000]) {
            assert_eq!(wrong.add(now), count);
            let due = wrong.due(now).unwrap();
            assert_eq!(due - now, Duration::from_millis(wanted));
            now = due;
        }
        let later = now + REMEMBERED - LONGEST_DELAY;
        assert_eq!(wrong.due(later), Some(now), "it is remembered for a while");
        assert_eq!(wrong.due(now + REMEMBERED + REMEMBERED), None);
        assert_eq!(wrong.add(now), 1, "and then forgotten");
    }

    #[test]
    fn a_network_of_ipv6_is_one_client() {
        let of = |text: &str| network_of(text.parse().unwrap());
        assert_eq!(of("2001:db8:1:2::1"), of("2001:db8:1:2:ffff::2"));
        assert_ne!(of("2001:db8:1:2::1"), of("2001:db8:1:3::1"));
        assert_eq!(of("::ffff:192.0.2.1"), of("192.0.2.1"));
        assert_ne!(of("192.0.2.1"), of("192.0.2.2"));
    }
}
