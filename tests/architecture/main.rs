#![cfg(test)]
//! The rules of the architecture that a test can check: which crate may depend on which, which
//! crate may use which library, and which crates do no input or output.

use std::sync::OnceLock;

mod commands;
mod counts;
mod manifests;
mod modules;
mod pages;

use counts::Counts;
use manifests::{ANYTHING, Workspace, allowed_dependencies, confined, locked};
use modules::Sources;

/// The first crate of the table that may do input and output.
const FIRST_CRATE_WITH_IO: &str = "io";

/// Crates that a crate does not depend on even in its tests.
///
/// The simulator states the geometry independently (invariant 3), and only `scanner` joins lidar
/// and drive (invariant 2).
const INDEPENDENT: [(&str, &[&str]); 3] = [
    ("sim", &["lidar", "drive", "scanner", "cloud"]),
    ("lidar", &["drive", "sim"]),
    ("drive", &["lidar", "sim"]),
];

/// Packages that the default build leaves out: ROS 2's transport alone needs 137 crates.
const OPTIONAL_PACKAGES: [&str; 2] = ["zenoh", "xxhash-rust"];

/// Ceilings of the figures; they may only fall.
const MAX_REPEATED_TYPES: usize = 2;
const MAX_WORDS_OF_BOOK: usize = 25_000;

#[test]
fn crates_depend_only_on_what_the_table_allows() {
    let workspace = Workspace::read();
    let table = allowed_dependencies();
    for member in &workspace.members {
        let Some((_, allowed)) = table.iter().find(|(name, _)| *name == member.name) else {
            panic!("ARCHITECTURE.md does not list {}", member.name);
        };
        for dependency in workspace.internal_dependencies(member, false) {
            assert!(
                allowed
                    .iter()
                    .any(|name| name == dependency || name == ANYTHING),
                "{} depends on {dependency}; ARCHITECTURE.md allows {allowed:?}",
                member.name
            );
        }
    }
}

#[test]
fn simulator_lidar_and_drive_stay_independent_even_in_tests() {
    let workspace = Workspace::read();
    for (name, excluded) in INDEPENDENT {
        let member = workspace.members.iter().find(|m| m.name == name);
        let member = member.unwrap_or_else(|| panic!("no crate {name}"));
        for dependency in workspace.internal_dependencies(member, true) {
            assert!(
                !excluded.contains(&dependency),
                "{name} depends on {dependency}"
            );
        }
    }
}

#[test]
fn confined_libraries_stay_in_the_crates_of_deny_toml() {
    let workspace = Workspace::read();
    let locked = locked();
    for (library, users) in confined() {
        assert!(
            locked.contains(&library),
            "deny.toml confines {library}, which Cargo.lock lacks"
        );
        for member in &workspace.members {
            let uses_it = member.dependencies.iter().any(|d| d.package == library);
            assert!(
                !uses_it || users.contains(&member.package),
                "{} uses {library}; deny.toml allows {users:?}",
                member.package
            );
        }
    }
}

#[test]
fn the_default_build_leaves_ros2_out() {
    let workspace = Workspace::read();
    for (package, member) in workspace.default_build() {
        assert!(
            !OPTIONAL_PACKAGES.contains(&package),
            "{member} needs {package}"
        );
    }
}

#[test]
fn lower_crates_ban_clocks_files_and_sockets() {
    let workspace = Workspace::read();
    let table = allowed_dependencies();
    let lower = table
        .iter()
        .take_while(|(name, _)| name != FIRST_CRATE_WITH_IO);
    for (name, _) in lower {
        let Some(member) = workspace.members.iter().find(|m| m.name == *name) else {
            continue;
        };
        let path = member.folder.join("clippy.toml");
        let text = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for banned in [
            "std::time::Instant::now",
            "std::time::SystemTime::now",
            "std::fs::File::open",
            "std::net::UdpSocket::bind",
        ] {
            assert!(
                text.contains(banned),
                "{} does not ban {banned}",
                path.display()
            );
        }
    }
}

/// The figures, made once for all tests.
fn counts_of_sources() -> &'static Counts {
    static COUNTS: OnceLock<Counts> = OnceLock::new();
    COUNTS.get_or_init(|| Counts::of(&Sources::read()))
}

/// Prints the figures of the source text: `cargo test -p architecture -- --ignored --nocapture`.
#[test]
#[ignore = "prints figures, checks nothing"]
fn counts() {
    println!("{}", counts_of_sources());
}

#[test]
fn modules_of_different_folders_do_not_import_each_other_in_cycles() {
    let counts = counts_of_sources();
    assert!(counts.cycles.is_empty(), "{:#?}", counts.cycles);
}

#[test]
fn comments_are_wrapped_at_100_columns() {
    let counts = counts_of_sources();
    assert!(
        counts.long_comments.is_empty(),
        "{:#?}",
        counts.long_comments
    );
}

#[test]
fn type_names_are_unique() {
    let counts = counts_of_sources();
    assert!(
        counts.repeated_types.len() <= MAX_REPEATED_TYPES,
        "{} type names are used more than once: {:#?}",
        counts.repeated_types.len(),
        counts.repeated_types
    );
}

/// The binary interprets a command line and prints; what it does is in the libraries.
#[test]
fn the_binary_is_thin() {
    let counts = counts_of_sources();
    let lines = counts.crates["velomotion"].lines;
    assert!(lines <= 8_000, "{lines} lines");
    let files = counts.capture_files["velomotion"];
    assert!(
        files <= 12,
        "commands/capture.rs needs {files} files of the binary"
    );
}

#[test]
fn links_lead_somewhere_and_the_book_lists_its_pages() {
    let broken = pages::broken_links();
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn commands_of_the_pages_name_what_exists() {
    let broken = commands::broken();
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn the_book_is_short() {
    let words = pages::words_of_book();
    assert!(
        words <= MAX_WORDS_OF_BOOK,
        "{words} words of prose, at most {MAX_WORDS_OF_BOOK}"
    );
}
