//! `()`: no effect. All of it is nothing, and is compiled to nothing.

use units::Degrees;

use super::{
    Absorb, Axis, Beam, Clock, Effect, Encoder, Mechanism, Objects, Parcel, Surface, View, Wire,
};
use crate::simulate::{Echoes, Firing, Surroundings};

impl Effect for () {
    fn name(&self) -> &'static str {
        "none"
    }
}

impl Absorb for () {}

impl Objects for () {
    #[inline(always)]
    fn place(&self, _: f64, _: &mut Surroundings) -> u32 {
        0
    }
}

impl View for () {}

impl Beam for () {
    #[inline(always)]
    fn receive(&self, _: &Firing, _: &Surroundings, _: &mut Echoes) -> u32 {
        0
    }
}

impl Surface for () {
    #[inline(always)]
    fn reflect(&self, _: &Firing, _: &mut Echoes) -> u32 {
        0
    }
}

impl Clock for () {
    #[inline(always)]
    fn host_ns(&self, device_ns: i64) -> i64 {
        device_ns
    }
}

impl Mechanism for () {
    #[inline(always)]
    fn is_there(&self) -> bool {
        false
    }

    #[inline(always)]
    fn step(&mut self, _: f64, _: &mut Axis) -> bool {
        false
    }
}

impl Encoder for () {
    #[inline(always)]
    fn read(&mut self, _: u64, shaft: Degrees) -> Degrees {
        shaft
    }
}

impl Wire for () {
    #[inline(always)]
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        arrive(parcel);
        0
    }
}
