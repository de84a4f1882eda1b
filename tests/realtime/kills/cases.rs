//! One signal to the program during one motion.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::Duration;

use firmware_sim::epos2::BrakeState;
use units::random::split_mix_64;

use crate::bench::{Aftermath, Bench, wait};

/// A signal by its name, and whether the program can handle it.
pub type Signal = (&'static str, bool);

/// Every signal that ends or suspends a program from outside.
pub const SIGNALS: [Signal; 7] = [
    ("KILL", false),
    ("STOP", false),
    ("TSTP", true),
    ("TERM", true),
    ("INT", true),
    ("HUP", true),
    ("QUIT", true),
];

/// What the program does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    Homing,
    Goto,
    Sweep,
    /// A goto by a daemon.
    Daemon,
}

impl Motion {
    pub const ALL: [Self; 4] = [Self::Homing, Self::Goto, Self::Sweep, Self::Daemon];
}

/// A held axis has lost its power.
pub const NOT_HELD: &str = "held axis without power";

/// When the signal is sent.
#[derive(Clone, Copy, Debug)]
pub enum Moment {
    /// As soon as the axis moves.
    Moving,
    /// This long after the program's start.
    After(Duration),
}

/// A signal during a motion.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub motion: Motion,
    pub signal: Signal,
    pub moment: Moment,
    /// Whether the axis is held powered instead of released.
    pub held: bool,
}

/// The program under test, its messages, and the command that it obeys.
struct Program {
    child: Child,
    messages: JoinHandle<String>,
    client: Option<Child>,
}

impl Case {
    /// A kill at a random moment of a random motion.
    pub fn random(seed: u64) -> Self {
        let mut state = seed;
        let mut below = |limit: u64| split_mix_64(&mut state) % limit;
        let motion = Motion::ALL[usize::try_from(below(4)).unwrap()];
        // Of connecting, homing and moving.
        let most_us = match motion {
            Motion::Homing | Motion::Goto => 1_500_000,
            Motion::Sweep | Motion::Daemon => 2_500_000,
        };
        Self {
            motion,
            signal: SIGNALS[0],
            moment: Moment::After(Duration::from_micros(below(most_us))),
            held: false,
        }
    }

    /// Starts the motion, sends the signal and judges what the axis does.
    pub fn run(self, bench: &Bench) -> Result<Aftermath, String> {
        bench.forget();
        let mut program = self.start(bench)?;
        match self.moment {
            Moment::Moving => {
                // A sweep comes after homing, which is slower.
                let faster = if self.motion == Motion::Sweep {
                    20.0
                } else {
                    1.0
                };
                let moves = wait("the motion", || {
                    let ended = !program.is_running();
                    (ended || bench.moves_faster(faster)).then_some(!ended)
                });
                if moves != Ok(true) {
                    program.send("KILL");
                    let (status, messages) = program.end()?;
                    let why = format!("no motion: {moves:?}, {status}, {messages}");
                    return Err(why);
                }
            }
            Moment::After(delay) => std::thread::sleep(delay),
        }
        program.send(self.signal.0);
        // The program that sends the signal has taken a moment to start.
        let signalled = io::clock::now();
        let aftermath = bench.aftermath(signalled);
        let ended = match self.signal.0 {
            "STOP" => program.resume(self.motion == Motion::Daemon),
            _ => program.end(),
        };
        let (aftermath, (status, messages)) = (aftermath?, ended?);
        wait("an axis at rest", || bench.is_safe(self.held).then_some(()))?;
        let rule = |holds: bool, rule: &str| match holds {
            true => Ok(()),
            false => Err(format!("{rule}: {aftermath:?}, {status}, {messages}")),
        };
        rule(!aftermath.moves, "moves after 1 s")?;
        match self.held {
            true => rule(aftermath.powered, NOT_HELD)?,
            false => {
                rule(!aftermath.powered, "powered after 1 s")?;
                rule(aftermath.brake != BrakeState::Open, "brake open after 1 s")?;
            }
        }
        if self.motion != Motion::Daemon {
            let code = status.code();
            match self.signal {
                ("STOP", _) => rule(
                    ["did not run", "sent no heartbeat", "8130"]
                        .iter()
                        .any(|why| messages.contains(why)),
                    "unexplained",
                )?,
                (_, true) => rule(code == Some(130), "exit code is not 130")?,
                _ => {}
            }
        }
        Ok(aftermath)
    }

    fn start(self, bench: &Bench) -> Result<Program, String> {
        // To the end that is farther from here; homing has set 0.
        let home = bench.path().join("home");
        let zero: f64 = match std::fs::read_to_string(&home) {
            Ok(text) => text.parse().unwrap(),
            Err(_) => {
                std::fs::write(&home, bench.angle().to_string()).unwrap();
                bench.angle()
            }
        };
        let to = if bench.angle() - zero < -20.0 {
            -1
        } else {
            -42
        };
        match self.motion {
            Motion::Homing => Program::start(bench.command("tilt home"), None),
            Motion::Goto => {
                let line = format!("tilt goto {to} --speed 40");
                Program::start(bench.command(&line), None)
            }
            Motion::Sweep => {
                let line = "capture --speed 45 --both-ways --sweeps 4 -o scan.ply --force";
                Program::start(bench.command(line), None)
            }
            Motion::Daemon => {
                let mut daemon = bench.command("daemon --listen 127.0.0.1:0 --json");
                daemon.stdout(Stdio::piped());
                let mut program = Program::start(daemon, None)?;
                let mut line = String::new();
                let out = program.child.stdout.take().ok_or("no stdout")?;
                let read = BufReader::new(out).read_line(&mut line);
                read.map_err(|error| error.to_string())?;
                let line = format!("tilt goto {to} --speed 20");
                // The daemon may be connecting, which refuses a goto.
                wait("the daemon's drive", || bench.run("tilt status").ok())?;
                let mut goto = bench.command(&line);
                goto.stdout(Stdio::null()).stderr(Stdio::null());
                program.client = Some(goto.spawn().map_err(|error| error.to_string())?);
                Ok(program)
            }
        }
    }
}

impl Program {
    fn start(mut command: Command, client: Option<Child>) -> Result<Self, String> {
        let mut child = command
            .stdin(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| error.to_string())?;
        let mut stderr = child.stderr.take().ok_or("no stderr")?;
        let messages = std::thread::spawn(move || {
            let mut text = Vec::new();
            let _ = stderr.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        Ok(Self {
            child,
            messages,
            client,
        })
    }

    fn is_running(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(None))
    }

    fn send(&mut self, signal: &str) {
        // A client without its daemon would move the axis itself.
        if let Some(client) = &mut self.client {
            let _ = client.kill();
        }
        send(self.child.id(), signal);
    }

    /// Continues a suspended program, which must end by itself if it is no daemon.
    fn resume(mut self, daemon: bool) -> Result<(ExitStatus, String), String> {
        self.send("CONT");
        if daemon {
            self.send("TERM");
        }
        self.end()
    }

    fn end(mut self) -> Result<(ExitStatus, String), String> {
        let status = wait("the program's end", || self.child.try_wait().ok().flatten());
        if status.is_err() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
        if let Some(mut client) = self.client {
            let _ = client.kill();
            let _ = client.wait();
        }
        Ok((status?, self.messages.join().unwrap_or_default()))
    }
}

/// Sends a signal to a process.
pub fn send(process: u32, signal: &str) {
    let mut kill = Command::new("kill");
    let sent = kill
        .args([&format!("-{signal}"), &process.to_string()])
        .stderr(Stdio::null())
        .status();
    // A program that has ended is found to have.
    sent.unwrap();
}
