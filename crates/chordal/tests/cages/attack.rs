//! Cages that once had a limit surface other than the one their rounds converge to.
use chordal::check;
use chordal::explicit::subdivision::{Boundary, CreasingMethod, INFINITELY_SHARP};
use chordal::explicit::{Cage, InvalidCage};
use chordal::{Budget, Job, Tolerance, convert};
use chordal_testkit::sampler::distance;

/// The largest distance between the limit surface of a cage and that after each of so many rounds, at places
/// of all faces.
fn off(cage: &Cage, rounds: u32) -> f64 {
    let mut cage = cage.clone();
    let mut most = 0.0;
    for _ in 0..rounds {
        let next = cage.refined().unwrap();
        let (limit, after) = (cage.limit().unwrap(), next.limit().unwrap());
        let mut first_part = vec![0];
        cage.faces().for_each(|face| first_part.push(first_part[first_part.len() - 1] + face.len()));
        let mut sheet_of = vec![None; next.n_faces()];
        (0..after.n_sheets()).for_each(|sheet| sheet_of[after.face_of(sheet).0] = Some(sheet));
        for index in 0..limit.n_sheets() {
            let (face, corner) = limit.face_of(index);
            let sheet = limit.sheet(index).unwrap();
            let is_quad = cage.face(face).len() == 4;
            for part in if is_quad { 0..4 } else { corner..corner + 1 } {
                let child = after.sheet(sheet_of[first_part[face] + part].unwrap()).unwrap();
                for (s, t) in [(0.0, 0.0), (0.3, 0.8), (0.5, 0.125), (0.9, 0.03), (0.0, 0.4), (0.7, 0.0)] {
                    let (u, v) = match (is_quad, part) {
                        (false, _) => (s, t),
                        (true, 0) => (0.5 * s, 0.5 * t),
                        (true, 1) => (1.0 - 0.5 * t, 0.5 * s),
                        (true, 2) => (1.0 - 0.5 * s, 1.0 - 0.5 * t),
                        _ => (0.5 * t, 1.0 - 0.5 * s),
                    };
                    let apart = distance(sheet.at(u, v).unwrap().point, child.at(s, t).unwrap().point);
                    most = f64::max(most, apart);
                }
            }
        }
        cage = next;
    }
    most
}

/// 3 × 3 quads, lifted.
fn sheet() -> Cage {
    let point = |k: u32| [f64::from(k % 4), f64::from(k / 4), f64::from(k * k % 7) * 0.2];
    let quads = (0..9).map(|k| k / 3 * 4 + k % 3).map(|k| [k, k + 1, k + 5, k + 4]);
    Cage::new((0..16).map(point).collect(), quads).unwrap().with_creasing(CreasingMethod::Chaikin)
}

/// A half of a crease that is 0.9 sharp stays sharp for the sake of the sharper ones at both its ends, of
/// which one is no vertex of the face in the corner.
#[test]
fn by_chaikin_the_far_end_of_a_crease_counts() {
    let cage = sheet();
    let creases = [([5, 6], 0.9), ([4, 5], 5.0), ([6, 7], 5.0), ([6, 10], 4.0)];
    let cage = cage.with_creases(&creases).unwrap();
    assert!(off(&cage, 3) < 1e-13, "{}", off(&cage, 3));
}

/// At a corner between four infinitely sharp edges with a crease on either side.
#[test]
fn by_chaikin_creases_beyond_a_corner_count() {
    // Eight faces around the middle, creases by turns.
    let turn = |k: u32| {
        let places = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];
        places[k as usize % 8].map(f64::from)
    };
    let mut points = vec![[0.0, 0.0, 0.3]];
    points.extend((0..8).map(|k| [turn(k)[0], turn(k)[1], f64::from(k * k % 5) * 0.2]));
    points.extend((0..8).map(|k| {
        let (a, b) = (turn(k), turn(k + 1));
        [a[0] + b[0], a[1] + b[1], f64::from(k * k % 3) * 0.3]
    }));
    let quads = (0..8).map(|k| [0, 1 + k, 9 + k, 1 + (k + 1) % 8]);
    let cage = Cage::new(points, quads).unwrap().with_creasing(CreasingMethod::Chaikin);
    let sharpness =
        [INFINITELY_SHARP, 0.9, INFINITELY_SHARP, 4.0, INFINITELY_SHARP, 2.0, INFINITELY_SHARP, 0.5];
    let creases: Vec<_> = (1..9).zip(sharpness).map(|(k, sharp)| ([0, k], sharp)).collect();
    let cage = cage.with_creases(&creases).unwrap();
    assert!(off(&cage, 3) < 1e-13, "{}", off(&cage, 3));
}

/// Two quads back to back with one sharp edge: around a vertex of two faces it ends, as both go on along the
/// other one.
#[test]
fn a_crease_ends_between_two_faces_with_two_common_sides() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [1.2, 1.0, 0.0], [0.0, 1.0, 0.7]];
    let cage = Cage::new(points, [[0, 1, 2, 3], [3, 2, 1, 0]]).unwrap();
    let cage = cage.with_creases(&[([0, 1], INFINITELY_SHARP)]).unwrap();
    assert!(off(&cage, 3) < 1e-13, "{}", off(&cage, 3));
    let budget = Budget::length(Tolerance::new(1e-2).unwrap());
    let mesh = convert::cage_to_mesh(&cage, &budget, &Job::default()).unwrap();
    assert!(mesh.bound.at_most().unwrap() <= 1e-2);
    // The vertices of later rounds, of which each is within 4⁻⁵ of the cage's size of the surface.
    let fine = cage.refined_times(6).unwrap();
    let (far, _) = check::surface_at_least(fine.positions(), &mesh.shape).unwrap();
    assert!(far <= 1e-2 + 2e-3, "{far}");
}

/// Around one edge of a seam faces may hang together that do not have its other edge.
#[test]
fn seams_shape_faces_that_have_one_of_their_edges() {
    let points = vec![[-0.87, -0.04, -0.05], [-0.37, 0.69, -0.83], [0.66, 0.56, -0.37], [-0.42, 0.53, -0.61]];
    let cage = Cage::new(points, [[0, 2, 1], [3, 1, 0], [3, 1, 0], [0, 1, 2]]).unwrap();
    for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
        let cage = cage.clone().with_boundary(boundary);
        assert!(off(&cage, 3) < 1e-13, "{}", off(&cage, 3));
    }
}

/// A cube of that half an edge.
fn cube(half: f64) -> Cage {
    let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -half } else { half });
    let sides: [&[u32]; 6] =
        [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
    Cage::new((0..8).map(corner).collect(), sides).unwrap()
}

/// Where squares of lengths are no numbers any more, or 0.
#[test]
fn the_distance_of_polygons_is_proved_at_every_scale_or_refused() {
    // A corner of the cube goes to half of itself: it is √3/2 away.
    for half in [1e-300, 1e-160, 1e-153, 1e-100, 1.0, 1e100, 1e149] {
        let bound = check::limit_deviation(&cube(half), &Job::default()).unwrap();
        assert!(bound.at_most().unwrap() >= 0.866 * half, "{half}: {bound:?}");
    }
    for half in [1e151, 1e160, 1e300, 1.7e308] {
        let refused = check::limit_deviation(&cube(half), &Job::default());
        assert_eq!(refused.unwrap_err(), InvalidCage::NotFinite { row: 0 }, "{half}");
    }
}
