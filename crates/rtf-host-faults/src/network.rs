//! The faults of the private network: a thread passes its packets on, later or not at all.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{PipeReader, PipeWriter, Read, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::impairment::Impairment;
use crate::loopback;

/// More than a packet.
const BUFFER_BYTES: usize = 64 * 1024;
/// How long the thread waits without a packet.
const IDLE: Duration = Duration::from_secs(3600);

/// The network of this process has one loopback interface.
static NETWORK: Mutex<Option<Diversion>> = Mutex::new(None);

/// The diverted packets, while there are faults.
struct Diversion {
    impairments: Arc<Mutex<Vec<(u64, Impairment)>>>,
    last: u64,
    /// Closed to end the thread.
    stop: PipeWriter,
    thread: JoinHandle<()>,
}

/// A fault of the network, which ends with this value.
#[derive(Debug)]
pub(crate) struct Impaired(u64);

/// Begins a fault.
///
/// # Errors
/// Why that is not possible.
pub(crate) fn impair(impairment: Impairment) -> Result<Impaired, String> {
    let mut network = lock(&NETWORK);
    let diversion = match &mut *network {
        Some(diversion) => diversion,
        none => none.insert(Diversion::begin()?),
    };
    diversion.last += 1;
    lock(&diversion.impairments).push((diversion.last, impairment));
    Ok(Impaired(diversion.last))
}

impl Drop for Impaired {
    fn drop(&mut self) {
        let mut network = lock(&NETWORK);
        let Some(diversion) = &*network else { return };
        let mut impairments = lock(&diversion.impairments);
        impairments.retain(|(number, _)| *number != self.0);
        let is_last = impairments.is_empty();
        drop(impairments);
        if is_last && let Some(diversion) = network.take() {
            loopback::restore();
            drop(diversion.stop);
            let _ = diversion.thread.join();
        }
    }
}

impl Diversion {
    fn begin() -> Result<Self, String> {
        let failed = |error: std::io::Error| error.to_string();
        let (wake, stop) = std::io::pipe().map_err(failed)?;
        let tun = loopback::divert()?;
        let impairments = Arc::new(Mutex::new(Vec::new()));
        let shared = Arc::clone(&impairments);
        let thread = std::thread::Builder::new().spawn(move || pass_on(&tun, &wake, &shared));
        let thread = thread.map_err(|error| {
            loopback::restore();
            failed(error)
        })?;
        Ok(Self { impairments, last: 0, stop, thread })
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The packets that are on their way.
#[derive(Default)]
struct Queue {
    packets: BinaryHeap<Reverse<(Instant, u64, Vec<u8>)>>,
    count: u64,
}

impl Queue {
    fn push(&mut self, at: Instant, packet: Vec<u8>) {
        self.count += 1;
        self.packets.push(Reverse((at, self.count, packet)));
    }

    /// Passes on the packets that are due.
    fn send_until(&mut self, now: Option<Instant>, mut tun: &File) {
        while let Some(Reverse((at, ..))) = self.packets.peek() {
            if now.is_some_and(|now| *at > now) {
                break;
            }
            if let Some(Reverse((_, _, packet))) = self.packets.pop() {
                // The kernel loses packets, too.
                let _ = tun.write(&packet);
            }
        }
    }

    fn next(&self) -> Option<Instant> {
        self.packets.peek().map(|Reverse((at, ..))| *at)
    }
}

fn pass_on(tun: &File, wake: &PipeReader, impairments: &Mutex<Vec<(u64, Impairment)>>) {
    let mut queue = Queue::default();
    let mut bytes = vec![0; BUFFER_BYTES];
    loop {
        let now = Instant::now();
        queue.send_until(Some(now), tun);
        let wait = queue.next().map_or(IDLE, |at| at.saturating_duration_since(now));
        let mut polled = [PollFd::new(tun, PollFlags::IN), PollFd::new(wake, PollFlags::IN)];
        if poll(&mut polled, Timespec::try_from(wait).ok().as_ref()).is_err() {
            // Interrupted by a signal.
            continue;
        }
        let has_ended = !polled[1].revents().is_empty();
        let mut reader = tun;
        while let Ok(length @ 1..) = reader.read(&mut bytes) {
            let packet = &bytes[..length];
            let impairments = &mut lock(impairments);
            if let Some(answers) = impairments.iter().find_map(|(_, it)| it.answers(packet)) {
                answers.into_iter().for_each(|answer| queue.push(Instant::now(), answer));
                continue;
            }
            for at in arrivals(packet, impairments) {
                queue.push(at, packet.to_vec());
            }
        }
        if has_ended {
            return queue.send_until(None, tun);
        }
    }
}

/// A packet passes all faults, one after the other.
fn arrivals(packet: &[u8], impairments: &mut [(u64, Impairment)]) -> Vec<Instant> {
    let mut arrivals = vec![Instant::now()];
    for (_, impairment) in impairments {
        arrivals = arrivals.iter().flat_map(|at| impairment.arrivals(packet, *at)).collect();
    }
    arrivals
}
