//! PLY, text and binary, through `ply-rs-bw`.

use glam::DVec3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::{Fault, TriangleSoup};

pub(super) fn read(mut bytes: &[u8]) -> Result<TriangleSoup, Fault> {
    let ply = Parser::<DefaultElement>::new()
        .read_ply(&mut bytes)
        .map_err(|error| error.to_string())?;
    let mut soup = TriangleSoup::default();
    for vertex in ply
        .payload
        .get("vertex")
        .ok_or("expected an element vertex")?
    {
        let of = |name: &str| {
            let property = vertex.get(name).and_then(number);
            property.ok_or(format!(
                "expected numbers x, y and z of a vertex, got no {name}"
            ))
        };
        soup.vertices.push(DVec3::new(of("x")?, of("y")?, of("z")?));
    }
    for face in ply.payload.get("face").ok_or("expected an element face")? {
        let corners = face
            .get("vertex_indices")
            .or_else(|| face.get("vertex_index"))
            .and_then(Property::to_u32_list)
            .ok_or("expected vertex_indices of a face, whole numbers from 0")?;
        let [first, rest @ ..] = corners.as_slice() else {
            continue;
        };
        let fan = rest.windows(2).filter_map(|pair| match pair {
            &[second, third] => Some([*first, second, third]),
            _ => None,
        });
        soup.triangles.extend(fan);
    }
    Ok(soup)
}

fn number(property: &Property) -> Option<f64> {
    match *property {
        Property::Char(n) => Some(f64::from(n)),
        Property::UChar(n) => Some(f64::from(n)),
        Property::Short(n) => Some(f64::from(n)),
        Property::UShort(n) => Some(f64::from(n)),
        Property::Int(n) => Some(f64::from(n)),
        Property::UInt(n) => Some(f64::from(n)),
        Property::Float(n) => Some(f64::from(n)),
        Property::Double(n) => Some(n),
        _ => None,
    }
}
