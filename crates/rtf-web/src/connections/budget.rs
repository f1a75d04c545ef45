//! Counts connections: in total, and per client address.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};

/// How many connections there are.
#[derive(Clone, Debug)]
pub struct Budget {
    used: Arc<Mutex<HashMap<IpAddr, usize>>>,
    total: usize,
    per_address: usize,
}

/// Room for one connection; given back when it is dropped.
#[derive(Debug)]
pub struct ConnectionSlot {
    budget: Budget,
    address: IpAddr,
}

impl Budget {
    #[must_use]
    pub fn new(total: usize, per_address: usize) -> Self {
        Self { used: Arc::default(), total, per_address }
    }

    /// Room for one more connection of this address, if there is any.
    #[must_use]
    pub fn take(&self, address: IpAddr) -> Option<ConnectionSlot> {
        let mut used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let total: usize = used.values().sum();
        let own = used.get(&address).copied().unwrap_or_default();
        if total >= self.total || own >= self.per_address {
            return None;
        }
        used.insert(address, own + 1);
        Some(ConnectionSlot { budget: self.clone(), address })
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        let mut used = self.budget.used.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(own) = used.get_mut(&self.address) {
            *own -= 1;
            if *own == 0 {
                used.remove(&self.address);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_address_takes_all_connections_and_all_together_stay_within_the_total() {
        let budget = Budget::new(5, 3);
        let (first, second) = (IpAddr::from([127, 0, 0, 1]), IpAddr::from([127, 0, 0, 2]));
        let mut places: Vec<_> = (0..3).map(|_| budget.take(first).unwrap()).collect();
        assert!(budget.take(first).is_none(), "the limit of one address");
        places.extend((0..2).map(|_| budget.take(second).unwrap()));
        assert!(budget.take(second).is_none(), "the limit of all");
        places.clear();
        assert!(budget.used.lock().unwrap().is_empty(), "all of it was given back");
        assert!(budget.take(first).is_some());
    }
}
