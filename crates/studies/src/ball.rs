//! Closed meshes of any size, equal on every machine.

use glam::DVec3;

/// A closed ball in rings from the bottom to the top, each cut into sectors.
#[derive(Clone, Copy)]
pub(crate) struct BallMesh {
    /// Number of rings, including the two of triangles at the ends.
    pub rings: usize,
    /// Sectors per ring.
    pub sectors: usize,
}

impl BallMesh {
    /// Its vertices: each direction from the centre, moved by `place`. The ends come first, then
    /// ring after ring from below.
    pub fn vertices(self, place: impl Fn(DVec3) -> DVec3) -> Vec<DVec3> {
        let mut vertices = vec![place(DVec3::NEG_Z), place(DVec3::Z)];
        for ring in 1..self.rings {
            let polar = ring as f64 / self.rings as f64 * std::f64::consts::PI;
            for sector in 0..self.sectors {
                let turn = sector as f64 / self.sectors as f64 * std::f64::consts::TAU;
                let (level, height) = (polar.sin(), -polar.cos());
                vertices.push(place(DVec3::new(
                    level * turn.cos(),
                    level * turn.sin(),
                    height,
                )));
            }
        }
        vertices
    }

    /// Index of a vertex; sectors wrap around.
    pub fn vertex(self, ring: usize, sector: usize) -> u32 {
        let at = match ring {
            0 => 0,
            ring if ring >= self.rings => 1,
            ring => 2 + (ring - 1) * self.sectors + sector % self.sectors.max(1),
        };
        u32::try_from(at).unwrap_or(u32::MAX)
    }

    /// The two triangles of a cell, counterclockwise from outside. At the ends one of them has no
    /// area.
    pub fn cell(self, ring: usize, sector: usize) -> [[u32; 3]; 2] {
        let [a, b] = [sector, sector + 1].map(|sector| self.vertex(ring, sector));
        let [d, c] = [sector, sector + 1].map(|sector| self.vertex(ring + 1, sector));
        [[a, b, c], [a, c, d]]
    }

    /// All triangles with an area.
    pub fn triangles(self) -> Vec<[u32; 3]> {
        let cells = (0..self.rings)
            .flat_map(|ring| (0..self.sectors).map(move |sector| self.cell(ring, sector)));
        cells
            .flatten()
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_closed_and_its_triangles_face_outward() {
        let ball = BallMesh {
            rings: 12,
            sectors: 20,
        };
        let vertices = ball.vertices(|along| 3.0 * along);
        let triangles = ball.triangles();
        assert_eq!(vertices.len(), 2 + 11 * 20);
        assert_eq!(triangles.len(), 2 * 11 * 20);
        let mut volume = 0.0;
        let mut edges = std::collections::BTreeMap::new();
        for corners in triangles {
            let [a, b, c] = corners.map(|at| vertices[at as usize]);
            assert!((b - a).cross(c - a).dot(a) > 0.0, "{corners:?}");
            volume += a.dot(b.cross(c)) / 6.0;
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                *edges.entry((corners[from], corners[to])).or_insert(0) += 1;
            }
        }
        // Every edge occurs once in each direction.
        for ((from, to), times) in &edges {
            assert_eq!((*times, edges[&(*to, *from)]), (1, 1));
        }
        let whole = 4.0 / 3.0 * std::f64::consts::PI * 27.0;
        assert!((0.94..1.0).contains(&(volume / whole)), "{volume}");
    }
}
