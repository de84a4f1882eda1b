//! What a drive can do wrong.

use crate::drive::Drive;
use crate::run::Transport;

/// When a misbehaviour begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Before the client connects.
    Start,
    /// 0.2 s into homing.
    Homing,
    /// With the end of homing.
    Homed,
    /// 0.05 s later, at rest under power.
    Waiting,
    /// With the command that starts the sweep.
    SweepStart,
    /// 0.4 s into the sweep.
    MidSweep,
    /// 0.1 s before the sweep ends: the axis brakes, 2.5 deg before its limit.
    Braking,
    /// With the first stop after a SIGTERM in mid-sweep.
    Stopping,
}

/// What the client must make of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// The capture is complete, exit 0.
    Completes,
    /// Refused before anything moves.
    Refused,
    /// Stopped within 50 ms of the sample that shows it.
    Stopped,
    /// No sample shows it: stopped once silence or damage is certain: within a second, on RS232
    /// 1.6 s.
    Silent,
    /// The positions do not show it: stopped once a limit switch does.
    Unseen,
    /// The quick stop is ignored: stopped by power off and brake.
    Braked,
    /// The first power off is lost, too.
    BrakedLate,
    /// Homing ends within its bound of travel.
    HomingBound,
    /// Homing stops within 50 ms of the sample that shows that the axis does not follow.
    HomingStopped,
    /// The drive obeys nothing, or hears nothing: the message tells to cut the supply.
    Unstoppable,
    /// The power is off and the command failed; only weight moves the axis.
    Falls,
    /// Complete or stopped; safe in the end.
    Safe,
}

/// A way in which a drive misbehaves.
#[derive(Clone, Copy)]
pub struct Misbehaviour {
    /// Its row in the table.
    pub name: &'static str,
    /// When it begins.
    pub when: When,
    /// What begins.
    pub act: fn(&mut Drive),
    /// What must come of it.
    pub expect: Expect,
    /// Only on CAN.
    pub only_can: bool,
    /// Who moves the axis.
    pub by: By,
}

impl Misbehaviour {
    /// Whether it can be seen on this link.
    pub fn is_possible(&self, transport: Transport) -> bool {
        !self.only_can || transport == Transport::Slcan
    }
}

/// Who moves the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// `velomotion capture`.
    Capture,
    /// `velomotion tilt home`, then `velomotion tilt goto`.
    Goto,
    /// A daemon, for `velomotion capture`.
    Daemon,
}

/// What the motor does while the power stage is enabled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Motor {
    /// What the servo wants.
    #[default]
    Follows,
    /// The opposite of the profile.
    Backwards,
    /// Turns at this speed, deg/s.
    RunsAt(f64),
    /// Keeps the speed that it has.
    KeepsOn,
}

/// The position that is reported.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Report {
    /// That of the encoder.
    #[default]
    Truth,
    /// That at the beginning.
    Held,
    /// Off by so many quadcounts.
    Shifted(i32),
    /// That of so many seconds ago.
    Late(f64),
}

/// Damage to the answers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Damage {
    /// None.
    #[default]
    None,
    /// There are no answers.
    Silence,
    /// They leave this much later, in seconds.
    Late(f64),
    /// Random bytes.
    Garbage,
    /// Every n-th one is lost.
    Every(u32),
}

/// Limit switches as the drive sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Switches {
    /// As they are.
    #[default]
    Work,
    /// Never pressed.
    Dead,
    /// The positive one is always pressed.
    PositiveOn,
    /// The negative one is always pressed.
    NegativeOn,
    /// A pressed one opens again and again for milliseconds.
    Bounce,
}

impl Switches {
    /// The pressed switches as seen.
    pub fn seen(self, pressed: u16, now: f64) -> u16 {
        match self {
            Self::Work => pressed,
            Self::Dead => 0,
            Self::PositiveOn => pressed | 2,
            Self::NegativeOn => pressed | 1,
            Self::Bounce if ((now * 400.0) as u64).is_multiple_of(3) => 0,
            Self::Bounce => pressed,
        }
    }
}

/// Everything that is wrong with a drive.
pub struct Faults {
    pub armed: Option<&'static Misbehaviour>,
    pub motor: Motor,
    pub report: Report,
    pub damage: Damage,
    pub switches: Switches,
    /// Amplitude of the positions at rest, qc.
    pub dither: f64,
    /// Profile velocity as executed, per requested.
    pub speed_factor: f64,
    /// The drive's own following error and limit switches stop nothing.
    pub unprotected: bool,
    pub ignores_switches: bool,
    pub ignores_quick_stop: bool,
    pub ignores_disable: bool,
    /// So many commands of power off have no effect.
    pub lost_disables: u32,
    pub ignores_writes: bool,
    pub ignores_targets: bool,
    pub never_acknowledges: bool,
    /// Seconds until a quick stop begins, and until the power goes off.
    pub stops_after: f64,
    pub disables_after: f64,
    /// Speed that remains after a quick stop.
    pub creeps: Option<f64>,
    /// Statusword: switch-on disabled, whatever is.
    pub claims_off: bool,
    /// Statusword: target reached, or not.
    pub reached: Option<bool>,
    pub mode_lies: bool,
    pub speed_lies: bool,
    pub brake_stays_shut: bool,
    pub brake_stays_open: bool,
    pub sends_emcy: bool,
    pub emcy_storm: bool,
    pub stops_heartbeat: bool,
    /// Another node with the same id is pre-operational.
    pub second_node: bool,
    pub is_deaf: bool,
    pub wrong_node: bool,
    pub wrong_object: bool,
    pub spoils_sums: bool,
    pub drops_segments: bool,
    /// Copies of each answer.
    pub copies: u8,
    pub is_unplugged: bool,
    /// No program reads the client's output.
    pub unread: bool,
    pub(crate) held: Option<i32>,
    pub(crate) kept: Option<f64>,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            armed: None,
            motor: Motor::Follows,
            report: Report::Truth,
            damage: Damage::None,
            switches: Switches::Work,
            dither: 0.0,
            speed_factor: 1.0,
            unprotected: false,
            ignores_switches: false,
            ignores_quick_stop: false,
            ignores_disable: false,
            lost_disables: 0,
            ignores_writes: false,
            ignores_targets: false,
            never_acknowledges: false,
            stops_after: 0.0,
            disables_after: 0.0,
            creeps: None,
            claims_off: false,
            reached: None,
            mode_lies: false,
            speed_lies: false,
            brake_stays_shut: false,
            brake_stays_open: false,
            sends_emcy: true,
            emcy_storm: false,
            stops_heartbeat: false,
            second_node: false,
            is_deaf: false,
            wrong_node: false,
            wrong_object: false,
            spoils_sums: false,
            drops_segments: false,
            copies: 1,
            is_unplugged: false,
            unread: false,
            held: None,
            kept: None,
        }
    }
}
