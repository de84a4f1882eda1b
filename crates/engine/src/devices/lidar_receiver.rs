//! Receives the lidar's packets on a thread, with or without a log.
//!
//! A log's recording begins and ends between two turns of that thread, so that counts belong
//! exactly to the log.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use io::log::RecorderHandle;
use io::udp::{GATHER, LidarListener, ListenCounts, UdpError};
use protocol::record::{Record, Wire};

use crate::devices::lidar_sockets::{DATA_PORT, LidarSockets, POSITION_PORT};
use crate::devices::simulated::LidarPorts;
use crate::failure::{Failure, Kind};
use crate::threads::spawn;

/// Time for which packets are collected without a log: their times are the kernel's, and rates are
/// read every second.
const UNRECORDED: Duration = Duration::from_millis(50);
/// A thread that does not answer within this time is lost: it checks requests every 50 ms.
const TURN_LIMIT: Duration = Duration::from_secs(10);

/// Callback for every record of the lidar. It must not block: it runs on the receiving thread.
pub type PacketTap = Box<dyn FnMut(&Record<'_>) + Send>;

/// A lidar whose packets are received until this is dropped.
pub struct LidarReceiver {
    shared: Arc<ReceiverState>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct ReceiverState {
    /// Set to make the thread check its requests.
    turn: AtomicBool,
    stop: AtomicBool,
    packets: AtomicU64,
    requests: Mutex<Requests>,
}

#[derive(Default)]
struct Requests {
    waiting: Vec<CountsRequest>,
    failed: Option<Failure>,
}

/// New destination of records, and the receiver of the counts at that moment.
struct CountsRequest {
    /// `Some(None)` ends the recording, `None` only asks for the counts.
    log: Option<Option<RecorderHandle>>,
    answer: Sender<Result<ListenCounts, Failure>>,
}

impl ReceiverState {
    fn requests(&self) -> MutexGuard<'_, Requests> {
        self.requests.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl LidarReceiver {
    /// Starts to receive.
    ///
    /// # Errors
    /// Returns [`Kind::NoDevice`] if the system provides no thread.
    pub fn start(sockets: LidarSockets, tap: PacketTap) -> Result<Self, Failure> {
        let shared = Arc::new(ReceiverState::default());
        let theirs = Arc::clone(&shared);
        let run = move || listen(sockets, tap, &theirs);
        let thread = spawn("lidar", "the lidar", run)?;
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// Number of packets received so far.
    #[must_use]
    pub fn packets(&self) -> u64 {
        self.shared.packets.load(Ordering::Relaxed)
    }

    /// Whether the thread runs and no socket has failed.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.shared.requests().failed.is_none()
            && self
                .thread
                .as_ref()
                .is_some_and(|thread| !thread.is_finished())
    }

    /// Counts so far.
    ///
    /// # Errors
    /// Returns the failure of the sockets.
    pub fn counts(&self) -> Result<ListenCounts, Failure> {
        self.ask(None)
    }

    /// Sends records to `log` from now on, or to none. Returns the counts of what went to the
    /// previous destination.
    ///
    /// # Errors
    /// Returns the failure of the sockets.
    pub fn record_to(&self, log: Option<RecorderHandle>) -> Result<ListenCounts, Failure> {
        self.ask(Some(log))
    }

    fn ask(&self, log: Option<Option<RecorderHandle>>) -> Result<ListenCounts, Failure> {
        let (answer, counts) = channel();
        {
            let mut requests = self.shared.requests();
            if let Some(failure) = &requests.failed {
                return Err(failure.clone());
            }
            requests.waiting.push(CountsRequest { log, answer });
        }
        self.wake_thread();
        counts.recv_timeout(TURN_LIMIT).unwrap_or_else(|_| {
            Err(
                Failure::new(Kind::Incomplete, "the lidar's thread does not answer")
                    .help("this is a defect of the program; run with -vv and report the messages"),
            )
        })
    }
}

impl LidarReceiver {
    fn wake_thread(&self) {
        self.shared.turn.store(true, Ordering::Release);
        if let Some(thread) = &self.thread {
            thread.thread().unpark();
        }
    }
}

impl Drop for LidarReceiver {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Release);
        self.wake_thread();
        if let Some(thread) = self.thread.take() {
            // A panic of that thread has been reported by the requests for its counts.
            let _ = thread.join();
        }
    }
}

fn listen(sockets: LidarSockets, mut tap: PacketTap, shared: &ReceiverState) {
    let LidarSockets {
        mut listener,
        ports,
    } = sockets;
    let mut log = None;
    while !shared.stop.load(Ordering::Acquire) {
        listener.gather(match log {
            Some(_) => GATHER,
            None => UNRECORDED,
        });
        let received = receive_until_request(&mut listener, ports, log.as_ref(), &mut tap, shared);
        // Reset before the requests are read: a later request sets it again.
        shared.turn.store(false, Ordering::Release);
        let mut requests = shared.requests();
        let received = received.map_err(|error| Failure {
            kind: Kind::Incomplete,
            ..lidar_failure(&error)
        });
        for request in requests.waiting.drain(..) {
            if let Some(wanted) = request.log {
                log = wanted;
            }
            // A client that has ended needs no answer.
            let _ = request.answer.send(received.clone());
        }
        if let Err(failure) = received {
            requests.failed = Some(failure);
            return;
        }
    }
}

/// Receives until a request arrives.
fn receive_until_request(
    listener: &mut LidarListener,
    ports: LidarPorts,
    log: Option<&RecorderHandle>,
    tap: &mut PacketTap,
    shared: &ReceiverState,
) -> Result<ListenCounts, UdpError> {
    listener.run(&shared.turn, |record| {
        shared.packets.fetch_add(1, Ordering::Relaxed);
        let record = with_port_of_the_lidar(record, ports);
        if let Some(log) = log {
            log.record(&record);
        }
        tap(&record);
    })
}

/// Gives a record the port that the lidar has by its manual, so that logs do not depend on the
/// local port.
fn with_port_of_the_lidar<'a>(record: &Record<'a>, local: LidarPorts) -> Record<'a> {
    let mut record = *record;
    if let Wire::Lidar { port, .. } = &mut record.wire {
        if *port == local.data {
            *port = DATA_PORT;
        } else if *port == local.position {
            *port = POSITION_PORT;
        }
    }
    record
}

/// Failure of the lidar's sockets, with help.
#[must_use]
pub fn lidar_failure(error: &UdpError) -> Failure {
    let help = match error {
        UdpError::Busy { .. } => {
            "close the other program that listens to the lidar (another capture, VeloView, a ROS driver)"
        }
        UdpError::NoInterface { .. } => {
            "give lidar in the device's profile an address of this machine, or 0.0.0.0"
        }
        UdpError::Io { action: "join", .. } => {
            "see whether lidar in the device's profile is the address of an interface that is up, or, where it is 0.0.0.0, whether a\n\
             route to lidar_group exists (ip route get GROUP)"
        }
        UdpError::Io { .. } => {
            "see whether the network interface is up and this user may open sockets"
        }
    };
    Failure::new(Kind::NoDevice, error.to_string()).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use io::log::{LogConfig, LogRecorder, LogWriter};
    use io::udp::ListenConfig;
    use std::net::{Ipv4Addr, UdpSocket};

    fn receiver() -> (LidarReceiver, UdpSocket) {
        let config = ListenConfig {
            address: Ipv4Addr::LOCALHOST,
            data_port: 0,
            position_port: Some(0),
            ..ListenConfig::default()
        };
        let sockets = LidarSockets::bind(&config).unwrap();
        let to = sockets.ports.data;
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.connect((Ipv4Addr::LOCALHOST, to)).unwrap();
        (
            LidarReceiver::start(sockets, Box::new(|_| {})).unwrap(),
            socket,
        )
    }

    #[test]
    fn a_log_gets_exactly_the_packets_between_start_and_stop() {
        let (receiver, socket) = receiver();
        let send = |n| (0..n).for_each(|_| assert_eq!(socket.send(&[7; 100]).unwrap(), 100));
        send(3);
        // On loopback a datagram is in the receiver's queue when it is sent.
        let writer = LogWriter::new(Vec::new(), &LogConfig::default()).unwrap();
        let log = LogRecorder::start(writer).unwrap();
        let before = receiver.record_to(Some(log.handle())).unwrap();
        assert_eq!(before.data, 3);
        send(5);
        let after = receiver.record_to(None).unwrap();
        assert_eq!(after.data, 8);
        send(2);
        assert_eq!(receiver.counts().unwrap().data, 10);
        assert_eq!(receiver.packets(), 10);
        assert_eq!(log.finish().unwrap().log.lidar, 5);
    }
}
