//! Wavefront OBJ, through `tobj`.

use std::path::Path;

use glam::DVec3;

use super::{Fault, TriangleSoup};

pub(super) fn read(mut bytes: &[u8]) -> Result<TriangleSoup, Fault> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    // Materials are of no use here.
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut bytes, &options, no_materials)
        .map_err(|error| error.to_string())?;
    let mut soup = TriangleSoup::default();
    for model in models {
        let first = u32::try_from(soup.vertices.len()).map_err(|_| "too many vertices")?;
        let (vertices, rest) = model.mesh.positions.as_chunks::<3>();
        let (triangles, left) = model.mesh.indices.as_chunks::<3>();
        if !rest.is_empty() || !left.is_empty() {
            return Err("expected triangles of points with three coordinates".into());
        }
        soup.vertices
            .extend(vertices.iter().copied().map(DVec3::from_array));
        // A number beyond all vertices is found when the mesh is made.
        let numbers = triangles
            .iter()
            .map(|corners| corners.map(|n| n.saturating_add(first)));
        soup.triangles.extend(numbers);
    }
    Ok(soup)
}
