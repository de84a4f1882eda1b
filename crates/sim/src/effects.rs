//! Disturbances of the simulation, each absent unless configured.
//!
//! An effect implements the trait of the place where its physics acts:
//!
//! | trait | acts on | called |
//! |---|---|---|
//! | [`ObjectsEffect`] | positions of objects | per firing, before rays are cast |
//! | [`ViewEffect`] | which lasers fire, which beams leave the scanner | per block, per firing |
//! | [`BeamEffect`] | a pulse on its way: footprint, second returns, rain | per firing |
//! | [`SurfaceEffect`] | what a return reports: range, strength, detection | per firing |
//! | [`ClockEffect`] | the lidar's time against the host's | per firing and packet |
//! | [`MechanismEffect`] | from the commanded angle to motor shaft and platform | per [`STEP_S`] |
//! | [`EncoderEffect`] | the position that the drive reports | per poll |
//! | [`LinkEffect`] | arrival and loss of packets and answers | per message |
//!
//! All lasers of a firing go in together, never point by point. `()` is the absence of any effect:
//! code instantiated for it contains no code of effects. A `Vec` of [`MeteredEffect`] holds the
//! effects that a scene file configures.
//!
//! The first five are shared by threads that take firings in any order. Their results depend only
//! on their arguments and their [`RandomSource`](crate::random::RandomSource), so one seed gives
//! the same bytes on any number of threads. The last three run in order of time in one thread and
//! may keep state.

mod listed;

use units::{Degrees, Gearing};

use crate::firing::{Echoes, SimulatedFiring, Surroundings};
use crate::sensor::LaserBeam;

pub use listed::{ConfiguredEffects, EffectUsage, MeteredEffect, Stopwatch, UsageCounts};

/// Seconds per step of the mechanism; it moves linearly in between.
pub const STEP_S: f64 = 250e-6;

/// Inputs of an effect that take time to compute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Needs {
    /// The surface's normal at every return.
    pub normals: bool,
    /// Calls of [`ViewEffect::fires`].
    pub azimuths: bool,
    /// Calls of [`ObjectsEffect::place`].
    pub moving: bool,
}

impl Needs {
    /// The needs of both.
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

/// Methods of all effects.
pub trait Effect: core::fmt::Debug {
    /// The key in the scene file's `[effects]` and the name of the effect's random draws.
    fn name(&self) -> &'static str;

    /// Inputs that take time to compute; none by default.
    #[inline]
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// Explanation for an effect that never acted in a run.
    fn idle_reason(&self) -> &'static str {
        "it never changed anything"
    }

    /// Adds the counts of a copy that a thread worked with.
    #[inline]
    fn absorb(&mut self, copy: &Self)
    where
        Self: Sized,
    {
        let _ = copy;
    }
}

/// Moves objects of the scene.
pub trait ObjectsEffect: Effect {
    /// Moves objects to their positions at `time_s` seconds after the start (host time). Returns
    /// how many moved.
    #[inline(always)]
    fn place(&self, time_s: f64, surroundings: &mut Surroundings) -> u32 {
        let _ = (time_s, surroundings);
        0
    }
}

/// Keeps beams from leaving the scanner.
pub trait ViewEffect: Effect {
    /// Whether the sensor fires a block that begins at this azimuth (0..360 degrees). Called only
    /// if [`Needs::azimuths`] is set.
    #[inline(always)]
    fn fires(&self, azimuth_deg: f64) -> bool {
        let _ = azimuth_deg;
        true
    }

    /// Clears lasers of [`SimulatedFiring::alive`] whose beams are blocked. Returns how many.
    #[inline(always)]
    fn hide(&self, firing: &mut SimulatedFiring) -> u32 {
        let _ = firing;
        0
    }
}

/// Only each `every`-th firing (0 as 1) sends pulses: a sample of a scene that keeps its packets
/// and its time.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct FiringSample {
    /// Firings from one to the next.
    pub every: u64,
}

impl Effect for FiringSample {
    fn name(&self) -> &'static str {
        "firing_sample"
    }
}

impl ViewEffect for FiringSample {
    fn hide(&self, firing: &mut SimulatedFiring) -> u32 {
        if firing.number.is_multiple_of(self.every.max(1)) {
            return 0;
        }
        let hidden = firing.alive.count_ones();
        firing.alive = 0;
        hidden
    }
}

/// Acts on a pulse between sensor and surface.
pub trait BeamEffect: Effect {
    /// Replaces the returns of each beam's axis by those of the whole pulse. `surroundings` casts
    /// further rays. Returns on how many lasers the effect acted.
    #[inline(always)]
    fn receive(
        &self,
        firing: &SimulatedFiring,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
    ) -> u32 {
        let _ = (firing, surroundings, echoes);
        0
    }
}

/// Acts on the measurement of a return.
pub trait SurfaceEffect: Effect {
    /// Changes ranges and strengths or removes returns. Returns on how many lasers it acted.
    #[inline(always)]
    fn reflect(&self, firing: &SimulatedFiring, echoes: &mut Echoes) -> u32 {
        let _ = (firing, echoes);
        0
    }

    /// Variance of its random errors of a range, square metres.
    fn range_variance_m2(&self) -> f64 {
        0.0
    }

    /// Moves the lasers from where the sensor's tables have them, before the first firing.
    fn misalign(&self, beams: &mut [LaserBeam]) {
        let _ = beams;
    }
}

/// The lidar's clock.
pub trait ClockEffect: Effect {
    /// Host nanoseconds since the start when the lidar's clock shows `device_ns` since the start.
    /// Monotonic.
    #[inline(always)]
    fn host_ns(&self, device_ns: i64) -> i64 {
        device_ns
    }
}

/// Angles of the tilt axis at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisAngles {
    /// Commanded angle, degrees of tilt. Read-only for effects.
    pub commanded_deg: f64,
    /// Motor shaft as the encoder sees it, in degrees of tilt by the gear ratio.
    pub shaft_deg: f64,
    /// Platform, degrees.
    pub platform_deg: f64,
}

/// Servo, gear and stops. Starts at rest at the commanded angle.
pub trait MechanismEffect: Effect {
    /// Whether [`MechanismEffect::step`] has to be called; else the axis follows its command.
    #[inline]
    fn is_present(&self) -> bool {
        true
    }

    /// Advances by [`STEP_S`] to `time_s` seconds after the start and changes shaft and platform.
    /// Both come as commanded or as the previous effect left them; an effect that moves the shaft
    /// moves `platform_deg` by the same amount. Returns whether it acted.
    #[inline(always)]
    fn step(&mut self, time_s: f64, axis: &mut AxisAngles) -> bool {
        let _ = (time_s, axis);
        false
    }
}

/// The encoder on the motor shaft.
pub trait EncoderEffect: Effect {
    /// The reported angle for the true angle `shaft`; `poll` counts from 0.
    #[inline(always)]
    fn read(&mut self, poll: u64, shaft: Degrees) -> Degrees {
        let _ = poll;
        shaft
    }

    /// Encoder and gear that quadcounts refer to, where they are not those of an ideal encoder.
    #[inline]
    fn gearing(&self) -> Option<Gearing> {
        None
    }
}

/// A message between a device and the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LinkMessage {
    /// Its kind.
    pub kind: MessageKind,
    /// Its number among messages of its kind, from 0.
    pub number: u64,
    /// Time at which it is sent, and after an effect at which it arrives: host nanoseconds since
    /// the start.
    pub time_ns: i64,
}

/// Kinds of messages; their order is that of the random channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageKind {
    /// A data packet of the lidar.
    Data,
    /// A position packet of the lidar.
    Position,
    /// A request to the drive.
    Request,
    /// An answer of the drive.
    Answer,
}

impl MessageKind {
    /// Whether the lidar sends it; else it is exchanged with the drive.
    #[must_use]
    pub const fn is_from_lidar(self) -> bool {
        matches!(self, Self::Data | Self::Position)
    }

    /// The channel of its random draws.
    #[must_use]
    pub const fn channel(self) -> u32 {
        self as u32
    }
}

/// The links.
pub trait LinkEffect: Effect {
    /// Passes a message to `arrive` with its time of arrival (not before it is sent): once, not at
    /// all or several times. Messages of a kind come in the order in which they are sent. Returns
    /// how often the effect acted.
    #[inline(always)]
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        arrive(message);
        0
    }
}

/// No effect.
impl Effect for () {
    fn name(&self) -> &'static str {
        "none"
    }
}

impl ObjectsEffect for () {}
impl ViewEffect for () {}
impl BeamEffect for () {}
impl SurfaceEffect for () {}
impl ClockEffect for () {}
impl EncoderEffect for () {}
impl LinkEffect for () {}
impl MechanismEffect for () {
    #[inline(always)]
    fn is_present(&self) -> bool {
        false
    }
}

/// Effects that threads share: those that act on firings.
#[derive(Clone, Debug, Default)]
pub struct FiringEffectSet<O = (), V = (), B = (), S = (), C = ()> {
    /// Moving objects.
    pub objects: O,
    /// Hidden beams.
    pub view: V,
    /// The way of the pulse.
    pub beam: B,
    /// The measurement.
    pub surface: S,
    /// The lidar's clock.
    pub clock: C,
}

/// All effects of a run. `Effects::default()` is none.
#[derive(Clone, Debug, Default)]
pub struct Effects<F = FiringEffectSet, M = (), E = (), L = ()> {
    /// Effects on firings.
    pub firings: F,
    /// Effects on the axis.
    pub mechanism: M,
    /// Effects on the encoder's readings.
    pub encoder: E,
    /// Effects on the links.
    pub link: L,
}

/// The five parts of [`FiringEffectSet`] behind one type parameter. Threads work on copies.
pub trait FiringEffects: Clone + Send {
    /// Moving objects.
    type Objects: ObjectsEffect;
    /// Hidden beams.
    type View: ViewEffect;
    /// The way of the pulse.
    type Beam: BeamEffect;
    /// The measurement.
    type Surface: SurfaceEffect;
    /// The lidar's clock.
    type Clock: ClockEffect;

    /// All five parts.
    fn parts(&self) -> FiringEffectRefs<'_, Self>;
    /// The needs of all parts.
    fn needs(&self) -> Needs;
    /// Adds the counts of a copy that a thread worked with.
    fn absorb(&mut self, copy: &Self);
}

/// The five parts of [`FiringEffects`], borrowed.
#[derive(Debug)]
#[non_exhaustive]
pub struct FiringEffectRefs<'a, F: FiringEffects> {
    /// Moving objects.
    pub objects: &'a F::Objects,
    /// Hidden beams.
    pub view: &'a F::View,
    /// The way of the pulse.
    pub beam: &'a F::Beam,
    /// The measurement.
    pub surface: &'a F::Surface,
    /// The lidar's clock.
    pub clock: &'a F::Clock,
}

impl<O, V, B, S, C> FiringEffects for FiringEffectSet<O, V, B, S, C>
where
    O: ObjectsEffect + Clone + Send,
    V: ViewEffect + Clone + Send,
    B: BeamEffect + Clone + Send,
    S: SurfaceEffect + Clone + Send,
    C: ClockEffect + Clone + Send,
{
    type Objects = O;
    type View = V;
    type Beam = B;
    type Surface = S;
    type Clock = C;

    #[inline]
    fn parts(&self) -> FiringEffectRefs<'_, Self> {
        FiringEffectRefs {
            objects: &self.objects,
            view: &self.view,
            beam: &self.beam,
            surface: &self.surface,
            clock: &self.clock,
        }
    }

    #[inline]
    fn needs(&self) -> Needs {
        (self.objects.needs())
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
