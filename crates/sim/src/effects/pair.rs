//! `(A, B)`: A, then B. Pairs of pairs make as many as one likes, all known beforehand.

use units::{Degrees, Gearing};

use super::{
    Absorb, Axis, Beam, Clock, Effect, Encoder, Mechanism, Needs, Objects, Parcel, Surface, View,
    Wire,
};
use crate::simulate::{Echoes, Firing, Surroundings};

impl<A: Effect, B: Effect> Effect for (A, B) {
    fn name(&self) -> &'static str {
        "pair"
    }

    #[inline]
    fn needs(&self) -> Needs {
        self.0.needs().and(self.1.needs())
    }
}

impl<A: Absorb, B: Absorb> Absorb for (A, B) {
    fn absorb(&mut self, copy: &Self) {
        self.0.absorb(&copy.0);
        self.1.absorb(&copy.1);
    }
}

impl<A: Objects, B: Objects> Objects for (A, B) {
    #[inline]
    fn place(&self, at_s: f64, surroundings: &mut Surroundings) -> u32 {
        self.0.place(at_s, surroundings) + self.1.place(at_s, surroundings)
    }
}

impl<A: View, B: View> View for (A, B) {
    #[inline]
    fn fires(&self, azimuth_deg: f64) -> bool {
        self.0.fires(azimuth_deg) && self.1.fires(azimuth_deg)
    }

    #[inline]
    fn look(&self, firing: &mut Firing) -> u32 {
        self.0.look(firing) + self.1.look(firing)
    }
}

impl<A: Beam, B: Beam> Beam for (A, B) {
    #[inline]
    fn receive(&self, firing: &Firing, surroundings: &Surroundings, echoes: &mut Echoes) -> u32 {
        self.0.receive(firing, surroundings, echoes) + self.1.receive(firing, surroundings, echoes)
    }
}

impl<A: Surface, B: Surface> Surface for (A, B) {
    #[inline]
    fn reflect(&self, firing: &Firing, echoes: &mut Echoes) -> u32 {
        self.0.reflect(firing, echoes) + self.1.reflect(firing, echoes)
    }
}

impl<A: Clock, B: Clock> Clock for (A, B) {
    #[inline]
    fn host_ns(&self, device_ns: i64) -> i64 {
        self.1.host_ns(self.0.host_ns(device_ns))
    }
}

impl<A: Mechanism, B: Mechanism> Mechanism for (A, B) {
    #[inline]
    fn is_there(&self) -> bool {
        self.0.is_there() || self.1.is_there()
    }

    #[inline]
    fn step(&mut self, at_s: f64, axis: &mut Axis) -> bool {
        let first = self.0.step(at_s, axis);
        self.1.step(at_s, axis) || first
    }
}

impl<A: Encoder, B: Encoder> Encoder for (A, B) {
    #[inline]
    fn read(&mut self, poll: u64, shaft: Degrees) -> Degrees {
        let shaft = self.0.read(poll, shaft);
        self.1.read(poll, shaft)
    }

    fn gearing(&self) -> Option<Gearing> {
        self.1.gearing().or_else(|| self.0.gearing())
    }
}

impl<A: Wire, B: Wire> Wire for (A, B) {
    #[inline]
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        let (first, second) = (&mut self.0, &mut self.1);
        let mut acted = 0;
        let also = first.deliver(parcel, &mut |parcel| {
            acted += second.deliver(parcel, arrive);
        });
        acted + also
    }
}
