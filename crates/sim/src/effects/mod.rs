//! What keeps the real world from being ideal: one file each, and each absent unless a configuration asks for it.
//!
//! An effect implements the trait of the place where its physics acts:
//!
//! | trait | acts on | asked |
//! |---|---|---|
//! | [`Objects`] | where things of the scene stand | once a firing, before rays are cast |
//! | [`View`] | which lasers fire at all, which beams leave the scanner | once a block, once a firing |
//! | [`Beam`] | what comes back of a pulse: footprint, second returns, rain | once a firing |
//! | [`Surface`] | what a return says: range, strength, whether it is noticed | once a firing |
//! | [`Clock`] | the lidar's time against the host's | once a firing and packet |
//! | [`Mechanism`] | the way from the commanded angle to motor shaft and platform | once a step of [`STEP_S`] |
//! | [`Encoder`] | what the drive says of its shaft | once a poll |
//! | [`Wire`] | when packets and answers arrive, and whether | once a packet, request and answer |
//!
//! All lasers of a firing go in together, never point by point. `()` is the absence of any effect: the engine instantiated for it has no code of
//! effects in it. `(A, B)` is A, then B, without a call that is not known beforehand. A `Vec` of [`Listed`] is what a scene file asks for.
//! The first five are shared by threads that take firings in any order: what they answer depends on what they are asked and on their
//! [`Source`](crate::random::Source) alone, which is why one seed gives the same bytes on any number of threads. The last three go through time
//! in order, in one thread, and may remember.
//!
//! A servo's lag is the drive's own ([`firmware_sim::epos2::Servo`]) in the rig, as its encoder shows it. Left out here: what each effect is.

mod absent;
#[cfg(feature = "effects")]
mod backlash;
#[cfg(feature = "effects")]
mod batching;
#[cfg(feature = "effects")]
mod catalogue;
#[cfg(feature = "effects")]
mod divergence;
#[cfg(feature = "effects")]
mod duplicate;
#[cfg(feature = "effects")]
mod encoder_quantisation;
#[cfg(feature = "effects")]
mod explain;
mod gear_ripple;
#[cfg(feature = "effects")]
mod lidar_clock;
#[cfg(feature = "effects")]
mod light;
#[cfg(feature = "effects")]
mod limited_field_of_view;
#[cfg(feature = "effects")]
mod link_jitter;
#[cfg(feature = "effects")]
mod listed;
#[cfg(feature = "effects")]
mod loss;
#[cfg(feature = "effects")]
mod moving_objects;
#[cfg(feature = "effects")]
mod own_shadow;
mod pair;
#[cfg(feature = "effects")]
mod range_noise;
#[cfg(feature = "effects")]
mod reflectance;
#[cfg(feature = "effects")]
mod reorder;
#[cfg(feature = "effects")]
mod returns;
#[cfg(feature = "effects")]
mod servo_lag;
#[cfg(feature = "effects")]
mod settings;
#[cfg(feature = "effects")]
mod some_later;
#[cfg(all(test, feature = "effects"))]
mod testing;
#[cfg(feature = "effects")]
mod tilt_limits;
#[cfg(feature = "effects")]
mod uneven_gear;
#[cfg(feature = "effects")]
mod weather;

use units::{Degrees, Gearing};

use crate::simulate::{Echoes, Firing, Surroundings};

pub use gear_ripple::GearRipple;

#[cfg(feature = "effects")]
pub use self::{
    backlash::{Backlash, BacklashSettings},
    batching::{Batching, BatchingSettings},
    catalogue::{Misplaced, Wish, Wishes},
    divergence::{Divergence, DivergenceSettings},
    duplicate::{Duplicate, DuplicateSettings},
    encoder_quantisation::{EncoderQuantisation, EncoderQuantisationSettings},
    explain::{Explained, Explanation},
    lidar_clock::{DriftingClock, LidarClockSettings},
    limited_field_of_view::{LimitedFieldOfView, LimitedFieldOfViewSettings},
    link_jitter::{LinkJitter, LinkJitterSettings},
    listed::{Asked, Listed, Usage, Used},
    loss::{Loss, LossSettings},
    moving_objects::{Mover, MovingBox, MovingObjects, MovingObjectsSettings},
    own_shadow::{OwnShadow, OwnShadowSettings, ShadowSector},
    range_noise::{RangeNoise, RangeNoiseSettings},
    reflectance::{Reflectance, ReflectanceSettings},
    reorder::{Reorder, ReorderSettings},
    servo_lag::{ServoLag, ServoLagSettings},
    settings::{Settings, Stopwatch, Unfit},
    tilt_limits::{TiltLimits, TiltLimitsSettings},
    uneven_gear::{GearRippleSettings, UnevenGear},
    weather::{Weather, WeatherSettings},
};

/// Seconds from one step of the mechanism to the next; it moves evenly in between.
pub const STEP_S: f64 = 250e-6;

/// What an effect needs that costs time to find out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The surface's normal at every return.
    pub normals: bool,
    /// To be asked which azimuths the sensor fires at ([`View::fires`]).
    pub azimuths: bool,
    /// To be asked where objects stand ([`Objects::place`]).
    pub moving: bool,
}

impl Needs {
    /// None of it.
    pub const NOTHING: Self = Self {
        normals: false,
        azimuths: false,
        moving: false,
    };

    /// What either needs.
    #[inline]
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self {
            normals: self.normals | other.normals,
            azimuths: self.azimuths | other.azimuths,
            moving: self.moving | other.moving,
        }
    }
}

/// What all effects have.
pub trait Effect: core::fmt::Debug {
    /// What the scene file's `[effects]` calls it, and the name its random draws go by.
    fn name(&self) -> &'static str;

    /// What it needs; nothing unless it says so.
    #[inline]
    fn needs(&self) -> Needs {
        Needs::NOTHING
    }

    /// Why it was not needed, where it never acted in a whole run.
    fn why_idle(&self) -> &'static str {
        "it never changed anything"
    }
}

/// Things of the scene that move.
pub trait Objects: Effect {
    /// Moves them to where they stand `at_s` seconds after the start (host's time); how many moved.
    fn place(&self, at_s: f64, surroundings: &mut Surroundings) -> u32;
}

/// What keeps beams from leaving the scanner.
pub trait View: Effect {
    /// Whether the sensor fires a block that begins at this azimuth (0..360 degrees). Asked only if [`Needs::azimuths`] is set.
    #[inline]
    fn fires(&self, azimuth_deg: f64) -> bool {
        let _ = azimuth_deg;
        true
    }

    /// Takes lasers out of [`Firing::alive`] whose beams do not get out; how many.
    #[inline]
    fn look(&self, firing: &mut Firing) -> u32 {
        let _ = firing;
        0
    }
}

/// What happens to a pulse on its way.
pub trait Beam: Effect {
    /// Changes what came back of each beam's middle to what comes back of the pulse: other ranges, second returns, none. The surroundings can be
    /// asked for more rays. How many lasers it acted on.
    fn receive(&self, firing: &Firing, surroundings: &Surroundings, echoes: &mut Echoes) -> u32;
}

/// What the sensor makes of what came back.
pub trait Surface: Effect {
    /// Changes ranges and strengths, or takes returns away; how many lasers it acted on.
    fn reflect(&self, firing: &Firing, echoes: &mut Echoes) -> u32;
}

/// The lidar's clock.
pub trait Clock: Effect {
    /// Nanoseconds since the start on the host's clock when the lidar's shows `device_ns` since the start. Never falls as `device_ns` rises.
    fn host_ns(&self, device_ns: i64) -> i64;
}

/// Where the tilt axis stands at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// What the motion commands, degrees of tilt. Not for changing.
    pub commanded_deg: f64,
    /// Where the motor's shaft is, which the encoder sees, in degrees of tilt by the gear's ratio.
    pub shaft_deg: f64,
    /// Where the platform is, degrees.
    pub platform_deg: f64,
}

/// Servo, gear and stops. It starts at rest, its shaft and platform where they are commanded.
pub trait Mechanism: Effect {
    /// Whether it has to be asked at all, step by step; else the axis is where it is commanded.
    #[inline]
    fn is_there(&self) -> bool {
        true
    }

    /// Goes on by [`STEP_S`] to `at_s` seconds after the start, and changes where shaft and platform are to be there. Both come as commanded,
    /// or as the effect before left them: what moves the shaft moves `platform_deg` by as much. Whether it acted.
    fn step(&mut self, at_s: f64, axis: &mut Axis) -> bool;
}

/// The encoder on the motor's shaft.
pub trait Encoder: Effect {
    /// What it says of a shaft that truly is at `shaft`; `poll` counts from 0.
    fn read(&mut self, poll: u64, shaft: Degrees) -> Degrees;

    /// The lines and gear that quadcounts are of, where not those of an ideal encoder.
    #[inline]
    fn gearing(&self) -> Option<Gearing> {
        None
    }
}

/// What is on its way between a device and the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parcel {
    /// Of what kind.
    pub kind: ParcelKind,
    /// Its number among its kind, from 0.
    pub number: u64,
    /// When it leaves where it comes from, host's nanoseconds since the start.
    pub leaves_ns: i64,
}

/// Kinds of parcels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParcelKind {
    /// A data packet of the lidar's.
    Data,
    /// A position packet of the lidar's.
    Position,
    /// A request to the drive.
    Request,
    /// The drive's answer.
    Answer,
}

impl ParcelKind {
    /// Whether it comes from the lidar; else it goes to the drive or comes from there.
    #[must_use]
    pub const fn is_lidars(self) -> bool {
        matches!(self, Self::Data | Self::Position)
    }

    /// The channel of its random draws.
    #[must_use]
    pub const fn channel(self) -> u32 {
        match self {
            Self::Data => 0,
            Self::Position => 1,
            Self::Request => 2,
            Self::Answer => 3,
        }
    }
}

/// The links.
pub trait Wire: Effect {
    /// Hands a parcel on to `arrive` with the time at which it arrives (not before it left): once, not at all, or more often. Parcels of a kind
    /// come in the order in which they leave. How often it acted.
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32;
}

/// Effects that threads share: everything that acts on firings.
#[derive(Clone, Debug, Default)]
pub struct OnFirings<O = (), V = (), B = (), S = (), C = ()> {
    /// What moves.
    pub objects: O,
    /// What keeps beams in.
    pub view: V,
    /// What happens on the way.
    pub beam: B,
    /// What is made of it.
    pub surface: S,
    /// The lidar's clock.
    pub clock: C,
}

/// All effects of a run. `Effects::default()` is none at all.
#[derive(Clone, Debug, Default)]
pub struct Effects<F = OnFirings, M = (), E = (), W = ()> {
    /// What acts on firings.
    pub firings: F,
    /// What acts on the axis.
    pub mechanism: M,
    /// What acts on its readings.
    pub encoder: E,
    /// What acts on the links.
    pub wire: W,
}

/// The five of [`OnFirings`], by name, so that whoever is generic over them is so over one thing. Threads work on copies.
pub trait FiringEffects: Clone + Send {
    /// What moves.
    type Objects: Objects;
    /// What keeps beams in.
    type View: View;
    /// What happens on the way.
    type Beam: Beam;
    /// What is made of it.
    type Surface: Surface;
    /// The lidar's clock.
    type Clock: Clock;

    /// All five.
    fn parts(&self) -> Parts<'_, Self>;
    /// What any of them needs.
    fn needs(&self) -> Needs;
    /// Takes over the counts of a copy that a thread worked with.
    fn absorb(&mut self, copy: &Self);
}

/// The five, borrowed.
#[derive(Debug)]
pub struct Parts<'a, F: FiringEffects> {
    /// What moves.
    pub objects: &'a F::Objects,
    /// What keeps beams in.
    pub view: &'a F::View,
    /// What happens on the way.
    pub beam: &'a F::Beam,
    /// What is made of it.
    pub surface: &'a F::Surface,
    /// The lidar's clock.
    pub clock: &'a F::Clock,
}

/// What counts how often it acted, and gives the counts of a copy back.
pub trait Absorb {
    /// Adds the counts of a copy.
    #[inline]
    fn absorb(&mut self, copy: &Self) {
        let _ = copy;
    }
}

impl<O, V, B, S, C> FiringEffects for OnFirings<O, V, B, S, C>
where
    O: Objects + Absorb + Clone + Send,
    V: View + Absorb + Clone + Send,
    B: Beam + Absorb + Clone + Send,
    S: Surface + Absorb + Clone + Send,
    C: Clock + Absorb + Clone + Send,
{
    type Objects = O;
    type View = V;
    type Beam = B;
    type Surface = S;
    type Clock = C;

    #[inline]
    fn parts(&self) -> Parts<'_, Self> {
        Parts {
            objects: &self.objects,
            view: &self.view,
            beam: &self.beam,
            surface: &self.surface,
            clock: &self.clock,
        }
    }

    #[inline]
    fn needs(&self) -> Needs {
        self.objects
            .needs()
            .and(self.view.needs())
            .and(self.beam.needs())
            .and(self.surface.needs())
            .and(self.clock.needs())
    }

    fn absorb(&mut self, copy: &Self) {
        self.objects.absorb(&copy.objects);
        self.view.absorb(&copy.view);
        self.beam.absorb(&copy.beam);
        self.surface.absorb(&copy.surface);
        self.clock.absorb(&copy.clock);
    }
}
