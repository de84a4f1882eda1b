//! The misbehaviours: the rows of the table.

use crate::drive::Drive;
use crate::faults::Expect::{
    self, Braked, BrakedLate, Completes, Falls, HomingBound, HomingStopped, Refused, Safe, Silent,
    Stopped, Unseen, Unstoppable,
};
use crate::faults::When::{
    self, Braking, Homed, Homing, MidSweep, Start, Stopping, SweepStart, Waiting,
};
use crate::faults::{By, Damage, Misbehaviour, Motor, Report, Switches};

const fn row(name: &'static str, when: When, expect: Expect, act: fn(&mut Drive)) -> Misbehaviour {
    Misbehaviour {
        name,
        when,
        act,
        expect,
        only_can: false,
        by: By::Capture,
    }
}

const fn by(by: By, row: Misbehaviour) -> Misbehaviour {
    Misbehaviour { by, ..row }
}

const fn can(name: &'static str, when: When, expect: Expect, act: fn(&mut Drive)) -> Misbehaviour {
    Misbehaviour {
        only_can: true,
        ..row(name, when, expect, act)
    }
}

/// The drive neither protects itself nor obeys its switches.
fn unguarded(drive: &mut Drive) {
    drive.faults.unprotected = true;
}

/// Every misbehaviour.
#[rustfmt::skip] // a row a line
pub const ROWS: &[Misbehaviour] = &[
    row("nothing is wrong", Start, Completes, |_| {}),
    row("dither of 2 qc at rest", Start, Completes, |d| d.faults.dither = 2.0),
    row("dither of 8 qc at rest", Start, Completes, |d| d.faults.dither = 8.0),
    row("velocity 606C lies", Start, Completes, |d| d.faults.speed_lies = true),
    row("encoder of 512 lines", Start, Refused, |d| d.set(0x2210, 1, 512)),
    row("answers 150 ms late from the start", Start, Refused, |d| d.faults.damage = Damage::Late(0.15)),
    row("no position sensor (2210:2)", Start, Refused, |d| d.set(0x2210, 2, 0)),
    row("faults switch off at once (605E = 0)", Start, Refused, |d| d.set(0x605E, 0, 0)),
    row("velocity notation differs (608B)", Start, Refused, |d| d.set(0x608B, 0, 0xFD)),
    row("mode of operation is displayed wrong", Start, Refused, |d| d.faults.mode_lies = true),
    row("writes have no effect", Start, Refused, |d| d.faults.ignores_writes = true),
    row("segments of an upload are empty", Start, Refused, |d| d.faults.drops_segments = true),
    can("another node 1 sends heartbeats", Homing, Safe, |d| d.faults.second_node = true),
    // Homing.
    row("homing: the switch is dead", Start, HomingBound, |d| d.faults.switches = Switches::Dead),
    row("homing: the switch is always on", Start, HomingBound, |d| {
        d.faults.switches = Switches::PositiveOn;
    }),
    row("homing: the switch bounces", Start, Safe, |d| d.faults.switches = Switches::Bounce),
    row("homing: the motor runs backwards", Homing, HomingStopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::Backwards;
    }),
    row("homing: the motor stalls", Homing, HomingStopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(0.0);
    }),
    row("homing: it runs away at 60 deg/s", Homing, HomingStopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(-60.0);
    }),
    row("homing: the switch is dead, the demand is refused (6062)", Start, HomingBound, |d| {
        d.faults.switches = Switches::Dead;
        d.objects.remove(&(0x6062, 0));
    }),
    row("homing: the switch is dead, demand and position freeze", Start, HomingBound, |d| {
        (d.faults.switches, d.faults.report) = (Switches::Dead, Report::Held);
        d.objects.remove(&(0x6062, 0));
    }),
    row("homing: fault 2310", Homing, Stopped, |d| d.fail(0x2310, false)),
    row("homing: no answers", Homing, Silent, |d| d.faults.damage = Damage::Silence),
    row("homing: supply lost for 0.3 s", Homing, Safe, |d| d.lose_supply(0.3)),
    // A sweep.
    row("it moves away once it is homed", Homed, Stopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(20.0);
    }),
    row("it moves before its command", Waiting, Stopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(20.0);
    }),
    row("the motor runs backwards", SweepStart, Stopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::Backwards;
    }),
    row("twice the speed", SweepStart, Stopped, |d| d.faults.speed_factor = 2.0),
    row("the command to move has no effect", SweepStart, Stopped, |d| {
        d.faults.ignores_targets = true;
    }),
    row("the command to move is not acknowledged", SweepStart, Safe, |d| {
        d.faults.never_acknowledges = true;
    }),
    row("target reached is reported at once", SweepStart, Completes, |d| {
        d.faults.reached = Some(true);
    }),
    row("target reached is never reported", SweepStart, Safe, |d| d.faults.reached = Some(false)),
    row("the brake stays shut", SweepStart, Stopped, |d| {
        unguarded(d);
        d.faults.brake_stays_shut = true;
    }),
    row("stall", MidSweep, Stopped, |d| { unguarded(d); d.faults.motor = Motor::RunsAt(0.0); }),
    row("the motor turns round", MidSweep, Stopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(56.25);
    }),
    row("the encoder stops counting", MidSweep, Stopped, |d| {
        unguarded(d);
        d.axis.counting = 0.0;
    }),
    row("the encoder counts half", MidSweep, Unseen, |d| d.axis.counting = 0.5),
    row("the encoder counts half, and switches stop nothing", SweepStart, Unseen, |d| {
        d.axis.counting = 0.5;
        d.faults.ignores_switches = true;
    }),
    row("the position is frozen", MidSweep, Stopped, |d| d.faults.report = Report::Held),
    row("the position jumps by 10 deg", MidSweep, Stopped, |d| {
        d.faults.report = Report::Shifted(6_667);
    }),
    row("the position wraps", MidSweep, Stopped, |d| d.faults.report = Report::Shifted(i32::MIN)),
    row("the position is 500 ms old", MidSweep, Stopped, |d| d.faults.report = Report::Late(0.5)),
    row("it moves on past its target", Braking, Stopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::KeepsOn;
    }),
    row("it moves on and ignores quick stop", Braking, Braked, |d| {
        unguarded(d);
        d.faults.motor = Motor::KeepsOn;
        d.faults.ignores_quick_stop = true;
    }),
    row("it moves on and obeys nothing", Braking, Unstoppable, |d| {
        unguarded(d);
        d.faults.motor = Motor::KeepsOn;
        (d.faults.ignores_quick_stop, d.faults.ignores_disable) = (true, true);
    }),
    row("it ignores quick stop and loses the first power off", Braking, BrakedLate, |d| {
        unguarded(d);
        d.faults.motor = Motor::KeepsOn;
        (d.faults.ignores_quick_stop, d.faults.lost_disables) = (true, 1);
    }),
    row("it turns round and ignores quick stop", MidSweep, Braked, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(56.25);
        d.faults.ignores_quick_stop = true;
    }),
    row("a limit switch is pressed and stops nothing", MidSweep, Stopped, |d| {
        d.faults.ignores_switches = true;
        d.faults.switches = Switches::NegativeOn;
    }),
    row("fault 2310", MidSweep, Stopped, |d| d.fail(0x2310, false)),
    row("fault 2310 without EMCY", MidSweep, Stopped, |d| {
        d.faults.sends_emcy = false;
        d.fail(0x2310, false);
    }),
    row("switched off by itself, without a fault", MidSweep, Stopped, |d| {
        d.state = crate::drive::State::Disabled;
        d.power(false);
    }),
    row("statusword: switched off, and it moves on", MidSweep, Stopped, |d| {
        unguarded(d);
        (d.faults.motor, d.faults.claims_off) = (Motor::KeepsOn, true);
    }),
    row("supply lost for 0.3 s", MidSweep, Safe, |d| d.lose_supply(0.3)),
    row("no answers", MidSweep, Silent, |d| d.faults.damage = Damage::Silence),
    row("no answers, and it moves on", MidSweep, Silent, |d| {
        unguarded(d);
        (d.faults.motor, d.faults.damage) = (Motor::KeepsOn, Damage::Silence);
    }),
    row("it hears nothing", MidSweep, Unstoppable, |d| d.faults.is_deaf = true),
    row("it neither hears nor answers", MidSweep, Unstoppable, |d| {
        (d.faults.is_deaf, d.faults.damage) = (true, Damage::Silence);
    }),
    row("answers 150 ms late", MidSweep, Safe, |d| d.faults.damage = Damage::Late(0.15)),
    row("answers 150 ms late, and it moves on", MidSweep, Safe, |d| {
        unguarded(d);
        (d.faults.motor, d.faults.damage) = (Motor::KeepsOn, Damage::Late(0.15));
    }),
    row("every fifth answer is lost", MidSweep, Safe, |d| d.faults.damage = Damage::Every(5)),
    row("answers with a wrong checksum", MidSweep, Silent, |d| d.faults.spoils_sums = true),
    row("garbage instead of answers", MidSweep, Silent, |d| d.faults.damage = Damage::Garbage),
    row("every answer twice", MidSweep, Safe, |d| d.faults.copies = 2),
    row("answers of another object", MidSweep, Safe, |d| d.faults.wrong_object = true),
    can("answers of another node", MidSweep, Safe, |d| d.faults.wrong_node = true),
    can("heartbeats stop", MidSweep, Completes, |d| d.faults.stops_heartbeat = true),
    can("EMCY a thousand times a second", MidSweep, Stopped, |d| d.faults.emcy_storm = true),
    can("it leaves the NMT state operational", MidSweep, Silent, |d| d.operational = false),
    row("the port vanishes", MidSweep, Unstoppable, |d| d.faults.is_unplugged = true),
    // Other commands.
    by(By::Goto, row("tilt home: the motor runs backwards", Homing, HomingStopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::Backwards;
    })),
    by(By::Goto, row("tilt goto: stall", MidSweep, Stopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(0.0);
    })),
    by(By::Goto, row("tilt goto: it moves on and ignores quick stop", Braking, Braked, |d| {
        unguarded(d);
        d.faults.motor = Motor::KeepsOn;
        d.faults.ignores_quick_stop = true;
    })),
    by(By::Goto, row("tilt goto: no answers", MidSweep, Silent, |d| {
        d.faults.damage = Damage::Silence;
    })),
    by(By::Goto, row("tilt goto: SIGTERM, quick stop is ignored", Stopping, Braked, |d| {
        d.faults.ignores_quick_stop = true;
    })),
    by(By::Daemon, row("daemon: homing: the motor stalls", Homing, HomingStopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(0.0);
    })),
    by(By::Daemon, row("daemon: the motor turns round", MidSweep, Stopped, |d| {
        unguarded(d);
        d.faults.motor = Motor::RunsAt(56.25);
    })),
    by(By::Daemon, row("daemon: it moves on and ignores quick stop", Braking, Braked, |d| {
        unguarded(d);
        d.faults.motor = Motor::KeepsOn;
        d.faults.ignores_quick_stop = true;
    })),
    by(By::Daemon, row("daemon: no answers", MidSweep, Silent, |d| {
        d.faults.damage = Damage::Silence;
    })),
    by(By::Daemon, row("daemon: SIGTERM of the client", Stopping, Braked, |d| {
        d.faults.ignores_quick_stop = true;
    })),
    // SIGTERM in mid-sweep.
    row("SIGTERM, output unread", Stopping, Stopped, |d| d.faults.unread = true),
    row("SIGTERM, quick stop is ignored", Stopping, Braked, |d| d.faults.ignores_quick_stop = true),
    row("SIGTERM, it moves on whatever quick stop says", Stopping, Braked, |d| {
        unguarded(d);
        (d.faults.motor, d.faults.ignores_quick_stop) = (Motor::KeepsOn, true);
    }),
    row("SIGTERM, nothing is obeyed", Stopping, Unstoppable, |d| {
        unguarded(d);
        d.faults.motor = Motor::KeepsOn;
        (d.faults.ignores_quick_stop, d.faults.ignores_disable) = (true, true);
    }),
    row("SIGTERM, quick stop begins 0.3 s late", Stopping, Braked, |d| d.faults.stops_after = 0.3),
    row("SIGTERM, power goes off 0.3 s late", Stopping, Stopped, |d| d.faults.disables_after = 0.3),
    row("SIGTERM, it creeps after the quick stop", Stopping, Braked, |d| {
        d.faults.creeps = Some(-2.0);
    }),
    row("SIGTERM, writes have no effect", Stopping, Unstoppable, |d| {
        d.faults.ignores_writes = true;
    }),
    row("SIGTERM, no answers", Stopping, Stopped, |d| d.faults.damage = Damage::Silence),
    row("SIGTERM, it hears nothing", Stopping, Unstoppable, |d| d.faults.is_deaf = true),
    row("SIGTERM, the position freezes, quick stop is ignored", Stopping, Stopped, |d| {
        (d.faults.report, d.faults.ignores_quick_stop) = (Report::Held, true);
    }),
    row("SIGTERM, the brake stays open and the head falls", Stopping, Falls, |d| {
        d.faults.brake_stays_open = true;
        d.axis.gravity = -90.0;
    }),
    row("SIGTERM, the brake slips", Stopping, Falls, |d| d.axis.slip = -1.0),
];
