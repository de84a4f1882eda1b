use super::*;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::thread;
use std::time::Instant;

use units::{Host, Span, Stamp};

use crate::clock;
use crate::log::OwnedRecord;

fn local(receive_buffer: usize) -> ListenConfig {
    ListenConfig {
        address: Ipv4Addr::LOCALHOST,
        data_port: 0,
        position_port: Some(0),
        receive_buffer,
        ..ListenConfig::default()
    }
}

fn payload_of(record: &OwnedRecord) -> (u16, Vec<u8>) {
    match record.as_record().wire {
        Wire::Lidar {
            source,
            port,
            payload,
        } => {
            assert_eq!(source, [127, 0, 0, 1]);
            (port, payload.to_vec())
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn both_ports_deliver_with_kernel_times() {
    let mut listener = LidarListener::bind(&local(1 << 20)).unwrap();
    let data = listener.sockets()[0].address;
    let position = listener.sockets()[1].address;
    assert_ne!(data.port(), position.port());
    assert!(listener.sockets()[0].receive_buffer > 0);
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, inbox) = channel();
    let listening = {
        let stop = Arc::clone(&stop);
        thread::spawn(move || {
            let counts = listener.run(&stop, |record| {
                sender
                    .send((OwnedRecord::from(record), clock::now()))
                    .unwrap();
            });
            (listener, counts)
        })
    };
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let mut last: Option<Stamp<Host>> = None;
    for n in 0..200_u8 {
        let (to, length) = if n % 10 == 0 {
            (position, 512)
        } else {
            (data, 1206)
        };
        let before = clock::now();
        sender.send_to(&vec![n; length], to).unwrap();
        let (record, after) = inbox.recv_timeout(Duration::from_secs(5)).unwrap();
        assert_eq!(payload_of(&record), (to.port(), vec![n; length]));
        // On loopback the packet is stamped within the send.
        assert!(
            before <= record.host() && record.host() <= after,
            "packet {n}"
        );
        assert!(last <= Some(record.host()), "times do not decrease");
        last = Some(record.host());
    }
    let stopping = Instant::now();
    stop.store(true, Ordering::Release);
    let (listener, counts) = listening.join().unwrap();
    assert!(stopping.elapsed() < Duration::from_secs(1));
    assert_eq!(
        counts.unwrap(),
        ListenCounts {
            data: 180,
            position: 20,
            ..ListenCounts::default()
        }
    );
    assert_eq!(listener.counts().data, 180);
}

#[test]
fn kernel_times_do_not_depend_on_the_read() {
    let mut listener = LidarListener::bind(&local(1 << 20)).unwrap();
    let to = listener.sockets()[0].address;
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    sender.send_to(b"early", to).unwrap();
    let sent = clock::now();
    thread::sleep(Duration::from_millis(100));
    let mut times = Vec::new();
    // With the flag set, datagrams that arrived are still delivered.
    let counts = listener
        .run(&AtomicBool::new(true), |record| times.push(record.host))
        .unwrap();
    assert_eq!((counts.data, times.len()), (1, 1));
    assert!(
        times[0] <= sent + Span::from_millis(50),
        "{times:?}, sent {sent:?}"
    );
}

#[test]
fn drops_of_the_kernel_are_counted_exactly() {
    let mut listener = LidarListener::bind(&local(4096)).unwrap();
    let to = listener.sockets()[0].address;
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let stop = AtomicBool::new(true);
    // More than the buffer holds, without a reader.
    for n in 0..500_u16 {
        sender.send_to(&[n as u8; 1206], to).unwrap();
    }
    let first = listener.run(&stop, |_| {}).unwrap();
    assert!(first.data < 500, "the buffer is too small");
    // The count arrives with the next delivered packet.
    sender.send_to(b"after", to).unwrap();
    let counts = listener.run(&stop, |_| {}).unwrap();
    assert_eq!(counts.data, first.data + 1);
    assert_eq!(counts.dropped, 501 - counts.data);
}

#[test]
fn bind_errors_name_the_reason() {
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let config = ListenConfig {
        data_port: port,
        ..local(65_536)
    };
    let busy = LidarListener::bind(&config).unwrap_err();
    assert!(
        matches!(busy, UdpError::Busy { address, .. } if address.port() == port),
        "{busy}"
    );
    let config = ListenConfig {
        address: Ipv4Addr::new(203, 0, 113, 7), // TEST-NET-3 (RFC 5737)
        ..local(65_536)
    };
    let elsewhere = LidarListener::bind(&config).unwrap_err();
    assert!(
        matches!(elsewhere, UdpError::NoInterface { .. }),
        "{elsewhere}"
    );
}

#[test]
fn a_common_port_uses_one_socket() {
    let free = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    let config = ListenConfig {
        data_port: port,
        position_port: Some(port),
        ..local(65_536)
    };
    assert_eq!(LidarListener::bind(&config).unwrap().sockets().len(), 1);
}

/// A data packet with valid block flags.
fn data_packet() -> Vec<u8> {
    let mut data = vec![1; 1206];
    for block in data.chunks_exact_mut(100) {
        block[..2].copy_from_slice(&[0xFF, 0xEE]);
    }
    data
}

/// Received datagrams by source, port and length.
fn received(listener: &mut LidarListener) -> Vec<([u8; 4], u16, usize)> {
    let mut received = Vec::new();
    listener
        .run(&AtomicBool::new(true), |record| match record.wire {
            Wire::Lidar {
                source,
                port,
                payload,
            } => received.push((source, port, payload.len())),
            Wire::Drive { .. } => panic!("{record:?}"),
        })
        .unwrap();
    received
}

#[test]
fn datagrams_of_several_ports_are_delivered_in_order_of_time() {
    let mut listener = LidarListener::bind(&local(4 << 20)).unwrap();
    let [data, position] = [0, 1].map(|n: usize| listener.sockets()[n].address);
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    // Several batches, most of them of one port; the longest datagram and an empty one are among
    // them.
    let mut sent = Vec::new();
    for n in 0..600_usize {
        let to = if n % 10 == 0 { position } else { data };
        let length = match n {
            301 => 65_507,
            302 => 0,
            _ => 1000 + n,
        };
        sender.send_to(&vec![n as u8; length], to).unwrap();
        sent.push((to.port(), length));
    }
    let mut times = Vec::new();
    let mut got = Vec::new();
    let counts = listener
        .run(&AtomicBool::new(true), |record| {
            times.push(record.host);
            let Wire::Lidar { port, payload, .. } = record.wire else {
                panic!("{record:?}");
            };
            assert!(payload.iter().all(|&byte| byte == got.len() as u8));
            got.push((port, payload.len()));
        })
        .unwrap();
    assert_eq!(got, sent);
    assert!(times.is_sorted());
    assert_eq!((counts.data, counts.position), (540, 60));
}

#[test]
fn drops_are_counted_after_batches_without_drops() {
    let mut listener = LidarListener::bind(&local(65_536)).unwrap();
    let to = listener.sockets()[0].address;
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let mut sent = 0;
    // The third and fifth bursts exceed the buffer.
    for burst in [1, 8, 500, 3, 500, 1] {
        for _ in 0..burst {
            sender.send_to(&[7; 1206], to).unwrap();
        }
        sent += burst;
        listener.run(&AtomicBool::new(true), |_| {}).unwrap();
    }
    let counts = listener.counts();
    assert!(counts.dropped > 0, "{counts:?}");
    assert_eq!(counts.data + counts.dropped, sent);
}

#[test]
fn sensors_are_distinguished_by_source_and_port() {
    let mut listener = LidarListener::bind(&local(1 << 20)).unwrap();
    let [data, position] = [0, 1].map(|n: usize| listener.sockets()[n].address);
    let sensors = ["127.0.0.2:0", "127.0.0.3:0"].map(|at| UdpSocket::bind(at).unwrap());
    sensors[0].send_to(&data_packet(), data).unwrap();
    sensors[1].send_to(&data_packet(), data).unwrap();
    sensors[1].send_to(&data_packet(), data).unwrap();
    sensors[1].send_to(&data_packet(), position).unwrap();
    sensors[0].send_to(&[0; 512], position).unwrap();
    sensors[0].send_to(b"hello", data).unwrap();
    let mut senders: Vec<_> = received(&mut listener)
        .iter()
        .map(|(source, port, _)| (source[3], *port))
        .collect();
    senders.sort_unstable();
    let mut expected = [
        (2, data.port()),
        (2, data.port()),
        (2, position.port()),
        (3, data.port()),
        (3, data.port()),
        (3, position.port()),
    ];
    expected.sort_unstable();
    assert_eq!(senders, expected);
    let counts = listener.counts();
    assert_eq!((counts.data, counts.position), (4, 2));
}

#[test]
fn only_wanted_sources_are_delivered() {
    let config = ListenConfig {
        sources: vec![Ipv4Addr::new(127, 0, 0, 3)],
        ..local(1 << 20)
    };
    let mut listener = LidarListener::bind(&config).unwrap();
    let data = listener.sockets()[0].address;
    for from in ["127.0.0.2:0", "127.0.0.3:0", "127.0.0.4:0"] {
        let sensor = UdpSocket::bind(from).unwrap();
        sensor.send_to(&data_packet(), data).unwrap();
    }
    assert_eq!(
        received(&mut listener),
        [([127, 0, 0, 3], data.port(), 1206)]
    );
    let counts = listener.counts();
    assert_eq!((counts.data, counts.unwanted), (1, 2));
}

#[test]
fn multicast_groups_are_joined_on_the_given_interface() {
    let group = Ipv4Addr::new(239, 255, 76, 68);
    let config = ListenConfig {
        group: Some(group),
        ..local(1 << 20)
    };
    let mut listener = LidarListener::bind(&config).unwrap();
    let port = listener.sockets()[0].address.port();
    let sender = socket2::Socket::new(socket2::Domain::IPV4, socket2::Type::DGRAM, None).unwrap();
    sender.set_multicast_if_v4(&Ipv4Addr::LOCALHOST).unwrap();
    let sender = UdpSocket::from(sender);
    sender.send_to(&data_packet(), (group, port)).unwrap();
    let other = Ipv4Addr::new(239, 255, 76, 69);
    sender.send_to(&[1; 7], (other, port)).unwrap();
    sender
        .send_to(&[0; 512], (Ipv4Addr::LOCALHOST, port))
        .unwrap();
    let received = received(&mut listener);
    let lengths: Vec<usize> = received.iter().map(|r| r.2).collect();
    assert_eq!(
        lengths,
        [1206, 512],
        "the group and unicast, without the other group"
    );

    let nonsense = ListenConfig {
        group: Some(Ipv4Addr::new(192, 168, 1, 1)),
        ..local(1 << 20)
    };
    let error = LidarListener::bind(&nonsense).unwrap_err();
    assert!(
        matches!(error, UdpError::Io { action: "join", .. }),
        "{error}"
    );
}

#[test]
fn the_gathering_time_follows_the_rate() {
    let mut listener = LidarListener::bind(&local(1 << 20)).unwrap();
    let longest = Duration::from_millis(50);
    listener.gather(longest);
    (0..10).for_each(|_| listener.adapt(3));
    assert_eq!(listener.gather, longest);
    listener.adapt(GATHERED);
    assert_eq!(listener.gather, longest);
    listener.adapt(GATHERED + 1);
    assert_eq!(listener.gather, longest / 2);
    (0..10).for_each(|_| listener.adapt(1_000));
    assert_eq!(listener.gather, GATHER);
    (0..10).for_each(|_| listener.adapt(3));
    // Back to the default.
    listener.gather(GATHER);
    listener.adapt(3);
    assert_eq!(listener.gather, GATHER);
}

#[test]
fn a_stop_interrupts_the_gathering() {
    let mut listener = LidarListener::bind(&local(1 << 20)).unwrap();
    listener.gather(Duration::from_secs(600));
    (0..20).for_each(|_| listener.adapt(0));
    assert_eq!(listener.gather, Duration::from_secs(600));
    let to = listener.sockets()[0].address;
    let stop = Arc::new(AtomicBool::new(false));
    let stopping = Arc::clone(&stop);
    let listening = thread::spawn(move || listener.run(&stopping, |_| {}));
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    sender.send_to(&[1; 1206], to).unwrap();
    stop.store(true, Ordering::Release);
    listening.thread().unpark();
    assert_eq!(listening.join().unwrap().unwrap().data, 1);
}
