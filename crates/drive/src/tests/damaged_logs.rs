//! The listener on each link: a clean log gives the client's samples, a damaged one fewer, never
//! wrong ones.

use std::sync::OnceLock;

use proptest::prelude::*;
use proptest::sample::Index;
use protocol::epos2::rs232::OKAY;
use protocol::record::{Direction, DriveLink};
use units::{Host, Rpm, Span, Stamp};

use super::links::same;
use super::rig::{Rig, to};
use crate::{DriveCommand, DriveListener, MoveCommand, Observation, SampleTrigger, ShaftSample};

const LINKS: [DriveLink; 3] = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can];

type Record = (Direction, Vec<u8>, Stamp<Host>);

/// A log, and the client's samples.
struct Recorded {
    log: Vec<Record>,
    samples: Vec<ShaftSample>,
    /// Start of the drive's clock.
    started: Stamp<Host>,
}

/// A short move with standstill before and after, recorded once.
fn recorded(link: DriveLink) -> &'static Recorded {
    static RECORDED: [OnceLock<Recorded>; 3] = [const { OnceLock::new() }; 3];
    let at = LINKS.iter().position(|other| *other == link).unwrap();
    RECORDED[at].get_or_init(|| {
        let mut rig = Rig::homed_on(link);
        rig.run(DriveCommand::Sweep(MoveCommand {
            speed: Rpm(1500),
            ..to(-57.0)
        }))
        .unwrap();
        Recorded {
            samples: rig.samples(),
            started: rig.drive.started,
            log: rig.log,
        }
    })
}

fn listen(link: DriveLink, log: &[Record]) -> Vec<ShaftSample> {
    let mut listener = DriveListener::new(1);
    let mut samples = Vec::new();
    for (direction, bytes, host) in log {
        listener.observe(link, *direction, bytes, *host, &mut |seen| {
            if let Observation::Sample(sample) = seen {
                samples.push(sample);
            }
        });
    }
    samples
}

#[test]
fn a_clean_log_gives_the_clients_own_samples() {
    for link in LINKS {
        let Recorded { log, samples, .. } = recorded(link);
        let observed = listen(link, log);
        assert_eq!(observed.len(), samples.len(), "{link:?}");
        for (client, log) in samples.iter().zip(&observed) {
            assert!(same(link, client, log), "{link:?}: {client:?} {log:?}");
        }
        let on_can = link == DriveLink::Can;
        for sample in samples {
            assert_eq!(sample.trigger == SampleTrigger::Sync, on_can);
            assert_eq!(sample.drive_us.is_some(), on_can);
        }
    }
}

/// A recorder may write whole frames alone: each side's handshakes follow from the bytes after
/// them.
#[test]
fn a_log_without_handshakes_gives_the_same_positions() {
    let Recorded { log, samples, .. } = recorded(DriveLink::Rs232);
    for (is_of_drive, is_of_master) in [(true, false), (false, true), (true, true)] {
        let is_kept = |(direction, bytes, _): &&Record| match direction {
            Direction::ToDrive => !is_of_master || *bytes != [OKAY],
            Direction::FromDrive => !is_of_drive || *bytes != [OKAY],
        };
        let rest: Vec<Record> = log.iter().filter(is_kept).cloned().collect();
        assert!(rest.len() < log.len());
        let observed = listen(DriveLink::Rs232, &rest);
        let what = format!("without the drive's: {is_of_drive}, the master's: {is_of_master}");
        assert_eq!(observed.len(), samples.len(), "{what}");
        for (client, log) in samples.iter().zip(&observed) {
            assert_eq!(client.position, log.position, "{what}");
            let overlap = log.request <= client.answer && client.request <= log.answer;
            assert!(overlap, "{what}: {client:?} {log:?}");
        }
    }
}

/// A recorder that was stopped for a while leaves the beginning of one answer and the end of
/// another: no position is given a time that another one had.
#[test]
fn a_hole_in_a_log_joins_no_two_polls() {
    for link in LINKS {
        let Recorded { log, samples, .. } = recorded(link);
        let middle = samples[samples.len() / 3].request;
        let first = log.partition_point(|(.., host)| *host < middle);
        // Every record of two polls is the first that is missing, every one of two others the last.
        for from in first..first + 20 {
            for length in [5, 20, 40, 80].map(Span::from_millis) {
                let end = log[from].2 + length;
                let end = log.partition_point(|(.., host)| *host < end);
                for end in end..end + 20 {
                    let rest = [&log[..from], &log[end.min(log.len())..]].concat();
                    for seen in listen(link, &rest) {
                        let is_true = |own: &ShaftSample| {
                            own.position == seen.position
                                && own.request <= seen.answer
                                && seen.request <= own.answer
                        };
                        let is_one = samples.iter().any(is_true);
                        assert!(is_one, "{link:?}, {from}, {end}: {seen:?}");
                    }
                }
            }
        }
    }
}

/// The drive's time is that of the sample: 120 us after the SYNC here.
#[test]
fn the_drives_time_belongs_to_the_position() {
    let Recorded {
        samples, started, ..
    } = recorded(DriveLink::Can);
    for sample in samples {
        let latched = sample.request + Span::from_micros(120);
        let us = (latched - *started).as_nanos() / 1_000;
        assert_eq!(sample.drive_us, Some(us as u32));
    }
}

/// Damage to records. A recorder knows its own requests; only replies can be damaged.
#[derive(Clone, Debug)]
enum Distortion {
    /// Extra bytes.
    Noise(Index, Vec<u8>, bool),
    /// The rest of a reply is missing.
    Cut(Index, Index),
    /// A flipped bit of a reply.
    Flipped(Index, Index, u8),
    /// A repeated record.
    Doubled(Index),
    /// A missing reply.
    Missing(Index),
}

fn damages() -> impl Strategy<Value = Vec<Distortion>> {
    let index = || any::<Index>();
    let bytes = proptest::collection::vec(any::<u8>(), 0..24);
    let one = prop_oneof![
        (index(), bytes, any::<bool>())
            .prop_map(|(at, bytes, way)| Distortion::Noise(at, bytes, way)),
        (index(), index()).prop_map(|(at, to)| Distortion::Cut(at, to)),
        (index(), index(), 0..8_u8).prop_map(|(at, byte, bit)| Distortion::Flipped(at, byte, bit)),
        index().prop_map(Distortion::Doubled),
        index().prop_map(Distortion::Missing),
    ];
    proptest::collection::vec(one, 0..40)
}

fn way(to_device: bool) -> Direction {
    if to_device {
        Direction::ToDrive
    } else {
        Direction::FromDrive
    }
}

fn damage_log(link: DriveLink, log: &mut Vec<Record>, damage: &Distortion) {
    let ours = |log: &[Record], at: usize| log[at].0 == Direction::ToDrive;
    match damage {
        Distortion::Noise(at, bytes, to_device) => {
            let at = at.index(log.len());
            log.insert(at, (way(*to_device), bytes.clone(), log[at].2));
        }
        Distortion::Cut(at, to) => {
            let at = at.index(log.len());
            if !ours(log, at) && !log[at].1.is_empty() {
                let to = to.index(log[at].1.len());
                log[at].1.truncate(to);
            }
        }
        Distortion::Flipped(at, byte, bit) => {
            let at = at.index(log.len());
            // A CAN frame arrives complete or not at all.
            if link != DriveLink::Can && !ours(log, at) && !log[at].1.is_empty() {
                let byte = byte.index(log[at].1.len());
                log[at].1[byte] ^= 1 << bit;
            }
        }
        Distortion::Doubled(at) => {
            let at = at.index(log.len());
            let copy = log[at].clone();
            log.insert(at, copy);
        }
        Distortion::Missing(at) => {
            let at = at.index(log.len());
            if !ours(log, at) {
                log.remove(at);
            }
        }
    }
}

/// Whether a sample of a damaged log is one of the client's. On CAN it may have an earlier SYNC,
/// which certainly preceded the sample.
fn is_one_of(link: DriveLink, observed: &ShaftSample, samples: &[ShaftSample]) -> bool {
    samples.iter().any(|client| {
        let older = ShaftSample {
            request: observed.request,
            ..*client
        };
        match link {
            DriveLink::Can => *observed == older && observed.request <= client.request,
            DriveLink::Usb | DriveLink::Rs232 => same(link, client, observed),
        }
    })
}

/// A recorder that drops one reply loses one sample: the next request shows that the client had
/// its reply.
#[test]
fn one_missing_reply_costs_one_sample() {
    for link in LINKS {
        let Recorded { log, samples, .. } = recorded(link);
        let replies = (0..log.len()).filter(|at| log[*at].0 == Direction::FromDrive);
        let middle = replies.clone().count() / 2;
        for missing in replies.skip(middle).take(12) {
            let mut log = log.clone();
            log.remove(missing);
            let observed = listen(link, &log);
            let lost = samples.len() - observed.len();
            assert!(lost <= 1, "{link:?}: {lost} of {} lost", samples.len());
            for sample in &observed {
                assert!(is_one_of(link, sample, samples), "{link:?}: {sample:?}");
            }
        }
    }
}

/// The exchanges of positions on USB, one per `period`, and their samples.
fn slow_polls(period: Span) -> (Vec<Vec<Record>>, Vec<ShaftSample>) {
    let Recorded { log, samples, .. } = recorded(DriveLink::Usb);
    let mut slow = (Vec::new(), Vec::new());
    let mut begin = samples[0].request;
    for sample in samples {
        let delay = begin - sample.request;
        let exchange = log.iter().filter(|(way, _, host)| match way {
            Direction::ToDrive => *host == sample.request,
            Direction::FromDrive => *host > sample.request && *host <= sample.answer,
        });
        let delayed = exchange.map(|(way, bytes, host)| (*way, bytes.clone(), *host + delay));
        slow.0.push(delayed.collect());
        slow.1.push(ShaftSample {
            request: begin,
            answer: sample.answer + delay,
            ..*sample
        });
        begin += period;
    }
    slow
}

/// Between slow polls a master may have given up. Timing and position show which poll is answered.
#[test]
fn one_missing_reply_costs_at_most_two_slow_polls() {
    for period_ms in [35, 50, 100] {
        let (exchanges, samples) = slow_polls(Span::from_millis(period_ms));
        let whole = listen(DriveLink::Usb, &exchanges.concat());
        assert!(whole == samples, "{} of {}", whole.len(), samples.len());
        let cases = 5..samples.len() - 3;
        assert!(cases.len() > 100);
        let mut twice = 0;
        for missing in cases.clone() {
            let mut exchanges = exchanges.clone();
            exchanges[missing].retain(|(way, ..)| *way == Direction::ToDrive);
            let observed = listen(DriveLink::Usb, &exchanges.concat());
            let lost = samples.len() - observed.len();
            assert!(
                (1..=2).contains(&lost),
                "{period_ms} ms: {lost} at {missing}"
            );
            twice += usize::from(lost == 2);
            assert!(observed.iter().all(|sample| samples.contains(sample)));
        }
        // The next poll is lost too only where the speed changes.
        assert!(4 * twice <= cases.len(), "{period_ms} ms: {twice}");
    }
}

/// A reply so late that the master asks again is not taken for that to the next poll, unless the
/// axis rests.
#[test]
fn a_late_reply_is_not_that_to_the_next_slow_poll() {
    let (exchanges, samples) = slow_polls(Span::from_millis(35));
    for late in 5..samples.len() - 3 {
        let mut exchanges = exchanges.clone();
        let delay = Span::from_millis(35) + Span::from_micros(500);
        let mut replies = exchanges[late].split_off(1);
        for reply in &mut replies {
            reply.2 += delay;
        }
        exchanges[late + 1].splice(1..1, replies);
        for sample in listen(DriveLink::Usb, &exchanges.concat()) {
            let own = samples.iter().find(|own| own.request == sample.request);
            let apart = own.unwrap().position.0 - sample.position.0;
            assert!(apart.abs() <= 2, "{late}: {sample:?}");
        }
    }
}

/// A write whose confirmation is missing is reported all the same, before the samples after it.
#[test]
fn a_write_without_its_confirmation_is_reported() {
    for link in LINKS {
        let Recorded { log, .. } = recorded(link);
        let writes = |log: &[Record]| {
            let mut listener = DriveListener::new(1);
            let mut writes = Vec::new();
            for (direction, bytes, host) in log {
                listener.observe(link, *direction, bytes, *host, &mut |seen| {
                    if let Observation::Wrote { address, value, .. } = seen {
                        writes.push((address, value));
                    }
                });
            }
            writes
        };
        let all = writes(log);
        // Nothing follows the last write, so nothing shows that its confirmation is missing.
        let (_, followed) = all.split_last().unwrap();
        assert!(followed.len() > 5, "{link:?}: {}", followed.len());
        for at in 0..log.len() {
            if log[at].0 == Direction::ToDrive {
                continue;
            }
            let mut log = log.clone();
            log.remove(at);
            let found = writes(&log);
            assert!(
                found.starts_with(followed),
                "{link:?}: without record {at}: {found:?}"
            );
        }
    }
}

/// A checksum ends with 90, which USB doubles. Without the second one the frame is complete with
/// the first byte of the next reply, which is later than its own request.
#[test]
fn a_reply_without_its_last_byte_is_not_completed_by_the_next() {
    let Recorded { log, samples, .. } = recorded(DriveLink::Usb);
    let ends = |bytes: &[u8]| bytes.ends_with(&[0x90, 0x90]);
    let at = log
        .iter()
        .position(|(way, bytes, _)| *way == Direction::FromDrive && ends(bytes));
    let at = at.unwrap();
    let mut log = log.clone();
    log[at].1.pop();
    let observed = listen(DriveLink::Usb, &log);
    assert_eq!(observed.len(), samples.len() - 1);
    for sample in &observed {
        assert!(is_one_of(DriveLink::Usb, sample, samples), "{sample:?}");
    }
}

/// Replies dropped throughout a log cost no more samples than replies.
#[test]
fn missing_replies_cost_their_own_samples() {
    for link in LINKS {
        let Recorded { log, samples, .. } = recorded(link);
        let mut count = 0;
        let mut missing = 0;
        let mut log = log.clone();
        log.retain(|(way, ..)| {
            count += usize::from(*way == Direction::FromDrive);
            let is_dropped = *way == Direction::FromDrive && count % 50 == 0;
            missing += usize::from(is_dropped);
            !is_dropped
        });
        let lost = samples.len() - listen(link, &log).len();
        assert!(
            lost <= missing,
            "{link:?}: {lost} samples lost by {missing} replies"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_damaged_log_gives_no_wrong_samples(which in 0..3_usize, damages in damages()) {
        let link = LINKS[which];
        let Recorded { log, samples, .. } = recorded(link);
        let mut log = log.clone();
        for one in &damages {
            damage_log(link, &mut log, one);
        }
        for observed in listen(link, &log) {
            prop_assert!(is_one_of(link, &observed, samples), "{:?}: {:?}", link, observed);
        }
    }

    /// With reordered records, even a reply before its request, only values from the log are
    /// reported. A serial reply does not say whose it is.
    #[test]
    fn reordered_records_give_only_recorded_values(which in 0..3_usize, swaps in proptest::collection::vec(any::<Index>(), 1..40)) {
        let link = LINKS[which];
        let Recorded { log, samples, .. } = recorded(link);
        let mut log = log.clone();
        for swap in swaps {
            let at = swap.index(log.len() - 1);
            log.swap(at, at + 1);
        }
        let replies = |position: i32| {
            let bytes = position.to_le_bytes();
            log.iter().any(|(way, record, _)| {
                // USB doubles 0x90.
                let plain: Vec<u8> = match link {
                    DriveLink::Usb => unstuffed(record),
                    DriveLink::Rs232 | DriveLink::Can => record.clone(),
                };
                *way == Direction::FromDrive && plain.windows(4).any(|w| w == bytes)
            })
        };
        for observed in listen(link, &log) {
            let known = samples.iter().any(|client| client.position == observed.position);
            prop_assert!(known || replies(observed.position.0), "{:?}: {:?}", link, observed);
        }
    }

    /// Arbitrary records cause no panic.
    #[test]
    fn arbitrary_records_are_accepted(
        which in 0..3_usize,
        records in proptest::collection::vec((any::<bool>(), proptest::collection::vec(any::<u8>(), 0..32), any::<i64>()), 0..60),
    ) {
        let log: Vec<Record> = records
            .into_iter()
            .map(|(to_device, bytes, at)| (way(to_device), bytes, Stamp::from_nanos(at)))
            .collect();
        prop_assert_eq!(listen(LINKS[which], &log), []);
    }
}

fn unstuffed(record: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    let mut doubled = false;
    for &byte in record {
        doubled = byte == 0x90 && !doubled;
        if !doubled || plain.is_empty() {
            plain.push(byte);
        }
    }
    plain
}
