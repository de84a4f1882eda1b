//! Scenes that come with the simulator.

macro_rules! scenes {
    ($($name:literal),*) => {
        [$(($name, include_str!(concat!("../../scenes/", $name, ".toml")))),*]
    };
}

/// All shipped scenes: name and scene file. None needs another file.
pub const SHIPPED: [(&str, &str); 12] = scenes!(
    "hollow-sphere",
    "planes",
    "hall",
    "parking",
    "quarry",
    "room",
    "wavy-walls",
    "stairwell",
    "glass-corridor",
    "fog",
    "traffic",
    "rig"
);

/// The scene file of this name.
#[must_use]
pub fn shipped(name: &str) -> Option<&'static str> {
    SHIPPED
        .into_iter()
        .find_map(|(known, text)| (known == name).then_some(text))
}
