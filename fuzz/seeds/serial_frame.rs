//! Frames of the serial links, sessions of a client with the simulated unit, and logs of such.

use protocol::epos2::message::{
    InitiateSegmentedRead, ReadObject, RequestCanFrame, SegmentedRead, WriteObject,
};
use protocol::epos2::{SerialFrame, objects, rs232, usb};

use crate::Seed;

/// Modes of `properties::serial_frame`.
const USB_BYTES: u8 = 0;
const USB_NOISE: u8 = 1;
const RS232_BYTES: u8 = 2;
const RS232_FRAME: u8 = 3;
const USB_SERVER: u8 = 4;
const RS232_SERVER: u8 = 5;
const CLIENT: u8 = 6;
const LOG: u8 = 7;

pub fn seeds() -> Vec<Seed> {
    let mut seeds = Vec::new();
    let mut add = |name: &str, parts: &[&[u8]]| seeds.push((name.to_owned(), parts.concat()));
    let requests = requests();
    let framed: Vec<u8> = requests
        .iter()
        .flat_map(|frame| usb::to_bytes(frame).as_slice().to_vec())
        .collect();
    add("usb-bytes", &[&[USB_BYTES], &framed]);
    add("usb-broken-off", &[&[USB_BYTES], &framed[..20], &framed]);
    add(
        "usb-noise",
        &[
            &[USB_NOISE, 0x10, 2, 0x64, 0x60, 0x90, 0x90],
            &framed[..21],
            &[0x90],
        ],
    );
    let mut bodies = Vec::new();
    for frame in requests
        .iter()
        .filter(|frame| frame.opcode == ReadObject::OPCODE)
    {
        rs232::encode_body(frame, &mut bodies).expect("requests have words");
    }
    add(
        "rs232-bytes",
        &[&[RS232_BYTES, ReadObject::OPCODE], &bodies],
    );
    add(
        "rs232-frame",
        &[&[RS232_FRAME, 0x11, 4, 1, 2, 3, 4, 5, 6, 7, 8]],
    );
    for (name, mode) in [("usb", USB_SERVER), ("rs232", RS232_SERVER)] {
        let mut script = vec![mode];
        for frame in &requests {
            script.extend([0x80, 1, frame.opcode, frame.words.len() as u8]);
            script.extend(frame.words.iter().flat_map(|word| word.to_le_bytes()));
        }
        add(&format!("{name}-server"), &[&script]);
    }
    for (link, name) in [(0, "usb"), (1, "rs232"), (2, "can")] {
        for (kind, script) in sessions() {
            add(
                &format!("client-{name}-{kind}-marked"),
                &[&[CLIENT, link | 0x80], &script],
            );
            add(
                &format!("client-{name}-{kind}"),
                &[&[CLIENT, link], &script],
            );
        }
        add(&format!("log-{name}"), &[&[LOG], &log(link)]);
    }
    seeds
}

fn requests() -> Vec<SerialFrame> {
    let read = |address| ReadObject { node: 1, address }.to_frame();
    let write = |address, value| {
        WriteObject {
            node: 1,
            address,
            value,
        }
        .to_frame()
    };
    let name = objects::DEVICE_NAME;
    vec![
        read(objects::POSITION_ACTUAL.address),
        read(objects::STATUSWORD.address),
        write(objects::CONTROLWORD.address, 0x80),
        write(objects::CONTROLWORD.address, 0x06),
        write(objects::CONTROLWORD.address, 0x0F),
        InitiateSegmentedRead {
            node: 1,
            address: name,
        }
        .to_frame(),
        SegmentedRead { toggle: false }.to_frame(),
        SerialFrame::new(RequestCanFrame::OPCODE, &[0x701, 8]).expect("few words"),
    ]
}

/// Steps of `properties::drive_link`: 3 starts, 2 runs undisturbed for 16 iterations per count, 7
/// to 12 move bytes in transit.
fn sessions() -> [(&'static str, Vec<u8>); 5] {
    let connect = [3, 0, 0, 2, 60];
    let home = [3, 0, 1, 2, 40];
    let sweep = [3, 8, 3, 2, 60];
    let hold = [3, 0, 4, 2, 12];
    [
        (
            "well",
            [&connect[..], &home, &sweep, &[3, 0, 5, 2, 30]].concat(),
        ),
        ("hold", [&connect[..], &hold, &[3, 0, 8, 2, 10]].concat()),
        (
            "loss",
            [
                &connect[..],
                &[
                    3, 0, 4, 2, 1, 7, 11, 6, 3, 7, 8, 12, 6, 60, 6, 60, 2, 5, 7, 8, 10, 3, 5, 200,
                    10, 9, 2, 9,
                ],
                &[3, 0, 5, 2, 9],
            ]
            .concat(),
        ),
        (
            "late",
            [
                &connect[..],
                &[3, 0, 4, 0, 5, 7, 8],
                &[6, 63].repeat(9),
                &[7, 8, 9, 2, 3],
            ]
            .concat(),
        ),
        (
            "forged",
            [
                &connect[..],
                &[3, 0, 4, 7, 15, 16, 1, 2, 3, 4, 15, 1, 5, 0x40, 9, 2, 9],
            ]
            .concat(),
        ),
    ]
}

/// Records of `properties::drive_log`: requests for the position and answers, 0.1 ms apart.
fn log(link: u8) -> Vec<u8> {
    // The smallest header of the link: its number modulo 3 selects the link, higher bits the rest.
    let head = |bits: u8| {
        (bits..=bits + 7)
            .find(|head| head % 3 == link)
            .unwrap_or(bits)
    };
    let mut log = 1_795_000_000_000_000_000_i64.to_le_bytes().to_vec();
    for n in 0..8_u8 {
        log.extend([head(0x48), 100, 0, 0, 0, 0, 0]);
        log.extend([head(0x68), 100, 0, n, 1, 0, 0]);
    }
    log
}
