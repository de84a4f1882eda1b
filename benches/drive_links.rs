//! Rate and cost of reading the drive's position over each link, in real time with pseudo-terminals
//! and the simulated drive in its own process.
//!
//! `cargo bench -p velomotion-tests --bench drive_links` prints the tables of docs/src/links.md.
//! `-- --seconds N` sets the duration of each row (10 s; 60 s for the stream at SYNC), `-- --can
//! IFACE` adds an interface of the kernel. Wire time is not included, as a pseudo-terminal has
//! none; the page states it.

use std::cell::RefCell;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command as Process, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use drive::{
    AxisConfig, DriveClient, DriveCommand, DriveListener, Observation, SampleTrigger, ShaftSample,
};
use engine::config::{AxisSettings, Device, DeviceKind};
use engine::devices::drive_port as ports;
use engine::devices::drive_session::Session;
use engine::devices::profile as devices;
use io::can::{CanPort, Slcan, SocketCan};
use io::port::{Port, RecordingPort, SerialPort};
use protocol::canopen::sdo::{Initiate, SdoRequest, SdoResponse};
use protocol::canopen::slcan::Bitrate;
use protocol::canopen::{CanFrame, CobId, CommunicationObject, NodeId, PdoNumber};
use protocol::epos2::objects::POSITION_ACTUAL;
use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Quadcounts, Span, Stamp};
use velomotion::cli::{Common, FirmwareSim};

/// First argument of the process that is the simulated drive.
const SIMULATED_DRIVE: &str = "--simulated-drive";

/// `velomotion firmware-sim` with these arguments.
fn simulated_drive(interface: &[String]) {
    let is = |name: &str| interface.first().is_some_and(|first| first == name);
    let arguments = FirmwareSim {
        usb: is("--usb"),
        rs232: is("--rs232"),
        slcan: is("--slcan"),
        can: interface.get(1).cloned(),
        link: None,
        gravity: None,
        friction: None,
        brake: None,
        brake_holds: None,
        latch: false,
        dither: 0,
    };
    let common = Common {
        config: None,
        json: false,
        quiet: true,
        verbose: 0,
    };
    velomotion::commands::firmware_sim::run(&arguments, &common)
        .map(drop)
        .unwrap();
}

/// The simulated drive in its own process.
struct DriveProcess {
    process: Child,
    port: String,
}

impl DriveProcess {
    fn start(interface: &[&str]) -> Self {
        let mut process = Process::new(std::env::current_exe().unwrap())
            .arg(SIMULATED_DRIVE)
            .args(interface)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut port = String::new();
        BufReader::new(process.stdout.take().unwrap())
            .read_line(&mut port)
            .unwrap();
        let port = port.trim().to_owned();
        Self { process, port }
    }
}

impl Drop for DriveProcess {
    fn drop(&mut self) {
        // It ends when its standard input closes.
        drop(self.process.stdin.take());
        let _ = self.process.wait();
    }
}

/// CPU seconds of a process so far, user and system (proc(5)).
fn cpu_s(process: &str) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    let after_name = stat.rsplit_once(')').unwrap().1;
    let fields: Vec<f64> = after_name
        .split_whitespace()
        .map(|field| field.parse().unwrap_or(0.0))
        .collect();
    const TICKS_A_SECOND: f64 = 100.0;
    (fields[11] + fields[12]) / TICKS_A_SECOND
}

/// Results of a sampling interval.
struct Measured {
    samples: Vec<ShaftSample>,
    /// Times of sent SYNCs and received process data.
    beats: Vec<Stamp<Host>>,
    answers: Vec<Stamp<Host>>,
    seconds: f64,
    client_share: f64,
    drive_share: f64,
}

fn device(kind: DeviceKind) -> Device {
    Device {
        kind,
        accel_deg_s2: 5_000.0,
        ..Device::simulator()
    }
}

/// Samples for a duration at the axis's poll period.
fn measure(kind: DeviceKind, drive: &DriveProcess, axis: AxisConfig, seconds: f64) -> Measured {
    let opened = ports::open(&device(kind), drive.port.as_ref(), None).unwrap();
    // As in a log: sent and received bytes count, not the client's interpretation.
    let received = RefCell::new(ReceivedTraffic::new(&axis));
    let port = RecordingPort::new(opened.port, opened.link, |record: &Record<'_>| {
        received.borrow_mut().receive(record);
    });
    let client = DriveClient::new(axis, opened.link);
    let mut session = Session::new(client, port, Arc::new(AtomicBool::new(false)));
    session.run(DriveCommand::Connect, &mut |_| {}).unwrap();
    session.run(DriveCommand::Home, &mut |_| {}).unwrap();
    let before = received.borrow().listener.clone();
    *received.borrow_mut() = ReceivedTraffic {
        listener: before,
        ..ReceivedTraffic::new(&AxisConfig::default())
    };
    let child = drive.process.id().to_string();
    let (begin, client_s, drive_s) = (Instant::now(), cpu_s("self"), cpu_s(&child));
    let until = session.port().now() + Span::from_secs_f64(seconds);
    session
        .run(DriveCommand::Hold { until }, &mut |_| {})
        .unwrap();
    let took = begin.elapsed().as_secs_f64();
    let traffic = received.replace(ReceivedTraffic::new(&AxisConfig::default()));
    let measured = Measured {
        samples: traffic.samples,
        beats: traffic.beats,
        answers: traffic.answers,
        seconds: took,
        client_share: (cpu_s("self") - client_s) / took,
        drive_share: (cpu_s(&child) - drive_s) / took,
    };
    session.run(DriveCommand::Brake, &mut |_| {}).unwrap();
    measured
}

/// Reads the position by SDO for a duration, one read after the other, at most one per period: the
/// fallback on a bus whose drive refuses the mapping.
fn ask(kind: DeviceKind, drive: &DriveProcess, period: Span, seconds: f64) -> Measured {
    let mut bus: Box<dyn CanPort> = match kind {
        DeviceKind::Can => Box::new(SocketCan::open(&drive.port).unwrap()),
        _ => {
            let port = SerialPort::open(&drive.port, 115_200).unwrap();
            Box::new(Slcan::open(port, Bitrate::Kbit1000).unwrap())
        }
    };
    let node = NodeId::new(AxisConfig::default().node).unwrap();
    let mut samples = Vec::new();
    let child = drive.process.id().to_string();
    let (begin, client_s, drive_s) = (Instant::now(), cpu_s("self"), cpu_s(&child));
    let until = bus.now() + Span::from_secs_f64(seconds);
    let mut due = bus.now();
    while due < until {
        while bus.now() < due {
            let left = due.saturating_since(bus.now());
            bus.read(left).unwrap();
        }
        let request = bus.now();
        let position = Quadcounts(read_position(bus.as_mut(), node));
        let answer = bus.now();
        samples.push(ShaftSample {
            request,
            answer,
            position,
            trigger: SampleTrigger::Request,
            drive_us: None,
        });
        // Like the client: no burst of late requests.
        due = (due + period).max(answer);
    }
    let took = begin.elapsed().as_secs_f64();
    Measured {
        samples,
        beats: Vec::new(),
        answers: Vec::new(),
        seconds: took,
        client_share: (cpu_s("self") - client_s) / took,
        drive_share: (cpu_s(&child) - drive_s) / took,
    }
}

fn read_position(bus: &mut dyn CanPort, node: NodeId) -> i32 {
    let address = POSITION_ACTUAL.address;
    let request = SdoRequest::InitiateUpload { address };
    bus.write_frame(&request.to_frame(node)).unwrap();
    loop {
        let (frame, _) = bus.read(Span::from_secs(1)).unwrap().expect("a response");
        if let Ok((
            _,
            SdoResponse::InitiateUpload {
                transfer: Initiate::Expedited(position),
                ..
            },
        )) = SdoResponse::parse(&frame)
        {
            return position.to_u32().cast_signed();
        }
    }
}

/// Counts and times of a session's traffic.
struct ReceivedTraffic {
    listener: DriveListener,
    samples: Vec<ShaftSample>,
    beats: Vec<Stamp<Host>>,
    answers: Vec<Stamp<Host>>,
    /// Identifier of the stream's process data.
    stream: CobId,
}

impl ReceivedTraffic {
    fn new(axis: &AxisConfig) -> Self {
        Self {
            listener: DriveListener::new(axis.node),
            samples: Vec::new(),
            beats: Vec::new(),
            answers: Vec::new(),
            stream: CommunicationObject::TransmitPdo(
                PdoNumber::One,
                NodeId::new(axis.node).unwrap(),
            )
            .cob_id(),
        }
    }

    fn receive(&mut self, record: &Record<'_>) {
        if is_frame(record, Direction::ToDrive, CobId::SYNC) {
            self.beats.push(record.host);
        }
        if is_frame(record, Direction::FromDrive, self.stream) {
            self.answers.push(record.host);
        }
        let Wire::Drive {
            link,
            direction,
            frame,
        } = record.wire
        else {
            return;
        };
        let samples = &mut self.samples;
        self.listener
            .observe(link, direction, frame, record.host, &mut |seen| {
                if let Observation::Sample(sample) = seen {
                    samples.push(sample);
                }
            });
    }
}

/// Whether this is a bus frame of this direction and identifier.
fn is_frame(record: &Record<'_>, way: Direction, id: CobId) -> bool {
    let Wire::Drive {
        link: DriveLink::Can,
        direction,
        frame,
    } = record.wire
    else {
        return false;
    };
    direction == way
        && CanFrame::from_socketcan(frame).is_ok_and(|frame| frame.cob_id() == Some(id))
}

/// Median, 99th percentile and maximum of these spans, in microseconds.
fn spans_us(spans: impl Iterator<Item = Span>) -> [f64; 3] {
    let mut spans: Vec<f64> = spans.map(Span::as_micros_f64).collect();
    spans.sort_by(f64::total_cmp);
    [0.5, 0.99, 1.0].map(|part| spans[((spans.len() - 1) as f64 * part) as usize])
}

fn row(name: &str, pace: &str, measured: &Measured) {
    let samples = &measured.samples;
    let [median, most, worst] = spans_us(samples.iter().map(|s| s.answer - s.request));
    println!(
        "| {name} | {pace} | {:.0} | {median:.0} | {most:.0} | {worst:.0} | {:.1} % | {:.1} % |",
        samples.len() as f64 / measured.seconds,
        measured.client_share * 100.0,
        measured.drive_share * 100.0,
    );
}

/// The stream at SYNC, 1 kHz: by the drive's time no sample is missing.
fn stream(name: &str, measured: &Measured) {
    let times: Vec<u32> = measured.samples.iter().filter_map(|s| s.drive_us).collect();
    let spacings: Vec<f64> = times
        .windows(2)
        .map(|w| f64::from(w[1].wrapping_sub(w[0])) / 1e3)
        .collect();
    let worst = spacings.iter().copied().fold(0.0, f64::max);
    let (beats, answers) = (&measured.beats, &measured.answers);
    // In order, which is correct if none is lost.
    let [median, most, _] = spans_us(beats.iter().zip(answers).map(|(beat, at)| *at - *beat));
    println!(
        "| {name} | {:.1} s | {:.0} | {} | {} | {} | {} | {worst:.2} ms | {median:.0} | {most:.0} | {:.1} % | {:.1} % |",
        measured.seconds,
        measured.seconds * 1e3,
        beats.len(),
        answers.len(),
        beats.len().saturating_sub(answers.len()),
        times.len(),
        measured.client_share * 100.0,
        measured.drive_share * 100.0,
    );
}

fn option(name: &str) -> Option<String> {
    let mut arguments = std::env::args();
    arguments.find(|argument| argument == name)?;
    arguments.next()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some((SIMULATED_DRIVE, interface)) = arguments
        .split_first()
        .map(|(first, rest)| (first.as_str(), rest))
    {
        simulated_drive(interface);
        return;
    }
    let seconds = option("--seconds").map(|text| text.parse::<f64>().unwrap());
    let can = option("--can");
    let mut links = vec![
        ("USB", DeviceKind::Usb, vec!["--usb"]),
        ("RS232", DeviceKind::Rs232, vec!["--rs232"]),
        ("SLCAN", DeviceKind::Slcan, vec!["--slcan"]),
    ];
    if let Some(interface) = &can {
        links.push(("SocketCAN", DeviceKind::Can, vec!["--can", interface]));
    }
    let axis = || devices::axis(&AxisSettings::default()).unwrap();
    println!(
        "| link | poll period | samples/s | round trip us: median | 99 % | worst | client, of a core | simulated drive |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let [polled, polled_s, streamed] = [10.0, 10.0, 60.0].map(|usual| seconds.unwrap_or(usual));
    let paces = [("1 ms", Span::from_millis(1)), ("none", Span::ZERO)];
    for (name, kind, interface) in links.iter().take(2) {
        for (pace, period) in paces {
            let drive = DriveProcess::start(interface);
            let mut axis = axis();
            axis.timing.poll_period = period;
            row(name, pace, &measure(*kind, &drive, axis, polled));
        }
    }
    for (name, kind, interface) in links.iter().skip(2) {
        for (pace, period) in paces {
            let drive = DriveProcess::start(interface);
            let name = format!("{name}, by SDO");
            row(&name, pace, &ask(*kind, &drive, period, polled_s));
        }
    }
    println!();
    println!(
        "| stream at 1 kHz SYNC | time | SYNCs due | sent | answered | lost | instants | worst spacing | SYNC to sample us: median | 99 % | client, of a core | simulated drive |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for (name, kind, interface) in links.iter().skip(2) {
        let drive = DriveProcess::start(interface);
        stream(name, &measure(*kind, &drive, axis(), streamed));
    }
}
