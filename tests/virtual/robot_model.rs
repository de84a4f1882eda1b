//! The robot model for RViz has the frames and poses that the daemon publishes.

use std::path::Path;

use cloud::messages::{Frames, TILT_JOINT, frames};
use engine::config::Config;
use glam::{DMat4, DQuat, DVec3, EulerRot};
use units::Degrees;

fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../packaging")
}

fn numbers(text: &str) -> DVec3 {
    let numbers: Vec<f64> = text.split(' ').map(|word| word.parse().unwrap()).collect();
    DVec3::from_slice(&numbers)
}

/// Parent, child, pose at an angle of the joint, and its limits.
fn joint(node: roxmltree::Node<'_, '_>, angle_rad: f64) -> (String, String, DMat4) {
    let child = |name| node.children().find(|node| node.has_tag_name(name));
    let link = |name| child(name).unwrap().attribute("link").unwrap().to_owned();
    let origin = child("origin").unwrap();
    let of = |name| numbers(origin.attribute(name).unwrap());
    let (xyz, rpy) = (of("xyz"), of("rpy"));
    let fixed = DQuat::from_euler(EulerRot::ZYX, rpy.z, rpy.y, rpy.x);
    let turned = child("axis").map_or(DQuat::IDENTITY, |axis| {
        DQuat::from_axis_angle(numbers(axis.attribute("xyz").unwrap()), angle_rad)
    });
    let pose = DMat4::from_rotation_translation(fixed * turned, xyz);
    (link("parent"), link("child"), pose)
}

#[test]
fn the_robot_model_moves_as_the_published_transforms() {
    let text = std::fs::read_to_string(folder().join("ros/velomotion16.urdf")).unwrap();
    let model = roxmltree::Document::parse(&text).unwrap();
    let packaged = std::fs::read_to_string(folder().join("velomotion.toml")).unwrap();
    let config: Config = toml::from_str(&packaged).unwrap();
    let mount = config.mount.pose().mount();
    let names = Frames::default();
    for tilt in [0.0, -10.0, -45.0, 30.0].map(Degrees) {
        let mut published = names.fixed(Some(mount));
        published.push(names.tilted(tilt));
        let joints = model
            .descendants()
            .filter(|node| node.has_tag_name("joint"));
        let joints: Vec<_> = joints
            .map(|node| joint(node, tilt.to_radians().0))
            .collect();
        assert_eq!(joints.len(), published.len());
        for pose in published {
            let named = |(parent, child, _): &&(String, String, DMat4)| {
                (parent.as_str(), child.as_str()) == (pose.parent, pose.child)
            };
            let (_, _, found) = joints.iter().find(named).unwrap();
            let rotation = DQuat::from_array(pose.rotation.quaternion);
            let expected =
                DMat4::from_rotation_translation(rotation, DVec3::from_array(pose.translation_m));
            assert!(found.abs_diff_eq(expected, 1e-12), "{pose:?} {found}");
        }
    }
    let joint = |name| {
        let mut nodes = model.descendants();
        nodes.find(|node| node.has_tag_name("joint") && node.attribute("name") == Some(name))
    };
    let tilt = joint(TILT_JOINT).unwrap();
    assert_eq!(tilt.attribute("type"), Some("revolute"));
    let limit = tilt.children().find(|node| node.has_tag_name("limit"));
    let limit = |name| -> f64 { limit.unwrap().attribute(name).unwrap().parse().unwrap() };
    let axis = &config.axis;
    for (name, deg) in [
        ("lower", axis.min_deg),
        ("upper", axis.max_deg),
        ("velocity", axis.max_speed_deg_s),
    ] {
        assert!((limit(name).to_degrees() - deg).abs() < 1e-9, "{name}");
    }
    assert_eq!(model.root_element().attribute("name"), Some("velomotion16"));
    let links = model.descendants().filter(|node| node.has_tag_name("link"));
    let links: Vec<_> = links.filter_map(|node| node.attribute("name")).collect();
    assert_eq!(
        links,
        [frames::ROOT, frames::BASE, frames::PLATFORM, frames::LIDAR]
    );
}
