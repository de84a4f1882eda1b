//! The dependency table of docs/ARCHITECTURE, held against `cargo tree`.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Crate, and what of the workspace it may depend on. `velomotion` and `velomotion-tests` may depend on anything.
const MAY_DEPEND_ON: [(&str, &[&str]); 10] = [
    ("units", &[]),
    ("protocol", &["units"]),
    ("lidar", &["units", "protocol"]),
    ("drive", &["units", "protocol"]),
    ("firmware-sim", &["units", "protocol"]),
    ("cloud", &["units"]),
    ("scanner", &["units", "lidar", "drive", "cloud"]),
    ("sim", &["units", "firmware-sim"]),
    ("analysis", &["units", "cloud"]),
    ("io", &["units", "protocol"]),
];

/// A library, and the crates of the workspace that may use it directly.
const CONFINED: [(&str, &[&str]); 23] = [
    ("serialport", &["io"]),
    ("socket2", &["io"]),
    ("nix", &["io"]),
    ("etherparse", &["io"]),
    ("clap", &["velomotion"]),
    ("miette", &["velomotion"]),
    ("indicatif", &["velomotion"]),
    ("signal-hook", &["velomotion"]),
    ("axum", &["velomotion"]),
    ("hyper", &["velomotion"]),
    ("hyper-util", &["velomotion", "velomotion-tests"]),
    ("prometheus-client", &["velomotion"]),
    ("sd-notify", &["velomotion"]),
    // Both behind its feature `ros2`.
    ("xxhash-rust", &["velomotion"]),
    ("zenoh", &["velomotion"]),
    ("las", &["cloud"]),
    // velomotion reads back what they wrote.
    ("e57", &["cloud", "velomotion"]),
    ("mcap", &["cloud", "velomotion"]),
    ("rayon", &["sim", "analysis"]),
    ("fantoccini", &["velomotion-tests"]),
    ("gltf", &["sim"]),
    ("ply-rs-bw", &["sim"]),
    ("tobj", &["sim"]),
];

/// What `sim` must never see, not even in its tests: it states the geometry its own way (invariant 3).
const STRANGERS_TO_SIM: [&str; 4] = ["lidar", "drive", "scanner", "cloud"];

/// Direct dependencies of every member, by name, along these kinds of edges, with more arguments for cargo.
fn direct_dependencies(edges: &str, more: &[&str]) -> BTreeMap<String, BTreeSet<String>> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let output = Command::new(cargo)
        .args(["tree", "--workspace", "--offline", "--edges", edges])
        .args(["--depth", "1", "--prefix", "depth", "--format", " {p}"])
        .args(more)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .expect("cargo runs");
    assert!(
        output.status.success(),
        "cargo tree: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let mut tree: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut member = String::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let mut words = line.split_whitespace();
        match (words.next(), words.next()) {
            (Some("0"), Some(name)) => {
                member = name.to_owned();
                tree.entry(member.clone()).or_default();
            }
            (Some("1"), Some(name)) => {
                tree.entry(member.clone())
                    .or_default()
                    .insert(name.to_owned());
            }
            _ => {}
        }
    }
    tree
}

#[test]
fn crates_depend_only_on_what_the_table_allows() {
    let tree = direct_dependencies("normal,build", &[]);
    let members: BTreeSet<&str> = tree.keys().map(String::as_str).collect();
    for (name, allowed) in MAY_DEPEND_ON {
        let dependencies = &tree[name];
        for dependency in dependencies.iter().filter(|d| members.contains(d.as_str())) {
            assert!(
                allowed.contains(&dependency.as_str()),
                "{name} depends on {dependency}; the table allows {allowed:?}"
            );
        }
    }
    for member in members {
        let listed = MAY_DEPEND_ON.iter().any(|(name, _)| *name == member);
        assert!(
            listed || member == "velomotion" || member == "velomotion-tests",
            "{member} is not in the table"
        );
    }
}

#[test]
fn the_simulator_and_the_scanner_stay_strangers_even_in_tests() {
    let tree = direct_dependencies("normal,build,dev", &[]);
    for stranger in STRANGERS_TO_SIM {
        assert!(!tree["sim"].contains(stranger), "sim sees {stranger}");
    }
    for (member, strangers) in [("lidar", ["drive", "sim"]), ("drive", ["lidar", "sim"])] {
        for stranger in strangers {
            assert!(!tree[member].contains(stranger), "{member} sees {stranger}");
        }
    }
}

#[test]
fn libraries_stay_in_the_crates_they_are_for() {
    let tree = direct_dependencies("normal,build", &["--all-features"]);
    for (library, allowed) in CONFINED {
        for (member, dependencies) in &tree {
            assert!(
                !dependencies.contains(library) || allowed.contains(&member.as_str()),
                "{member} uses {library}, which belongs to {allowed:?}"
            );
        }
    }
}

/// ROS 2's transport is 137 crates more: whoever does not ask for it does not build them.
#[test]
fn the_default_build_is_without_zenoh() {
    let tree = direct_dependencies("normal,build", &[]);
    for library in ["zenoh", "xxhash-rust"] {
        assert!(!tree["velomotion"].contains(library), "{library}");
    }
}

#[test]
fn the_core_bans_clocks_files_and_sockets() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    for (name, _) in MAY_DEPEND_ON.iter().filter(|(name, _)| *name != "io") {
        let directory = match *name {
            "protocol" | "firmware-sim" => format!("{root}/{name}"),
            name => format!("{root}/crates/{name}"),
        };
        let text = std::fs::read_to_string(format!("{directory}/clippy.toml"))
            .unwrap_or_else(|error| panic!("{directory}/clippy.toml: {error}"));
        for banned in [
            "std::time::Instant::now",
            "std::time::SystemTime::now",
            "std::fs::File::open",
            "std::net::UdpSocket::bind",
        ] {
            assert!(
                text.contains(banned),
                "{name}'s clippy.toml does not ban {banned}"
            );
        }
    }
}
