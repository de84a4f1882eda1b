//! The listener over each link: on a clean log it sees what the client saw; a hurt one shows it less, never anything else.

use std::sync::OnceLock;

use proptest::prelude::*;
use proptest::sample::Index;
use protocol::record::{Direction, DriveLink};
use units::{Host, Rpm, Span, Stamp};

use super::links::same;
use super::rig::{Rig, to};
use crate::{DriveCommand, DriveListener, MoveCommand, Observation, SampleTrigger, ShaftSample};

const LINKS: [DriveLink; 3] = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can];

type Record = (Direction, Vec<u8>, Stamp<Host>);

/// What was on the wire, and what the client made of it.
struct Recorded {
    log: Vec<Record>,
    samples: Vec<ShaftSample>,
}

/// A short move and some time at rest on either side of it, recorded once.
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
        let Recorded { log, samples } = recorded(link);
        let heard = listen(link, log);
        assert_eq!(heard.len(), samples.len(), "{link:?}");
        for (client, log) in samples.iter().zip(&heard) {
            assert!(same(link, client, log), "{link:?}: {client:?} {log:?}");
        }
        let on_can = link == DriveLink::Can;
        for sample in samples {
            assert_eq!(sample.trigger == SampleTrigger::Sync, on_can);
            assert_eq!(sample.device_us.is_some(), on_can);
        }
    }
}

/// The drive's own time is that of the shaft: 120 us after the SYNC here.
#[test]
fn the_drives_time_is_that_of_the_position() {
    let Recorded { samples, .. } = recorded(DriveLink::Can);
    for sample in samples {
        let latched = sample.request + Span::from_micros(120);
        assert_eq!(sample.device_us, Some(super::fake::device_us(latched)));
    }
}

/// What becomes of the records. A recorder knows its own requests as they were: only what came can be other than it was sent.
#[derive(Clone, Debug)]
enum Hurt {
    /// Bytes that nobody said.
    Noise(Index, Vec<u8>, bool),
    /// The rest of an answer is missing.
    Cut(Index, Index),
    /// A bit of an answer is wrong.
    Flipped(Index, Index, u8),
    /// A record stands there twice.
    Doubled(Index),
    /// An answer is missing.
    Missing(Index),
}

fn hurts() -> impl Strategy<Value = Vec<Hurt>> {
    let index = || any::<Index>();
    let bytes = proptest::collection::vec(any::<u8>(), 0..24);
    let one = prop_oneof![
        (index(), bytes, any::<bool>()).prop_map(|(at, bytes, way)| Hurt::Noise(at, bytes, way)),
        (index(), index()).prop_map(|(at, to)| Hurt::Cut(at, to)),
        (index(), index(), 0..8_u8).prop_map(|(at, byte, bit)| Hurt::Flipped(at, byte, bit)),
        index().prop_map(Hurt::Doubled),
        index().prop_map(Hurt::Missing),
    ];
    proptest::collection::vec(one, 0..40)
}

fn way(to_device: bool) -> Direction {
    if to_device {
        Direction::ToDevice
    } else {
        Direction::FromDevice
    }
}

fn hurt(link: DriveLink, log: &mut Vec<Record>, hurt: &Hurt) {
    let ours = |log: &[Record], at: usize| log[at].0 == Direction::ToDevice;
    match hurt {
        Hurt::Noise(at, bytes, to_device) => {
            let at = at.index(log.len());
            log.insert(at, (way(*to_device), bytes.clone(), log[at].2));
        }
        Hurt::Cut(at, to) => {
            let at = at.index(log.len());
            if !ours(log, at) && !log[at].1.is_empty() {
                let to = to.index(log[at].1.len());
                log[at].1.truncate(to);
            }
        }
        Hurt::Flipped(at, byte, bit) => {
            let at = at.index(log.len());
            // A frame of CAN that arrives is whole.
            if link != DriveLink::Can && !ours(log, at) && !log[at].1.is_empty() {
                let byte = byte.index(log[at].1.len());
                log[at].1[byte] ^= 1 << bit;
            }
        }
        Hurt::Doubled(at) => {
            let at = at.index(log.len());
            let copy = log[at].clone();
            log.insert(at, copy);
        }
        Hurt::Missing(at) => {
            let at = at.index(log.len());
            if !ours(log, at) {
                log.remove(at);
            }
        }
    }
}

/// Whether a sample of a hurt log is one of the client's. On a bus it may be given an older SYNC than its own: that is sure to
/// have gone out before the position was taken.
fn is_one_of(link: DriveLink, heard: &ShaftSample, samples: &[ShaftSample]) -> bool {
    samples.iter().any(|client| {
        let older = ShaftSample {
            request: heard.request,
            ..*client
        };
        match link {
            DriveLink::Can => *heard == older && heard.request <= client.request,
            DriveLink::Usb | DriveLink::Rs232 => same(link, client, heard),
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_hurt_log_shows_nothing_that_was_not(which in 0..3_usize, hurts in hurts()) {
        let link = LINKS[which];
        let Recorded { log, samples } = recorded(link);
        let mut log = log.clone();
        for one in &hurts {
            hurt(link, &mut log, one);
        }
        for heard in listen(link, &log) {
            prop_assert!(is_one_of(link, &heard, samples), "{:?}: {:?}", link, heard);
        }
    }

    /// Records that change places, even an answer with its own question: a value that was never said is never told. Whose it is cannot
    /// be known then, as a serial answer does not say.
    #[test]
    fn what_is_told_was_said(which in 0..3_usize, swaps in proptest::collection::vec(any::<Index>(), 1..40)) {
        let link = LINKS[which];
        let Recorded { log, samples } = recorded(link);
        let mut log = log.clone();
        for swap in swaps {
            let at = swap.index(log.len() - 1);
            log.swap(at, at + 1);
        }
        let said = |position: i32| {
            let bytes = position.to_le_bytes();
            log.iter().any(|(way, record, _)| {
                // On USB a 90 among them stands twice.
                let plain: Vec<u8> = match link {
                    DriveLink::Usb => unstuffed(record),
                    DriveLink::Rs232 | DriveLink::Can => record.clone(),
                };
                *way == Direction::FromDevice && plain.windows(4).any(|w| w == bytes)
            })
        };
        for heard in listen(link, &log) {
            let known = samples.iter().any(|client| client.position == heard.position);
            prop_assert!(known || said(heard.position.0), "{:?}: {:?}", link, heard);
        }
    }

    /// Anything at all: no panic.
    #[test]
    fn any_log_is_listened_to(
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
