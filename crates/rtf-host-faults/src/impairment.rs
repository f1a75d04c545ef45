//! What happens to single packets: delay, loss, duplication, reordering, bandwidth.

use std::time::{Duration, Instant};

use rtf_model::NetworkFault;
use rtf_statistics::RandomStream;

use crate::refusal;

const TCP: u8 = 6;
const UDP: u8 = 17;
/// Packets that wait for bandwidth; more are lost, as in a switch.
const QUEUE_PACKETS: u64 = 1000;
/// The size of packets.
const PACKET_BITS: u64 = 1500 * 8;

/// A fault of the network.
#[derive(Debug)]
pub(crate) struct Impairment {
    fault: NetworkFault,
    /// Only packets from or to this port.
    port: Option<u16>,
    random: RandomStream,
    draws: u64,
    /// When the bandwidth is free again.
    free_at: Instant,
}

impl Impairment {
    pub fn new(fault: NetworkFault, port: Option<u16>, random: RandomStream) -> Self {
        Self { fault, port, random, draws: 0, free_at: Instant::now() }
    }

    /// The answers to a packet that is refused, and does not arrive; `None` if it may pass.
    pub fn answers(&self, packet: &[u8]) -> Option<Vec<Vec<u8>>> {
        (self.fault.refuses && self.concerns(packet))
            .then(|| refusal::answers(packet, self.port))
            .flatten()
    }

    fn concerns(&self, packet: &[u8]) -> bool {
        self.port.is_none_or(|port| has_port(packet, port))
    }

    /// When the copies of a packet arrive that is sent at `sent`; none if it is lost.
    pub fn arrivals(&mut self, packet: &[u8], sent: Instant) -> Vec<Instant> {
        if !self.concerns(packet) {
            return vec![sent];
        }
        if self.happens(self.fault.loss_ppm) {
            return Vec::new();
        }
        let Some(through) = self.through(packet, sent) else { return Vec::new() };
        let copies = 1 + usize::from(self.happens(self.fault.duplicate_ppm));
        (0..copies).map(|_| through + self.delay()).collect()
    }

    /// When a packet has passed the bandwidth.
    fn through(&mut self, packet: &[u8], sent: Instant) -> Option<Instant> {
        let Some(rate) = self.fault.rate_bits.filter(|rate| *rate > 0) else { return Some(sent) };
        let time = |bits: u64| Duration::from_secs_f64(bits as f64 / rate as f64);
        let begin = self.free_at.max(sent);
        if begin - sent > time(QUEUE_PACKETS * PACKET_BITS) {
            return None;
        }
        self.free_at = begin + time(packet.len() as u64 * 8);
        Some(self.free_at)
    }

    /// A packet that overtakes others has no delay.
    fn delay(&mut self) -> Duration {
        if self.happens(self.fault.reorder_ppm) {
            return Duration::ZERO;
        }
        let jitter = 2.0 * self.unit() - 1.0;
        let [delay, most] = [self.fault.delay_us, self.fault.jitter_us].map(|us| us as f64 / 1e6);
        Duration::from_secs_f64((delay + jitter * most).max(0.0))
    }

    fn happens(&mut self, ppm: u32) -> bool {
        ppm > 0 && self.unit() * 1e6 < f64::from(ppm)
    }

    fn unit(&mut self) -> f64 {
        self.draws += 1;
        self.random.unit(self.draws)
    }
}

/// Whether a packet of IPv4 is from or to a port of TCP or UDP.
fn has_port(packet: &[u8], port: u16) -> bool {
    let Some(first) = packet.first().filter(|first| **first >> 4 == 4) else { return false };
    let (header, protocol) = (usize::from(first & 15) * 4, packet.get(9));
    let is_first_fragment = packet.get(6..8).is_some_and(|it| it[0] & 0x1f == 0 && it[1] == 0);
    let ports = packet.get(header..header + 4);
    is_first_fragment
        && protocol.is_some_and(|it| [TCP, UDP].contains(it))
        && ports.is_some_and(|it| it.chunks(2).any(|it| it == port.to_be_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn impairment(fault: NetworkFault, port: Option<u16>) -> Impairment {
        Impairment::new(fault, port, RandomStream::new(1, "fault", "test"))
    }

    /// A packet of UDP, from port 4660 to port 80.
    fn packet(length: usize) -> Vec<u8> {
        let mut packet = vec![0; length];
        (packet[0], packet[9]) = (0x45, UDP);
        packet[20..24].copy_from_slice(&[0x12, 0x34, 0, 80]);
        packet
    }

    fn arrived(impairment: &mut Impairment, count: usize) -> Vec<Vec<Duration>> {
        let sent = Instant::now();
        let packets = (0..count).map(|_| impairment.arrivals(&packet(1500), sent));
        packets.map(|all| all.into_iter().map(|it| it - sent).collect()).collect()
    }

    #[test]
    fn packets_are_lost_doubled_and_overtake() {
        let fault = NetworkFault {
            delay_us: 50_000,
            jitter_us: 10_000,
            loss_ppm: 100_000,
            duplicate_ppm: 200_000,
            reorder_ppm: 50_000,
            ..NetworkFault::default()
        };
        let all = arrived(&mut impairment(fault, None), 10_000);
        let count = |wanted: usize| all.iter().filter(|it| it.len() == wanted).count();
        assert!((850..1150).contains(&count(0)), "{}", count(0));
        assert!((1650..1950).contains(&count(2)), "{}", count(2));
        let delays: Vec<Duration> = all.concat();
        let early = delays.iter().filter(|it| it.is_zero()).count();
        assert!((450..630).contains(&early), "{early}");
        let range = Duration::from_millis(40)..Duration::from_millis(60);
        assert!(delays.iter().all(|it| it.is_zero() || range.contains(it)));
    }

    #[test]
    fn the_bandwidth_limits_the_rate_and_the_queue() {
        let fault = NetworkFault { rate_bits: Some(12_000_000), ..NetworkFault::default() };
        let all = arrived(&mut impairment(fault, None), 1500);
        // One packet each millisecond.
        assert_eq!(all[99], [Duration::from_millis(100)]);
        let lost = all.iter().filter(|it| it.is_empty()).count();
        assert!((490..=500).contains(&lost), "{lost}");
    }

    #[test]
    fn other_ports_are_not_affected() {
        let fault = NetworkFault { loss_ppm: 1_000_000, ..NetworkFault::default() };
        for (port, is_lost) in [(80, true), (0x1234, true), (81, false)] {
            let all = arrived(&mut impairment(fault, Some(port)), 1);
            assert_eq!(all[0].is_empty(), is_lost, "{port}");
        }
        for broken in [&[][..], &[0x45; 3], &packet(100)[..22]] {
            assert!(!has_port(broken, 80));
        }
        let mut fragment = packet(100);
        fragment[7] = 1;
        assert!(!has_port(&fragment, 80));
    }
}
