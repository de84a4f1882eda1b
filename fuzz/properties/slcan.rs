//! SLCAN lines in both directions, and the simulated adapter: lines decode to what was encoded,
//! noise never destroys a frame after a CR, and every command is answered.

use firmware_sim::epos2::{SimulatedDrive, SimulatedDriveConfig, SlcanServer};
use protocol::canopen::slcan::{CommandDecoder, ReplyDecoder, SlcanCommand, SlcanReply};

use super::can_frames::frame;
use super::input::Input;

/// Mode 0: any bytes to both decoders. 1: a frame after any bytes. Else the adapter with a unit.
pub fn holds(data: &[u8]) {
    let mut input = Input::new(data);
    match input.u8() % 3 {
        0 => any_bytes(input.rest()),
        1 => frame_behind_noise(&mut input),
        _ => adapter(&mut input),
    }
}

fn replies(bytes: &[u8]) -> Vec<Option<SlcanReply>> {
    let mut decoder = ReplyDecoder::new();
    let pushed = bytes.iter().filter_map(|&byte| decoder.push(byte));
    pushed.map(Result::ok).collect()
}

fn commands(bytes: &[u8]) -> Vec<Option<SlcanCommand>> {
    let mut decoder = CommandDecoder::new();
    let pushed = bytes.iter().filter_map(|&byte| decoder.push(byte));
    pushed.map(Result::ok).collect()
}

fn any_bytes(bytes: &[u8]) {
    for reply in replies(bytes).into_iter().flatten() {
        let mut again = Vec::new();
        reply.encode(&mut again);
        assert_eq!(replies(&again), [Some(reply)], "{again:X?}");
    }
    for command in commands(bytes).into_iter().flatten() {
        let mut again = Vec::new();
        command.encode(&mut again);
        assert_eq!(commands(&again), [Some(command)], "{again:X?}");
    }
}

fn frame_behind_noise(input: &mut Input<'_>) {
    let frame = frame(input);
    let stamp = input.u16();
    let reply = SlcanReply::Received {
        frame,
        stamp_ms: (stamp & 1 == 0).then_some(stamp >> 1),
    };
    let noise = input.rest();
    let mut bytes = [noise, b"\r"].concat();
    reply.encode(&mut bytes);
    assert_eq!(replies(&bytes).last(), Some(&Some(reply)));

    let mut bytes = [noise, b"\r"].concat();
    SlcanCommand::Transmit(frame).encode(&mut bytes);
    assert_eq!(
        commands(&bytes).last(),
        Some(&Some(SlcanCommand::Transmit(frame)))
    );
}

fn adapter(input: &mut Input<'_>) {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig::default());
    let mut server = SlcanServer::new();
    // A second decoder of the same bytes counts the expected answers.
    let mut shadow = CommandDecoder::new();
    while !input.is_empty() {
        match input.u8() % 4 {
            0 => {
                for _ in 0..=input.u8() {
                    node.tick();
                    server.poll(&mut node, &mut |line| {
                        assert!(is_frame(line), "{line:X?}");
                    });
                }
            }
            1 => node.set_phase_us(input.u16().into()),
            2 => {
                let mut line = Vec::new();
                SlcanCommand::Transmit(frame(input)).encode(&mut line);
                feed(&mut server, &mut node, &mut shadow, &line);
            }
            _ => feed(&mut server, &mut node, &mut shadow, input.short()),
        }
    }
}

/// Passes bytes to the adapter; each command is answered once, in addition to frames of the bus.
fn feed(
    server: &mut SlcanServer,
    node: &mut SimulatedDrive,
    shadow: &mut CommandDecoder,
    bytes: &[u8],
) {
    let commands = bytes.iter().filter_map(|&byte| shadow.push(byte)).count();
    let mut answered = 0;
    server.input(node, bytes, &mut |line| {
        answered += usize::from(!is_frame(line));
    });
    assert_eq!(answered, commands);
}

/// Whether a line contains a frame; else it answers a command.
fn is_frame(line: &[u8]) -> bool {
    match replies(line).as_slice() {
        [Some(SlcanReply::Received { .. })] => true,
        [Some(SlcanReply::Unknown(_)) | None] | [] | [_, _, ..] => panic!("no reply: {line:X?}"),
        [Some(_)] => false,
    }
}
