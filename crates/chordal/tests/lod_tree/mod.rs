//! Trees of tiles: the leaves are the mesh, any mixture of depths is one surface, and its bound holds.

use crate::solids::shapes;
use chordal::budget::{Evidence, JobError, Reference, RefusalCode};
use chordal::check::{Goal, Validity, deviation, validity};
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::lod::tiling::{LodTile, LodTileTree, TilingOptions, tree};
use chordal::{Bound, Bounded, Job, Mesh, Tolerance};
use chordal_testkit::{Random, is_long};
use std::collections::{BTreeMap, BTreeSet};

/// Tiles of so many triangles, the first above the leaves within a share of the diagonal.
fn cuts(mesh: &Mesh, most: usize, share: f64) -> TilingOptions {
    TilingOptions {
        max_triangles: most,
        ..TilingOptions::from_step(Tolerance::new(share * mesh.bounds().diagonal()).expect("a length"))
    }
}

fn exact(mesh: &Mesh) -> Bounded<Mesh> {
    Bounded { shape: mesh.clone(), bound: Bound::exact(Reference::InputTriangles) }
}

fn made(mesh: &Mesh, most: usize, share: f64) -> LodTileTree {
    let made = tree(&exact(mesh), Topology::Positions, &cuts(mesh, most, share), &Job::default());
    let made = made.expect("a tree");
    well_formed(&made, most);
    made
}

/// What holds of every tree.
fn well_formed(made: &LodTileTree, most: usize) {
    let mut parents = vec![0; made.tiles.len()];
    made.roots.iter().for_each(|root| parents[*root] += 1);
    assert!(made.roots.iter().all(|root| made.tiles[*root].depth == 0));
    for (at, tile) in made.tiles.iter().enumerate() {
        assert!(tile.mesh.faces().len() <= most && !tile.mesh.faces().is_empty());
        assert_eq!(*tile.bound.evidence(), Evidence::Proved);
        let below: Vec<&LodTile> = tile.children.iter().map(|child| &made.tiles[*child]).collect();
        assert!(tile.children.iter().all(|child| *child > at));
        assert!(below.iter().all(|child| child.depth == tile.depth + 1 && child.error() < tile.error()));
        let n: usize = below.iter().map(|child| child.mesh.faces().len()).sum();
        assert!(below.is_empty() || tile.mesh.faces().len() <= n, "{} of {n}", tile.mesh.faces().len());
        tile.children.iter().for_each(|child| parents[*child] += 1);
    }
    assert!(parents.iter().all(|n| *n == 1), "each tile hangs on one other");
}

/// Corners with their values, from the least one on.
type Corners = [Vec<u64>; 3];

fn corners(mesh: &Mesh, face: usize) -> Corners {
    let of = |k: usize| {
        let row = mesh.faces()[face][k] as usize;
        let values = mesh.attributes().iter().flat_map(|a| match a.domain {
            Domain::Vertex => a.row(row),
            Domain::Corner => a.row(3 * face + k),
            Domain::Face => a.row(face),
        });
        mesh.positions()[row].iter().chain(values).map(|x| x.to_bits()).collect::<Vec<u64>>()
    };
    let all = [of(0), of(1), of(2)];
    let least = (0..3).min_by_key(|k| &all[*k]).expect("three");
    std::array::from_fn(|k| all[(least + k) % 3].clone())
}

fn all_corners<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> Vec<Corners> {
    let mut all: Vec<Corners> =
        meshes.flat_map(|mesh| (0..mesh.faces().len()).map(|face| corners(mesh, face))).collect();
    all.sort_unstable();
    all
}

fn leaves_are(made: &LodTileTree, mesh: &Mesh) {
    let leaves = made.tiles.iter().filter(|tile| tile.children.is_empty()).map(|tile| &tile.mesh);
    assert!(all_corners(leaves) == all_corners(std::iter::once(mesh)), "the leaves are not the mesh");
}

/// Some tiles that may be shown together.
fn mixture<'a>(made: &'a LodTileTree, random: &mut Random) -> Vec<&'a LodTile> {
    let mut open = made.roots.clone();
    let mut shown = Vec::new();
    let go_on = random.signed();
    while let Some(at) = open.pop() {
        let tile = &made.tiles[at];
        if tile.children.is_empty() || random.signed() < go_on {
            shown.push(tile);
        } else {
            open.extend(&tile.children);
        }
    }
    shown
}

/// The triangles of tiles as one mesh, without values.
fn together(tiles: &[&LodTile]) -> Mesh {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for tile in tiles {
        let first = positions.len() as u32;
        positions.extend_from_slice(tile.mesh.positions());
        faces.extend(tile.mesh.faces().iter().map(|face| face.map(|row| row + first)));
    }
    Mesh::new(positions, faces).expect("a mesh")
}

/// Mixtures to try on each tree: each is judged against the whole mesh, which takes longer than the tree.
fn tries() -> u64 {
    if is_long() { 12 } else { 4 }
}

/// Every mixture is a surface like the mesh, and near it.
fn mixes(made: &LodTileTree, mesh: &Mesh, alike: impl Fn(&Validity, &Validity)) {
    let whole = validity(mesh, Topology::Positions);
    let mut depths = BTreeSet::new();
    for seed in 0..tries() {
        let shown = mixture(made, &mut Random::new(seed));
        depths.insert(shown.iter().map(|tile| tile.depth).collect::<Vec<_>>());
        let one = together(&shown);
        let found = validity(&one, Topology::Positions);
        let errors = shown.iter().map(|tile| tile.error());
        let error = errors.fold(0.0, |most: f64, x| if x > most { x } else { most });
        println!("seed {seed}: {} tiles, {} triangles, within {error:e}", shown.len(), one.faces().len());
        alike(&found, &whole);
        // How far exactly takes longer than whether it is within the error.
        let goal = Goal { max: Tolerance::new(error).ok(), ..Goal::default() };
        let far = deviation(mesh, &one, &goal, &Job::default()).expect("judged");
        assert!(far.bound.at_least() <= error, "seed {seed}: {} is not within {error}", far.bound);
    }
    assert!(3 * depths.len() as u64 > tries(), "the mixtures are all alike");
}

/// The same kind of surface, without a crack.
fn same(found: &Validity, whole: &Validity) {
    assert!(found.manifold() && found.oriented && whole.manifold());
    assert_eq!((found.closed, found.boundary_loops), (whole.closed, whole.boundary_loops));
    assert_eq!((found.components, found.euler), (whole.components, whole.euler));
}

#[test]
fn a_torus_is_one_at_every_depth() {
    let mesh = shapes::torus([80, 40], 0.05);
    let made = made(&mesh, 600, 1e-4);
    leaves_are(&made, &mesh);
    mixes(&made, &mesh, same);
    assert_eq!(made.roots, [0]);
    assert!(made.tiles[0].mesh.faces().len() < 150, "{}", made.tiles[0].mesh.faces().len());
}

#[test]
fn hills_keep_their_one_border() {
    let mesh = shapes::heights([60, 50], 0.001);
    let made = made(&mesh, 800, 1e-4);
    leaves_are(&made, &mesh);
    mixes(&made, &mesh, same);
    assert_eq!(made.roots, [0]);
    assert!(made.tiles[0].mesh.faces().len() <= 64);
    // The border of the whole shrinks in tiles as well.
    let on_border = |mesh: &Mesh| mesh.positions().iter().filter(|p| p[0] == 0.0).count();
    let shown: Vec<&LodTile> = made.tiles.iter().filter(|tile| tile.depth == 1).collect();
    assert!(on_border(&together(&shown)) < on_border(&mesh) / 2);
}

#[test]
fn two_balls_stay_two() {
    let mesh = shapes::twice(&shapes::sphere(4), [3.0, 0.5, 0.0]);
    let made = made(&mesh, 600, 1e-4);
    leaves_are(&made, &mesh);
    mixes(&made, &mesh, same);
    assert_eq!(made.roots, [0]);
    assert!(made.tiles[0].mesh.faces().len() <= 64);
}

#[test]
fn creases_and_thin_walls_hold() {
    // As files hold them: at full precision the flat sides of the gear are proved for 90 s.
    let single = |mesh: Mesh| {
        let positions = mesh.positions().iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
        if is_long() { mesh } else { mesh.with_positions(positions).expect("as many") }
    };
    for (mesh, most) in [(single(shapes::gear(2, 8)), 200), (shapes::tray(14, 0.01), 300)] {
        let made = made(&mesh, most, 1e-4);
        leaves_are(&made, &mesh);
        mixes(&made, &mesh, same);
        assert_eq!(made.roots, [0]);
    }
}

#[test]
fn a_moebius_strip_has_one_side_at_every_depth() {
    let mesh = shapes::mobius([200, 12]);
    let made = made(&mesh, 500, 1e-4);
    leaves_are(&made, &mesh);
    mixes(&made, &mesh, |found, whole| {
        assert!(found.manifold() && !found.orientable);
        assert_eq!((found.boundary_loops, found.euler), (whole.boundary_loops, whole.euler));
    });
}

/// A square of n × n cells, in its plane; texture coordinates of corners with a seam in the middle, materials
/// of faces in three stripes across it, and normals of vertices.
fn painted(n: u32) -> Mesh {
    let flat = shapes::heights([n, n], 0.0);
    let level = flat.positions().iter().map(|p| [p[0], p[1], 0.0]).collect();
    let mesh = flat.with_positions(level).expect("as many");
    let centre = |face: usize| -> [f64; 2] {
        let c = mesh.corners(face);
        std::array::from_fn(|k| (c[0][k] + c[1][k] + c[2][k]) / 3.0)
    };
    let at = |face: usize, p: [f64; 3]| texcoord(centre(face), p);
    let faces = 0..mesh.faces().len();
    let texcoords = faces.clone().flat_map(|f| mesh.corners(f).map(|p| at(f, p))).flatten().collect();
    let stripes = faces.map(|face| stripe(centre(face))).collect();
    let normals = vec![[0.0, 0.0, 1.0]; mesh.positions().len()];
    let of = |semantic, domain, width, values| Attribute { semantic, domain, width, values };
    let texcoords = of(Semantic::TexCoord(0), Domain::Corner, 2, texcoords);
    let stripes = of(Semantic::Group("material".into()), Domain::Face, 1, stripes);
    let mesh = mesh.with_attribute(texcoords).expect("fits").with_attribute(stripes).expect("fits");
    mesh.with_attribute(Attribute::vertex_normals(&normals)).expect("fits")
}

/// A map that jumps by 10 at x = 1/2.
fn texcoord(centre: [f64; 2], p: [f64; 3]) -> [f64; 2] {
    [3.0 * p[0] + if centre[0] > 0.5 { 10.0 } else { 0.0 }, 3.0 * p[1]]
}

/// Stripes between y = 1/4 and y = 3/4, where lines of vertices are.
fn stripe(centre: [f64; 2]) -> f64 {
    f64::from(u8::from(centre[1] > 0.25) + u8::from(centre[1] > 0.75))
}

#[test]
fn seams_and_materials_hold_along_the_cuts_too() {
    let mesh = painted(48);
    let made = made(&mesh, 300, 1e-4);
    leaves_are(&made, &mesh);
    mixes(&made, &mesh, same);
    let known: BTreeSet<Vec<u64>> = all_corners(std::iter::once(&mesh)).into_iter().flatten().collect();
    for seed in 0..tries() {
        let shown = mixture(&made, &mut Random::new(seed));
        // Positions of several tiles at once.
        let mut tiles_at: BTreeMap<&[u64], BTreeSet<usize>> = BTreeMap::new();
        let of_tile: Vec<Vec<Corners>> =
            shown.iter().map(|tile| all_corners(std::iter::once(&tile.mesh))).collect();
        for (at, all) in of_tile.iter().enumerate() {
            all.iter().flatten().for_each(|corner| {
                tiles_at.entry(&corner[..3]).or_default().insert(at);
            });
        }
        let shared = of_tile.iter().flatten().flatten().filter(|corner| tiles_at[&corner[..3]].len() > 1);
        assert!(shared.clone().all(|corner| known.contains(corner)), "seed {seed}: a value at a cut changed");
        for tile in &shown {
            let texcoords = tile.mesh.attribute(&Semantic::TexCoord(0)).expect("kept");
            let stripes = tile.mesh.attribute(&Semantic::Group("material".into())).expect("kept");
            for face in 0..tile.mesh.faces().len() {
                let c = tile.mesh.corners(face);
                let centre = std::array::from_fn(|k| (c[0][k] + c[1][k] + c[2][k]) / 3.0);
                assert_eq!(stripes.row(face), [stripe(centre)], "seed {seed}");
                for (k, p) in c.into_iter().enumerate() {
                    let (found, true_) = (texcoords.row(3 * face + k), texcoord(centre, p));
                    // Where a border gives way by a length, what is painted there does by three of it, in
                    // each step.
                    let off = 10.0 * tile.error() + 1e-9;
                    assert!((0..2).all(|k| (found[k] - true_[k]).abs() <= off), "{found:?} {true_:?}");
                }
            }
        }
    }
    let root = &made.tiles[0].mesh;
    assert!(made.roots == [0] && root.faces().len() <= 64, "{}", root.faces().len());
}

#[test]
fn rows_of_one_position_stay_tied_by_indices() {
    // A torus whose triangles have rows of their own, tied by position.
    let torus = shapes::torus([40, 20], 0.0);
    let rows = torus.faces().as_flattened();
    let positions = rows.iter().map(|row| torus.positions()[*row as usize]).collect();
    let faces = (0..rows.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let mut first = vec![u32::MAX; torus.positions().len()];
    let name = |(at, row): (usize, &u32)| {
        let first = &mut first[*row as usize];
        *first = (*first).min(at as u32);
        *first
    };
    let ids = rows.iter().enumerate().map(name).collect();
    let mesh = Mesh::new(positions, faces).expect("a soup").with_position_id(ids).expect("tied");
    let found = tree(&exact(&mesh), Topology::Indices, &cuts(&mesh, 300, 1e-3), &Job::default());
    let found = found.expect("a tree");
    well_formed(&found, 300);
    leaves_are(&found, &mesh);
    mixes(&found, &mesh, same);
    assert!(found.roots == [0] && found.tiles[0].mesh.faces().len() < 150);
}

#[test]
fn a_small_mesh_is_a_chain() {
    let mesh = shapes::sphere(3);
    let made = made(&mesh, 1 << 16, 1e-3);
    leaves_are(&made, &mesh);
    assert!(made.tiles.len() > 2);
    assert!(made.tiles[..made.tiles.len() - 1].iter().all(|tile| tile.children.len() == 1));
}

#[test]
fn bounds_begin_at_that_of_the_finest() {
    let mesh = shapes::sphere(4);
    let loss = Bound::proved(0.001, 0.002, Reference::LimitSurface);
    let finest = Bounded { shape: mesh.clone(), bound: loss.clone() };
    let made = tree(&finest, Topology::Indices, &cuts(&mesh, 600, 1e-3), &Job::default()).expect("a tree");
    well_formed(&made, 600);
    for tile in &made.tiles {
        assert_eq!(tile.bound.reference, Reference::LimitSurface);
        if tile.children.is_empty() {
            assert_eq!(tile.bound, loss);
        } else {
            assert!(tile.error() > 0.002);
        }
    }
    // Against its own triangles the root is off by about what it says beyond that.
    let far = deviation(&mesh, &made.tiles[0].mesh, &Goal::default(), &Job::default()).expect("judged");
    assert!(far.bound.at_least() <= made.tiles[0].error() - 0.002);
    assert!(made.tiles[0].error() <= 0.002 + 1.2 * far.bound.at_least());
}

#[test]
fn threads_change_nothing() {
    let mesh = shapes::torus([44, 22], 0.05);
    let on = |threads| {
        let job = Job::default().with_threads(threads);
        tree(&exact(&mesh), Topology::Positions, &cuts(&mesh, 300, 3e-4), &job).expect("a tree")
    };
    let one = on(1);
    assert!(one.tiles.len() > 8);
    assert!(one == on(2) && one == on(3));
}

#[test]
fn what_does_not_shrink_stays_in_several_roots() {
    // Triangles far from each other.
    let rows = (0..9).flat_map(|i| {
        let x = 10.0 * f64::from(i);
        [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]]
    });
    let faces = (0..9).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh::new(rows.collect(), faces).expect("valid");
    let found = tree(&exact(&mesh), Topology::Positions, &cuts(&mesh, 2, 1e-6), &Job::default());
    let found = found.expect("a tree");
    well_formed(&found, 2);
    assert!(found.roots.len() > 1);
    let roots: Vec<&LodTile> = found.roots.iter().map(|root| &found.tiles[*root]).collect();
    let far = deviation(&mesh, &together(&roots), &Goal::default(), &Job::default()).expect("judged");
    let error = roots.iter().fold(0.0, |most: f64, tile| most.max(tile.error()));
    assert!(far.bound.at_least() <= error);
}

#[test]
fn soups_keep_their_bounds() {
    for seed in 0..4 {
        println!("soup {seed}");
        let mut random = Random::new(seed);
        let n = 40;
        // Lattice points, so that many corners, edges and whole triangles meet, and some have no area.
        let mut coordinate = || (2.5 * random.signed()).round();
        let positions: Vec<[f64; 3]> = (0..n).map(|_| std::array::from_fn(|_| coordinate())).collect();
        let mut row = || (random.bits() % n) as u32;
        let faces = (0..60).map(|_| [row(), row(), row()]).collect();
        let mesh = Mesh::new(positions, faces).expect("valid");
        let made = made(&mesh, 20, 0.05);
        let shown = mixture(&made, &mut Random::new(seed));
        let error = shown.iter().fold(0.0, |most: f64, tile| most.max(tile.error()));
        let far = deviation(&mesh, &together(&shown), &Goal::default(), &Job::default()).expect("judged");
        assert!(far.bound.at_least() <= error, "{} is not within {error}", far.bound);
    }
}

#[test]
fn triangles_without_area_are_tiles_too() {
    let points = (0..40).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let mesh = Mesh::new(points, (0..40).map(|i| [i, i, i]).collect()).expect("valid");
    let found = tree(&exact(&mesh), Topology::Indices, &cuts(&mesh, 8, 0.1), &Job::default());
    leaves_are(&found.expect("a tree"), &mesh);
    let one = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).expect("valid");
    assert_eq!(made(&one, 1, 0.1).tiles.len(), 1);
}

#[test]
fn refuses_what_it_cannot_do() {
    let mesh = shapes::sphere(2);
    let good = cuts(&mesh, 100, 0.01);
    let code = |finest: &Bounded<Mesh>, cuts: &TilingOptions| match tree(
        finest,
        Topology::Indices,
        cuts,
        &Job::default(),
    ) {
        Err(JobError::Refused(refusal)) => refusal.code,
        other => panic!("{other:?}"),
    };
    for factor in [1.0, 0.5, -2.0, f64::NAN] {
        assert_eq!(code(&exact(&mesh), &TilingOptions { factor, ..good }), RefusalCode::Budget);
    }
    assert_eq!(code(&exact(&mesh), &TilingOptions { max_triangles: 0, ..good }), RefusalCode::Budget);
    assert_eq!(code(&exact(&Mesh::default()), &good), RefusalCode::Empty);
    let guess = Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::InputTriangles);
    assert_eq!(code(&Bounded { shape: mesh.clone(), bound: guess }, &good), RefusalCode::Unsupported);
    let job = Job::default();
    job.cancel();
    assert!(matches!(tree(&exact(&mesh), Topology::Indices, &good, &job), Err(JobError::Cancelled)));
}
