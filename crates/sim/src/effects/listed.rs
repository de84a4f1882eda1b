//! Lists of effects that are known only at run time, each with counts of its work and its cost.
//!
//! Costs are measured only where a stopwatch is given; this crate has no clock.

use std::cell::Cell;
use std::ops::Deref;
use std::sync::Arc;

use units::{Degrees, Gearing};

use super::{
    AxisAngles, BeamEffect, ClockEffect, Effect, Effects, EncoderEffect, FiringEffectSet,
    LinkEffect, LinkMessage, MechanismEffect, Needs, ObjectsEffect, SurfaceEffect, ViewEffect,
};
use crate::firing::{Echoes, SimulatedFiring, Surroundings};
use crate::sensor::LaserBeam;

/// A clock in nanoseconds from any origin that measures the cost of effects.
pub type Stopwatch = Option<fn() -> u64>;

/// A list of effects that threads share.
type SharedEffects<T> = Vec<MeteredEffect<Arc<T>>>;
/// A list of effects of one thread.
type OwnedEffects<T> = Vec<MeteredEffect<Box<T>>>;

/// Any number of effects of any type.
pub type ConfiguredEffects = Effects<
    FiringEffectSet<
        SharedEffects<dyn ObjectsEffect + Send + Sync>,
        SharedEffects<dyn ViewEffect + Send + Sync>,
        SharedEffects<dyn BeamEffect + Send + Sync>,
        SharedEffects<dyn SurfaceEffect + Send + Sync>,
        SharedEffects<dyn ClockEffect + Send + Sync>,
    >,
    OwnedEffects<dyn MechanismEffect + Send>,
    OwnedEffects<dyn EncoderEffect + Send>,
    OwnedEffects<dyn LinkEffect + Send>,
>;

/// Numbers of calls and actions of an effect, and the time it took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct UsageCounts {
    /// Calls.
    pub calls: u64,
    /// Calls that changed anything.
    pub acted: u64,
    /// Changes in all: lasers, steps, messages.
    pub changed: u64,
    /// Nanoseconds in all threads; 0 without a stopwatch.
    pub spent_ns: u64,
}

/// An effect of a run and its counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct EffectUsage {
    /// Its key in the scene file.
    pub name: &'static str,
    /// Unit of its calls: firings, polls...
    pub each: &'static str,
    /// Its counts.
    pub counts: UsageCounts,
    /// Explanation for an effect that never acted.
    pub idle_reason: &'static str,
}

/// Calls a macro with each list and the unit of its calls, in the order in which effects act.
macro_rules! for_each_list {
    ($effects:ident, $call:ident) => {
        $call!($effects.firings.objects, "firings");
        $call!($effects.firings.view, "firings");
        $call!($effects.firings.beam, "firings");
        $call!($effects.firings.surface, "firings");
        $call!($effects.firings.clock, "readings");
        $call!($effects.mechanism, "steps");
        $call!($effects.encoder, "polls");
        $call!($effects.link, "messages");
    };
}

impl ConfiguredEffects {
    /// Removes the effects whose names `keep` rejects.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        macro_rules! retain {
            ($list:expr, $each:literal) => {
                $list.retain(|listed| keep(listed.effect.name()))
            };
        }
        for_each_list!(self, retain);
    }

    /// All effects and their counts, in the order in which they act.
    #[must_use]
    pub fn usage(&self) -> Vec<EffectUsage> {
        let mut usage = Vec::new();
        macro_rules! collect {
            ($list:expr, $each:literal) => {
                usage.extend($list.iter().map(|listed| listed.effect_usage($each)))
            };
        }
        for_each_list!(self, collect);
        usage
    }
}

/// An effect in a list. `P` is an `Arc` or a `Box` of it.
#[derive(Debug)]
pub struct MeteredEffect<P> {
    /// The effect.
    pub effect: P,
    meter: Meter,
}

/// Counts and cost of an effect's calls.
#[derive(Debug)]
struct Meter {
    counts: Cell<UsageCounts>,
    stopwatch: Stopwatch,
}

impl<P: Clone> Clone for MeteredEffect<P> {
    /// A copy starts with counts of zero, so that they can be added to those of the original.
    fn clone(&self) -> Self {
        Self::new(self.effect.clone(), self.meter.stopwatch)
    }
}

impl<P> MeteredEffect<P> {
    /// An effect without any calls.
    #[must_use]
    pub fn new(effect: P, stopwatch: Stopwatch) -> Self {
        let counts = Cell::default();
        Self {
            effect,
            meter: Meter { counts, stopwatch },
        }
    }

    /// Its counts so far.
    #[must_use]
    pub fn counts(&self) -> UsageCounts {
        self.meter.counts.get()
    }
}

impl Meter {
    /// Makes a call and counts it; `changed` gives the number of changes of a result.
    #[inline]
    fn call<T>(&self, call: impl FnOnce() -> T, changed: impl FnOnce(&T) -> u32) -> T {
        let begun = self.stopwatch.map(|now| now());
        let result = call();
        let changed = changed(&result);
        let ended = self.stopwatch.map(|now| now());
        let spent_ns = begun.zip(ended).map_or(0, |(a, b)| b.saturating_sub(a));
        self.add(UsageCounts {
            calls: 1,
            acted: u64::from(changed > 0),
            changed: u64::from(changed),
            spent_ns,
        });
        result
    }

    #[inline]
    fn add(&self, more: UsageCounts) {
        let counts = self.counts.get();
        self.counts.set(UsageCounts {
            calls: counts.calls.saturating_add(more.calls),
            acted: counts.acted.saturating_add(more.acted),
            changed: counts.changed.saturating_add(more.changed),
            spent_ns: counts.spent_ns.saturating_add(more.spent_ns),
        });
    }
}

impl<P: Deref<Target: Effect>> MeteredEffect<P> {
    fn effect_usage(&self, each: &'static str) -> EffectUsage {
        EffectUsage {
            name: self.effect.name(),
            each: if self.effect.needs().azimuths {
                "blocks"
            } else {
                each
            },
            counts: self.counts(),
            idle_reason: self.effect.idle_reason(),
        }
    }
}

/// The number of changes of a result that is that number.
const fn count(count: &u32) -> u32 {
    *count
}

/// One change where a result differs from the input.
fn differs<T: PartialEq + Copy>(from: T) -> impl FnOnce(&T) -> u32 {
    move |to| u32::from(*to != from)
}

impl<P: Deref<Target: Effect> + std::fmt::Debug> Effect for Vec<MeteredEffect<P>> {
    fn name(&self) -> &'static str {
        "list"
    }

    fn needs(&self) -> Needs {
        self.iter().fold(Needs::default(), |needs, listed| {
            needs.and(listed.effect.needs())
        })
    }

    fn absorb(&mut self, copy: &Self) {
        for (mine, theirs) in self.iter().zip(copy) {
            mine.meter.add(theirs.counts());
        }
    }
}

impl<T: ObjectsEffect + ?Sized> ObjectsEffect for SharedEffects<T> {
    fn place(&self, time_s: f64, surroundings: &mut Surroundings) -> u32 {
        self.iter()
            .map(|MeteredEffect { effect, meter }| {
                meter.call(|| effect.place(time_s, surroundings), count)
            })
            .sum()
    }
}

impl<T: ViewEffect + ?Sized> ViewEffect for SharedEffects<T> {
    fn fires(&self, azimuth_deg: f64) -> bool {
        let mut views = self.iter().filter(|listed| listed.effect.needs().azimuths);
        views.all(|MeteredEffect { effect, meter }| {
            meter.call(|| effect.fires(azimuth_deg), |fires| u32::from(!fires))
        })
    }

    fn hide(&self, firing: &mut SimulatedFiring) -> u32 {
        // Effects of azimuths were applied when the run's firings were scheduled.
        self.iter()
            .filter(|listed| !listed.effect.needs().azimuths)
            .map(|MeteredEffect { effect, meter }| meter.call(|| effect.hide(firing), count))
            .sum()
    }
}

impl<T: BeamEffect + ?Sized> BeamEffect for SharedEffects<T> {
    fn receive(
        &self,
        firing: &SimulatedFiring,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
    ) -> u32 {
        self.iter()
            .map(|MeteredEffect { effect, meter }| {
                meter.call(|| effect.receive(firing, surroundings, echoes), count)
            })
            .sum()
    }
}

impl<T: SurfaceEffect + ?Sized> SurfaceEffect for SharedEffects<T> {
    fn reflect(&self, firing: &SimulatedFiring, echoes: &mut Echoes) -> u32 {
        self.iter()
            .map(|MeteredEffect { effect, meter }| {
                meter.call(|| effect.reflect(firing, echoes), count)
            })
            .sum()
    }

    fn range_variance_m2(&self) -> f64 {
        let each = self.iter().map(|listed| listed.effect.range_variance_m2());
        each.sum()
    }

    fn misalign(&self, beams: &mut [LaserBeam]) {
        self.iter().for_each(|listed| listed.effect.misalign(beams));
    }
}

impl<T: ClockEffect + ?Sized> ClockEffect for SharedEffects<T> {
    fn host_ns(&self, device_ns: i64) -> i64 {
        self.iter()
            .fold(device_ns, |ns, MeteredEffect { effect, meter }| {
                meter.call(|| effect.host_ns(ns), differs(ns))
            })
    }
}

impl<T: MechanismEffect + ?Sized> MechanismEffect for OwnedEffects<T> {
    fn is_present(&self) -> bool {
        !self.is_empty()
    }

    fn step(&mut self, time_s: f64, axis: &mut AxisAngles) -> bool {
        let mut any = false;
        for MeteredEffect { effect, meter } in self {
            any |= meter.call(|| effect.step(time_s, axis), |acted| u32::from(*acted));
        }
        any
    }
}

impl<T: EncoderEffect + ?Sized> EncoderEffect for OwnedEffects<T> {
    fn read(&mut self, poll: u64, shaft: Degrees) -> Degrees {
        self.iter_mut().fold(shaft, |shaft, listed| {
            let MeteredEffect { effect, meter } = listed;
            meter.call(|| effect.read(poll, shaft), differs(shaft))
        })
    }

    fn gearing(&self) -> Option<Gearing> {
        self.iter().rev().find_map(|listed| listed.effect.gearing())
    }
}

impl<T: LinkEffect + ?Sized> LinkEffect for OwnedEffects<T> {
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        deliver_through(self, message, arrive)
    }
}

/// Passes a message through the first link and its results through the rest.
fn deliver_through<T: LinkEffect + ?Sized>(
    links: &mut [MeteredEffect<Box<T>>],
    message: LinkMessage,
    arrive: &mut dyn FnMut(LinkMessage),
) -> u32 {
    let Some((MeteredEffect { effect, meter }, rest)) = links.split_first_mut() else {
        arrive(message);
        return 0;
    };
    // Collected first, so that the measured time is that of this link alone.
    let mut delivered = Vec::new();
    let mut collect = |message| delivered.push(message);
    let acted = meter.call(|| effect.deliver(message, &mut collect), count);
    delivered
        .into_iter()
        .map(|message| deliver_through(rest, message, arrive))
        .sum::<u32>()
        + acted
}
