//! Checks the facts of a certificate about a baked grid: its samples, their signs, its lattice, the solid.
use super::claims::ClaimList;
use super::counts::compare_with;
use crate::bake::{interpolant_error, off_at_most};
use crate::provenance::seal::seal_of;
use crate::report::{SolidFacts, to_value};
use crate::scene::{flatten, merged_parts};
use crate::{Input, MeshFailure, Shape};
use chordal::convert::SolidReport;
use chordal::explicit::query::{Bvh, Containment, Enclosure};
use chordal::implicit::{Affine3, Grid};
use chordal::math::{add_up, greater, sub_down};
use chordal::{Job, Mesh};
use chordal_io::Scene;
use serde_json::Value;

/// Compares the facts of a certificate about a baked grid with its samples and with the triangles.
pub(super) fn check_baked(
    baked: &Value,
    (read, written): (&Input, &Input),
    rounding: [f64; 2],
    claims: &mut ClaimList,
    job: &Job,
) -> Result<(), MeshFailure> {
    let Shape::Volume(sampled) = &written.shape else {
        claims.refute(
            "baked",
            "the certificate is for a baked grid, and the file or its input is something else",
        );
        return Ok(());
    };
    // An array has no origin and no step: the claimed ones are proved by the distances, which fit no others.
    let located = if written.format.is_array() { stated_lattice(baked) } else { None };
    let located = located.map(|affine| sampled.volume.grid.clone().with_affine(affine));
    let grid = located.as_ref().unwrap_or(&sampled.volume.grid);
    if let Shape::Scene(scene) = &read.shape {
        check_distances(baked, (scene, grid), rounding, claims, job)?;
    } else {
        let reason = format!("there is no judge of distances to a {}", read.shape.kind());
        claims.open("baked/off_at_most", reason);
    }
    let band = band_of(baked);
    let [nx, ny, nz] = grid.size();
    let places = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
    let distances = places.filter(|at| grid.sample(*at).abs() < band).count();
    let facts = [
        ("size", serde_json::to_value(grid.size()).unwrap_or_default()),
        ("origin", serde_json::to_value(grid.affine().at([0.0; 3])).unwrap_or_default()),
        ("spacing", grid.affine().rows()[0][0].into()),
        ("distances", distances.into()),
    ];
    for (key, actual) in facts {
        let claim = format!("baked/{key}");
        claims.decide(
            &claim,
            baked.get(key).is_some_and(|stated| seal_of(stated) == seal_of(&actual)),
            "the lattice of the file or its samples are different",
        );
    }
    Ok(())
}

/// The origin and the step of a baked lattice in a certificate.
fn stated_lattice(baked: &Value) -> Option<Affine3> {
    let origin: [f64; 3] = serde_json::from_value(baked.get("origin")?.clone()).ok()?;
    let spacing = baked.get("spacing")?.as_f64()?;
    let row = |k: usize| {
        std::array::from_fn(|j| if j == 3 { origin[k] } else { f64::from(u8::from(j == k)) * spacing })
    };
    Affine3::new([0, 1, 2].map(row)).ok()
}

fn band_of(baked: &Value) -> f64 {
    baked.get("band").and_then(Value::as_f64).unwrap_or(f64::INFINITY)
}

/// Checks the claims about distances to triangles: those of samples, and of the interpolant between them, which follow.
fn check_distances(
    baked: &Value,
    (scene, grid): (&Scene, &Grid),
    [rounding, again]: [f64; 2],
    claims: &mut ClaimList,
    job: &Job,
) -> Result<(), MeshFailure> {
    let flattened = flatten::flatten(scene.clone())?;
    let mesh = merged_parts::one_mesh(&flattened.scene)?;
    let claimed = baked.get("off_at_most").and_then(Value::as_f64);
    let sample_error = off_at_most(&mesh, (grid, band_of(baked)), job)?;
    let moved = flattened.moved_at_most;
    let moved = if again == 0.0 { moved } else { add_up(moved, again) };
    let error = if moved == 0.0 { sample_error } else { add_up(sample_error, moved) };
    // The baked triangles were put together and rounded, too, so that they may differ from these by `rounding`.
    let least = if rounding == 0.0 { error } else { greater(sub_down(error, rounding), 0.0) };
    claims.decide(
        "baked/off_at_most",
        claimed.is_some_and(|claimed| least <= claimed),
        "a sample is farther from the distance to the triangles than is claimed",
    );
    let bvh = Bvh::build(&mesh, job)?;
    let enclosure = Enclosure::new(&mesh, &bvh);
    let has_sides = check_sides(&enclosure, (grid, add_up(error, rounding)), claims);
    if let Some(claimed) = baked.pointer("/interpolant/at_most").and_then(Value::as_f64) {
        let of = baked.pointer("/interpolant/of").and_then(Value::as_str);
        let is_true = of == Some("distance") || of == Some("signed distance") && has_sides;
        claims.decide(
            "baked/interpolant",
            enclosure.is_closed() && is_true && interpolant_error(grid, least) <= claimed,
            "the interpolant may be farther from the distance to the triangles than is claimed",
        );
    }
    for at in ["/evidence", "/interpolant/evidence", "/route"] {
        let expected = if at == "/route" { "triangles" } else { "proved" };
        if let Some(stated) = baked.pointer(at).filter(|stated| !stated.is_null()) {
            let reason = "samples of triangles are distances to these, and proved";
            claims.decide(&format!("baked{at}"), stated == expected, reason);
        }
    }
    check_solid(baked, (&mesh, enclosure.is_closed()), claims, job)
}

/// Checks that every sample is on the side of its sign: below 0 if the triangles enclose it. Returns whether that is so.
///
/// If a mesh is closed and a sample is farther from the triangles than the next one along its row, both are on the same
/// side, since no triangle is between them. So only samples near the triangles need a winding number.
fn check_sides(enclosure: &Enclosure<'_>, (grid, error): (&Grid, f64), claims: &mut ClaimList) -> bool {
    let [nx, ny, nz] = grid.size();
    let rows = grid.affine().rows();
    // No shorter than a step along the row: the sum of its coordinates.
    let step = (0..3).fold(0.0, |sum, k| add_up(sum, rows[k][0].abs()));
    let (mut wrong, mut unknown) = (0_u64, 0_u64);
    for (j, k) in (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))) {
        let mut before: Option<(Option<bool>, f64)> = None;
        for i in 0..nx {
            let value = grid.sample([i, j, k]);
            let size = value.abs();
            if size <= error {
                // A sample so near to a triangle may be on either side.
                before = None;
                continue;
            }
            let is_clear = |size: f64| enclosure.is_closed() && sub_down(size, error) > step;
            let same = before.filter(|(_, size)| is_clear(*size)).map(|(side, _)| side);
            let at = || grid.affine().at([i as f64, j as f64, k as f64]);
            let is_inside = same.unwrap_or_else(|| side_of(enclosure.inside(at())));
            match is_inside {
                Some(is_inside) => wrong += u64::from(is_inside != (value < 0.0)),
                None => unknown += 1,
            }
            before = Some((is_inside, size));
        }
    }
    if wrong > 0 {
        let reason = format!("{wrong} samples are on the other side of the triangles than by their signs");
        claims.refute("baked/sides", reason);
    } else if unknown > 0 {
        claims.open("baked/sides", format!("the sides of {unknown} samples could not be determined"));
    } else {
        claims.prove("baked/sides");
    }
    wrong == 0 && unknown == 0
}

/// Whether a point is inside by the definition of `bake`: the winding number around it is above a half.
fn side_of(Containment { winding, .. }: Containment) -> Option<bool> {
    let (low, high) = (winding.value - winding.off_at_most, winding.value + winding.off_at_most);
    // NaN is on neither side.
    if low > 0.5 {
        Some(true)
    } else if high < 0.5 {
        Some(false)
    } else {
        None
    }
}

/// Checks the facts about the triangles that were sampled: whether they are closed and a solid.
fn check_solid(
    baked: &Value,
    (mesh, is_closed): (&Mesh, bool),
    claims: &mut ClaimList,
    job: &Job,
) -> Result<(), MeshFailure> {
    if baked.get("solid").is_some_and(|stated| !stated.is_null()) {
        let solid = SolidFacts::new(&SolidReport::from_mesh(mesh, is_closed, job)?);
        compare_with(baked, ("solid", &to_value(&solid)), ("baked/solid", claims));
    }
    Ok(())
}
