//! Mesh files of each format: a box mesh equals the box, and invalid files are refused.

use proptest::prelude::*;

use super::super::meshes::TriangleSoup;
use super::*;
use crate::cast::{Cuboid, Object};

/// Corners by their bits (x, y, z) and quadrilateral faces, counterclockwise from outside.
const FACES: [[u32; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

fn corners() -> [[f32; 3]; 8] {
    std::array::from_fn(|corner| {
        [
            if corner & 1 == 0 { -1.0 } else { 2.5 },
            if corner & 2 == 0 { -2.0 } else { 1.0 },
            if corner & 4 == 0 { 0.25 } else { 3.0 },
        ]
    })
}

fn obj() -> Vec<u8> {
    let mut text = "# a box\nmtllib none.mtl\no box\n".to_owned();
    for [x, y, z] in corners() {
        text += &format!("v {x} {y} {z}\n");
    }
    text += "g sides\n";
    for [a, b, c, d] in FACES {
        text += &format!("f {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1);
    }
    text.into_bytes()
}

fn ply_head(format: &str, number: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a box\nelement vertex 8\nproperty {number} x\nproperty {number} y\nproperty {number} z\n\
         element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn ply_text() -> Vec<u8> {
    let mut text = ply_head("ascii", "double");
    for [x, y, z] in corners() {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c, d] in FACES {
        text += &format!("4 {a} {b} {c} {d}\n");
    }
    text.into_bytes()
}

fn ply_binary() -> Vec<u8> {
    let mut bytes = ply_head("binary_big_endian", "float").into_bytes();
    bytes.extend(
        corners()
            .iter()
            .flatten()
            .flat_map(|number| number.to_be_bytes()),
    );
    for face in FACES {
        bytes.push(4);
        bytes.extend(face.iter().flat_map(|number| number.to_be_bytes()));
    }
    bytes
}

/// Positions, then a strip of four corners per face, u16.
fn gltf_buffer() -> Vec<u8> {
    let mut bytes: Vec<u8> = Vec::new();
    bytes.extend(
        corners()
            .iter()
            .flatten()
            .flat_map(|number| number.to_le_bytes()),
    );
    // A strip zigzags.
    let strips = FACES.iter().flat_map(|&[a, b, c, d]| [a, b, d, c]);
    bytes.extend(strips.flat_map(|number| (number as u16).to_le_bytes()));
    bytes
}

fn gltf_json(uri: &str) -> String {
    let primitives: Vec<String> = (0..6)
        .map(|face| {
            format!(
                "{{\"attributes\":{{\"POSITION\":0}},\"indices\":{},\"mode\":5}}",
                face + 1
            )
        })
        .collect();
    let indices: Vec<String> = (0..6)
        .map(|face| {
            format!(
                "{{\"bufferView\":1,\"byteOffset\":{},\"componentType\":5123,\"count\":4,\"type\":\"SCALAR\"}}",
                8 * face
            )
        })
        .collect();
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\
         \"nodes\":[{{\"children\":[1],\"translation\":[0,0,-7]}},{{\"mesh\":0,\"translation\":[0,0,7]}}],\
         \"meshes\":[{{\"primitives\":[{}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\",\
         \"min\":[-1,-2,0.25],\"max\":[2.5,1,3]}},{}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteLength\":96}},{{\"buffer\":0,\"byteOffset\":96,\"byteLength\":48}}],\
         \"buffers\":[{{{uri}\"byteLength\":144}}]}}",
        primitives.join(","),
        indices.join(",")
    )
}

fn glb() -> Vec<u8> {
    let mut json = gltf_json("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let bin = gltf_buffer();
    let mut bytes = b"glTF".to_vec();
    for number in [2, 12 + 8 + json.len() + 8 + bin.len(), json.len()] {
        bytes.extend((number as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((bin.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(bin);
    bytes
}

fn files(name: &str) -> Result<Vec<u8>, String> {
    match name {
        "meshes/box.obj" => Ok(obj()),
        "meshes/box.ply" => Ok(ply_text()),
        "meshes/binary.PLY" => Ok(ply_binary()),
        "meshes/box.gltf" => Ok(gltf_json("\"uri\":\"box.bin\",").into_bytes()),
        "meshes/box.bin" => Ok(gltf_buffer()),
        "meshes/box.glb" => Ok(glb()),
        other => Err(format!("{other} is not there")),
    }
}

const NAMES: [&str; 5] = ["box.obj", "box.ply", "binary.PLY", "box.gltf", "box.glb"];

/// The box as a mesh, from a file.
fn mesh(name: &str) -> PlacedScenery {
    let up = if name.contains(".gl") {
        ", y_up = false"
    } else {
        ""
    };
    let text = format!("[[objects]]\nmesh = {{ file = \"meshes/{name}\"{up} }}\n");
    Scenery::parse(&text).unwrap().place(0, &mut files).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_box_mesh_equals_the_box(rays in proptest::collection::vec((prop::array::uniform3(-6.0..6.0), prop::array::uniform3(-3.0..3.0)), 32)) {
        let own = Object::new(Cuboid::new(DVec3::new(-1.0, -2.0, 0.25), DVec3::new(2.5, 1.0, 3.0)));
        let own = Caster::new([own]).unwrap();
        for name in NAMES {
            let caster = mesh(name).caster().unwrap();
            for (from, to) in &rays {
                let (from, to): (DVec3, DVec3) = ((*from).into(), (*to).into());
                let Some(way) = (to - from).try_normalize() else { continue };
                let ray = Ray::new(from, way).unwrap();
                let got = caster.nearest(&ray, Reach::default());
                let expected = own.nearest(&ray, Reach::default());
                prop_assert_eq!(got.is_some(), expected.is_some(), "{} {} {}", name, from, way);
                if let (Some(got), Some(expected)) = (got, expected) {
                    prop_assert!((got.range_m - expected.range_m).abs() < 1e-12);
                    let normal = caster.normal(&got, ray.at(got.range_m));
                    let expected = own.normal(&expected, ray.at(expected.range_m));
                    prop_assert!(normal.abs_diff_eq(expected, 1e-12), "{name}: inside out");
                }
            }
        }
    }
}

#[test]
fn units_and_up_axis_follow_the_scene() {
    let look = |more: &str| {
        let text = format!("[[objects]]\nmesh = {{ file = \"meshes/box.{more} }}\n");
        let placed = Scenery::parse(&text).unwrap().place(0, &mut files).unwrap();
        let caster = placed.caster().unwrap();
        let down = hit(&placed, &caster, DVec3::new(0.0, -0.5, 9.0), -DVec3::Z).unwrap();
        9.0 - down.0
    };
    assert_eq!(look("obj\""), 3.0);
    assert_eq!(look("obj\", unit_m = 2"), 6.0);
    // The up axis of glTF is y, and its z becomes -y.
    assert_eq!(look("glb\""), 1.0);
    assert_eq!(look("glb\", y_up = false"), 3.0);
}

#[test]
fn a_shared_mesh_file_is_read_once() {
    let text = "[[objects]]\nmesh = { file = \"meshes/box.obj\" }\n[[objects]]\nmesh = { file = \"meshes/box.obj\" }\n\
                copies = { counts = [3, 1, 1], step_m = [9, 0, 0] }\n";
    let mut reads = 0;
    let mut counting = |name: &str| {
        reads += 1;
        files(name)
    };
    let placed = Scenery::parse(text)
        .unwrap()
        .place(0, &mut counting)
        .unwrap();
    assert_eq!((placed.objects.len(), reads), (4, 1));
}

/// The error for a file of this name with these contents.
fn refused(name: &str, bytes: &[u8]) -> MeshFileError {
    let text = format!("\n[[objects]]\nmesh = {{ file = \"{name}\" }}\n");
    let mut file = |_: &str| Ok(bytes.to_vec());
    match Scenery::parse(&text).unwrap().place(0, &mut file) {
        Err(error) => {
            assert_eq!(error.at.line, 2);
            error.source.unwrap()
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn malformed_meshes_are_refused() {
    let replaced = |bytes: Vec<u8>, from: &str, to: &str| {
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1).into_bytes()
    };
    let gltf = || gltf_json("\"uri\":\"box.bin\",").into_bytes();
    let contents = |name: &str, bytes: &[u8]| match refused(name, bytes) {
        MeshFileError::Contents { message, .. } => message,
        MeshFileError::Mesh(error) => error.to_string(),
        other => panic!("{other:?}"),
    };
    assert!(
        contents("a.obj", &replaced(obj(), "f 1 5 7 3", "f 1 5 99 3")).contains("out of bounds")
    );
    assert!(contents("a.obj", &replaced(obj(), "f 1 5 7 3", "f 1 5 x 3")).contains("face parse"));
    assert!(
        contents("a.obj", &replaced(obj(), "v -1 -2 0.25", "v -1 -2 NaN")).contains("vertex 0")
    );
    assert_eq!(refused("a.obj", b""), MeshFileError::Empty);
    assert!(
        contents("a.ply", &replaced(ply_text(), "4 0 4 6 2", "4 0 4 8 2"))
            .contains("below 8, got 8")
    );
    assert!(
        contents("a.ply", &replaced(ply_text(), "4 0 4 6 2", "4 0 4 -6 2"))
            .contains("whole numbers")
    );
    assert!(contents("a.ply", &replaced(ply_text(), "double z", "double w")).contains("no z"));
    assert!(
        contents("a.ply", &replaced(ply_text(), "-1 -2 0.25", "-1 1e16 0.25")).contains("vertex 0")
    );
    assert!(
        contents(
            "a.gltf",
            &replaced(gltf(), "\"byteOffset\":96", "\"byteOffset\":9999")
        )
        .contains("beyond its buffer")
    );
    assert!(contents("a.gltf", &replaced(gltf(), "\"mesh\":0", "\"mesh\":5")).len() > 5);
    assert!(contents("a.gltf", &replaced(gltf(), "box.bin", "data:,")).contains("data URI"));
    let mut short = glb();
    short[8..12].copy_from_slice(&3_u32.to_le_bytes());
    assert!(contents("a.glb", &short).contains("12 bytes or more, got 3"));
    let mut index = glb();
    let last = index.len() - 2;
    index[last..].copy_from_slice(&8_u16.to_le_bytes());
    assert!(contents("a.glb", &index).contains("below 8, got 8"));
    assert_eq!(
        refused("a.stl", b""),
        MeshFileError::Ending("a.stl".to_owned())
    );
    assert_eq!(
        wrong("[[objects]]\nmesh = { file = \"a.obj\" }"),
        "line 1, column 1: mesh a.obj"
    );
}

/// Readers do not panic on a file truncated at any byte, or with any one byte changed.
#[test]
fn broken_files_never_panic() {
    for (format, bytes) in [
        (MeshFormat::Obj, obj()),
        (MeshFormat::Ply, ply_text()),
        (MeshFormat::Ply, ply_binary()),
        (MeshFormat::Gltf, glb()),
    ] {
        let read = |bytes: &[u8]| {
            let soup = meshes::read(format, bytes, &mut |_| Ok(gltf_buffer()));
            let _ = soup.as_ref().map(TriangleSoup::mesh);
        };
        for length in 0..bytes.len() {
            read(&bytes[..length]);
        }
        for at in 0..bytes.len() {
            for byte in [0, 1, b'9', b'-', 0xFF] {
                let mut broken = bytes.clone();
                broken[at] = byte;
                read(&broken);
            }
        }
    }
}
