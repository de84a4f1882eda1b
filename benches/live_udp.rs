//! Loss and cost of receiving and recording three sensors at the dual-return rate on loopback, as
//! `capture` does.
//!
//! `cargo bench -p velomotion-io --bench live_udp -- --seconds 60 [--log FILE]`
//!
//! The sensors are a separate process that sends numbered packets, 1206 bytes every 663.552 us (12
//! sequences of 55.296 us, VLP-16 user manual 63-9243, 9.3.2) and 512 bytes every 6.8 ms for each
//! sensor, from 127.0.0.2 to 127.0.0.4. The log is read back at the end. The bench fails on any
//! loss. Packets have no meaningful content.

use std::error::Error;
use std::io::{BufRead, BufReader, Write};
use std::net::UdpSocket;
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use io::clock;
use io::files::Overwrite;
use io::log::{LogConfig, LogRecorder, LogWriter};
use io::recording::{DatagramKind, Recording};
use io::udp::{LidarListener, ListenConfig};
use nix::time::{ClockId, clock_gettime};
use protocol::record::Wire;
use protocol::vlp16::{BLOCK_LEN, DATA_LEN, POSITION_LEN};

const SENSORS: u8 = 3;
const FIRST_ADDRESS: u8 = 2;
const DATA_PERIOD: Duration = Duration::from_nanos(663_552);
const POSITION_PERIOD: Duration = Duration::from_micros(6_800);
/// Offset of the packet's number: in the first block's channels, and before the time of a position
/// packet.
const NUMBER_AT: usize = 4;
/// Time for the last packets after the sensors ended.
const GRACE: Duration = Duration::from_millis(300);

fn main() -> ExitCode {
    let done = match Arguments::parse() {
        Ok(Arguments::Send {
            data,
            position,
            seconds,
        }) => send(data, position, seconds),
        Ok(Arguments::Receive { seconds, log }) => receive(seconds, log),
        Err(error) => Err(error),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("live_udp: {error}");
            ExitCode::FAILURE
        }
    }
}

enum Arguments {
    Send {
        data: u16,
        position: u16,
        seconds: u64,
    },
    Receive {
        seconds: u64,
        log: Option<PathBuf>,
    },
}

impl Arguments {
    fn parse() -> Result<Self, Box<dyn Error>> {
        let (mut seconds, mut log, mut ports) = (60, None, None);
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let mut next = || words.next().ok_or(format!("{word}: a value is missing"));
            match word.as_str() {
                "--seconds" => seconds = next()?.parse()?,
                "--log" => log = Some(PathBuf::from(next()?)),
                "--send" => ports = Some((next()?.parse()?, next()?.parse()?)),
                "--bench" => {} // passed by cargo
                _ => return Err(format!("{word}: expected --seconds N or --log FILE").into()),
            }
        }
        Ok(match ports {
            Some((data, position)) => Self::Send {
                data,
                position,
                seconds,
            },
            None => Self::Receive { seconds, log },
        })
    }
}

/// Sends each packet at its time, and late ones at once.
fn send(data: u16, position: u16, seconds: u64) -> Result<(), Box<dyn Error>> {
    let mut payload = vec![0x55; DATA_LEN];
    for block in payload.chunks_exact_mut(BLOCK_LEN) {
        put(block, 0, &[0xFF, 0xEE, 0, 0]);
    }
    put(&mut payload, DATA_LEN - 2, &[0x39, 0x22]);
    let mut streams = Vec::new();
    for sensor in 0..SENSORS {
        let socket = UdpSocket::bind((
            "127.0.0.1".replace(".1", &format!(".{}", FIRST_ADDRESS + sensor)),
            0,
        ))?;
        // The sensors are out of phase.
        let phase = DATA_PERIOD * u32::from(sensor) / u32::from(SENSORS);
        let stream = |socket, port, period, payload| Stream {
            socket,
            port,
            period,
            next: phase,
            sent: 0,
            payload,
        };
        streams.push(stream(
            socket.try_clone()?,
            data,
            DATA_PERIOD,
            payload.clone(),
        ));
        streams.push(stream(
            socket,
            position,
            POSITION_PERIOD,
            vec![0; POSITION_LEN],
        ));
    }
    let begin = Instant::now();
    let end = Duration::from_secs(seconds);
    while let Some(stream) = streams.iter_mut().min_by_key(|stream| stream.next) {
        if stream.next >= end {
            break;
        }
        thread::sleep(stream.next.saturating_sub(begin.elapsed()));
        stream.send()?;
    }
    let mut out = std::io::stdout();
    writeln!(
        out,
        "{}",
        streams.iter().map(|stream| stream.sent).sum::<u64>()
    )?;
    Ok(())
}

struct Stream {
    socket: UdpSocket,
    port: u16,
    period: Duration,
    next: Duration,
    sent: u64,
    payload: Vec<u8>,
}

impl Stream {
    fn send(&mut self) -> std::io::Result<()> {
        put(&mut self.payload, NUMBER_AT, &self.sent.to_le_bytes());
        self.socket
            .send_to(&self.payload, ("127.0.0.1", self.port))?;
        self.sent += 1;
        self.next += self.period;
        Ok(())
    }
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    if let Some(place) = bytes.get_mut(at..at + value.len()) {
        place.copy_from_slice(value);
    }
}

/// The number in a packet.
fn number(payload: &[u8]) -> u64 {
    let bytes = payload
        .get(NUMBER_AT..)
        .and_then(|bytes| bytes.first_chunk());
    bytes.map_or(0, |&bytes| u64::from_le_bytes(bytes))
}

/// Statistics of the numbers of one stream.
#[derive(Clone, Copy, Default)]
struct SensorStream {
    packets: u64,
    next: u64,
    missing: u64,
}

/// CPU time used so far, s.
fn cpu(clock: ClockId) -> Result<f64, Box<dyn Error>> {
    Ok(Duration::from(clock_gettime(clock)?).as_secs_f64())
}

fn receive(seconds: u64, log: Option<PathBuf>) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = log.unwrap_or_else(|| folder.path().join("live.pcapng"));
    let mut listener = LidarListener::bind(&ListenConfig {
        address: "127.0.0.1".parse()?,
        data_port: 0,
        position_port: Some(0),
        ..ListenConfig::default()
    })?;
    let ports: Vec<u16> = listener
        .sockets()
        .iter()
        .map(|s| s.address.port())
        .collect();
    let granted = listener.sockets().first().map_or(0, |s| s.receive_buffer);
    let &[data, position] = ports.as_slice() else {
        return Err("two sockets were to be bound".into());
    };
    let writer = LogWriter::create(&path, &LogConfig::default(), Overwrite::Replace)?;
    let recorder = LogRecorder::start(writer)?;
    let handle = recorder.handle();

    let stop = Arc::new(AtomicBool::new(false));
    let sensors = sensors(data, position, seconds, Arc::clone(&stop))?;
    let mut streams_by_sensor = [[SensorStream::default(); 2]; SENSORS as usize];
    let mut delays_us = Vec::with_capacity(seconds as usize * 5_000);
    let (begin, thread_before, before) = (
        Instant::now(),
        cpu(ClockId::CLOCK_THREAD_CPUTIME_ID)?,
        cpu(ClockId::CLOCK_PROCESS_CPUTIME_ID)?,
    );
    let counts = listener.run(&stop, |record| {
        delays_us.push((clock::now() - record.host).as_micros_f64() as f32);
        handle.record(record);
        let Wire::Lidar {
            source: [_, _, _, last],
            port,
            payload,
        } = record.wire
        else {
            return;
        };
        let sensor = usize::from(last.wrapping_sub(FIRST_ADDRESS));
        let Some(stream) = streams_by_sensor
            .get_mut(sensor)
            .and_then(|s| s.get_mut(usize::from(port == position)))
        else {
            return;
        };
        let got = number(payload);
        stream.packets += 1;
        stream.missing += got.saturating_sub(stream.next);
        stream.next = got + 1;
    })?;
    let thread_s = cpu(ClockId::CLOCK_THREAD_CPUTIME_ID)? - thread_before;
    let wall_s = begin.elapsed().as_secs_f64();
    let recorded = recorder.finish()?;
    let process_s = cpu(ClockId::CLOCK_PROCESS_CPUTIME_ID)? - before;
    let sent = sensors
        .join()
        .map_err(|_| "the thread of the sensors panicked")??;

    let streams = streams_by_sensor.as_flattened();
    let received: u64 = streams.iter().map(|stream| stream.packets).sum();
    let missing: u64 = streams.iter().map(|stream| stream.missing).sum();
    delays_us.sort_by(f32::total_cmp);
    let delay = |share: f64| {
        let at = (delays_us.len() as f64 * share) as usize;
        delays_us
            .get(at.min(delays_us.len().saturating_sub(1)))
            .copied()
            .unwrap_or(0.0)
    };
    println!(
        "{SENSORS} sensors, dual return, {wall_s:.1} s, receive buffer {granted} bytes a socket"
    );
    println!("sent                       {sent}");
    println!(
        "received                   {received} ({:.0} a second)",
        received as f64 / wall_s
    );
    println!("dropped by the kernel      {}", counts.dropped);
    println!("numbers missing            {missing}");
    println!("recorder: dropped          {}", recorded.dropped);
    println!("recorder: out of order     {}", recorded.out_of_order);
    println!("without a kernel time      {}", counts.without_kernel_time);
    println!(
        "CPU, receiving thread      {:.2} % of one core",
        100.0 * thread_s / wall_s
    );
    println!(
        "CPU, whole process         {:.2} % of one core (with the recorder)",
        100.0 * process_s / wall_s
    );
    println!(
        "kernel stamp to read       median {:.0} us, 99.9 % {:.0} us, worst {:.0} us",
        delay(0.5),
        delay(0.999),
        delay(1.0)
    );
    let logged = read_back(&path, seconds)?;
    let lost = sent.abs_diff(received)
        + missing
        + counts.dropped
        + recorded.dropped
        + sent.abs_diff(logged);
    println!("lost                       {lost}");
    if lost == 0 {
        Ok(())
    } else {
        Err("packets were lost".into())
    }
}

/// Starts the sensors. A thread waits for them, sets the stop flag and returns the number of
/// packets sent.
fn sensors(
    data: u16,
    position: u16,
    seconds: u64,
    stop: Arc<AtomicBool>,
) -> Result<thread::JoinHandle<Result<u64, String>>, Box<dyn Error>> {
    let mut child = Command::new(std::env::current_exe()?)
        .args(["--send", &data.to_string(), &position.to_string()])
        .args(["--seconds", &seconds.to_string()])
        .stdout(Stdio::piped())
        .spawn()?;
    Ok(thread::spawn(move || {
        let lines = child.stdout.take().map(BufReader::new);
        let line = lines.and_then(|lines| lines.lines().next());
        let ended = child.wait();
        thread::sleep(GRACE);
        stop.store(true, Ordering::Release);
        let line = line.ok_or(format!("no line from the sensors: {ended:?}"))?;
        let line = line.map_err(|e| e.to_string())?;
        line.parse()
            .map_err(|e| format!("unexpected line {line:?} from the sensors: {e}"))
    }))
}

/// Counts the lidar's packets in the log.
fn read_back(path: &PathBuf, seconds: u64) -> Result<u64, Box<dyn Error>> {
    let begin = Instant::now();
    let mut recording = Recording::open(path)?;
    let mut packets = 0;
    while let Some(record) = recording.next_record()? {
        if let Wire::Lidar { payload, .. } = record.wire {
            packets += u64::from(DatagramKind::of(payload).is_lidar());
        }
    }
    let took_s = begin.elapsed().as_secs_f64();
    let bytes = std::fs::metadata(path)?.len() as f64;
    println!(
        "in the log                 {packets} ({:.1} MB; read back in {took_s:.2} s, {:.0} MB/s, {:.0} x real time)",
        bytes / 1e6,
        bytes / 1e6 / took_s,
        seconds as f64 / took_s
    );
    Ok(packets)
}
