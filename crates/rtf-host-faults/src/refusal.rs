//! Refused packets: the network answers as if no process had the port.

use etherparse::icmpv4::DestUnreachableHeader;
use etherparse::{Icmpv4Type, IpNumber, Ipv4HeaderSlice, PacketBuilder, TcpHeaderSlice};

/// How many routers an answer may pass, as usual for Linux.
const TTL: u8 = 64;
/// What an ICMP message repeats of the data of a packet: the ports are in it.
const REPEATED_BYTES: usize = 8;

/// The answers to a packet of IPv4 that is refused, and not passed on; `port` is the refused one,
/// if not all are. `None` if it is neither TCP nor UDP: it is not refused.
pub(crate) fn answers(packet: &[u8], port: Option<u16>) -> Option<Vec<Vec<u8>>> {
    let ip = Ipv4HeaderSlice::from_slice(packet).ok()?;
    let data = packet.get(ip.slice().len()..)?;
    match ip.protocol() {
        IpNumber::TCP => Some(reset(&ip, data)),
        IpNumber::UDP => Some(unreachable(&ip, data, port).into_iter().collect()),
        _ => None,
    }
}

/// Resets a connection at both ends. That of the sender would not be enough: the receiver may
/// never send.
fn reset(ip: &Ipv4HeaderSlice<'_>, data: &[u8]) -> Vec<Vec<u8>> {
    let Ok(tcp) = TcpHeaderSlice::from_slice(data) else { return Vec::new() };
    if tcp.rst() {
        return Vec::new();
    }
    let to_sender = PacketBuilder::ipv4(ip.destination(), ip.source(), TTL);
    let (own, other) = (tcp.destination_port(), tcp.source_port());
    if !tcp.ack() {
        // It opens a connection: only its number identifies it. RFC 9293, 3.10.7.1.
        let carried = data.len() - tcp.slice().len();
        let carried = u32::try_from(carried).unwrap_or(0) + u32::from(tcp.syn());
        let number = tcp.sequence_number().wrapping_add(carried + u32::from(tcp.fin()));
        return written(to_sender.tcp(own, other, 0, 0).rst().ack(number)).into_iter().collect();
    }
    let to_sender = to_sender.tcp(own, other, tcp.acknowledgment_number(), 0).rst();
    let to_receiver = PacketBuilder::ipv4(ip.source(), ip.destination(), TTL)
        .tcp(other, own, tcp.sequence_number(), 0)
        .rst()
        .ack(tcp.acknowledgment_number());
    [written(to_sender), written(to_receiver)].into_iter().flatten().collect()
}

fn written(builder: etherparse::PacketBuilderStep<etherparse::TcpHeader>) -> Option<Vec<u8>> {
    let mut packet = Vec::new();
    builder.write(&mut packet, &[]).ok().map(|()| packet)
}

/// The port of a datagram has no process; `None` for a datagram from a refused port.
fn unreachable(ip: &Ipv4HeaderSlice<'_>, data: &[u8], port: Option<u16>) -> Option<Vec<u8>> {
    let to = data.get(2..4)?;
    if port.is_some_and(|port| to != port.to_be_bytes()) {
        return None;
    }
    let kind = Icmpv4Type::DestinationUnreachable(DestUnreachableHeader::Port);
    let builder = PacketBuilder::ipv4(ip.destination(), ip.source(), TTL).icmpv4(kind);
    let repeated = [ip.slice(), data.get(..REPEATED_BYTES)?].concat();
    let mut packet = Vec::new();
    builder.write(&mut packet, &repeated).ok().map(|()| packet)
}

#[cfg(test)]
mod tests {
    use etherparse::{SlicedPacket, TransportSlice};

    use super::*;

    const CLIENT: [u8; 4] = [127, 0, 0, 1];
    const SERVER: [u8; 4] = [127, 0, 0, 2];

    fn tcp(
        change: impl Fn(etherparse::TcpHeader) -> etherparse::TcpHeader,
        data: &[u8],
    ) -> Vec<u8> {
        let header = change(etherparse::TcpHeader::new(4660, 80, 1000, 500));
        let mut packet = Vec::new();
        let builder = PacketBuilder::ipv4(CLIENT, SERVER, TTL).tcp_header(header);
        builder.write(&mut packet, data).expect("a packet");
        packet
    }

    /// Destination, ports, number, acknowledged number.
    type Reset = ([u8; 4], (u16, u16), u32, Option<u32>);

    fn resets(packet: &[u8]) -> Vec<Reset> {
        let answers = answers(packet, Some(80)).expect("answers");
        let fields = answers.iter().map(|answer| {
            let sliced = SlicedPacket::from_ip(answer).expect("a packet");
            let Some(TransportSlice::Tcp(tcp)) = sliced.transport else { panic!("no TCP") };
            assert!(tcp.rst() && !tcp.syn());
            let ip = Ipv4HeaderSlice::from_slice(answer).expect("a header");
            assert_eq!(ip.header_checksum(), ip.to_header().calc_header_checksum());
            let sum = tcp.calc_checksum_ipv4(ip.source(), ip.destination()).expect("a checksum");
            assert_eq!(tcp.checksum(), sum);
            let ports = (tcp.source_port(), tcp.destination_port());
            let acknowledged = tcp.ack().then(|| tcp.acknowledgment_number());
            (ip.destination(), ports, tcp.sequence_number(), acknowledged)
        });
        fields.collect()
    }

    #[test]
    fn a_new_connection_is_refused() {
        let syn = tcp(|header| etherparse::TcpHeader { syn: true, ..header }, &[]);
        assert_eq!(resets(&syn), [(CLIENT, (80, 4660), 0, Some(1001))]);
    }

    #[test]
    fn both_ends_of_a_connection_are_reset() {
        let with_ack =
            |header| etherparse::TcpHeader { ack: true, acknowledgment_number: 7000, ..header };
        let expected = [(CLIENT, (80, 4660), 7000, None), (SERVER, (4660, 80), 1000, Some(7000))];
        assert_eq!(resets(&tcp(with_ack, b"data")), expected);
        let reset = tcp(|header| etherparse::TcpHeader { rst: true, ..with_ack(header) }, &[]);
        assert_eq!(resets(&reset), []);
    }

    #[test]
    fn a_datagram_to_the_port_is_answered_and_one_from_it_is_lost() {
        let mut datagram = Vec::new();
        let builder = PacketBuilder::ipv4(CLIENT, SERVER, TTL).udp(4660, 80);
        builder.write(&mut datagram, b"0123456789").expect("a packet");
        let [answer] = &answers(&datagram, Some(80)).expect("answers")[..] else { panic!() };
        let sliced = SlicedPacket::from_ip(answer).expect("a packet");
        let Some(TransportSlice::Icmpv4(message)) = sliced.transport else { panic!("no ICMP") };
        let port = Icmpv4Type::DestinationUnreachable(DestUnreachableHeader::Port);
        assert_eq!(message.icmp_type(), port);
        assert_eq!(message.payload(), &datagram[..28]);
        assert_eq!(answers(&datagram, Some(4660)), Some(Vec::new()));
        assert_eq!(answers(&datagram, None).map(|answers| answers.len()), Some(1));
    }

    #[test]
    fn other_and_damaged_packets_are_not_answered() {
        let mut ping = Vec::new();
        let builder = PacketBuilder::ipv4(CLIENT, SERVER, TTL).icmpv4_echo_request(1, 1);
        builder.write(&mut ping, &[]).expect("a packet");
        assert_eq!(answers(&ping, None), None);
        assert_eq!(answers(&[], None), None);
        let syn = tcp(|header| etherparse::TcpHeader { syn: true, ..header }, &[]);
        for length in 0..syn.len() {
            assert!(answers(&syn[..length], None).is_none_or(|answers| answers.is_empty()));
        }
    }
}
