//! Both devices together: the output depends on the input and its times, and the encoder agrees
//! with the truth.

use firmware_sim::epos2::Servo;
use proptest::prelude::*;
use units::Span;

use super::*;

const START: Stamp<Host> = Stamp::from_nanos(1_790_000_000_000_000_000);

fn after(ns: i64) -> Stamp<Host> {
    START + Span::from_nanos(ns)
}

/// A USB frame made by hand: CRC-16/XMODEM over words, high byte first, length before operation;
/// each 0x90 doubled.
fn frame(opcode: u8, words: &[u16]) -> Vec<u8> {
    let header = u16::from_be_bytes([words.len() as u8, opcode]);
    let crc = std::iter::once(&header)
        .chain(words)
        .flat_map(|word| word.to_be_bytes())
        .fold(0_u16, |crc, byte| {
            (0..8).fold(crc ^ u16::from(byte) << 8, |crc, _| {
                if crc & 0x8000 == 0 {
                    crc << 1
                } else {
                    crc << 1 ^ 0x1021
                }
            })
        });
    let mut plain = vec![opcode, words.len() as u8];
    plain.extend(
        words
            .iter()
            .chain([&crc])
            .flat_map(|word| word.to_le_bytes()),
    );
    let stuffed = plain.iter().flat_map(|&byte| {
        let twice = usize::from(byte == 0x90);
        std::iter::repeat_n(byte, 1 + twice)
    });
    [0x90, 0x02].into_iter().chain(stuffed).collect()
}

fn read(index: u16, sub: u16) -> Vec<u8> {
    frame(0x10, &[index, 0x0100 | sub])
}

fn write(index: u16, sub: u16, value: u32) -> Vec<u8> {
    frame(
        0x11,
        &[index, 0x0100 | sub, value as u16, (value >> 16) as u16],
    )
}

/// Error code and first data word pair of an answer.
fn answer(bytes: &[u8]) -> (u32, i32) {
    assert_eq!(bytes[..3], [0x90, 0x02, 0x00]);
    let mut plain = Vec::new();
    let mut rest = bytes[4..].iter().copied();
    while let Some(byte) = rest.next() {
        if byte == 0x90 {
            assert_eq!(rest.next(), Some(0x90));
        }
        plain.push(byte);
    }
    let long = |at: usize| {
        plain
            .get(at..at + 4)
            .map_or([0; 4], |b| b.try_into().unwrap())
    };
    (u32::from_le_bytes(long(0)), i32::from_le_bytes(long(4)))
}

fn exchange(rig: &mut Rig, request: &[u8]) -> i32 {
    rig.drive_input(request);
    let (error, value) = answer(&rig.drive_output().unwrap().bytes);
    assert_eq!((error, rig.drive_output()), (0, None));
    value
}

/// Requests that move the axis by `by_qc` in profile position mode, one per millisecond.
fn motion(by_qc: i32) -> Vec<Vec<u8>> {
    vec![
        write(0x6040, 0, 0x80),
        write(0x6060, 0, 1),
        write(0x6081, 0, 1_125),
        write(0x6083, 0, 20_000),
        write(0x6084, 0, 20_000),
        write(0x607A, 0, by_qc as u32),
        write(0x6040, 0, 0x06),
        write(0x6040, 0, 0x0F),
        // Enabling takes a while.
        read(0x6041, 0),
        read(0x6041, 0),
        read(0x6041, 0),
        read(0x6041, 0),
        write(0x6040, 0, 0x5F),
    ]
}

#[test]
fn hand_made_frames_equal_the_golden_ones() {
    assert_eq!(
        read(0x6041, 0),
        [0x90, 0x02, 0x10, 0x02, 0x41, 0x60, 0x00, 0x01, 0x64, 0xCF]
    );
    assert_eq!(
        write(0x6040, 0, 0xF),
        [
            0x90, 0x02, 0x11, 0x04, 0x40, 0x60, 0, 1, 0x0F, 0, 0, 0, 0x2D, 0x2C
        ]
    );
}

#[test]
fn the_encoder_reports_the_true_platform_angle_within_a_cycle() {
    let mut rig = Rig::new(RigConfig::new(START));
    for (ms, request) in motion(9_000).iter().enumerate() {
        rig.advance(after(1_000_000 * (10 + ms as i64)));
        exchange(&mut rig, request);
    }
    let mut read_at = Vec::new();
    for i in 0..1_500 {
        rig.advance(after(20_000_000 + 237_000 * i));
        read_at.push((rig.now(), exchange(&mut rig, &read(0x6064, 0))));
    }
    let truth = rig.truth();
    let mut moved_within_a_cycle = 0;
    for &(at, position) in &read_at {
        // 0.0015 deg per quadcount; the drive's zero is its position at power-on, -3000 qc from
        // level.
        let exact = truth.tilt_deg_at(at).unwrap() / 0.0015 + 3_000.0;
        let ahead = exact - f64::from(position);
        assert!(
            (-1e-6..1.0 + 1e-6).contains(&ahead),
            "{at:?}: {position} of {exact}"
        );
        let ms = Span::from_nanos((at - START).as_nanos() % 1_000_000);
        let began = truth.tilt_deg_at(at - ms).unwrap() / 0.0015 + 3_000.0;
        moved_within_a_cycle += usize::from(exact - began > 2.0);
    }
    assert!(read_at.is_sorted_by_key(|&(_, position)| position));
    assert_eq!((read_at[0].1, read_at[1_499].1), (0, 9_000));
    assert!(moved_within_a_cycle > 500, "{moved_within_a_cycle}");
}

#[test]
fn datagrams_are_sent_after_their_last_firing_sequence() {
    let mut rig = Rig::new(RigConfig::new(START));
    let mut data = 0;
    while data < 40 {
        let next = rig.next_event();
        rig.advance(next - Span::from_nanos(1));
        assert_eq!(rig.poll_datagram(), None);
        rig.advance(next);
        assert_eq!(rig.next_event(), next);
        let datagram = rig.poll_datagram().unwrap();
        assert_eq!((datagram.at, datagram.port), (next, 2368));
        data += 1;
        let stamp = datagram.payload[1200..1204]
            .try_into()
            .map(u32::from_le_bytes);
        let ended = i64::from(stamp.unwrap()) * 1_000 + 1_327_104;
        let late = next - rig.truth().lidar_to_host(ended);
        assert!((0..1_000).contains(&late.as_nanos()), "{late:?}");
        if data % 5 == 0 {
            let position = rig.poll_datagram().unwrap();
            assert_eq!((position.at, position.port), (next, 8308));
            assert_eq!(position.payload.len(), 512);
        }
    }
}

#[test]
fn a_packet_that_ends_with_a_control_cycle_is_sent() {
    // 3 x 1327.104 us on a clock so slow that they take 4 ms.
    let lidar = RigLidar {
        drift_ppm: -4_672.0,
        ..RigLidar::default()
    };
    let mut rig = Rig::new(RigConfig {
        lidar,
        ..RigConfig::new(START)
    });
    rig.advance(after(100_000_000));
    let left: Vec<_> = std::iter::from_fn(|| rig.poll_datagram())
        .filter(|datagram| datagram.port == DATA_PORT)
        .map(|datagram| (datagram.at - START).as_nanos())
        .collect();
    assert_eq!(
        (left.len(), left[2], left[74]),
        (75, 4_000_000, 100_000_000)
    );
}

#[test]
fn time_does_not_go_back() {
    let mut rig = Rig::new(RigConfig::new(START));
    rig.advance(after(5_000_000));
    let (next, end) = (rig.next_event(), rig.truth().end());
    for to in [Stamp::from_nanos(i64::MIN), START, rig.now()] {
        rig.advance(to);
        assert_eq!(
            (rig.now(), rig.next_event(), rig.truth().end()),
            (after(5_000_000), next, end)
        );
    }
}

#[test]
fn the_seed_changes_padding_of_the_drive_and_nothing_of_the_lidar() {
    let run = |seed| {
        let mut rig = Rig::new(RigConfig {
            seed,
            ..RigConfig::new(START)
        });
        rig.advance(after(20_000_000));
        // A word-sized object: the second data word is garbage.
        rig.drive_input(&read(0x6041, 0));
        let answers: Vec<_> = std::iter::from_fn(|| rig.drive_output()).collect();
        let datagrams: Vec<_> = std::iter::from_fn(|| rig.poll_datagram()).collect();
        (answers, datagrams)
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1).0, run(2).0);
    assert_eq!(run(1).1, run(2).1);
}

/// Answers to a position request each 1.1 ms of a move, lidar packets, and the truth at the end.
fn moved(config: RigConfig) -> (Vec<DriveOutput>, Vec<Datagram>, Truth) {
    let mut rig = Rig::new(config);
    for request in motion(-9_000) {
        rig.advance(rig.now() + Span::from_millis(1));
        rig.drive_input(&request);
    }
    while rig.drive_output().is_some() {}
    for _ in 0..150 {
        rig.advance(rig.now() + Span::from_micros(1_100));
        rig.drive_input(&read(0x6064, 0));
    }
    let answers = std::iter::from_fn(|| rig.drive_output()).collect();
    let datagrams = std::iter::from_fn(|| rig.poll_datagram()).collect();
    (answers, datagrams, rig.truth())
}

#[test]
fn gear_errors_affect_the_lidar_and_no_byte_of_the_drive() {
    let plain = moved(RigConfig::new(START));
    let ripple = GearRipple {
        amplitude: Degrees(0.2),
        per_motor_turn: 1,
        phase: Degrees(0.0),
    };
    let rippled = moved(RigConfig {
        ripple: Some(ripple),
        ..RigConfig::new(START)
    });
    assert_eq!(rippled.0, plain.0);
    assert_eq!(rippled.1.len(), plain.1.len());
    assert_ne!(rippled.1, plain.1);
    let off = plain.0.iter().map(|sent| {
        let angle = |truth: &Truth| truth.tilt_deg_at(sent.at - Span::from_micros(1)).unwrap();
        angle(&rippled.2) - angle(&plain.2)
    });
    let (least, most) = off.fold((0.0_f64, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    assert!((least + 0.2).abs() < 0.01 && (most - 0.2).abs() < 0.01);
}

#[test]
fn servo_lag_affects_encoder_and_platform_alike() {
    let mut config = RigConfig::new(START);
    config.drive.servo = Some(Servo::FirstOrder {
        corner_millihertz: 15_000,
    });
    let plain = moved(RigConfig::new(START));
    let (answers, _, truth) = moved(config);
    let mut most_behind = 0.0_f64;
    for sent in &answers {
        // The drive's zero is its position at power-on, 3000 counts below level.
        let (_, position) = answer(&sent.bytes);
        let angle = truth.tilt_deg_at(sent.at);
        let Some(angle) = angle else { continue };
        assert!((f64::from(position - 3_000) * 0.0015 - angle).abs() < 0.0031);
        most_behind = most_behind.max(angle - plain.2.tilt_deg_at(sent.at).unwrap());
    }
    // 1 / (2 pi 15 Hz) at 56.25 deg/s.
    assert!((most_behind - 0.597).abs() < 0.01, "{most_behind}");
}

/// Answers, datagrams, truth and degrees moved in a run with `inputs` (each at its time, ns) that
/// also stops at each of `stops`.
fn outcome(
    inputs: &[(i64, Vec<u8>)],
    stops: &[i64],
    end: i64,
) -> (Vec<DriveOutput>, Vec<Datagram>, String, f64) {
    let mut rig = Rig::new(RigConfig {
        seed: 5,
        ..RigConfig::new(START)
    });
    let (mut answers, mut datagrams) = (Vec::new(), Vec::new());
    let mut stops = stops.iter().copied().peekable();
    for (at, bytes) in inputs.iter().chain([&(end, Vec::new())]) {
        while let Some(stop) = stops.next_if(|stop| stop <= at) {
            rig.advance(after(stop));
            datagrams.extend(std::iter::from_fn(|| rig.poll_datagram()));
        }
        rig.advance(after(*at));
        rig.drive_input(bytes);
        answers.extend(std::iter::from_fn(|| rig.drive_output()));
    }
    datagrams.extend(std::iter::from_fn(|| rig.poll_datagram()));
    let truth = rig.truth();
    let moved = truth.tilt_deg_at(after(end)).unwrap() + 4.5;
    (answers, datagrams, format!("{truth:?}"), moved)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn results_do_not_depend_on_the_time_steps(
        mut stops in prop::collection::vec(0..100_000_000_i64, 0..60),
        on_cycles in prop::collection::vec(0..100_i64, 0..20),
        polls in prop::collection::vec(0..100_000_000_i64, 20),
        by_qc in -2_000..2_000_i32,
    ) {
        stops.extend(on_cycles.iter().map(|ms| ms * 1_000_000));
        stops.sort_unstable();
        let commands = motion(by_qc).into_iter().zip(0..).map(|(bytes, ms)| (1_000_000 * ms, bytes));
        let mut inputs: Vec<_> = commands.chain(polls.into_iter().map(|at| (at, read(0x6064, 0)))).collect();
        inputs.sort_by_key(|(at, _)| *at);
        let plain = outcome(&inputs, &[], 100_000_000);
        prop_assert_eq!(plain.0.len(), inputs.len());
        prop_assert_eq!(plain.1.len(), 75 + 15);
        prop_assert!(by_qc.abs() < 10 || plain.3 * f64::from(by_qc) > 0.0, "{}", plain.3);
        prop_assert!(plain == outcome(&inputs, &stops, 100_000_000));
    }
}
