//! Bursts of damaged replies in mid-sweep: a damaged link is not a lost link.

use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use super::rig::Rig;
use super::test_drive::Distortion;
use crate::{CommandOutcome, DriveError};
use protocol::epos2::cia402::DeviceState;

/// Kinds of damage to replies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Damage {
    /// One bit is flipped, another one each time.
    Bits,
    /// The last byte is wrong.
    Crc,
    /// The second half is missing.
    Half,
    /// The first byte is missing: on USB nothing of the frame is recognised.
    Head,
}

const DAMAGES: [Damage; 4] = [Damage::Bits, Damage::Crc, Damage::Half, Damage::Head];

/// Damages input during an interval. CAN frames keep their length on the way to the client.
fn distorting(damage: Damage, from: Stamp<Host>, until: Stamp<Host>) -> Distortion {
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

#[test]
fn damage_in_bursts_is_survived() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        for damage in DAMAGES {
            for (k, burst) in (0..).zip([2, 20, 50, 75, 100]) {
                let mut rig = Rig::sweeping_on(link, Span::from_micros(600_000 + 7_310 * k));
                let until = rig.now + Span::from_millis(burst);
                rig.drive.distort = distorting(damage, rig.now, until);
                let ended = rig.finish();
                assert!(
                    matches!(ended, Ok(CommandOutcome::Arrived(_))),
                    "{link:?} {damage:?} for {burst} ms: {ended:?}"
                );
                // The first sample follows soon after. An RS232 handshake without an answer looks
                // like a working drive.
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

/// The sweep fails and the axis stops if it still receives: within 200 ms of the first recognised
/// damage, later by one request timeout where the damage looks like a missing reply, and after a
/// second where it looks like silence (RS232, whose drive waits for handshakes). Another 100 ms
/// later the client knows whether the axis has stopped.
#[test]
fn continuous_damage_ends_the_sweep_in_time() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        for damage in DAMAGES {
            let mut rig = Rig::sweeping_on(link, Span::from_millis(600));
            let (from, for_ever) = (rig.now, rig.now + Span::from_secs(100));
            rig.drive.distort = distorting(damage, from, for_ever);
            let error = rig.finish().unwrap_err();
            let DriveError::NotStopped { cause, .. } = &error else {
                panic!("{link:?} {damage:?}: {error}")
            };
            let stop = rig.quick_stop().unwrap();
            let limit = Span::from_millis(match damage {
                Damage::Bits | Damage::Crc => 200,
                Damage::Half | Damage::Head if link == DriveLink::Rs232 => 1_560,
                Damage::Half | Damage::Head => 260,
            });
            assert!(
                stop - from <= limit,
                "{link:?} {damage:?}: {:?} {cause}",
                stop - from
            );
            assert!(
                rig.now - stop <= BLIND_STOP,
                "{link:?} {damage:?}: {:?} {error}",
                rig.now - stop
            );
            assert_ne!(
                rig.drive.state(),
                DeviceState::OperationEnabled,
                "{link:?} {damage:?}: the drive is still enabled"
            );
            assert!(rig.drive.is_at_rest(), "{link:?} {damage:?}: {error}");
        }
    }
}

/// A stop without replies: 80 ms of quick stop, its ramp of 75 ms, and 80 ms of power off.
const BLIND_STOP: Span = Span::from_millis(240);

/// Silence gets a second, to the end of the probe under way; on RS232 a probe takes the 500 ms
/// after which the drive drops a telegram.
#[test]
fn silence_ends_the_sweep_after_a_second() {
    for (link, most) in [(DriveLink::Usb, 1_100), (DriveLink::Rs232, 1_520)] {
        let mut rig = Rig::sweeping_on(link, Span::from_millis(600));
        let from = rig.now;
        rig.drive.distort = Box::new(|_, _| Vec::new());
        let error = rig.finish().unwrap_err();
        let DriveError::NotStopped { cause, .. } = &error else {
            panic!("{link:?}: {error}")
        };
        assert!(
            matches!(**cause, DriveError::LinkLost { silent, .. } if silent <= Span::from_millis(most)),
            "{link:?}: {cause}"
        );
        let limit = Span::from_millis(most) + BLIND_STOP;
        assert!(rig.now - from <= limit, "{link:?}: {:?}", rig.now - from);
    }
}

/// A heartbeat with an unknown state is a damaged one: SLCAN has no checksum.
#[test]
fn a_damaged_heartbeat_is_ignored() {
    let mut rig = Rig::sweeping_on(DriveLink::Can, Span::from_millis(600));
    let mut n = 0;
    rig.drive.distort = Box::new(move |_, mut bytes| {
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
