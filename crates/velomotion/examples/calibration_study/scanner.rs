//! Simulated scanners that differ from seed to seed, and the truth of their parameters.

use std::f64::consts::PI;
use std::fmt::Write;

use units::random::{split_mix_64, unit_interval};

/// Random numbers of a seed (SplitMix64).
pub struct StudyDraws(pub u64);

impl StudyDraws {
    /// From -most to most.
    pub fn uniform(&mut self, most: f64) -> f64 {
        most * (2.0 * unit_interval(split_mix_64(&mut self.0)) - 1.0)
    }

    /// Normal (Box and Muller).
    pub fn normal(&mut self, sd: f64) -> f64 {
        let radius = (-2.0 * (0.5 + self.uniform(0.5)).max(1e-300).ln()).sqrt();
        sd * radius * self.uniform(PI).cos()
    }
}

/// A scanner: values of its parameters by name.
pub struct TrueScanner {
    /// Rotation about x and z, degrees, and position, metres.
    pub rotation_deg: [f64; 2],
    pub position_m: [f64; 2],
    /// Amplitude and phase of the ripple, degrees.
    pub ripple_deg: [f64; 2],
    pub play_deg: f64,
    /// Delay of the lidar's packets, microseconds.
    pub packets_late_us: f64,
    pub ranges_m: Vec<f64>,
    pub elevations_deg: Vec<f64>,
    pub azimuths_deg: Vec<f64>,
}

/// The default delay of packets on their way, microseconds.
const PACKETS_LATE_US: f64 = 40.0;

impl TrueScanner {
    /// The scanner of a seed: turned by up to 2 deg, moved by up to 15 mm, its lasers off by 10 mm
    /// and 50 mdeg (one standard deviation), its gear by 3 mdeg.
    pub fn new(seed: u64) -> Self {
        let mut draws = StudyDraws(1_000 + seed);
        let rotation_deg = [draws.uniform(2.0), draws.uniform(2.0)];
        let position_m = [draws.uniform(0.01), 0.06 + draws.uniform(0.015)];
        let mut lasers = |sd: f64| -> Vec<f64> { (0..16).map(|_| draws.normal(sd)).collect() };
        let (ranges_m, elevations_deg, mut azimuths_deg) =
            (lasers(0.01), lasers(0.05), lasers(0.05));
        // The mean is the mount's rotation about z.
        let mean = azimuths_deg.iter().sum::<f64>() / 16.0;
        azimuths_deg.iter_mut().for_each(|azimuth| *azimuth -= mean);
        Self {
            rotation_deg,
            position_m,
            ripple_deg: [0.003, draws.uniform(180.0)],
            play_deg: 0.0,
            packets_late_us: PACKETS_LATE_US,
            ranges_m,
            elevations_deg,
            azimuths_deg,
        }
    }

    /// Sections of a scene file.
    pub fn sections(&self) -> String {
        let [x, z] = self.position_m;
        let [about_x, about_z] = self.rotation_deg;
        let [amplitude, phase] = self.ripple_deg;
        let backlash = match self.play_deg {
            0.0 => String::new(),
            play => format!("[effects.backlash]\nplay_deg = {play}\n"),
        };
        format!(
            "[mount]\nd_m = {z}\nposition_m = [{x}, 0.0, 0.0]\nrotation_deg = [{about_x}, 0.0, {about_z}]\n\
             [effects]\nall = false\n[effects.own_shadow]\nsectors = [{{ azimuth_from_deg = 175, azimuth_to_deg = 185 }}]\n\
             [effects.reflectance]\n[effects.range_noise]\nsd_m = 0.01\n[effects.encoder_quantisation]\n\
             [effects.lidar_clock]\ndrift_ppm = 12\n[effects.link_jitter]\nlidar_delay_us = {:?}\n\
             [effects.laser_errors]\nrange_m = {:?}\nelevation_deg = {:?}\nazimuth_deg = {:?}\n\
             [effects.gear_ripple]\namplitude_deg = {amplitude}\nphase_deg = {phase}\n{backlash}",
            self.packets_late_us, self.ranges_m, self.elevations_deg, self.azimuths_deg
        )
    }

    /// Factors of sine and cosine of the ripple, degrees.
    pub fn ripple(&self) -> [f64; 2] {
        let [amplitude, phase] = self.ripple_deg;
        let (sin, cos) = phase.to_radians().sin_cos();
        [amplitude * cos, amplitude * sin]
    }

    /// Values of all parameters but those of logs, with the delay of a log.
    pub fn values(&self, delay_us: f64) -> Vec<(String, f64)> {
        let [ripple_sin, ripple_cos] = self.ripple();
        let mut values: Vec<(String, f64)> = [
            ("mount_rotation_x_deg", self.rotation_deg[0]),
            ("mount_rotation_z_deg", self.rotation_deg[1]),
            ("mount_position_x_m", self.position_m[0]),
            ("mount_position_z_m", self.position_m[1]),
            ("delay_us", delay_us),
            ("scale", 0.0),
            ("ripple_sin_deg", ripple_sin),
            ("ripple_cos_deg", ripple_cos),
            // The platform trails the shaft.
            ("play_deg", -self.play_deg),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .into();
        for laser in 0..16 {
            let of = |kind: &str| format!("laser_{laser}_{kind}");
            values.push((of("range_m"), -self.ranges_m[laser]));
            values.push((of("elevation_deg"), self.elevations_deg[laser]));
            values.push((of("azimuth_deg"), self.azimuths_deg[laser]));
        }
        values
    }
}

/// The mount file of values by name.
pub fn mount_file(value: &dyn Fn(&str) -> f64) -> String {
    let mut text = format!(
        "model = \"VLP-16\"\n[mount]\nd_m = {:?}\nposition_m = [{:?}, 0.0, 0.0]\nrotation_deg = [{:?}, 0.0, {:?}]\n\
         [axis_correction]\ndelay_us = {:?}\nscale = {:?}\nripple_deg = [{:?}, {:?}]\nplay_deg = {:?}\n",
        value("mount_position_z_m"),
        value("mount_position_x_m"),
        value("mount_rotation_x_deg"),
        value("mount_rotation_z_deg"),
        value("delay_us"),
        value("scale"),
        value("ripple_sin_deg"),
        value("ripple_cos_deg"),
        value("play_deg")
    );
    for (laser, beam) in protocol::vlp16::models::VLP_16.lasers.iter().enumerate() {
        let of = |kind: &str| value(&format!("laser_{laser}_{kind}"));
        let _ = write!(
            text,
            "[[laser]]\nid = {laser}\nelevation_deg = {:?}\nazimuth_offset_deg = {:?}\nrange_offset_m = {:?}\n",
            beam.elevation_deg + of("elevation_deg"),
            beam.azimuth_offset_deg + of("azimuth_deg"),
            of("range_m")
        );
    }
    text
}
