//! Edges of patches: known angles and curvatures, halves of one patch, turned and mirrored neighbours, poles,
//! gaps, the teapot.
use chordal::check::surfaces::{EdgeJoin, PatchSideId, SurfaceEdges, edge_join, surface_edges};
use chordal::explicit::parametric::{AffineMap, PatchSide};
use chordal::{Bezier, Patch};
use chordal_testkit::Random;

const SIDES: [PatchSide; 4] = PatchSide::ALL;

/// The patch between a profile and the same profile moved: ruled straight along `v`.
fn extruded(profile: Bezier<3>, by: [f64; 3]) -> Patch {
    let moved = |p: [f64; 3], part: f64| std::array::from_fn(|k| p[k] + part * by[k]);
    Patch { control: std::array::from_fn(|row| profile.control.map(|p| moved(p, row as f64 / 3.0))) }
}

/// A patch with its rows and columns in another order: `turns` quarters, then mirrored or not.
fn written_otherwise(patch: &Patch, turns: usize, mirrored: bool) -> Patch {
    let turned = patch.turned(SIDES[turns % 4]);
    let transposed =
        Patch { control: std::array::from_fn(|i| std::array::from_fn(|j| turned.control[j][i])) };
    if mirrored { transposed } else { turned }
}

fn random_patch(random: &mut Random) -> Patch {
    let control = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let off: [f64; 3] = random.point_within(0.4);
            [j as f64 + off[0], i as f64 + off[1], off[2]]
        })
    });
    Patch { control }
}

fn mapped(patch: &Patch, map: &AffineMap<3>) -> Patch {
    Patch { control: patch.control.map(|row| row.map(|p| map.point(p))) }
}

/// The only join of two patches.
#[track_caller]
fn only(patches: &[Patch]) -> EdgeJoin {
    let found = surface_edges(patches);
    assert_eq!(found.joins.len(), 1, "{found:?}");
    assert_eq!((found.branching.len(), found.collapsed.len(), found.boundary.len()), (0, 0, 6));
    found.joins[0]
}

fn classes(join: &EdgeJoin) -> [Option<u8>; 2] {
    [join.parametric, join.geometric]
}

/// Both patches in all 8 × 8 orders of their control points, and both orders of the patches.
fn in_every_order(pair: [Patch; 2], mut check: impl FnMut(EdgeJoin)) {
    for way in 0..64 {
        let [a, b] = [(0, way % 8), (1, way / 8)]
            .map(|(which, way)| written_otherwise(&pair[which], way % 4, way >= 4));
        for both in [[a, b], [b, a]] {
            let join = only(&both);
            let mirrored = [way % 8 >= 4, way / 8 >= 4];
            assert_eq!(join.fronts_agree, mirrored[0] == mirrored[1], "{way}");
            // The point is on both sides.
            let [first, second] = join.sides;
            let worst = join.angle_rad.unwrap();
            let [u, v] = first.side.uv(worst.t);
            let on_first = both[first.patch].at(u, v);
            let t = if join.fronts_agree { 1.0 - worst.t } else { worst.t };
            let [u, v] = second.side.uv(t);
            let on_second = both[second.patch].at(u, v);
            for k in 0..3 {
                assert!((on_first[k] - worst.at[k]).abs() + (on_second[k] - worst.at[k]).abs() < 1e-13);
            }
            check(join);
        }
    }
}

#[test]
fn flat_patches_meet_at_the_angle_between_them() {
    for angle_deg in [0.0, 1e-6, 30.0, 90.0, 150.0, 179.0, 180.0_f64] {
        let angle = angle_deg.to_radians();
        let floor = Patch::flat([0.0; 3], [2.0, 0.0, 0.0], [0.5, 1.0, 0.0]);
        // Of another width, and leaning along the edge.
        let (c, s) = (angle.cos(), angle.sin());
        let ramp = Patch::flat([2.0, 0.0, 0.0], [3.0 * c + 0.25, 0.5, 3.0 * s], [0.5, 1.0, 0.0]);
        // The part of `ramp` that is perpendicular to the edge makes the angle.
        let along = [0.5 / 1.25_f64.sqrt(), 1.0 / 1.25_f64.sqrt(), 0.0];
        let across = [1.0 / 1.25_f64.sqrt(), -0.5 / 1.25_f64.sqrt(), 0.0];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let out = [3.0 * c + 0.25, 0.5, 3.0 * s];
        let truth = libm::atan2(out[2], dot(out, across)).abs();
        assert!(dot(out, along).abs() > 0.1);
        in_every_order([floor, ramp], |join| {
            let found = join.angle_rad.unwrap().value;
            assert!((found - truth).abs() < 1e-14, "{angle_deg}: {found} for {truth}");
            let class = if angle_deg == 0.0 { 2 } else { 0 };
            assert_eq!(classes(&join), [Some(0), Some(class)], "{angle_deg}");
            assert_eq!((join.position_gap.value, join.curvature_gap.map(|gap| gap.value)), (0.0, Some(0.0)));
        });
    }
}

#[test]
fn a_cylinder_runs_smoothly_into_a_plane_and_the_curvature_jumps_by_its_own() {
    // A cubic that starts along x with curvature 1: two thirds of the height of its third control point over the
    // square of its first step.
    let h = 0.5;
    let bent = Bezier { control: [[0.0; 3], [h, 0.0, 0.0], [0.9, 0.0, 1.5 * h * h], [1.0, 0.0, 1.0]] };
    let straight = Bezier { control: [[-3.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0; 3]] };
    for (scale, offset) in [(1.0, 0.0), (1e-6, 0.0), (1e150, 0.0), (1e-150, 0.0), (1.0, 1e3)] {
        let pair = [bent, straight].map(|profile| {
            let patch = extruded(profile, [0.0, 2.0, 0.0]);
            Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| x * scale + offset))) }
        });
        in_every_order(pair, |join| {
            assert_eq!(classes(&join), [Some(0), Some(1)], "{scale} {join:?}");
            let gap = join.curvature_gap.unwrap().value * scale;
            assert!((gap - 1.0).abs() < if offset == 0.0 { 1e-13 } else { 1e-11 }, "{scale}: {gap}");
            assert_eq!(join.angle_rad.unwrap().value, 0.0);
        });
    }
    // The usual quarter of a circle has curvature 0.97853 at its ends (see `curvature_comb`), on the other side of the
    // tangent twice that.
    let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
    let end = 2.0 / 3.0 * (1.0 - k) / (k * k);
    let quarter = Bezier { control: [[0.0; 3], [k, 0.0, 0.0], [1.0, 0.0, 1.0 - k], [1.0, 0.0, 1.0]] };
    let wave = Bezier { control: quarter.control.map(|p| p.map(|x| -x)) }.reversed();
    let by = [0.0, 1.0, 0.0];
    in_every_order([extruded(quarter, by), extruded(wave, by)], |join| {
        assert_eq!(classes(&join), [Some(1), Some(1)]);
        assert!((join.curvature_gap.unwrap().value - 2.0 * end).abs() < 1e-13, "{join:?}");
    });
}

#[test]
fn halves_of_a_patch_are_c2_and_parts_of_unequal_width_g2() {
    let mut random = Random::new(11);
    for case in 0..40 {
        let patch = random_patch(&mut random);
        let far = random.power(-3.0, 3.0);
        let columns = std::array::from_fn(|_| random.point_within::<3>(2.0));
        let map = AffineMap { columns, offset: random.point_within(far) };
        let patch = mapped(&patch, &map);
        for pair in [patch.halves_u(), patch.halves_v()] {
            in_every_order(pair, |join| assert_eq!(classes(&join), [Some(2); 2], "{case} {join:?}"));
        }
        // The control points of a part are rounded each by itself, so that the shared ones are copied.
        let mut pair = [patch.part([0.0, 0.375], [0.0, 1.0]), patch.part([0.375, 1.0], [0.0, 1.0])];
        for i in 0..4 {
            pair[1].control[i][0] = pair[0].control[i][3];
        }
        in_every_order(pair, |join| assert_eq!(classes(&join), [Some(0), Some(2)], "{case} {join:?}"));
    }
}

#[test]
fn a_moved_row_is_told_by_the_derivative_that_it_changes() {
    let mut random = Random::new(12);
    for case in 0..40 {
        let halves = random_patch(&mut random).halves_u();
        // Columns 1 and 2 from the edge hold the first and the second derivative.
        for (column, expected) in [(1, [Some(0), Some(0)]), (2, [Some(1), Some(1)])] {
            let mut pair = halves;
            for row in &mut pair[1].control {
                row[column][2] += 1e-6;
            }
            in_every_order(pair, |join| assert_eq!(classes(&join), expected, "{case} {join:?}"));
        }
        // Less than rounding is not told.
        let mut pair = halves;
        pair[1].control[2][1][2] += 1e-16;
        assert_eq!(classes(&only(&pair)), [Some(2); 2]);
    }
}

#[test]
fn the_worst_place_is_found_within_the_edge() {
    // A hinge whose angle grows from 0 at both ends and is largest at one place within: the second patch is flat
    // but for one control point beside the edge.
    let floor = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for (row, truth) in [(1, 1.0 / 3.0), (2, 2.0 / 3.0)] {
        let mut bump = Patch::flat([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        bump.control[row][1][2] = 0.1;
        let join = only(&[floor, bump]);
        let worst = join.angle_rad.unwrap();
        // The slope is 3·0.1 times a cubic Bernstein polynomial, which is at most 4/9, at a third of the edge.
        assert!((worst.value - libm::atan(0.3 * 4.0 / 9.0)).abs() < 1e-14, "{worst:?}");
        assert!((worst.t - truth).abs() < 1e-6 && (worst.at[1] - truth).abs() < 1e-6, "{worst:?}");
        assert_eq!(join.geometric, Some(0));
    }
}

/// The angle between the normals at the side, and the difference of the normal curvatures across it, both from the
/// derivatives by u and v.
fn truth(patches: [&Patch; 2], uv: [[f64; 2]; 2], along: [f64; 3]) -> [f64; 2] {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let sides = [0, 1].map(|which| {
        let (patch, [u, v]) = (patches[which], uv[which]);
        let normal = patch.normal(u, v).unwrap();
        let across = cross(normal, along);
        let across = across.map(|x| x / dot(across, across).sqrt());
        // `across` as a sum of the tangents, by Cramer's rule.
        let [by_u, by_v] = patch.tangents(u, v);
        let [e, f, g] = [dot(by_u, by_u), dot(by_u, by_v), dot(by_v, by_v)];
        let (p, q) = (dot(across, by_u), dot(across, by_v));
        let (a, b) = ((p * g - q * f) / (e * g - f * f), (q * e - p * f) / (e * g - f * f));
        let [l, m, n] = patch.second_derivatives(u, v).map(|second| dot(second, normal));
        (normal, a * a * l + 2.0 * a * b * m + b * b * n)
    });
    let angle = libm::acos(dot(sides[0].0, sides[1].0).clamp(-1.0, 1.0));
    [angle, (sides[0].1 - sides[1].1).abs()]
}

#[test]
fn no_place_of_an_edge_is_worse_than_the_one_that_is_named() {
    let mut random = Random::new(14);
    for case in 0..200 {
        let first = random_patch(&mut random);
        let mut second = random_patch(&mut random);
        for i in 0..4 {
            second.control[i] = second.control[i].map(|[x, y, z]| [x + 3.0, y, z]);
            second.control[i][0] = first.control[i][3];
        }
        let join = only(&[first, second]);
        let at =
            |t: f64| truth([&first, &second], [[1.0, t], [0.0, t]], first.side(PatchSide::Right).tangent(t));
        let n = 4000;
        for (which, found) in [(0, join.angle_rad.unwrap()), (1, join.curvature_gap.unwrap())] {
            let named = at(found.t)[which];
            assert!((named - found.value).abs() <= 1e-6 * (1.0 + named), "{case}: {found:?} is {named}");
            let worst = (0..=n).map(|i| at(f64::from(i) / f64::from(n))[which]).fold(0.0, f64::max);
            assert!(worst <= found.value * (1.0 + 1e-6), "{case}: {worst} beside {found:?}");
        }
    }
}

/// Eight patches of revolution about z: four from the north pole down to the equator, four below. Quarters of
/// circles by the usual cubics.
fn globe() -> Vec<Patch> {
    let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
    let quarter = [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]];
    let turn = |[x, y]: [f64; 2], n: usize| (0..n).fold([x, y], |[x, y], _| [-y, x]);
    let mut patches = Vec::new();
    for n in 0..4 {
        for south in [false, true] {
            // From the equator to the pole.
            let control = std::array::from_fn(|i| {
                let [r, z] = quarter[i];
                std::array::from_fn(|j| {
                    let [x, y] = turn(quarter[j], n);
                    [r * x, r * y, if south { -z } else { z }]
                })
            });
            patches.push(Patch { control });
        }
    }
    patches
}

fn counts(found: &SurfaceEdges) -> [usize; 4] {
    [found.joins.len(), found.boundary.len(), found.branching.len(), found.collapsed.len()]
}

#[test]
fn poles_are_neither_edges_nor_kinks() {
    let patches = globe();
    let found = surface_edges(&patches);
    // Four edges on the equator, four meridians north and south; four sides in each pole.
    assert_eq!(counts(&found), [12, 0, 0, 8]);
    assert_eq!(found.joins.iter().filter(|join| !join.fronts_agree).count(), 4, "the south is inside out");
    for join in &found.joins {
        assert_eq!(classes(join)[0], Some(1), "{join:?}");
        assert_eq!(join.angle_rad.unwrap().value, 0.0, "{join:?}");
        assert!(join.geometric >= Some(1));
        // Mirror images of each other: the same curvature on both sides.
        assert_eq!(classes(join)[1], Some(2), "{join:?}");
    }
    // The ring of control points beside a pole, lifted with its ends.
    let mut other = patches;
    for j in 0..4 {
        other[0].control[2][j][2] += 0.1;
    }
    let found = surface_edges(&other);
    assert_eq!(counts(&found), [10, 4, 0, 8], "its meridians are not shared any more");
    // Lifted within only: the meridians stay and kink, most at the pole.
    let mut other = globe();
    for j in 1..3 {
        other[0].control[2][j][2] += 0.1;
    }
    let found = surface_edges(&other);
    assert_eq!(counts(&found), [12, 0, 0, 8]);
    let kinks: Vec<&EdgeJoin> = found.joins.iter().filter(|join| join.geometric == Some(0)).collect();
    assert_eq!(kinks.len(), 2);
    for kink in kinks {
        assert_eq!(kink.sides.iter().filter(|id| id.patch == 0).count(), 1);
        let worst = kink.angle_rad.unwrap();
        // At the pole the derivative across the meridian is proportional to the second control point of row 2:
        // (k, k·k) turned, and 0.1 up.
        let k: f64 = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
        assert!((worst.value - libm::atan(0.1 / (k * k))).abs() < 1e-5, "{worst:?}");
        assert!(worst.at[2] > 0.999_99);
    }
}

#[test]
fn an_edge_that_every_point_shares_with_a_doubled_row_has_the_direction_of_the_next() {
    let floor = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let mut ramp = Patch::flat([1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    for row in &mut ramp.control {
        row[1] = row[0];
    }
    let join = only(&[floor, ramp]);
    assert!((join.angle_rad.unwrap().value - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    assert_eq!((classes(&join), join.curvature_gap), ([Some(0), Some(0)], None));
    // A patch without any extent across the edge has no direction at all.
    for row in &mut ramp.control {
        *row = [row[0]; 4];
    }
    let sides =
        [(0, PatchSide::Right), (1, PatchSide::Left)].map(|(patch, side)| PatchSideId { patch, side });
    let join = edge_join(&[floor, ramp], sides);
    assert_eq!((join.angle_rad, classes(&join)), (None, [Some(0), Some(0)]));
}

#[test]
fn sides_that_nearly_meet_are_gaps_and_others_are_boundary() {
    let floor = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let next = |gap: f64| Patch::flat([1.0 + gap, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let join = only(&[floor, next(1.0 / 2048.0)]);
    assert!((join.position_gap.value - 1.0 / 2048.0).abs() < 1e-15);
    assert_eq!(classes(&join), [None; 2]);
    assert_eq!(join.angle_rad.unwrap().value, 0.0);
    assert_eq!(counts(&surface_edges(&[floor, next(1.0 / 512.0)])), [0, 8, 0, 0]);
    // One control point off: the gap is what it moves the curve by, in the middle.
    let mut bulged = next(0.0);
    bulged.control[1][0][0] += 1e-4;
    bulged.control[2][0][0] += 1e-4;
    let gap = only(&[floor, bulged]).position_gap;
    assert!((gap.value - 0.75e-4).abs() < 1e-15 && (gap.t - 0.5).abs() < 1e-6, "{gap:?}");
    // A long thin patch does not meet itself, nor a side two that are half as long.
    let ribbon = Patch::flat([0.0; 3], [1e4, 0.0, 0.0], [0.0, 1.0, 0.0]);
    assert_eq!(counts(&surface_edges(&[ribbon])), [0, 4, 0, 0]);
    let [low, high] = next(0.0).halves_v();
    assert_eq!(counts(&surface_edges(&[floor, low, high])), [1, 10, 0, 0]);
    // Three leaves of a book, and a patch given twice.
    let leaf = |x: f64, z: f64| Patch::flat([1.0, 0.0, 0.0], [x, 0.0, z], [0.0, 1.0, 0.0]);
    assert_eq!(counts(&surface_edges(&[floor, leaf(1.0, 0.0), leaf(1.0, 1.0)])), [0, 9, 1, 0]);
    let twice = surface_edges(&[floor, floor]);
    assert_eq!(counts(&twice), [4, 0, 0, 0]);
    assert!(twice.joins.iter().all(|join| join.angle_rad.unwrap().value == std::f64::consts::PI));
    assert_eq!(counts(&surface_edges(&[])), [0; 4]);
}

#[test]
fn many_sides_that_nearly_coincide_take_no_longer_than_others() {
    // Squares in a heap, each moved by a part of the reach: nearly all are near each other.
    let mut random = Random::new(13);
    let heap: Vec<Patch> =
        (0..2000).map(|_| Patch::flat(random.point_within(1e-5), [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])).collect();
    let found = surface_edges(&heap);
    assert_eq!(2 * found.joins.len() + found.boundary.len(), 8000);
    assert!(found.joins.iter().all(|join| join.geometric.is_none() && join.position_gap.value < 1e-4));
}

#[test]
fn a_closed_tube_meets_itself() {
    // One patch whose left side is its right side: a teardrop, whose ends meet at a right angle.
    let drop = Bezier { control: [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 0.0, 3.0], [0.0; 3]] };
    let found = surface_edges(&[extruded(drop, [0.0, 1.0, 0.0])]);
    assert_eq!(counts(&found), [1, 2, 0, 0]);
    let join = found.joins[0];
    assert_eq!((join.sides[0].side, join.sides[1].side), (PatchSide::Right, PatchSide::Left));
    assert_eq!(join.angle_rad.unwrap().value, std::f64::consts::FRAC_PI_2);
}
