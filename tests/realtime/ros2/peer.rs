//! Runs `peer.py`.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use cloud::messages::Topic;
use serde_json::{Value, json};

use crate::rig::{Rig, wait};

/// A running peer.
pub struct Peer {
    child: Child,
    mouth: ChildStdin,
    printed: Arc<Mutex<Vec<Value>>>,
    /// Folder in which it writes clouds.
    pub folder: tempfile::TempDir,
}

/// Lets one test run at a time: each has routers, peers and a daemon.
pub fn alone() -> MutexGuard<'static, ()> {
    static RUNNING: Mutex<()> = Mutex::new(());
    // A test that failed holds nothing that the next one needs.
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The Python interpreter of the tests.
pub fn python() -> std::ffi::OsString {
    std::env::var_os("VELOMOTION_PYTHON").unwrap_or_else(|| "python3".into())
}

/// A free address of this machine.
pub fn endpoint() -> String {
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", free.local_addr().unwrap())
}

impl Peer {
    /// Starts a `router`, or a `client` of one, at this endpoint.
    pub fn start(python: &std::ffi::OsStr, mode: &str, endpoint: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let script =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/realtime/ros2/peer.py");
        let mut child = Command::new(python)
            .arg(script)
            .args([mode, endpoint])
            .arg(folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mouth = child.stdin.take().unwrap();
        let printed = Arc::new(Mutex::new(Vec::new()));
        let (lines, output) = (child.stdout.take().unwrap(), Arc::clone(&printed));
        std::thread::spawn(move || {
            for line in BufReader::new(lines).lines().map_while(Result::ok) {
                let value = serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line}"));
                output.lock().unwrap().push(value);
            }
        });
        let peer = Self {
            child,
            mouth,
            printed,
            folder,
        };
        peer.until("the peer", |value| value.get("ready").map(|_| ()));
        peer
    }

    /// All printed values that `pick` accepts. Fails on errors of the peer.
    pub fn all<T>(&self, pick: impl Fn(&Value) -> Option<T>) -> Vec<T> {
        let printed = self.printed.lock().unwrap();
        for value in printed.iter() {
            assert!(value.get("error").is_none(), "{value}");
        }
        printed.iter().filter_map(pick).collect()
    }

    /// Waits for a printed value that `pick` accepts, past ones included.
    pub fn until<T>(&self, what: &str, pick: impl Fn(&Value) -> Option<T>) -> T {
        wait(what, || self.all(&pick).into_iter().next())
    }

    /// Sends a command and waits for its end. Returns what was printed meanwhile.
    pub fn request(&mut self, command: &Value) -> Vec<Value> {
        let before = self.all(|value| Some(value.clone())).len();
        writeln!(self.mouth, "{command}").unwrap();
        self.mouth.flush().unwrap();
        wait("an answer of the peer", || {
            let printed = self.all(|value| Some(value.clone()));
            let news = &printed[before..];
            let done = news.iter().any(|value| value["done"] == command["do"]);
            done.then(|| news.to_vec())
        })
    }

    /// Subscribes to a topic with the exact key of a ROS 2 node.
    pub fn subscribe(&mut self, who: &str, topic: Topic, name: &str) {
        let how = match topic.is_latched() {
            true => "subscribe_latched",
            false => "subscribe",
        };
        let kind = topic.message_type();
        let (path, last) = kind.name.rsplit_once('/').unwrap();
        let dds = format!("{}::dds_::{last}_", path.replace('/', "::"));
        let key = format!("{name}/{dds}/{}", kind.hash);
        self.request(&json!({ "do": how, "who": who, "key": key }));
    }

    /// Messages of a topic that `who` received.
    pub fn received(&self, who: &str, topic: &str) -> Vec<Value> {
        self.all(|value| (value["received"] == topic && value["who"] == who).then(|| value.clone()))
    }

    /// Present liveliness tokens.
    pub fn tokens(&self) -> Vec<String> {
        let mut tokens: Vec<String> = Vec::new();
        for (token, there) in self.all(|value| {
            let token = value.get("token")?.as_str()?.to_owned();
            Some((token, value["there"] == true))
        }) {
            tokens.retain(|known| *known != token);
            if there {
                tokens.push(token);
            }
        }
        tokens
    }

    pub fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args([name, &id]).status().unwrap();
        assert!(sent.success());
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A value of `/metrics`.
pub fn figure(rig: &Rig, name: &str) -> u64 {
    let text = rig.get("/metrics").text();
    let line = text.lines().find_map(|line| {
        let (known, value) = line.strip_prefix("velomotion_")?.split_once(' ')?;
        (known.trim_end_matches("_total") == name).then(|| value.parse::<f64>().unwrap())
    });
    line.unwrap_or_else(|| panic!("no {name} in {text}")) as u64
}

/// Waits until the daemon reports that a router is connected, or is not.
pub fn connected(rig: &Rig, there: bool) {
    wait("the router's coming or going", || {
        (figure(rig, "ros2_connected") == u64::from(there)).then_some(())
    });
}

/// A daemon with this router and more keys under `[daemon.ros2]`.
pub fn daemon(router: &str, more: &str) -> Rig {
    Rig::with(
        &format!("[daemon.ros2]\nrouter = '{router}'\n{more}"),
        |_| {},
    )
}
