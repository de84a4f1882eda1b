//! Smoke tests of commands that are tested beside their code.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};

use super::*;

#[test]
fn plan_chooses_a_speed() {
    let place = Place::new();
    let plan = json(&place.run("plan --at 20m --gap 0.8deg --error 9mm --device sim --json"));
    let command = plan["chosen"]["command"].as_str().unwrap();
    assert!(command.starts_with("velomotion capture --speed "), "{plan}");
}

#[test]
fn calibrate_finds_the_height_of_the_lidar() {
    let place = Place::new();
    for (name, speed) in [("fast", 90), ("slow", 60)] {
        let scene = format!(
            "scene = \"room\"\n[mount]\nd_m = 0.07\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -45\nspeed_deg_s = {speed}\n"
        );
        std::fs::write(place.path(&format!("{name}.toml")), scene).unwrap();
        let made = place.run(&format!("simulate {name}.toml -o {name}.pcapng"));
        assert!(made.status.success(), "{made:?}");
    }
    std::fs::write(place.path("start.toml"), "[mount]\nd_m = 0.06\n").unwrap();
    let line = "calibrate fast.pcapng slow.pcapng --mount start.toml -o mount.toml --json";
    let output = place.run(line);
    let report = json(&output);
    let d_m = report["mount"]["d_m"].as_f64().unwrap();
    assert!((d_m - 0.07).abs() < 0.003, "{report}");
}

/// A browser's request, answered by the program that serves a cloud.
#[test]
fn view_serves_a_cloud() {
    let place = Place::new();
    std::fs::write(place.path("cloud.csv"), "x_m,y_m,z_m\n1,2,3\n4,5,6\n").unwrap();
    let mut view = Running(
        Command::new(env!("CARGO_BIN_EXE_velomotion"))
            .args(["view", "cloud.csv", "--no-open"])
            .current_dir(place.0.path())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap(),
    );
    let mut line = String::new();
    let mut printed = BufReader::new(view.0.stderr.take().unwrap());
    while !line.starts_with("http://") {
        line.clear();
        assert!(printed.read_line(&mut line).unwrap() > 0, "no address");
    }
    let address = line.split(' ').next().unwrap().trim();
    let address = address.strip_prefix("http://").unwrap();
    let (host, path) = address.split_once('/').unwrap();
    let mut page = TcpStream::connect(host).unwrap();
    write!(
        page,
        "GET /{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
    )
    .unwrap();
    let mut answer = String::new();
    page.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert!(answer.contains("<html"), "{answer}");
}

/// A program that ends with its test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
