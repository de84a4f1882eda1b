//! The simulated EPOS2 on a CAN interface of the kernel (`velomotion firmware-sim --can vcan0`)
//! with two CANopen masters: one written for the test and the project's client.
//!
//! If the kernel has no CAN, `in-vm` runs this test program in an emulated machine. The logs of the
//! client and of `candump` are then read outside, by tshark too.

mod bus;
mod candump;
mod client;
mod logs;
mod stream;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use engine::config::AxisSettings;
use engine::devices::profile as devices;
use engine::devices::simulated;
use engine::devices::simulated_drive::{self, SimulatedDriveError, SimulatedPort};
use io::can::SocketCan;
use io::clock;
use protocol::canopen::emcy::Emergency;
use protocol::canopen::heartbeat::{HeartbeatConsumer, HeartbeatEvent};
use protocol::canopen::nmt::{Nmt, NmtCommand, NmtState};
use protocol::canopen::sdo::TransferError;
use protocol::canopen::{CanFrame, CommunicationObject, NodeId, PdoNumber};
use protocol::epos2::cia402::{DeviceState, control};
use protocol::epos2::objects::{self, Address};
use protocol::epos2::{AbortCode, DeviceError};
use sim::Attachment;
use tempfile::TempDir;
use units::Span;

use bus::Master;

const BUS: &str = "vcan0";
/// Set where the bus exists.
const INSIDE: &str = "VELOMOTION_VCAN_INSIDE";
/// Producer period of the node's heartbeat, ms.
const HEARTBEAT_MS: u16 = 50;
/// Silence after which a node counts as lost.
const LOST: Span = Span::from_secs(2);

/// Folder for files that leave the emulated machine.
const OUT: &str = "VELOMOTION_VCAN_OUT";

#[test]
#[ignore = "needs QEMU or the CAN interface vcan0, candump, tshark"]
fn the_simulated_drive_and_a_master_communicate_on_vcan() {
    if std::env::var_os(INSIDE).is_some() {
        drive_and_master();
    } else {
        run_inside("the_simulated_drive_and_a_master_communicate_on_vcan");
    }
}

#[test]
#[ignore = "needs QEMU or the CAN interface vcan0, candump, tshark"]
fn the_client_homes_and_sweeps_on_vcan() {
    if std::env::var_os(INSIDE).is_some() {
        let drive = SoftwareDrive::start();
        client::sweep(Path::new(&std::env::var_os(OUT).unwrap()));
        drive.stop();
    } else {
        let logs = run_inside("the_client_homes_and_sweeps_on_vcan");
        logs::check(logs.path());
    }
}

/// Runs the test `name` where the bus exists. Returns a folder with the files that it left.
fn run_inside(name: &str) -> TempDir {
    let runner = Path::new(env!("CARGO_MANIFEST_DIR")).join("foreign/vcan/in-vm");
    let out = tempfile::tempdir().unwrap();
    let mut command = Command::new(&runner);
    command.args(["--env", &format!("{INSIDE}=1"), "--out"]);
    command.arg(out.path());
    command.arg("--file");
    command.arg(format!("{}:/bin/candump", candump().display()));
    command
        .arg("--")
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", name, "--nocapture", "--include-ignored"]);
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}", runner.display()));
    let printed = [&output.stdout[..], &output.stderr].concat();
    let printed = String::from_utf8_lossy(&printed);
    println!("{printed}");
    assert!(output.status.success(), "{}", output.status);
    assert!(printed.contains("1 passed"), "no test has this name");
    out
}

/// The path of `candump`.
fn candump() -> PathBuf {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders)
        .map(|folder| folder.join("candump"))
        .find(|file| file.is_file())
        .expect("candump, of the Debian package can-utils")
}

/// The simulated drive on the bus, in a thread.
struct SoftwareDrive {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<Result<(), SimulatedDriveError>>,
}

impl SoftwareDrive {
    fn start() -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let stopping = Arc::clone(&stop);
        let node = simulated::node(&devices::axis(&AxisSettings::default()).unwrap());
        let port = SimulatedPort::Can(SocketCan::open(BUS).unwrap());
        let run = move || simulated_drive::run(node, Attachment::Can, port, &stopping);
        let thread = std::thread::spawn(run);
        Self { stop, thread }
    }

    fn stop(self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap().unwrap();
    }
}

fn drive_and_master() {
    let node = NodeId::new(1).unwrap();
    let mut master = Master::open(BUS, node);
    let mut consumer = HeartbeatConsumer::new(node, LOST);
    let drive = SoftwareDrive::start();
    expect_state(&mut master, &mut consumer, NmtState::BootUp);
    identity(&mut master);
    aborts(&mut master);
    stream::map_angle(&mut master, node);
    master.write(objects::PRODUCER_HEARTBEAT, HEARTBEAT_MS);
    expect_state(&mut master, &mut consumer, NmtState::PreOperational);
    let command = NmtCommand::Start;
    let start = Nmt {
        node: Some(node),
        command,
    };
    master.send(&start.to_frame());
    expect_state(&mut master, &mut consumer, NmtState::Operational);
    stream::enable_and_rotate(&mut master);
    println!("{}", stream::one_second(&mut master, node));
    stream::halt(&mut master);
    emergency(&mut master, node);
    drive.stop();
    heartbeat_is_lost(&mut master, &mut consumer);
}

/// Waits until the node reports the state `wanted`.
fn expect_state(master: &mut Master, consumer: &mut HeartbeatConsumer, wanted: NmtState) {
    let consumer = std::cell::RefCell::new(consumer);
    let event = master.wait_for(&format!("a heartbeat: {wanted}"), |(frame, host)| {
        consumer.borrow_mut().handle_frame(frame, *host)
    });
    match event {
        HeartbeatEvent::BootUp => assert_eq!(wanted, NmtState::BootUp),
        HeartbeatEvent::State { to, .. } => assert_eq!(to, wanted),
        HeartbeatEvent::Lost { silence } => panic!("{silence:?}"),
    }
}

/// Reads the identity: numbers in one exchange, the name in one segment, the serial number in two.
fn identity(master: &mut Master) {
    assert_eq!(master.read(objects::DEVICE_TYPE), 0x0002_0192);
    assert_eq!(master.read(objects::VENDOR_ID), 0xFB);
    assert_eq!(master.read(objects::PRODUCT_CODE), 0x6420_0000);
    assert_eq!(master.read(objects::REVISION), 0x2126_0000);
    let name = master.read_raw(objects::DEVICE_NAME).unwrap();
    assert_eq!(name.as_slice(), b"EPOS2");
    let serial = master.read_raw(objects::SERIAL_NUMBER_64).unwrap();
    let low = master.read(objects::SERIAL_NUMBER);
    assert_eq!(serial.len(), 8);
    assert_eq!(serial[..4], low.to_le_bytes());
}

/// Checks that aborts carry their reason (CiA 301, "SDO abort codes") and that the next transfer
/// works.
fn aborts(master: &mut Master) {
    let refused = |error| Err(TransferError::Aborted(error));
    let read = master.read_raw(Address::new(0x5FFF, 0)).map(drop);
    assert_eq!(read, refused(AbortCode::NO_OBJECT));
    let device_type = objects::DEVICE_TYPE.address;
    let written = master.write_raw(device_type, &[0; 4]);
    assert_eq!(written, refused(AbortCode::READ_ONLY));
    let written = master.write_raw(device_type, &[0; 12]);
    assert!(
        matches!(written, Err(TransferError::Aborted(_))),
        "{written:?}"
    );
    assert_eq!(master.read(objects::DEVICE_TYPE), 0x0002_0192);
}

/// Checks error 8210 for process data that is too short: sent at once, kept in the history, and its
/// end sent, too.
fn emergency(master: &mut Master, node: NodeId) {
    let reported = |(frame, _): &bus::ReceivedFrame| Emergency::parse(frame).ok();
    master.take_received();
    let id = CommunicationObject::ReceivePdo(PdoNumber::One, node).cob_id();
    master.send(&CanFrame::of(id, [0x06]));
    let emergency = master.wait_for("an emergency message", reported);
    assert_eq!(emergency.node, node);
    assert_eq!(emergency.code, DeviceError::PDO_LENGTH.0);
    assert_ne!(emergency.register, 0);
    assert_eq!(master.read(objects::ERROR_REGISTER), emergency.register);
    let latest = master.read(objects::ERROR_HISTORY_1);
    assert_eq!(latest & 0xFFFF, u32::from(DeviceError::PDO_LENGTH.0));
    stream::wait_for_state(master, DeviceState::Fault);
    master.write(objects::CONTROLWORD, control::FAULT_RESET);
    assert!(master.wait_for("the end of the error", reported).is_reset());
    stream::wait_for_state(master, DeviceState::SwitchOnDisabled);
}

/// Checks that the loss of a node is detected.
fn heartbeat_is_lost(master: &mut Master, consumer: &mut HeartbeatConsumer) {
    master.listen(clock::now());
    for (frame, host) in master.take_received() {
        assert_eq!(consumer.handle_frame(&frame, host), None, "{frame}");
    }
    let end = consumer.poll_timeout().unwrap();
    master.listen(end);
    assert_eq!(master.take_received(), []);
    assert!(matches!(
        consumer.handle_timeout(end),
        Some(HeartbeatEvent::Lost { silence }) if silence == LOST
    ));
}
