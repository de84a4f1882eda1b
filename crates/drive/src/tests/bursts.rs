//! Bursts of damaged answers in mid-sweep: a line that is hurt is no line that is dead.

use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use super::fake::{ENABLED, Hurt};
use super::rig::{Rig, to};
use crate::{CommandOutcome, DriveCommand, DriveError};

/// How answers are hurt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damage {
    /// A bit, another one each time, is wrong.
    Bits,
    /// The last byte is wrong.
    Crc,
    /// The second half is missing.
    Half,
    /// The first byte is missing: on USB all that follows is nothing.
    Head,
}

pub const DAMAGES: [Damage; 4] = [Damage::Bits, Damage::Crc, Damage::Half, Damage::Head];

/// Hurts what comes in from one time to another. Frames of CAN keep their length on the way to the client.
pub fn hurting(damage: Damage, from: Stamp<Host>, until: Stamp<Host>) -> Hurt {
    let mut seed = 0x9E37_79B9_u32;
    Box::new(move |now, mut bytes| {
        if now < from || now >= until || bytes.is_empty() {
            return bytes;
        }
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let last = bytes.len() - 1;
        match damage {
            Damage::Bits => bytes[seed as usize / 8 % (last + 1)] ^= 1 << (seed >> 29),
            Damage::Crc => bytes[last] ^= 0x55,
            Damage::Half => bytes.truncate(last.div_ceil(2)),
            Damage::Head => drop(bytes.remove(0)),
        }
        bytes
    })
}

fn sweeping(link: DriveLink, after: Span) -> Rig {
    let mut rig = Rig::homed_on(link);
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    assert_eq!(rig.run_for(after), None, "{link:?}");
    rig.forget();
    rig
}

#[test]
fn bursts_are_survived() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        for damage in DAMAGES {
            for (k, burst) in (0..).zip([2, 20, 50, 75, 100]) {
                let mut rig = sweeping(link, Span::from_micros(600_000 + 7_310 * k));
                let until = rig.now + Span::from_millis(burst);
                rig.fake.hurt = hurting(damage, rig.now, until);
                let ended = rig.finish();
                assert!(
                    matches!(ended, Ok(CommandOutcome::Arrived(_))),
                    "{link:?} {damage:?} for {burst} ms: {ended:?}"
                );
                // The first sample comes soon after; a handshake of RS232 without what follows it looks like a unit that works.
                let seen = rig.samples().into_iter().find(|s| s.answer > until);
                let hole = seen.unwrap().answer - until;
                let cut = matches!(damage, Damage::Half | Damage::Head);
                let limit = if cut && link == DriveLink::Rs232 {
                    130
                } else {
                    70
                };
                assert!(
                    hole < Span::from_millis(limit),
                    "{link:?} {damage:?} for {burst} ms: {hole:?}"
                );
            }
        }
    }
}

/// The end is told, and the axis stopped as far as it hears: at the latest 200 ms after the damage began where it is seen to be
/// damage, and the question's own time later where it looks like silence. Whether it stops is known within another 100 ms.
#[test]
fn damage_for_ever_ends_the_sweep_in_time() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        for damage in DAMAGES {
            let mut rig = sweeping(link, Span::from_millis(600));
            let (from, for_ever) = (rig.now, rig.now + Span::from_secs(100));
            rig.fake.hurt = hurting(damage, from, for_ever);
            let error = rig.finish().unwrap_err();
            let DriveError::NotStopped { cause, .. } = &error else {
                panic!("{link:?} {damage:?}: {error}")
            };
            let stop = rig.quick_stop().unwrap();
            let limit = Span::from_millis(match damage {
                Damage::Bits | Damage::Crc => 200,
                Damage::Half | Damage::Head => 260,
            });
            assert!(
                stop - from <= limit,
                "{link:?} {damage:?}: {:?} {cause}",
                stop - from
            );
            assert!(
                rig.now - stop <= Span::from_millis(100),
                "{link:?} {damage:?}: {:?} {error}",
                rig.now - stop
            );
            assert_ne!(rig.fake.state, ENABLED, "{link:?} {damage:?}: it heard");
        }
    }
}

/// Silence gets no more time than it had: a question's, and that of two markers.
#[test]
fn silence_ends_the_sweep_as_soon_as_ever() {
    for (link, most) in [(DriveLink::Usb, 181), (DriveLink::Rs232, 265)] {
        let mut rig = sweeping(link, Span::from_millis(600));
        let from = rig.now;
        rig.fake.hurt = Box::new(|_, _| Vec::new());
        let error = rig.finish().unwrap_err();
        let DriveError::NotStopped { cause, .. } = &error else {
            panic!("{link:?}: {error}")
        };
        assert!(
            matches!(**cause, DriveError::LinkLost { silent, .. } if silent <= Span::from_millis(most)),
            "{link:?}: {cause}"
        );
        assert!(rig.now - from <= Span::from_millis(most + 85), "{link:?}");
    }
}

/// A heartbeat of no known state was damaged on the way: SLCAN has no checksum.
#[test]
fn a_damaged_heartbeat_ends_nothing() {
    let mut rig = sweeping(DriveLink::Can, Span::from_millis(600));
    let mut n = 0;
    rig.fake.hurt = Box::new(move |_, mut bytes| {
        if bytes[..2] == [0, 0] && bytes[2..4] == [0x07, 0x01] {
            n += 1;
            if n % 2 == 0 {
                bytes[8] ^= 0x20;
            }
        }
        bytes
    });
    let ended = rig.finish();
    assert!(matches!(ended, Ok(CommandOutcome::Arrived(_))), "{ended:?}");
}
