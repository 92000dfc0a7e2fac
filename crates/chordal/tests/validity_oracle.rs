//! Twins and validity against a naive oracle, written from the definitions, on small random meshes full of
//! faults.
use chordal::Mesh;
use chordal::check::{Validity, validity};
use chordal::explicit::Topology;
use chordal::explicit::adjacency::{Twin, Twins};
use chordal_testkit::Random;
use std::collections::{BTreeMap, BTreeSet};

/// Few positions on a small lattice, rows tied at random, any faces: every kind of fault, also several at
/// once.
fn random_soup(random: &mut Random) -> Mesh {
    let n_rows = 3 + random.below(8);
    let n_ids = 1 + random.below(n_rows);
    let ids: Vec<u32> = (0..n_rows).map(|_| random.below(n_ids) as u32).collect();
    let lattice: Vec<[f64; 3]> =
        (0..n_ids).map(|_| std::array::from_fn(|_| random.below(3) as f64)).collect();
    let positions = ids.iter().map(|&id| lattice[id as usize]).collect();
    let n_faces = random.below(14);
    let faces = (0..n_faces).map(|_| std::array::from_fn(|_| random.below(n_rows) as u32)).collect();
    Mesh::new(positions, faces).unwrap().with_position_id(ids).unwrap()
}

/// A torus or Klein bottle of triangles, or an annulus or Möbius strip, with a few faces removed, turned,
/// repeated or glued to a wrong vertex.
fn broken_band(random: &mut Random) -> Mesh {
    let (nu, nv) = (3 + random.below(4), 3 + random.below(4));
    let (twisted, open) = (random.below(2) == 0, random.below(2) == 0);
    let at = |i: usize, j: usize| {
        // The open band lies between columns 0 and 1, which a twist swaps.
        let width = if open { 2 } else { nv };
        let mirrored = if i == nu && twisted { (2 * width - 1 - j) % width } else { j % width };
        ((i % nu) * nv + mirrored) as u32
    };
    let mut faces: Vec<[u32; 3]> = (0..nu * nv)
        .map(|quad| (quad / nv, quad % nv))
        .filter(|&(_, j)| !(open && j > 0))
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    for _ in 0..random.below(6) {
        let face = random.below(faces.len());
        match random.below(4) {
            0 => drop(faces.swap_remove(face)),
            1 => faces[face].swap(1, 2),
            2 => faces.push(faces[face]),
            _ => faces[face][random.below(3)] = random.below(nu * nv) as u32,
        }
    }
    let positions =
        (0..nu * nv).map(|v| [(v / nv) as f64, (v % nv) as f64, random.below(9) as f64]).collect();
    Mesh::new(positions, faces).unwrap()
}

/// Random soup and broken bands in turn.
fn random_mesh(seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    if seed.is_multiple_of(3) { broken_band(&mut random) } else { random_soup(&mut random) }
}

/// A use of an edge: which half-edge, and whether it runs from the lower position to the higher.
type Use = (u32, bool);

/// The mesh as the definitions see it: proper faces by position, and who uses each edge.
struct Naive {
    /// Face number and its positions.
    faces: Vec<(u32, [u32; 3])>,
    edges: BTreeMap<(u32, u32), Vec<Use>>,
}

impl Naive {
    fn new(mesh: &Mesh) -> Self {
        let proper = |f: &[u32; 3]| f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
        let ids = mesh.faces().iter().map(|face| face.map(|row| mesh.position_of(row)));
        let faces: Vec<_> = (0_u32..).zip(ids).filter(|(_, face)| proper(face)).collect();
        let mut edges: BTreeMap<_, Vec<Use>> = BTreeMap::new();
        for (number, face) in &faces {
            for k in 0..3 {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                edges.entry((a.min(b), a.max(b))).or_default().push((3 * number + k as u32, a < b));
            }
        }
        Self { faces, edges }
    }

    /// Partitions `items` into the sets that `linked` holds together.
    fn partition<T: Copy>(items: &[T], linked: impl Fn(T, T) -> bool) -> Vec<Vec<T>> {
        let mut sets: Vec<Vec<T>> = Vec::new();
        for &item in items {
            let (with, without): (Vec<_>, Vec<_>) =
                sets.into_iter().partition(|set| set.iter().any(|&other| linked(item, other)));
            sets = without;
            sets.push(with.into_iter().flatten().chain([item]).collect());
        }
        sets
    }

    fn share_edge(&self, a: u32, b: u32, counts: impl Fn((u32, u32), usize) -> bool) -> bool {
        self.edges.iter().any(|(&edge, uses)| {
            let has = |face| uses.iter().any(|u| u.0 / 3 == face);
            counts(edge, uses.len()) && has(a) && has(b)
        })
    }

    fn components(&self) -> usize {
        let faces: Vec<u32> = self.faces.iter().map(|f| f.0).collect();
        Self::partition(&faces, |a, b| self.share_edge(a, b, |_, _| true)).len()
    }

    /// The fans at every position.
    fn fans(&self) -> BTreeMap<u32, Vec<Vec<u32>>> {
        let positions: BTreeSet<u32> = self.faces.iter().flat_map(|f| f.1).collect();
        let fans_at = |p: u32| {
            let around: Vec<u32> = self.faces.iter().filter(|f| f.1.contains(&p)).map(|f| f.0).collect();
            Self::partition(&around, |a, b| {
                self.share_edge(a, b, |edge, n| n == 2 && (edge.0 == p || edge.1 == p))
            })
        };
        positions.into_iter().map(|p| (p, fans_at(p))).collect()
    }

    /// Closed loops and open chains of boundary edges, linked where they end the same fan.
    fn boundary(&self) -> (usize, usize) {
        let boundary: Vec<(u32, u32)> =
            self.edges.iter().filter(|(_, uses)| uses.len() == 1).map(|(edge, _)| *edge).collect();
        let mut links: Vec<[(u32, u32); 2]> = Vec::new();
        for (p, fans) in self.fans() {
            for fan in fans {
                let ends: Vec<_> = boundary
                    .iter()
                    .filter(|edge| edge.0 == p || edge.1 == p)
                    .filter(|edge| fan.contains(&(self.edges[edge][0].0 / 3)))
                    .copied()
                    .collect();
                links.extend(<[_; 2]>::try_from(ends));
            }
        }
        let strings =
            Self::partition(&boundary, |a, b| links.iter().any(|l| l.contains(&a) && l.contains(&b)));
        let closed = |string: &Vec<(u32, u32)>| {
            links.iter().filter(|l| string.contains(&l[0])).count() == string.len()
        };
        let loops = strings.iter().filter(|s| closed(s)).count();
        (loops, strings.len() - loops)
    }

    fn inconsistent(&self) -> usize {
        self.edges.values().filter(|uses| uses.len() == 2 && uses[0].1 == uses[1].1).count()
    }

    /// Tries every way to turn the faces.
    fn orientable(&self) -> bool {
        let place = |half_edge: u32| self.faces.iter().position(|f| f.0 == half_edge / 3).unwrap();
        (0..1_u32 << self.faces.len()).any(|turned| {
            self.edges.values().filter(|uses| uses.len() == 2).all(|uses| {
                let runs_up = |u: &Use| u.1 ^ (turned >> place(u.0) & 1 == 1);
                runs_up(&uses[0]) != runs_up(&uses[1])
            })
        })
    }

    /// Faces that repeat an earlier one, and those wound the other way.
    fn duplicates(&self) -> (usize, usize) {
        let sorted = |mut face: [u32; 3]| {
            face.sort_unstable();
            face
        };
        let rotations = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
        let first = |face: [u32; 3]| self.faces.iter().find(|f| sorted(f.1) == sorted(face)).unwrap();
        let repeats: Vec<_> = self.faces.iter().filter(|f| first(f.1).0 != f.0).collect();
        let opposite = repeats.iter().filter(|f| !rotations(first(f.1).1).contains(&f.1)).count();
        (repeats.len(), opposite)
    }
}

fn count_edges(naive: &Naive, n: impl Fn(usize) -> bool) -> u64 {
    naive.edges.values().filter(|uses| n(uses.len())).count() as u64
}

#[test]
fn twins_are_those_of_the_oracle() {
    for seed in 0..6000 {
        let mesh = random_mesh(seed);
        let (naive, twins) = (Naive::new(&mesh), Twins::new(&mesh, Topology::Indices));
        let mut expected = vec![Twin::Collapsed; 3 * mesh.faces().len()];
        for uses in naive.edges.values() {
            for (i, &(h, runs_up)) in uses.iter().enumerate() {
                let other = uses[1 - i.min(1)..].first().copied();
                expected[h as usize] = match (uses.len(), other) {
                    (1, _) => Twin::Boundary,
                    (2, Some((t, up))) if up != runs_up => Twin::Pair(t),
                    (2, Some((t, _))) => Twin::Flipped(t),
                    _ => Twin::NonManifold,
                };
            }
        }
        let found: Vec<Twin> = (0..twins.len() as u32).map(|h| twins.get(h)).collect();
        assert_eq!(found, expected, "seed {seed}");
        let crowded: BTreeSet<Vec<u32>> = twins.non_manifold_edges().map(<[u32]>::to_vec).collect();
        let expected: BTreeSet<Vec<u32>> = naive
            .edges
            .values()
            .filter(|uses| uses.len() > 2)
            .map(|uses| uses.iter().map(|u| u.0).collect())
            .collect();
        assert_eq!(crowded, expected, "seed {seed}");
    }
}

#[test]
fn counts_are_those_of_the_oracle() {
    let mut met = [0_u64; 9];
    for seed in 0..6000 {
        let mesh = random_mesh(seed);
        let (naive, found) = (Naive::new(&mesh), validity(&mesh, Topology::Indices));
        let fans = naive.fans();
        let split = fans.values().filter(|fans| fans.len() > 1).count() as u64;
        let (loops, chains) = naive.boundary();
        let (duplicates, opposite) = naive.duplicates();
        let expected = [
            ("edges", naive.edges.len() as u64, found.edges),
            ("components", naive.components() as u64, found.components),
            ("boundary edges", count_edges(&naive, |n| n == 1), found.boundary_edges.count),
            ("loops", loops as u64, found.boundary_loops),
            ("chains", chains as u64, found.boundary_chains),
            ("non-manifold edges", count_edges(&naive, |n| n > 2), found.non_manifold_edges.count),
            ("non-manifold vertices", split, found.non_manifold_vertices.count),
            ("inconsistent", naive.inconsistent() as u64, found.inconsistent_edges.count),
            ("duplicates", duplicates as u64, found.duplicate_faces.count),
            ("opposite", opposite as u64, found.opposite_faces.count),
            ("collapsed", (mesh.faces().len() - naive.faces.len()) as u64, found.collapsed_faces.count),
            ("positions", mesh.n_positions() as u64, found.positions),
        ];
        for (what, expected, found) in expected {
            assert_eq!(found, expected, "{what}, seed {seed}: {mesh:?}");
        }
        let euler = fans.len() as i64 - naive.edges.len() as i64 + naive.faces.len() as i64;
        assert_eq!(found.euler, euler, "seed {seed}");
        if naive.faces.len() <= 12 {
            assert_eq!(found.orientable, naive.orientable(), "orientable, seed {seed}: {mesh:?}");
        }
        let is_met = [
            split > 0,
            loops > 1,
            chains > 0,
            duplicates > 0,
            opposite > 0,
            !found.orientable,
            found.orientable && !found.oriented,
            found.genus.is_some_and(|genus| genus > 0),
            found.components > 1,
        ];
        met.iter_mut().zip(is_met).for_each(|(count, is)| *count += u64::from(is));
    }
    assert!(met.iter().all(|&count| count >= 20), "the random meshes are too tame: {met:?}");
}

#[test]
fn every_face_without_area_is_found_and_no_other() {
    for seed in 0..3000 {
        let mesh = random_soup(&mut Random::new(seed));
        // The coordinates are small integers: the cross product is exact.
        let flat = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|row| glam::DVec3::from(mesh.positions()[row as usize]));
            (b - a).cross(c - a) == glam::DVec3::ZERO
        };
        let expected = mesh.faces().iter().filter(|face| flat(face)).count() as u64;
        assert_eq!(validity(&mesh, Topology::Indices).zero_area_faces.count, expected, "seed {seed}");
    }
}

#[test]
fn witnesses_name_what_was_found_where_it_is() {
    use chordal::check::findings::{Finding, MAX_WITNESSES, MeshLocation};
    for seed in 0..2000 {
        let mesh = random_mesh(seed);
        let naive = Naive::new(&mesh);
        let found = validity(&mesh, Topology::Indices);
        let Validity { boundary_edges, non_manifold_edges, inconsistent_edges, .. } = &found;
        type NumberOfFaces = fn(usize) -> bool;
        let edges: [(&Finding, NumberOfFaces); 3] =
            [(boundary_edges, |n| n == 1), (non_manifold_edges, |n| n > 2), (inconsistent_edges, |n| n == 2)];
        for (finding, has_faces) in edges {
            assert_eq!(finding.witnesses.len(), MAX_WITNESSES.min(finding.count as usize), "seed {seed}");
            for witness in &finding.witnesses {
                let MeshLocation::Edge { vertices, faces } = &witness.place else { panic!("{witness:?}") };
                let [a, b] = vertices.map(|row| mesh.position_of(row));
                let uses = &naive.edges[&(a.min(b), a.max(b))];
                assert!(has_faces(uses.len()), "seed {seed}: {witness:?}");
                assert_eq!(*faces, uses.iter().map(|u| u.0 / 3).collect::<Vec<_>>(), "seed {seed}");
                let ends = vertices.map(|row| mesh.positions()[row as usize]);
                let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * ends[0][k] + 0.5 * ends[1][k]);
                assert_eq!(witness.at, middle, "seed {seed}");
            }
        }
        for witness in &found.non_manifold_vertices.witnesses {
            let MeshLocation::Vertex(row) = witness.place else { panic!("{witness:?}") };
            assert!(naive.fans()[&mesh.position_of(row)].len() > 1, "seed {seed}: {witness:?}");
            assert_eq!(witness.at, mesh.positions()[row as usize]);
        }
    }
}

#[test]
fn numbering_and_common_turning_change_no_count() {
    let counts = |v: &Validity| {
        let findings = [
            &v.boundary_edges,
            &v.non_manifold_edges,
            &v.non_manifold_vertices,
            &v.inconsistent_edges,
            &v.duplicate_faces,
            &v.collapsed_faces,
            &v.zero_area_faces,
            &v.unused_vertices,
        ];
        let strings = (v.boundary_loops, v.boundary_chains);
        (findings.map(|f| f.count), v.edges, v.components, strings, v.euler, v.genus, v.orientable)
    };
    for seed in 0..1000 {
        let mesh = random_mesh(seed);
        let mut random = Random::new(!seed);
        let n = mesh.positions().len();
        let mut to: Vec<u32> = (0..n as u32).collect();
        (1..n).rev().for_each(|i| to.swap(i, random.below(i + 1)));
        let (mut positions, mut ids) = (vec![[0.0; 3]; n], vec![0; n]);
        for row in 0..n {
            positions[to[row] as usize] = mesh.positions()[row];
            ids[to[row] as usize] = to[mesh.position_of(row as u32) as usize];
        }
        let mut faces: Vec<_> =
            mesh.faces().iter().map(|&[a, b, c]| [b, a, c].map(|row| to[row as usize])).collect();
        (1..faces.len()).rev().for_each(|i| faces.swap(i, random.below(i + 1)));
        faces.iter_mut().for_each(|face| face.rotate_left(random.below(3)));
        let other = Mesh::new(positions, faces).unwrap().with_position_id(ids).unwrap();
        let (one, other) = [&mesh, &other].map(|mesh| validity(mesh, Topology::Indices)).into();
        assert_eq!(counts(&one), counts(&other), "seed {seed}");
    }
}
