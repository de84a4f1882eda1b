//! Steps of either clock, and delays that resemble them.

use drive::SampleTrigger;
use units::{Lidar, Quadcounts, Span};

use super::*;
use delay_changes::assert_changed_once;

mod both_clocks;
mod delay_changes;
mod host_clock;

const EPOCH: i64 = 1_795_226_733_000_000_000;
const PACKET_NS: i64 = 1_327_104;
const S: i64 = 1_000_000_000;

/// A reproducible stream of numbers in 0..1 (xorshift64*).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A recording of a lidar at 30 ppm and of a polled drive, without clock steps.
struct Recorded {
    packets: Vec<Arrival>,
    /// Request and answer.
    polls: Vec<(i64, i64)>,
    /// Speed of the axis.
    counts_per_s: i64,
}

/// Records in the order of the file.
enum Entry {
    Packet(Arrival),
    Poll(i64, i64, i32),
}

impl Recorded {
    fn new(seconds: i64, poll_every_us: Option<i64>) -> Self {
        let mut noise = Noise(11);
        let mut last = 0;
        let packets = (0..seconds * S / PACKET_NS).map(|i| {
            let device = i * PACKET_NS;
            let late = -22e3 * (1.0 - noise.next()).ln();
            let spike = if noise.next() < 0.002 {
                15e6 * noise.next()
            } else {
                0.0
            };
            let host = EPOCH + device + device * 30 / 1_000_000 + (late + spike) as i64;
            last = host.max(last);
            Arrival {
                device: Stamp::from_nanos(EPOCH + device / 1_000 * 1_000),
                host: Stamp::from_nanos(last),
            }
        });
        let packets = packets.collect();
        let polls = poll_every_us.map_or(Vec::new(), |every| {
            (0..seconds * 1_000_000 / every)
                .map(|i| {
                    let request = EPOCH + i * every * 1_000;
                    let trip = 800_000.0 + 1.5e6 * noise.next();
                    (request, request + trip.min(every as f64 * 900.0) as i64)
                })
                .collect()
        });
        Self {
            packets,
            polls,
            counts_per_s: 0,
        }
    }

    /// The recording of a host whose clock is set at these true times.
    fn stepped(&self, steps: &[(i64, i64)]) -> Seen {
        let clock = |host: i64| {
            let past = steps.iter().filter(|(when, _)| *when <= host - EPOCH);
            host + past.map(|(_, by)| by).sum::<i64>()
        };
        let mut entries: Vec<(i64, Entry)> = Vec::new();
        for packet in &self.packets {
            let host = packet.host.as_nanos();
            let stamped = Arrival {
                host: Stamp::from_nanos(clock(host)),
                ..*packet
            };
            entries.push((host, Entry::Packet(stamped)));
        }
        for (request, answer) in &self.polls {
            let taken = request + (answer - request) * 2 / 5 - EPOCH;
            let position = taken * self.counts_per_s / S;
            let poll = Entry::Poll(clock(*request), clock(*answer), position as i32);
            entries.push((*answer, poll));
        }
        entries.sort_by_key(|(host, _)| *host);
        let mut seen = Seen::default();
        for (_, entry) in entries {
            match entry {
                Entry::Packet(packet) => {
                    seen.monotonic.packet(packet.device.as_nanos(), packet.host);
                    seen.arrivals.push(packet);
                }
                Entry::Poll(request, answer, position) => {
                    let stamp = Stamp::from_nanos;
                    let sewn = (
                        seen.monotonic.monotonic(stamp(request)),
                        seen.monotonic.monotonic(stamp(answer)),
                    );
                    seen.polls.push(sewn);
                    seen.samples.push(ShaftSample {
                        request: sewn.0,
                        answer: sewn.1,
                        position: Quadcounts(position),
                        trigger: SampleTrigger::Request,
                        drive_us: None,
                    });
                    seen.monotonic.sample();
                }
            }
        }
        seen
    }
}

/// Contents of a survey after the last record.
#[derive(Default)]
struct Seen {
    arrivals: Vec<Arrival>,
    monotonic: ClockSteps,
    polls: Vec<(Stamp<Host>, Stamp<Host>)>,
    samples: Vec<ShaftSample>,
}

impl Seen {
    fn timeline(&self) -> Timeline {
        Timeline::new(&self.arrivals, &self.samples, &self.monotonic).unwrap()
    }

    /// Greatest error of clock and polls in microseconds, without a constant, and the number of
    /// polls off by a round trip or more.
    fn errors(&self, timeline: &Timeline, truth: &Recorded) -> (f64, usize) {
        let clock = truth.packets.iter().zip(&self.arrivals).map(|(was, seen)| {
            let since = was.device.as_nanos() - EPOCH;
            let host = timeline
                .clock
                .moment_near(seen.device, Some(seen.host))
                .host;
            (host.as_nanos() - EPOCH - since - since * 30 / 1_000_000) as f64 / 1e3
        });
        let worst = clock.fold(0.0, |worst: f64, us| worst.max(us.abs()));
        let polls = self.polls.iter().zip(&truth.polls).filter(|(seen, was)| {
            let off = |seen: Stamp<Host>, was: i64| {
                (timeline.drive.host(seen).as_nanos() - was).abs() > 20_000
            };
            off(seen.0, was.0) || off(seen.1, was.1)
        });
        (worst, polls.count())
    }
}

fn only(timeline: &Timeline) -> ClockStep {
    let [step] = timeline.steps[..] else {
        panic!("{:?}", timeline.steps);
    };
    step
}

/// The lidar's clock is set by its first pulse, forward or back, or restarts after an outage: it
/// gets another piece, and host times are not affected.
#[test]
fn a_step_of_the_lidar_clock_is_found() {
    for poll_us in [Some(2_500), None] {
        for (by, outage) in [
            (300_700_000, 0),
            (-412_345_000, 0),
            (800 * S + 5_000, 0),
            (-1_234 * S + 77_000, 12 * S),
            (5 * S + 123_000, 12 * S),
        ] {
            let mut recorded = Recorded::new(50, poll_us);
            let at = EPOCH + 18 * S;
            recorded
                .packets
                .retain(|packet| !(at..at + outage).contains(&packet.device.as_nanos()));
            let truth = Recorded {
                packets: recorded.packets.clone(),
                polls: recorded.polls.clone(),
                counts_per_s: 0,
            };
            for packet in &mut recorded.packets {
                if packet.device.as_nanos() >= at {
                    packet.device += Span::from_nanos(by);
                }
            }
            let seen = recorded.stepped(&[]);
            let timeline = seen.timeline();
            let step = only(&timeline);
            assert_eq!(step.clock, SetClock::Lidar, "{by} {poll_us:?}");
            assert!(
                (step.by.as_nanos() - by).abs() < 1_000_000,
                "{by}: {step:?}"
            );
            let (worst_us, polls_off) = seen.errors(&timeline, &truth);
            assert!(
                worst_us < 5.0 && polls_off == 0,
                "{by}: {worst_us} us, {polls_off}"
            );
        }
    }
}

/// The first pulse per second after an outage of GPS sets the lidar's clock by a little, or by
/// whole packets.
#[test]
fn a_small_step_of_the_lidar_clock_is_found() {
    let odd = [
        100_000, -150_000, 700_000, -1_200_000, 1_200_000, 5_000_000, -5_000_000, 9_000_000,
    ];
    let whole = [1, -1, 2, -2, 3, -3, 6, -6].map(|count| count * PACKET_NS + count * 3_000);
    for by in odd.into_iter().chain(whole) {
        let mut recorded = Recorded::new(30, Some(2_500));
        let truth = Recorded::new(30, Some(2_500));
        let step = EPOCH + 18 * S;
        let is_after = |packet: &Arrival| packet.device.as_nanos() >= step;
        let first = recorded.packets.iter().find(|p| is_after(p)).unwrap().host;
        for packet in &mut recorded.packets {
            if is_after(packet) {
                packet.device += Span::from_nanos(by);
            } else if packet.device.as_nanos() >= step - by.abs() {
                // Late packets look as if they came after the step.
                let late = packet.host + Span::from_nanos(by.abs() * 3 / 5);
                packet.host = late.min(first - Span::from_micros(1));
            }
        }
        let seen = recorded.stepped(&[]);
        let timeline = seen.timeline();
        let step = only(&timeline);
        assert_eq!(step.clock, SetClock::Lidar, "{by}");
        assert!((step.by.as_nanos() - by).abs() < 10_000, "{by}: {step:?}");
        let is_forward = whole.contains(&by) && by > 0;
        let phantoms = if is_forward { by / PACKET_NS } else { 0 };
        assert_eq!(step.phantom_packets, phantoms as u64, "{by}");
        let (worst_us, polls_off) = seen.errors(&timeline, &truth);
        assert!(
            worst_us < 5.0 && polls_off == 0,
            "{by}: {worst_us} us, {polls_off}"
        );
    }
}

/// A pulse per second that comes and goes sets the lidar's clock by the same each time.
#[test]
fn repeated_steps_of_the_lidar_clock_are_found() {
    for by in [100_000, -100_000, 300_000, 1_200_000, 5_000_000] {
        for every_ms in [250, 1_000] {
            let truth = Recorded::new(12, Some(2_500));
            let mut recorded = Recorded::new(12, Some(2_500));
            let count = 8;
            for packet in &mut recorded.packets {
                let since = packet.device.as_nanos() - EPOCH - S;
                let past = since.div_euclid(every_ms * 1_000_000) + 1;
                packet.device += Span::from_nanos(by * past.clamp(0, count));
            }
            let seen = recorded.stepped(&[]);
            let timeline = seen.timeline();
            let what = format!("{by} ns every {every_ms} ms: {:?}", timeline.steps);
            assert_eq!(timeline.steps.len(), count as usize, "{what}");
            for step in &timeline.steps {
                assert_eq!(step.clock, SetClock::Lidar, "{what}");
                assert!((step.by.as_nanos() - by).abs() < 10_000, "{what}");
            }
            let (worst_us, polls_off) = seen.errors(&timeline, &truth);
            assert!(worst_us < 6.0 && polls_off == 0, "{worst_us} us, {what}");
        }
    }
}

/// A lidar with a limited field of view sends packets for a part of each revolution, whose firings
/// are not whole packets after those of the one before.
#[test]
fn a_limited_field_of_view_has_no_steps() {
    const FIRING_NS: i64 = 55_296;
    for network in ["quiet", "busy"] {
        let mut recorded = Recorded::new(12, Some(2_500));
        if network == "busy" {
            recorded = recorded.on_busy_network();
        }
        recorded.packets.retain_mut(|packet| {
            let revolution = (packet.device.as_nanos() - EPOCH) / (S / 10);
            let shift = Span::from_nanos(FIRING_NS * (3 * revolution + revolution % 3));
            packet.device += shift;
            packet.host += shift;
            (packet.device - shift).as_nanos().rem_euclid(S / 10) < 40_000_000
        });
        let timeline = recorded.stepped(&[]).timeline();
        assert_eq!(timeline.steps, [], "{network}");
        assert_eq!(timeline.delay_changes, [], "{network}");
    }
}

/// Lost packets are no steps of the lidar's clock, even if a slower network before them is faster
/// again after them.
#[test]
fn lost_packets_are_no_steps() {
    for lost in [1, 2, 3, 5] {
        for slower_ns in [0, PACKET_NS / 2, lost * PACKET_NS] {
            let mut recorded = Recorded::new(30, Some(2_500));
            let at = (18 * S / PACKET_NS) as usize;
            let count = recorded.packets.len();
            for packet in &mut recorded.packets[at - 200..at] {
                packet.host += Span::from_nanos(slower_ns);
            }
            recorded.packets.drain(at..at + lost as usize);
            assert_eq!(recorded.packets.len(), count - lost as usize);
            let steps = recorded.stepped(&[]).timeline().steps;
            assert_eq!(steps, [], "{lost} lost, {slower_ns} ns");
        }
    }
}

/// A stalled network delivers its packets all at once, also at the end of a recording or from its
/// start. Neither that nor lost packets nor a paused host are steps.
#[test]
fn delays_are_not_steps() {
    for (from, length) in [
        (10 * S, 3 * S),
        (15 * S, 4 * S),
        (0, 2 * S),
        (28 * S, 2 * S),
        (29 * S, S),
    ] {
        for poll_us in [Some(2_500), None] {
            let mut recorded = Recorded::new(30, poll_us);
            let truth = Recorded::new(30, poll_us);
            let until = EPOCH + from + length;
            for packet in &mut recorded.packets {
                if packet.host.as_nanos() >= EPOCH + from && packet.host.as_nanos() < until {
                    let place = packet.host.as_nanos() - EPOCH - from;
                    packet.host = Stamp::from_nanos(until + place / 1_000_000);
                }
            }
            let seen = recorded.stepped(&[]);
            let timeline = seen.timeline();
            assert_eq!(timeline.steps, [], "{from} {length}");
            assert_eq!(timeline.delay_changes, [], "{from} {length}");
            let (worst_us, polls_off) = seen.errors(&timeline, &truth);
            assert!(polls_off == 0, "{polls_off}");
            assert!(worst_us < 100.0, "{from} {length}: {worst_us} us");
        }
    }
    let mut recorded = Recorded::new(30, Some(2_500));
    let gap = EPOCH + 9 * S..EPOCH + 14 * S;
    recorded
        .packets
        .retain(|packet| !gap.contains(&packet.device.as_nanos()));
    recorded.polls.retain(|poll| !gap.contains(&poll.0));
    assert_eq!(recorded.stepped(&[]).timeline().steps, []);
}

/// A network that becomes slower for good does not set the host's clock.
#[test]
fn a_slower_network_while_the_axis_moves_is_no_step() {
    for slower_us in [150, 300, 500, 800, 3_000] {
        let mut recorded = Recorded {
            counts_per_s: 37_500,
            ..Recorded::new(20, Some(2_500))
        };
        for packet in &mut recorded.packets {
            if packet.host.as_nanos() >= EPOCH + 7 * S {
                packet.host += Span::from_micros(slower_us);
            }
        }
        let timeline = recorded.stepped(&[]).timeline();
        assert_eq!(timeline.steps, [], "{slower_us} us");
        // The positions exclude a step of the host's clock.
        assert_eq!(timeline.delay_changes, [], "{slower_us} us");
    }
}

/// A step below 10 ms that nothing attributes is absorbed; it is reported, and the bound contains
/// it.
#[test]
fn unattributed_small_steps_are_reported_and_within_the_bound() {
    for by in [100_000, 2_000_000, 8_000_000, -100_000, -2_000_000] {
        let recorded = Recorded::new(60, Some(2_500));
        let seen = recorded.stepped(&[(31 * S, by)]);
        let timeline = seen.timeline();
        assert_eq!(timeline.steps, []);
        assert_changed_once(&timeline, 31.0, by);
        // The stamps of the polls have the step too.
        let host_bound = timeline.clock.host_bound().as_nanos();
        assert!(host_bound >= by.abs() - 2_000, "{by}: {host_bound} ns");
        for (packet, was) in seen.arrivals.iter().zip(&recorded.packets) {
            // By the clock of that time.
            let since = was.device.as_nanos() - EPOCH;
            let set = if packet.host == was.host { 0 } else { by };
            let truth = EPOCH + since + since * 30 / 1_000_000 + set;
            let off = timeline.clock.host(packet.device).as_nanos() - truth;
            let bound = timeline.clock.bound_at(packet.device).as_nanos();
            // Whole microseconds of the device.
            assert!(off.abs() <= bound + 2_000, "{by}: {off} ns, bound {bound}");
        }
    }
}

/// A laptop without a battery for its clock starts in 1970, until the network sets it.
#[test]
fn a_clock_that_is_set_by_decades_is_found() {
    const YEAR_S: i64 = 31_557_600;
    for by in [46 * YEAR_S * S, -46 * YEAR_S * S] {
        let recorded = Recorded::new(60, Some(2_500));
        let timeline = recorded.stepped(&[(31 * S, by)]).timeline();
        let step = only(&timeline);
        assert_eq!(step.clock, SetClock::Host, "{by}");
        assert!(
            (step.by.as_nanos() - by).abs() < 1_000_000,
            "{by}: {step:?}"
        );
    }
}

/// After a silence of the lidar alone, packets that take longer are no step of the host's clock.
#[test]
fn a_slower_network_after_a_silence_of_the_lidar_is_no_step() {
    let mut recorded = Recorded::new(30, Some(2_500));
    let silent = EPOCH + 9 * S..EPOCH + 11 * S;
    recorded
        .packets
        .retain(|p| !silent.contains(&p.host.as_nanos()));
    for packet in &mut recorded.packets {
        if packet.host.as_nanos() >= silent.end {
            packet.host += Span::from_millis(3);
        }
    }
    let timeline = recorded.stepped(&[]).timeline();
    assert_eq!(timeline.steps, []);
    assert_changed_once(&timeline, 11.0, 3_000_000);
}

/// A damaged stamp, early by minutes, is ignored and does not bend the clock.
#[test]
fn an_early_packet_is_ignored() {
    let recorded = Recorded::new(20, Some(2_500));
    let mut seen = recorded.stepped(&[]);
    seen.arrivals[7_000].device += Span::from_secs(90);
    let timeline = seen.timeline();
    assert_eq!(timeline.steps, []);
    let sound = |i: &usize| *i != 7_000;
    let worst = (0..seen.arrivals.len()).filter(sound).map(|i| {
        let device: Stamp<Lidar> = seen.arrivals[i].device;
        let since = device.as_nanos() - EPOCH;
        (timeline.clock.host(device).as_nanos() - device.as_nanos() - since * 30 / 1_000_000).abs()
    });
    assert!(worst.max().unwrap() < 5_000);
}

/// With few packets there are no steps, and nothing panics.
#[test]
fn few_packets_have_no_steps() {
    for count in 1..40 {
        let mut recorded = Recorded::new(1, None);
        recorded.packets.truncate(count);
        let seen = recorded.stepped(&[]);
        assert_eq!(seen.timeline().steps, []);
    }
    assert!(Timeline::new(&[], &[], &ClockSteps::default()).is_none());
}
