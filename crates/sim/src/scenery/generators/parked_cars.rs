//! A row of parked cars: bodies, cabins, wheels, number plates, all from boxes and cylinders.

use glam::{DMat3, DVec3, dvec3};
use serde::Deserialize;

use super::super::error::{InvalidValue, above_0, invalid, within};
use super::super::materials::MaterialAssignment;
use super::{Draws, ObjectPart};
use crate::cast::Cylinder;

/// `parked_cars = { bays = N, .. }`: adjacent bays from the origin along x, cars along y with their
/// centres at y = 0, facing either way.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParkedCars {
    /// Number of bays.
    pub bays: u32,
    /// Width of a bay, metres.
    #[serde(default = "usual_pitch")]
    pub pitch_m: f64,
    /// Share of bays that are taken, 0 to 1.
    pub share: f64,
    /// Materials of bodies, to choose from.
    pub paints: Vec<String>,
    /// Material of windows.
    pub glass: String,
    /// Material of tyres.
    pub tyres: String,
    /// Material of number plates.
    pub plates: String,
}

const fn usual_pitch() -> f64 {
    2.5
}

impl ParkedCars {
    pub(in super::super) fn materials(&self) -> impl Iterator<Item = &String> {
        let others = [&self.glass, &self.tyres, &self.plates];
        self.paints.iter().chain(others)
    }

    pub(in super::super) fn check(&self) -> Result<(), InvalidValue> {
        above_0("parked_cars.pitch_m", self.pitch_m)?;
        within("parked_cars.share", self.share, 0.0..=1.0)?;
        within("parked_cars.bays", f64::from(self.bays), 1.0..=1_000.0)?;
        match self.paints.is_empty() {
            true => Err(invalid(
                "parked_cars.paints",
                "one material at least",
                &self.paints,
            )),
            false => Ok(()),
        }
    }
}

/// Materials of one car.
#[derive(Clone, Copy)]
struct CarMaterials {
    paint: u32,
    glass: u32,
    tyre: u32,
    plate: u32,
}

pub(in super::super) fn parked_cars(
    config: &ParkedCars,
    seed: u64,
    material: &dyn Fn(&str) -> u32,
) -> Vec<ObjectPart> {
    let mut draws = Draws::new(seed);
    let mut parts = Vec::new();
    for bay in (0..config.bays).map(f64::from) {
        let taken = draws.unit() < config.share;
        let paint = config.paints.get(draws.below(config.paints.len()));
        let looks = CarMaterials {
            paint: paint.map_or(0, |name| material(name)),
            glass: material(&config.glass),
            tyre: material(&config.tyres),
            plate: material(&config.plates),
        };
        let middle_m = dvec3((bay + 0.5) * config.pitch_m, 0.0, 0.0);
        let off_m = dvec3(
            draws.between([-0.15, 0.15]),
            draws.between([-0.3, 0.3]),
            0.0,
        );
        let backed_in = if draws.unit() < 0.3 { 180.0 } else { 0.0 };
        let turn_deg: f64 = backed_in + draws.between([-2.0, 2.0]);
        let turn = DMat3::from_rotation_z(turn_deg.to_radians());
        let car = car(&mut draws, looks);
        if taken {
            let set_down = car
                .into_iter()
                .map(|part| part.set_down(turn, middle_m + off_m));
            parts.extend(set_down);
        }
    }
    parts
}

/// A car along y, its nose at +y, its wheels on z = 0.
fn car(draws: &mut Draws, looks: CarMaterials) -> Vec<ObjectPart> {
    let length = draws.between([3.7, 4.8]);
    let width = draws.between([1.68, 1.86]);
    let height = draws.between([1.42, 1.62]);
    let (half, front, belt) = (0.5 * width, 0.5 * length, 0.62 * height);
    let wheel_m = 0.32;
    let (cabin_back, cabin_front) = (-0.42 * length, 0.2 * length);
    let box_of = |x: f64, y: [f64; 2], z: [f64; 2], material| {
        ObjectPart::cuboid([-x, y[0], z[0]], [x, y[1], z[1]], material)
    };
    let mut parts = vec![
        box_of(half, [-front, front], [0.22, belt], looks.paint),
        box_of(
            half - 0.1,
            [cabin_back, cabin_front],
            [belt, height - 0.08],
            looks.glass,
        ),
        box_of(
            half - 0.14,
            [cabin_back + 0.15, cabin_front - 0.35],
            [height - 0.08, height],
            looks.paint,
        ),
        box_of(0.26, [front, front + 0.01], [0.45, 0.56], looks.plate),
        box_of(0.26, [-front - 0.01, -front], [0.6, 0.71], looks.plate),
    ];
    let wheel = Cylinder {
        radius_m: wheel_m,
        bottom_m: -0.1,
        top_m: 0.1,
        capped: true,
    };
    for (side, along) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let at_m = DVec3::new(side * (half - 0.08), along * 0.31 * length, wheel_m);
        parts.push(ObjectPart {
            rotation: DMat3::from_rotation_y(std::f64::consts::FRAC_PI_2),
            ..ObjectPart::new(wheel, MaterialAssignment::One(looks.tyre)).moved(at_m)
        });
    }
    parts
}
