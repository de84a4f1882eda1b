//! velodyne-lidar's side of the benchmark: `peers-velodyne-lidar FOLDER RECORDING CONFIGURATION`.
//!
//! Reads a name of a measurement per line of stdin, and answers with CPU seconds, seconds, passes
//! and points. Points are the returns with a distance; the crate outputs a point for every channel,
//! and never the last revolution, which it keeps until the next one.

use std::hint::black_box;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use velodyne_lidar::types::frame_xyz::FrameXyz;
use velodyne_lidar::types::measurements::Measurement;
use velodyne_lidar::{Config, DataPacket, iter};

/// Minimum duration of a measurement, seconds: that of the other workers.
const LEAST_S: f64 = 0.1;
const PACKET: usize = 1206;
const HOST_TIME: usize = 8;

fn main() -> eyre::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, recording, configuration] = &arguments[..] else {
        eyre::bail!("usage: peers-velodyne-lidar FOLDER RECORDING CONFIGURATION");
    };
    let config = match configuration.as_str() {
        "VLP-16 single" => Config::new_vlp_16_strongest(),
        "VLP-16 dual" => Config::new_vlp_16_dual(),
        "VLP-32C single" => Config::new_vlp_32c_strongest(),
        "VLP-32C dual" => Config::new_vlp_32c_dual(),
        other => eyre::bail!("the crate has no table for {other}"),
    };
    let bytes = std::fs::read(Path::new(folder).join("packets.bin"))?;
    let packets: Vec<[u8; PACKET]> = bytes
        .chunks_exact(HOST_TIME + PACKET)
        .filter_map(|record| record[HOST_TIME..].try_into().ok())
        .collect();
    // Its types are casts of the bytes, so invalid bytes must not reach them.
    let sound = |bytes: &&[u8; PACKET]| {
        let flags = bytes.chunks_exact(100).take(12);
        let factory = matches!(bytes[1204], 0x37..=0x39)
            && matches!(bytes[1205], 0x21..=0x24 | 0x28 | 0x31 | 0xA1);
        factory
            && flags
                .into_iter()
                .all(|block| block.starts_with(&[0xFF, 0xEE]))
    };
    let memory = |take: &mut dyn FnMut(FrameXyz)| -> eyre::Result<()> {
        let packets = packets.iter().filter(sound);
        let packets = packets.map(|bytes| DataPacket::from_bytes(*bytes));
        iter::data_packet_to_frame_xyz(config.clone(), packets)?.for_each(take);
        Ok(())
    };
    let file = |take: &mut dyn FnMut(FrameXyz)| -> eyre::Result<()> {
        for frame in iter::frame_xyz_iter_from_file(config.clone(), recording)? {
            match frame {
                Ok(frame) => take(frame),
                // A file that is cut off: what was before the cut counts.
                Err(_) => break,
            }
        }
        Ok(())
    };
    let pass = |name: &str, take: &mut dyn FnMut(FrameXyz)| match name {
        "handed on" => memory(take),
        "kept" => {
            let mut frames = Vec::new();
            memory(&mut |frame| frames.push(frame))?;
            frames.into_iter().for_each(take);
            Ok(())
        }
        "file" => file(take),
        other => eyre::bail!("no such work: {other}"),
    };
    println!("{{}}");
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        // How many points one pass gives is counted outside the measurement.
        let mut points = 0;
        pass(&line, &mut |frame| points += returns(&frame))?;
        let mut passes = 0;
        let (start, core) = (Instant::now(), core_s());
        while passes == 0 || start.elapsed().as_secs_f64() < LEAST_S {
            pass(&line, &mut |frame| drop(black_box(frame)))?;
            passes += 1;
        }
        let (seconds, wall) = (core_s() - core, start.elapsed().as_secs_f64());
        let points = points * passes;
        println!(r#"{{"seconds":{seconds},"wall_s":{wall},"passes":{passes},"points":{points}}}"#);
        std::io::stdout().flush()?;
    }
    Ok(())
}

/// Channels with a distance; of a dual pair with equal distances, one.
fn returns(frame: &FrameXyz) -> usize {
    let some = |m: &Measurement| usize::from(m.distance.as_meters() > 0.0);
    let mut count = 0;
    for firing in frame.firing_iter() {
        for point in firing.point_iter() {
            if let Some(point) = point.as_single() {
                count += some(&point.measurement);
            }
            if let Some(point) = point.as_dual() {
                let (a, b) = (point.measurement_strongest(), point.measurement_last());
                count += some(a);
                count += if a.distance == b.distance { 0 } else { some(b) };
            }
        }
    }
    count
}

/// Seconds for which this process has had the core.
fn core_s() -> f64 {
    let clock = nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID;
    let time = clock.now().expect("Linux");
    time.tv_sec() as f64 + time.tv_nsec() as f64 * 1e-9
}
