//! A daemon in its own process, which can be killed: this program, started again.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use daemon::client::Client;
use velomotion::cli::{self, Cli, Common};

/// Argument that makes this program a daemon.
pub const ARGUMENT: &str = "--be-a-daemon";
/// Every awaited condition comes sooner, or never.
const LIMIT: Duration = Duration::from_secs(60);

/// A running daemon.
pub struct Process {
    child: Child,
    /// Client of its API.
    pub client: Client,
}

/// Runs the daemon of a configuration, as the command does.
pub fn be(path: &str) -> i32 {
    let cli = Cli {
        command: cli::Command::Daemon(cli::DaemonArguments {
            device: cli::DeviceArgument { name: None },
            listen: Some(([127, 0, 0, 1], 0).into()),
        }),
        common: Common {
            config: Some(path.into()),
            json: true,
            quiet: false,
            verbose: 1,
        },
    };
    match velomotion::run(&cli) {
        Ok(_) => 0,
        Err(failure) => {
            eprintln!("{failure}");
            i32::from(failure.kind.exit_code())
        }
    }
}

impl Process {
    /// Starts a daemon with the configuration in `folder` and waits for its first answer.
    pub fn start(folder: &Path) -> Result<Self, String> {
        let text = |error: std::io::Error| error.to_string();
        let path = folder.join("velomotion.toml");
        for left in sockets(folder)? {
            std::fs::remove_file(left).map_err(text)?;
        }
        let errors = File::options()
            .append(true)
            .create(true)
            .open(folder.join("daemon.log"))
            .map_err(text)?;
        let mut child = Command::new(std::env::current_exe().map_err(text)?)
            .arg(ARGUMENT)
            .arg(&path)
            .env("XDG_RUNTIME_DIR", folder)
            .env_remove("RUNTIME_DIRECTORY")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(errors)
            .spawn()
            .map_err(text)?;
        let mut line = String::new();
        if let Some(out) = child.stdout.take() {
            BufReader::new(out).read_line(&mut line).map_err(text)?;
        }
        if line.is_empty() {
            let ended = child.wait().map_err(text)?;
            return Err(format!("the daemon does not start: {ended}"));
        }
        Ok(Self {
            child,
            client: Client::at(sockets(folder)?.pop().ok_or("the daemon has no socket")?),
        })
    }

    /// Kills it without notice.
    pub fn kill(&mut self) -> Result<(), String> {
        self.child.kill().map_err(|error| error.to_string())?;
        self.child.wait().map(drop).map_err(|e| e.to_string())
    }

    /// Ends it with SIGTERM, which must succeed.
    pub fn end(&mut self) -> Result<(), String> {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args(["-TERM", &id]).status();
        sent.map_err(|error| error.to_string())?;
        let ended = wait("the daemon's end", || self.child.try_wait().ok().flatten())?;
        match ended.success() {
            true => Ok(()),
            false => Err(format!("reported to end, it ended with {ended}")),
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Sockets of daemons in a folder: only that of the running one, once a killed one's is removed.
fn sockets(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let there = std::fs::read_dir(folder).map_err(|error| error.to_string())?;
    let paths = there.flatten().map(|entry| entry.path());
    Ok(paths
        .filter(|path| path.to_string_lossy().ends_with(".daemon.sock"))
        .collect())
}

/// Repeats `wanted` until it returns a value.
pub fn wait<T>(what: &str, mut wanted: impl FnMut() -> Option<T>) -> Result<T, String> {
    let begin = Instant::now();
    loop {
        if let Some(found) = wanted() {
            return Ok(found);
        }
        if begin.elapsed() > LIMIT {
            return Err(format!("timed out after {} s: {what}", LIMIT.as_secs()));
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}
