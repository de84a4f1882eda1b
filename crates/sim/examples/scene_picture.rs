//! A picture of a scene, PNG on standard output: `cargo run --release -p velomotion-sim --example
//! scene_picture -- hall > hall.png`.
//!
//! Above, the scene from outside in sunlight, with what a level VLP-16 at the origin meets in one
//! turn; nearer walls and the ceiling of what encloses the scanner are cut away. Below, all that
//! can be seen from the scanner, 360 by 105 degrees: nearer is brighter and warmer, and what
//! returns nothing is black. Takes the name of a shipped scene, and six numbers for another camera:
//! where it is and what it looks at (metres). With `--scan` behind the name, the points of the
//! scene's own scan from outside, coloured by height: their true places, without errors of range
//! and angle.

use std::error::Error;
use std::io::{Write, stdout};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};
use sim::TruePoint;
use sim::cast::{Caster, Cylinder, Hit, Object, Ray, Reach, Surface};
use sim::scene_file::SceneFile;
use sim::scenery::{PlacedScenery, Scenery, no_files, shipped};
use sim::sensor::{LidarMount, LidarSensor};
use sim::simulate::{SimulationEvent, SimulationSink};

/// Pixels of the view, and of the panorama beneath it.
const WIDTH: usize = 880;
const VIEW: usize = 520;
const PANORAMA: usize = 256;
/// Samples of a pixel along either side.
const FINE: usize = 2;
/// Ends of the panorama, degrees above the horizon.
const TOP_DEG: f64 = 60.0;
const BOTTOM_DEG: f64 = -45.0;
const SUN: DVec3 = dvec3(-0.42, -0.5, 0.76);
/// Points of the scan.
const DOT: DVec3 = dvec3(0.8, 0.02, 0.01);

/// Position of the camera and the point at which it looks, metres.
fn usual_camera(scene: &str) -> [f64; 6] {
    match scene {
        "hollow-sphere" => [-29.0, -15.0, 14.0, 0.0, 0.0, 0.0],
        "planes" => [-17.0, -15.0, 11.0, 3.0, 3.0, 1.0],
        "parking" => [-36.0, -44.0, 34.0, 0.0, 0.0, 0.0],
        "quarry" => [-72.0, -64.0, 46.0, 0.0, 2.0, 0.0],
        "glass-corridor" => [14.0, -20.0, 12.0, 0.0, 2.0, 0.0],
        "fog" | "traffic" => [-36.0, -40.0, 32.0, 0.0, 2.0, 0.0],
        _ => [-26.0, -22.0, 27.0, -0.5, -0.5, 0.0],
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let name = words.next().unwrap_or_else(|| "hall".to_owned());
    let mut words = words.peekable();
    let is_scan = words.next_if(|word| word == "--scan").is_some();
    let numbers = words
        .map(|word| word.parse())
        .collect::<Result<Vec<f64>, _>>()?;
    let camera = <[f64; 6]>::try_from(numbers).unwrap_or_else(|_| usual_camera(&name));
    let text = shipped(&name).ok_or(format!("no scene {name} comes with it"))?;
    let placed = Scenery::parse(text)?.place(seed(text), &mut no_files)?;
    let caster = placed.caster()?;
    // The scanner on its tripod is in the picture and not in the scan.
    let tripod = Cylinder {
        radius_m: 0.2,
        bottom_m: -1.2,
        top_m: 0.25,
        capped: true,
    };
    let with_scanner = Caster::new(placed.objects.iter().cloned().chain([Object::new(tripod)]))?;
    let scene = Seen {
        with_scanner: &with_scanner,
        enclosing: enclosing(&placed),
        placed: &placed,
        caster: &caster,
    };
    let camera = Camera::new(camera);
    let image = if is_scan {
        scene.scan(&camera, &scanned(text)?)
    } else {
        let mut image = scene.view(&camera);
        scene.dots(&camera, &mut image)?;
        image.extend(scene.panorama());
        image
    };
    let rows = image.len() / WIDTH;
    let bytes: Vec<u8> = image.into_iter().flat_map(screen).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, WIDTH as u32, rows as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(stdout().write_all(&file)?)
}

/// True places of the scan that a scene file describes.
fn scanned(text: &str) -> Result<Vec<DVec3>, Box<dyn Error>> {
    let mut scene = SceneFile::parse(text, None, None)?;
    let mut points = TruePoints::default();
    let effects = &mut scene.effects.effects;
    scene
        .simulation
        .run(effects, NonZeroUsize::MIN, &mut points)?;
    Ok(points.0)
}

#[derive(Default)]
struct TruePoints(Vec<DVec3>);

impl SimulationSink for TruePoints {
    fn event(&mut self, _: &SimulationEvent) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        self.0.extend(points.iter().map(|point| point.position_m));
        ControlFlow::Continue(())
    }
}

/// The scene's own seed.
fn seed(text: &str) -> u64 {
    let line = text.lines().find_map(|line| line.strip_prefix("seed = "));
    line.and_then(|seed| seed.parse().ok()).unwrap_or(0)
}

/// Bytes of a colour.
fn screen(colour: DVec3) -> [u8; 3] {
    let bytes = colour
        .to_array()
        .map(|part| part.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0);
    bytes.map(|byte| byte.round() as u8)
}

/// Objects around the scanner.
fn enclosing(placed: &PlacedScenery) -> Vec<bool> {
    let inside = |surface: &Surface| match surface {
        Surface::Sphere(sphere) => sphere.radius_m > 5.0,
        Surface::Cuboid(cuboid) => {
            cuboid.low_m().max_element() < 0.0 && cuboid.high_m().min_element() > 4.0
        }
        _ => false,
    };
    placed
        .objects
        .iter()
        .map(|object| inside(&object.surface))
        .collect()
}

struct Camera {
    at_m: DVec3,
    /// Right, up, ahead.
    axes: DMat3,
    /// Pixels of a unit at distance 1.
    focal: f64,
}

impl Camera {
    fn new([x, y, z, to_x, to_y, to_z]: [f64; 6]) -> Self {
        let (at_m, to_m) = (dvec3(x, y, z), dvec3(to_x, to_y, to_z));
        let ahead = (to_m - at_m).normalize_or_zero();
        let right = ahead.cross(DVec3::Z).normalize_or_zero();
        Self {
            at_m,
            axes: DMat3::from_cols(right, right.cross(ahead), ahead),
            focal: 0.95 * WIDTH as f64,
        }
    }

    fn ray(&self, column: f64, row: f64) -> DVec3 {
        let (x, y) = (column - 0.5 * WIDTH as f64, 0.5 * VIEW as f64 - row);
        (self.axes * dvec3(x, y, self.focal)).normalize()
    }

    fn pixel(&self, point: DVec3) -> Option<DVec2> {
        let own = self.axes.transpose() * (point - self.at_m);
        let at =
            dvec2(own.x, -own.y) * (self.focal / own.z) + 0.5 * dvec2(WIDTH as f64, VIEW as f64);
        (own.z > 0.0).then_some(at)
    }
}

struct Seen<'a> {
    placed: &'a PlacedScenery,
    caster: &'a Caster,
    with_scanner: &'a Caster,
    enclosing: Vec<bool>,
}

impl Seen<'_> {
    /// The surface met and its normal; the outsides of enclosing surfaces are cut away.
    fn meet(&self, from: DVec3, direction: DVec3) -> Option<(Hit, DVec3)> {
        let ray = Ray::new(from, direction).ok()?;
        let mut reach = Reach::up_to(1e4);
        loop {
            let hit = self.with_scanner.nearest(&ray, reach)?;
            let normal = self.with_scanner.normal(&hit, ray.at(hit.range_m));
            let outside = normal.dot(direction) < 0.0;
            if !(outside && self.enclosing.get(hit.object.index()) == Some(&true)) {
                return Some((hit, normal));
            }
            reach.above_m = hit.range_m;
        }
    }

    fn colour(&self, hit: &Hit) -> DVec3 {
        let material = self.placed.material(hit.object.index(), hit.primitive);
        let Some(material) = material else {
            return dvec3(0.02, 0.1, 0.45);
        };
        let hue = match material.name.as_str() {
            "brick" => dvec3(0.75, 0.42, 0.32),
            "wood" | "bark" | "cardboard" => dvec3(0.72, 0.52, 0.33),
            "foliage" | "hedge" => dvec3(0.38, 0.62, 0.28),
            "glass" => dvec3(0.35, 0.5, 0.65),
            "rock" => dvec3(0.8, 0.7, 0.55),
            "yellow paint" => dvec3(0.95, 0.75, 0.2),
            "sign" | "number plate" => dvec3(1.0, 0.95, 0.4),
            "plaster" => dvec3(0.9, 0.85, 0.72),
            "dark paint" => dvec3(0.5, 0.2, 0.2),
            "grey paint" => dvec3(0.45, 0.55, 0.7),
            _ => dvec3(0.75, 0.76, 0.78),
        };
        hue.powf(2.2) * (0.45 + 0.55 * (f64::from(material.reflectivity.min(100)) / 100.0).sqrt())
    }

    /// A ray's colour in the sun.
    fn lit(&self, from: DVec3, direction: DVec3) -> DVec3 {
        let Some((hit, normal)) = self.meet(from, direction) else {
            return dvec3(0.62, 0.75, 0.9)
                .lerp(dvec3(0.9, 0.93, 0.96), (1.0 - direction.z.abs()).powi(3));
        };
        let point = from + hit.range_m * direction;
        let normal = if normal.dot(direction) > 0.0 {
            -normal
        } else {
            normal
        };
        let sun = SUN.normalize();
        // Within something closed there is light all the same.
        let shade = self.meet(point + 1e-3 * normal, sun).is_some();
        let facing = normal.dot(sun).max(0.0) * if shade { 0.15 } else { 1.0 };
        let sky = 0.5 + 0.5 * normal.z;
        let colour = self.colour(&hit) * (0.12 + 0.4 * sky + 0.9 * facing);
        let haze = 1.0 - (-hit.range_m / 900.0).exp();
        colour.lerp(dvec3(0.7, 0.78, 0.88), haze)
    }

    fn view(&self, camera: &Camera) -> Vec<DVec3> {
        pixels(VIEW, |column, row| {
            self.lit(camera.at_m, camera.ray(column, row))
        })
    }

    /// The points of a level VLP-16 that the camera sees.
    fn dots(&self, camera: &Camera, image: &mut [DVec3]) -> Result<(), Box<dyn Error>> {
        let (sensor, mount) = (LidarSensor::vlp16(), LidarMount::above(0.0));
        for azimuth in (0..1_200).map(|step| f64::from(step) * 0.3) {
            for laser in 0..16 {
                let (from, direction) = sensor.ray(laser, azimuth, 0.0, &mount).ok_or("laser")?;
                let hit = self
                    .caster
                    .nearest(&Ray::new(from, direction)?, Reach::up_to(100.0));
                if let Some(hit) = hit {
                    self.dot(camera, image, from + hit.range_m * direction, DOT);
                }
            }
        }
        Ok(())
    }

    /// The points of a scan that the camera sees, coloured by height.
    fn scan(&self, camera: &Camera, points: &[DVec3]) -> Vec<DVec3> {
        let mut image = vec![dvec3(0.01, 0.012, 0.02); VIEW * WIDTH];
        let mut heights: Vec<f64> = points.iter().map(|point| point.z).collect();
        heights.sort_by(f64::total_cmp);
        // Single points far above or below do not stretch the colours.
        let of = |share: usize| heights.get(heights.len() * share / 100).copied();
        let (low, high) = (of(1).unwrap_or(0.0), of(99).unwrap_or(1.0));
        for point in points {
            let above = (point.z - low) / (high - low).max(1e-3);
            self.dot(camera, &mut image, *point, warmth(1.0 - above));
        }
        image
    }

    fn dot(&self, camera: &Camera, image: &mut [DVec3], point: DVec3, colour: DVec3) {
        let off = point - camera.at_m;
        let Some(at) = camera.pixel(point) else {
            return;
        };
        let seen = self.meet(camera.at_m, off.normalize_or_zero());
        let visible = seen.is_some_and(|(hit, _)| {
            (hit.range_m - off.length()).abs() < 0.03 + 2e-3 * off.length()
        });
        let within = at.x >= 0.0 && at.y >= 0.0 && at.x < WIDTH as f64 && at.y < VIEW as f64;
        if visible
            && within
            && let Some(pixel) = image.get_mut(at.y as usize * WIDTH + at.x as usize)
        {
            *pixel = pixel.lerp(colour, 0.8);
        }
    }

    /// All around from the scanner, its forward in the middle.
    fn panorama(&self) -> Vec<DVec3> {
        pixels(PANORAMA, |column, row| {
            let azimuth = (column / WIDTH as f64 - 0.5) * std::f64::consts::TAU;
            let up = TOP_DEG + (BOTTOM_DEG - TOP_DEG) * row / PANORAMA as f64;
            let (sin, cos) = up.to_radians().sin_cos();
            let direction = dvec3(cos * azimuth.sin(), cos * azimuth.cos(), sin);
            let Ok(ray) = Ray::new(DVec3::ZERO, direction) else {
                return DVec3::ZERO;
            };
            let Some(hit) = self.caster.nearest(&ray, Reach::up_to(100.0)) else {
                return dvec3(0.01, 0.01, 0.02);
            };
            let normal = self.caster.normal(&hit, ray.at(hit.range_m));
            let facing = normal.dot(direction).abs();
            warmth((hit.range_m / 1.2).ln() / (100.0_f64 / 1.2).ln()) * (0.25 + 0.75 * facing)
        })
    }
}

/// Near is 0 and yellow, far is 1 and violet.
fn warmth(far: f64) -> DVec3 {
    const STOPS: [DVec3; 5] = [
        dvec3(0.98, 0.88, 0.3),
        dvec3(0.95, 0.42, 0.16),
        dvec3(0.65, 0.12, 0.3),
        dvec3(0.28, 0.06, 0.42),
        dvec3(0.06, 0.04, 0.25),
    ];
    let at = far.clamp(0.0, 1.0) * 4.0;
    let [low, high] = [at.floor(), at.floor() + 1.0].map(|stop| (stop as usize).min(4));
    STOPS[low].lerp(STOPS[high], at.fract())
}

/// The pixels of so many rows, each of several samples.
fn pixels(rows: usize, colour: impl Fn(f64, f64) -> DVec3) -> Vec<DVec3> {
    let samples = |column: usize, row: usize| {
        let steps = (0..FINE * FINE).map(|step| [step % FINE, step / FINE]);
        let sum: DVec3 = steps
            .map(|[x, y]| {
                let [x, y] = [x, y].map(|step| (step as f64 + 0.5) / FINE as f64);
                colour(column as f64 + x, row as f64 + y)
            })
            .sum();
        sum / (FINE * FINE) as f64
    };
    (0..rows * WIDTH)
        .map(|pixel| samples(pixel % WIDTH, pixel / WIDTH))
        .collect()
}
