//! Trees of different quality give equal hits.

use super::*;

fn qualities() -> impl Iterator<Item = Quality> {
    let bins = [0, 1, 2, 16, usize::MAX];
    let sharing = [0, 1, 4, usize::MAX];
    bins.into_iter()
        .flat_map(move |bins| sharing.map(|sharing| Quality { bins, sharing }))
}

#[test]
fn hits_do_not_depend_on_the_tree() {
    let (vertices, triangles) = ball(14, 18, 4.0, 0.3);
    let mesh = Mesh::new(&vertices, &triangles).unwrap();
    let mut numbers = Numbers(21);
    let rays: Vec<Ray> = (0..200)
        .map(|_| ray(numbers.vector() * 3.0, numbers.direction()))
        .collect();
    let cast = |mesh: Mesh| {
        let caster = Caster::new([Object::new(mesh)]).unwrap();
        let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
        caster.nearest_of(&rays, 1, Reach::default(), &mut hits);
        let with_normals = rays.iter().zip(&hits).map(|(ray, hit)| {
            assert_eq!(first(&caster, ray), *hit);
            first_with_normal(&caster, ray)
        });
        with_normals.collect::<Vec<_>>()
    };
    let expected = cast(mesh.clone());
    assert!(expected.iter().flatten().count() > 100);
    for quality in qualities() {
        assert_eq!(cast(mesh.rebuilt(quality)), expected, "{quality:?}");
    }
}

#[test]
fn rebuilding_a_tree_does_not_depend_on_the_previous_one() {
    let (vertices, triangles) = ball(8, 12, 4.0, 0.3);
    let mesh = Mesh::new(&vertices, &triangles).unwrap();
    let printed = |mesh: &Mesh| format!("{mesh:?}");
    assert_eq!(printed(&mesh.rebuilt(Quality::MESH)), printed(&mesh));
    for quality in qualities() {
        let once = mesh.rebuilt(quality);
        let again = mesh
            .rebuilt(Quality {
                bins: 3,
                sharing: 5,
            })
            .rebuilt(quality);
        assert_eq!(printed(&again), printed(&once), "{quality:?}");
    }
}

#[test]
fn build_quality_changes_the_size_of_the_tree() {
    let (vertices, triangles) = ball(40, 60, 4.0, 0.3);
    let mesh = Mesh::new(&vertices, &triangles).unwrap();
    let nodes = |bins, sharing| mesh.rebuilt(Quality { bins, sharing }).nodes();
    assert_eq!(nodes(16, 4), mesh.nodes());
    // Every node but the root and every triangle is a child: with eight children per node there is
    // at least one node per eight triangles.
    assert!(nodes(16, 1) > mesh.triangles() / 8);
    assert!(nodes(16, 4) < nodes(16, 1) && nodes(16, 8) < nodes(16, 4));
    // Out of bounds counts as the bound.
    assert_eq!(nodes(16, 16), nodes(16, usize::MAX));
    assert_eq!(nodes(64, 1), nodes(usize::MAX, 1));
    assert_eq!(nodes(0, 1), nodes(1, 1));
    let middle = mesh.rebuilt(Quality {
        bins: 0,
        ..Quality::MESH
    });
    assert_ne!(format!("{middle:?}"), format!("{mesh:?}"));
}
