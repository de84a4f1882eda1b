//! velomotion's ray caster and two crates, for `benches/rays/run`: writes scenes and rays to a
//! folder, then does the work that it is named on standard input and answers how long that took.
//!
//! usage: rays FOLDER

use std::fs::File;
use std::io::{BufRead, BufWriter, Write};
use std::path::Path;
use std::time::Duration;

use nix::time::{ClockId, clock_gettime};
use sim::cast::{Caster, Cuboid, Hit, Mesh, Object, Ray, Reach};

mod crates;
mod scene;

use scene::Triangles;

/// A turn lasts at least this long.
const TURN_S: f64 = 0.3;

fn seconds(clock: ClockId) -> f64 {
    Duration::from(clock_gettime(clock).expect("Linux has this clock")).as_secs_f64()
}

/// Repeats the work; returns the number of rays, the CPU time and the elapsed time.
fn timed(rays: usize, mut work: impl FnMut()) -> String {
    work();
    let (cpu, wall) = (
        seconds(ClockId::CLOCK_PROCESS_CPUTIME_ID),
        seconds(ClockId::CLOCK_MONOTONIC),
    );
    let mut passes = 0;
    while seconds(ClockId::CLOCK_MONOTONIC) - wall < TURN_S {
        work();
        passes += 1;
    }
    let (cpu, wall) = (
        seconds(ClockId::CLOCK_PROCESS_CPUTIME_ID) - cpu,
        seconds(ClockId::CLOCK_MONOTONIC) - wall,
    );
    format!(
        r#"{{"rays": {}, "seconds": {cpu}, "wall_s": {wall}}}"#,
        rays * passes
    )
}

fn write<const N: usize>(path: &Path, rows: impl Iterator<Item = [f64; N]>) -> std::io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    for value in rows.flatten() {
        file.write_all(&value.to_le_bytes())?;
    }
    file.flush()
}

fn publish(folder: &Path, name: &str, of: &Triangles) -> std::io::Result<()> {
    write(
        &folder.join(format!("{name}.vertices.f64")),
        of.vertices.iter().map(|v| v.to_array()),
    )?;
    let triangles = of.triangles.iter().map(|corners| corners.map(f64::from));
    write(&folder.join(format!("{name}.triangles.f64")), triangles)
}

/// Casts rays on so many threads.
fn together(caster: &Caster, rays: &[Ray], threads: usize) -> String {
    let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
    let firings = rays.len().div_ceil(scene::BEAMS).div_ceil(threads);
    timed(rays.len(), || {
        std::thread::scope(|scope| {
            let parts = rays.chunks(firings * scene::BEAMS);
            let mut parts = parts.zip(hits.chunks_mut(firings * scene::BEAMS));
            let own = parts.next();
            for (rays, hits) in parts {
                scope.spawn(move || caster.nearest_of(rays, scene::BEAMS, Reach::default(), hits));
            }
            if let Some((rays, hits)) = own {
                caster.nearest_of(rays, scene::BEAMS, Reach::default(), hits);
            }
        });
    })
}

fn one_by_one(caster: &Caster, rays: &[Ray]) -> String {
    let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
    timed(rays.len(), || {
        for (ray, hit) in rays.iter().zip(&mut hits) {
            *hit = caster.nearest(ray, Reach::default());
        }
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).ok_or("usage: rays FOLDER")?;
    let folder = Path::new(&folder);
    let rays = scene::rays();
    write(
        &folder.join("rays.f64"),
        rays.iter().map(|ray| {
            let ([a, b, c], [d, e, f]) = (ray.origin_m().to_array(), ray.direction().to_array());
            [a, b, c, d, e, f]
        }),
    )?;
    let scenes = [("box", scene::room()), ("mesh", scene::cave())];
    let mut casters = Vec::new();
    for (name, of) in &scenes {
        publish(folder, name, of)?;
        let caster = Caster::new([Object::new(Mesh::new(&of.vertices, &of.triangles)?)])?;
        let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
        caster.nearest_of(&rays, scene::BEAMS, Reach::default(), &mut hits);
        write(
            &folder.join(format!("{name}.ranges.f64")),
            hits.iter()
                .map(|hit| [hit.map_or(f64::INFINITY, |hit| hit.range_m)]),
        )?;
        casters.push(caster);
    }
    let solid = Caster::new([Object::new(Cuboid::new(
        glam::DVec3::new(-10.0, -10.0, -2.0),
        glam::DVec3::new(10.0, 10.0, 3.0),
    ))])?;
    let cores = std::thread::available_parallelism()?.get();
    println!(
        r#"{{"rays": {}, "triangles": {}}}"#,
        rays.len(),
        scenes[1].1.triangles.len()
    );
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let (name, how) = line.split_once(' ').ok_or("expected a scene and a way")?;
        let at = usize::from(name == "mesh");
        let (of, caster) = (&scenes[at].1, &casters[at]);
        println!(
            "{}",
            match how {
                "together" => together(caster, &rays, 1),
                "one" => one_by_one(caster, &rays),
                "cores" => together(caster, &rays, cores),
                "solid" => together(&solid, &rays, 1),
                "build" => timed(of.triangles.len(), || drop(Mesh::new(
                    &of.vertices,
                    &of.triangles
                ))),
                "obvhs" => crates::obvhs(of, &rays),
                "bvh" => crates::bvh(of, &rays),
                _ => return Err(format!("unknown: {line}").into()),
            }
        );
    }
    Ok(())
}
