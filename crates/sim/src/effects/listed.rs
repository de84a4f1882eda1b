//! What a scene file asks for: lists of effects that are not known beforehand, each with a count of what it did and what it cost.
//!
//! Time is measured only where a clock is given; this crate has none of its own. Left out: how a file asks for them.

use std::cell::Cell;
use std::sync::Arc;

use units::{Degrees, Gearing};

use super::{
    Absorb, Axis, Beam, Clock, Effect, Effects, Encoder, Mechanism, Needs, Objects, OnFirings,
    Parcel, Surface, View, Wire,
};
use crate::simulate::{Echoes, Firing, Surroundings};

/// A list of effects that threads share.
type Shared<T> = Vec<Listed<Arc<T>>>;
/// A list of effects of one thread.
type Owned<T> = Vec<Listed<Box<T>>>;

/// Any effects in any number.
pub type Asked = Effects<
    OnFirings<
        Shared<dyn Objects + Send + Sync>,
        Shared<dyn View + Send + Sync>,
        Shared<dyn Beam + Send + Sync>,
        Shared<dyn Surface + Send + Sync>,
        Shared<dyn Clock + Send + Sync>,
    >,
    Owned<dyn Mechanism + Send>,
    Owned<dyn Encoder + Send>,
    Owned<dyn Wire + Send>,
>;

/// How often an effect was asked and acted, and how long that took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Usage {
    /// How often it was asked.
    pub asked: u64,
    /// How often that changed anything.
    pub acted: u64,
    /// How much it changed: lasers, steps, parcels.
    pub changed: u64,
    /// Nanoseconds in it, all threads together; 0 where no clock was given.
    pub spent_ns: u64,
}

/// An effect of a run, and what it did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Used {
    /// What the scene file calls it.
    pub name: &'static str,
    /// What it is asked for each of: firings, polls...
    pub each: &'static str,
    /// What it did.
    pub usage: Usage,
    /// Why it was not needed, if it never acted.
    pub why_idle: &'static str,
}

impl Asked {
    /// Leaves out the effects whose names do not fit.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        let OnFirings {
            objects,
            view,
            beam,
            surface,
            clock,
        } = &mut self.firings;
        objects.retain(|listed| keep(listed.effect.name()));
        view.retain(|listed| keep(listed.effect.name()));
        beam.retain(|listed| keep(listed.effect.name()));
        surface.retain(|listed| keep(listed.effect.name()));
        clock.retain(|listed| keep(listed.effect.name()));
        self.mechanism.retain(|listed| keep(listed.effect.name()));
        self.encoder.retain(|listed| keep(listed.effect.name()));
        self.wire.retain(|listed| keep(listed.effect.name()));
    }

    /// All effects of the lists and what they did, in the order in which they act.
    #[must_use]
    pub fn used(&self) -> Vec<Used> {
        let mut used = Vec::new();
        let OnFirings {
            objects,
            view,
            beam,
            surface,
            clock,
        } = &self.firings;
        note(&mut used, "firings", objects);
        for listed in view {
            let each = match listed.effect.needs().azimuths {
                true => "blocks",
                false => "firings",
            };
            note(&mut used, each, core::slice::from_ref(listed));
        }
        note(&mut used, "firings", beam);
        note(&mut used, "firings", surface);
        note(&mut used, "readings", clock);
        note(&mut used, "steps", &self.mechanism);
        note(&mut used, "polls", &self.encoder);
        note(&mut used, "parcels", &self.wire);
        used
    }
}

fn note<P>(used: &mut Vec<Used>, each: &'static str, list: &[Listed<P>])
where
    P: core::ops::Deref<Target: Effect>,
{
    used.extend(list.iter().map(|listed| Used {
        name: listed.effect.name(),
        each,
        usage: listed.usage(),
        why_idle: listed.effect.why_idle(),
    }));
}

/// An effect in a list. `P` is an `Arc` or a `Box` of one.
#[derive(Debug)]
pub struct Listed<P> {
    effect: P,
    usage: Cell<Usage>,
    clock: Option<fn() -> u64>,
}

impl<P: Clone> Clone for Listed<P> {
    /// A copy has been asked nothing yet, so that its counts can be added to those of the original.
    fn clone(&self) -> Self {
        Self::new(self.effect.clone(), self.clock)
    }
}

impl<P> Listed<P> {
    /// An effect that has not been asked yet; `clock` gives nanoseconds from any beginning.
    #[must_use]
    pub const fn new(effect: P, clock: Option<fn() -> u64>) -> Self {
        Self {
            effect,
            usage: Cell::new(Usage {
                asked: 0,
                acted: 0,
                changed: 0,
                spent_ns: 0,
            }),
            clock,
        }
    }

    /// The effect.
    pub const fn effect(&self) -> &P {
        &self.effect
    }

    /// What it did so far.
    #[must_use]
    pub fn usage(&self) -> Usage {
        self.usage.get()
    }

    /// Asks the effect and counts. `changed` says how much an answer changed.
    #[inline]
    fn ask<T>(&self, ask: impl FnOnce(&P) -> T, changed: impl FnOnce(&T) -> u32) -> T {
        let begun = self.clock.map(|clock| clock());
        let answer = ask(&self.effect);
        self.count(begun, changed(&answer));
        answer
    }

    /// The same of an effect that remembers.
    #[inline]
    fn ask_mut<T>(&mut self, ask: impl FnOnce(&mut P) -> T, changed: impl FnOnce(&T) -> u32) -> T {
        let begun = self.clock.map(|clock| clock());
        let answer = ask(&mut self.effect);
        self.count(begun, changed(&answer));
        answer
    }

    #[inline]
    fn count(&self, begun: Option<u64>, changed: u32) {
        let ended = self.clock.map(|clock| clock());
        let spent_ns = begun.zip(ended).map_or(0, |(a, b)| b.saturating_sub(a));
        self.add(Usage {
            asked: 1,
            acted: u64::from(changed > 0),
            changed: u64::from(changed),
            spent_ns,
        });
    }

    #[inline]
    fn add(&self, more: Usage) {
        let usage = self.usage.get();
        self.usage.set(Usage {
            asked: usage.asked.saturating_add(more.asked),
            acted: usage.acted.saturating_add(more.acted),
            changed: usage.changed.saturating_add(more.changed),
            spent_ns: usage.spent_ns.saturating_add(more.spent_ns),
        });
    }
}

/// The answer is the count.
const fn as_said(count: &u32) -> u32 {
    *count
}

/// Whether an answer differs from what it was asked of.
fn differs<T: PartialEq + Copy>(from: T) -> impl FnOnce(&T) -> u32 {
    move |to| u32::from(*to != from)
}

impl<T: Effect + ?Sized> Effect for Vec<Listed<Arc<T>>> {
    fn name(&self) -> &'static str {
        "list"
    }

    fn needs(&self) -> Needs {
        self.iter().fold(Needs::NOTHING, |needs, listed| {
            needs.and(listed.effect.needs())
        })
    }
}

impl<T: Effect + ?Sized> Effect for Vec<Listed<Box<T>>> {
    fn name(&self) -> &'static str {
        "list"
    }

    fn needs(&self) -> Needs {
        self.iter().fold(Needs::NOTHING, |needs, listed| {
            needs.and(listed.effect.needs())
        })
    }
}

impl<P> Absorb for Vec<Listed<P>> {
    fn absorb(&mut self, copy: &Self) {
        for (mine, theirs) in self.iter().zip(copy) {
            mine.add(theirs.usage());
        }
    }
}

impl<T: Objects + ?Sized> Objects for Vec<Listed<Arc<T>>> {
    fn place(&self, at_s: f64, surroundings: &mut Surroundings) -> u32 {
        self.iter()
            .map(|listed| listed.ask(|effect| effect.place(at_s, surroundings), as_said))
            .sum()
    }
}

impl<T: View + ?Sized> View for Vec<Listed<Arc<T>>> {
    fn fires(&self, azimuth_deg: f64) -> bool {
        self.iter().all(|listed| {
            !listed.effect.needs().azimuths
                || listed.ask(
                    |effect| effect.fires(azimuth_deg),
                    |fires| u32::from(!fires),
                )
        })
    }

    fn look(&self, firing: &mut Firing) -> u32 {
        // Who says which azimuths fire has been asked for all of them beforehand.
        self.iter()
            .filter(|listed| !listed.effect.needs().azimuths)
            .map(|listed| listed.ask(|effect| effect.look(firing), as_said))
            .sum()
    }
}

impl<T: Beam + ?Sized> Beam for Vec<Listed<Arc<T>>> {
    fn receive(&self, firing: &Firing, surroundings: &Surroundings, echoes: &mut Echoes) -> u32 {
        self.iter()
            .map(|listed| {
                listed.ask(
                    |effect| effect.receive(firing, surroundings, echoes),
                    as_said,
                )
            })
            .sum()
    }
}

impl<T: Surface + ?Sized> Surface for Vec<Listed<Arc<T>>> {
    fn reflect(&self, firing: &Firing, echoes: &mut Echoes) -> u32 {
        self.iter()
            .map(|listed| listed.ask(|effect| effect.reflect(firing, echoes), as_said))
            .sum()
    }
}

impl<T: Clock + ?Sized> Clock for Vec<Listed<Arc<T>>> {
    fn host_ns(&self, device_ns: i64) -> i64 {
        self.iter().fold(device_ns, |ns, listed| {
            listed.ask(|effect| effect.host_ns(ns), differs(ns))
        })
    }
}

impl<T: Mechanism + ?Sized> Mechanism for Vec<Listed<Box<T>>> {
    fn is_there(&self) -> bool {
        !self.is_empty()
    }

    fn step(&mut self, at_s: f64, axis: &mut Axis) -> bool {
        let mut any = false;
        for listed in self {
            any |= listed.ask_mut(|effect| effect.step(at_s, axis), |acted| u32::from(*acted));
        }
        any
    }
}

impl<T: Encoder + ?Sized> Encoder for Vec<Listed<Box<T>>> {
    fn read(&mut self, poll: u64, shaft: Degrees) -> Degrees {
        self.iter_mut().fold(shaft, |shaft, listed| {
            listed.ask_mut(|effect| effect.read(poll, shaft), differs(shaft))
        })
    }

    fn gearing(&self) -> Option<Gearing> {
        self.iter().rev().find_map(|listed| listed.effect.gearing())
    }
}

impl<T: Wire + ?Sized> Wire for Vec<Listed<Box<T>>> {
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        through(self, parcel, arrive)
    }
}

/// Through the first link and what it hands on through the rest. As deep as there are effects.
fn through<T: Wire + ?Sized>(
    links: &mut [Listed<Box<T>>],
    parcel: Parcel,
    arrive: &mut dyn FnMut(Parcel),
) -> u32 {
    let Some((first, rest)) = links.split_first_mut() else {
        arrive(parcel);
        return 0;
    };
    // Its own time only: what it hands on waits until it is done.
    let mut onward = Vec::new();
    let acted = first.ask_mut(
        |effect| effect.deliver(parcel, &mut |parcel| onward.push(parcel)),
        as_said,
    );
    onward
        .into_iter()
        .map(|parcel| through(rest, parcel, arrive))
        .sum::<u32>()
        + acted
}
