//! The limit surface: what rounds converge to, and the same whether a round was done before or not.
use super::corpus::cages;
use chordal::explicit::Cage;
use chordal::explicit::subdivision::{Jet, Scheme};
use chordal_testkit::sampler::distance;

fn size(cage: &Cage) -> f64 {
    cage.positions().as_flattened().iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}

fn with_limit() -> impl Iterator<Item = (String, Cage)> {
    cages().into_iter().filter(|(_, cage)| cage.scheme() != Scheme::Loop)
}

/// At most so many sheets, spread over all.
fn some(n: usize) -> impl Iterator<Item = usize> {
    (0..n).step_by(n.div_ceil(40))
}

#[test]
fn rounds_converge_to_it() {
    for (name, cage) in with_limit() {
        let limit = cage.limit().unwrap();
        let mut before = f64::INFINITY;
        for rounds in [3_u32, 6] {
            let fine = cage.refined_times(rounds).unwrap();
            let mut worst = 0.0;
            // The faces of a sheet's corner: by the first round each corner's part is a face, which then is a
            // grid.
            let per_corner = 4_usize.pow(rounds - 1);
            let mut first_part = vec![0];
            for face in cage.faces() {
                first_part.push(first_part[first_part.len() - 1] + face.len());
            }
            for index in some(limit.n_sheets()) {
                let (face, corner) = limit.face_of(index);
                let sheet = limit.sheet(index).unwrap();
                // The grid of the part at the face's corner begins there; its first vertex is the corner's.
                let vertex = fine.face((first_part[face] + corner) * per_corner)[0];
                let here = sheet.at(0.0, 0.0).unwrap().point;
                worst = f64::max(worst, distance(here, fine.positions()[vertex as usize]));
                // The last vertex of the grid is the middle of the face.
                let vertex = fine.face((first_part[face] + corner + 1) * per_corner - 1)[2];
                let quad = cage.face(face).len() == 4;
                let there = if quad { sheet.at(0.5, 0.5) } else { sheet.at(1.0, 1.0) };
                worst = f64::max(worst, distance(there.unwrap().point, fine.positions()[vertex as usize]));
            }
            worst /= size(&cage);
            eprintln!("{name}: {rounds} rounds, {worst:.2e}");
            // Four times closer each round, more slowly around vertices of many edges; rounds that keep
            // creases sharp do nothing.
            let ends = cage.creases().iter().any(|crease| crease.1 < 10.0);
            assert!(ends || worst < 1e-13 || worst < 0.3 * before, "{name}: {worst} after {before}");
            assert!(rounds == 3 || worst < 5e-3, "{name}: {worst}");
            before = worst;
        }
    }
}

#[test]
fn a_round_leaves_it_where_it_is() {
    let (mut most, mut n) = (0.0, 0);
    for (name, cage) in with_limit() {
        let once = cage.refined().unwrap();
        let (limit, after) = (cage.limit().unwrap(), once.limit().unwrap());
        let mut part_of = vec![None; once.n_faces()];
        (0..after.n_sheets()).for_each(|sheet| part_of[after.face_of(sheet).0] = Some(sheet));
        let mut first_part = vec![0];
        for face in cage.faces() {
            first_part.push(first_part[first_part.len() - 1] + face.len());
        }
        for index in some(limit.n_sheets()) {
            let (face, corner) = limit.face_of(index);
            let sheet = limit.sheet(index).unwrap();
            let is_quad = cage.face(face).len() == 4;
            for part in if is_quad { 0..4 } else { corner..corner + 1 } {
                let Some(child) = part_of[first_part[face] + part] else { panic!("{name}: no part {part}") };
                let child = after.sheet(child).unwrap();
                for (s, t) in [(0.0, 0.0), (0.3, 0.8), (0.5, 0.125), (0.9, 0.03), (0.0, 0.4), (0.002, 0.001)]
                {
                    // The part of a quad begins at its corner.
                    let (u, v) = match (is_quad, part) {
                        (false, _) => (s, t),
                        (true, 0) => (0.5 * s, 0.5 * t),
                        (true, 1) => (1.0 - 0.5 * t, 0.5 * s),
                        (true, 2) => (1.0 - 0.5 * s, 1.0 - 0.5 * t),
                        _ => (0.5 * t, 1.0 - 0.5 * s),
                    };
                    let (a, b) = (sheet.at(u, v).unwrap(), child.at(s, t).unwrap());
                    let off = distance(a.point, b.point) / size(&cage);
                    assert!(off < 1e-13, "{name}: sheet {index} part {part} at {s}, {t}: {off}");
                    most = f64::max(most, off);
                    n += 1;
                    if let (Jet { normal: Some(p), .. }, Jet { normal: Some(q), .. }) = (a, b) {
                        let off = distance(p, q);
                        // Corners of several quads settle slowly; between two quads that lie on each other
                        // there is no side.
                        let off = if name == "catmark_val2_nonman" { 0.0 } else { off };
                        assert!(
                            off < 1e-3,
                            "{name}: sheet {index} part {part} at {s}, {t}: normal {p:?} {q:?}"
                        );
                    }
                }
            }
        }
    }
    eprintln!("{n} places, off by {most:.2e} at most");
}
