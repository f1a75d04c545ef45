//! The first and the last entries of a list that may be very long.

use std::collections::VecDeque;

/// The first and the last entries of a list, and important ones between them.
#[derive(Debug)]
pub struct Excerpt<T> {
    first: Vec<T>,
    important: Vec<T>,
    last: VecDeque<T>,
    limits: Limits,
    /// The sizes of both ends.
    first_size: usize,
    last_size: usize,
    omitted: u64,
}

#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The maximum size of the first entries, and of the last ones. At least one entry is
    /// kept at each end.
    pub end: usize,
    /// The maximum number of important entries between them.
    pub important: usize,
}

pub trait Entry {
    /// Its size, in the unit of the limits.
    fn size(&self) -> usize {
        1
    }

    /// Whether it is kept in the middle, too.
    fn is_important(&self) -> bool {
        false
    }
}

impl<T: Entry> Excerpt<T> {
    pub fn new(limits: Limits) -> Self {
        Self {
            first: Vec::new(),
            important: Vec::new(),
            last: VecDeque::new(),
            limits,
            first_size: 0,
            last_size: 0,
            omitted: 0,
        }
    }

    /// Adds an entry; calls `dropped` for each that is omitted, with the entry after it.
    pub fn add(&mut self, entry: T, mut dropped: impl FnMut(T, &mut T)) {
        let size = entry.size();
        let has_room = self.first_size + size <= self.limits.end || self.first.is_empty();
        if self.last.is_empty() && has_room {
            self.first_size += size;
            self.first.push(entry);
            return;
        }
        self.last_size += size;
        self.last.push_back(entry);
        while self.last_size > self.limits.end && self.last.len() > 1 {
            let Some(old) = self.last.pop_front() else { return };
            self.last_size -= old.size();
            if old.is_important() && self.important.len() < self.limits.important {
                self.important.push(old);
                continue;
            }
            self.omitted += 1;
            if let Some(next) = self.last.front_mut() {
                dropped(old, next);
            }
        }
    }

    /// The entries in their order, and the number of those that are omitted.
    pub fn into_entries(self) -> (Vec<T>, u64) {
        let entries = self.first.into_iter().chain(self.important).chain(self.last);
        (entries.collect(), self.omitted)
    }
}
