//! Bicubic Bézier patches to triangles: adaptive, crack-free by shared index, proved.
use super::patches::mesher::{Failed, Mesher, Proved};
use super::patches::plan::Allowance;
use crate::budget::{Bounded, Budget, Code, Failure, Job, Tolerance};
use crate::explicit::{Mesh, Patch};
use crate::math::flushes_subnormals;

/// Meshes bicubic Bézier patches so that nothing is farther from them than the budget allows.
///
/// **Bound.** Two-sided Hausdorff distance between the union of the patches, taken exactly as given, and the
/// triangles, *proved*, rounding included (the mathematics stands in `patches/bend.rs` and in
/// `docs/patches_to_mesh.md`). `at_least` is a distance that was found. With a budget of pixels the bound also
/// says how many pixels that is at the view; only distances count, neither normals nor contours inside the shape.
///
/// **Mesh.** Sides with equal control points (forwards or backwards) are one curve and share their vertices by
/// index, so there are no cracks and no T-junctions at any budget; a side that is one point becomes one vertex and
/// makes no degenerate triangle. Every vertex lies on the surface (up to rounding) with the surface's own unit
/// normal; where patches meet at an angle of 1° or more, vertices are split and tied by [`Mesh::position_id`].
///
/// **Budgets.** A length, pixels at a view, a number of triangles, or several. With a number of triangles alone the
/// mesh is the best on a ladder of lengths with 32 steps an octave; more triangles never give a larger bound.
///
/// **Cost.** O(triangles) time and about 100 bytes a triangle, on all threads of the job; the same bytes on any
/// number of threads.
///
/// # Errors
/// [`Failure::Refused`]: no limit in the budget or an angle ([`Code::Budget`], [`Code::Unsupported`]), no patches,
/// control points that are not finite or beyond 1e150, more triangles or bytes than the job allows (said before the
/// work), a budget below rounding ([`Code::BelowPrecision`]), an eye too close ([`Code::TooClose`]), an environment that flushes subnormals.
/// [`Failure::Unmet`] with the best mesh: the length or pixels need more triangles than the budget has.
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Patch, Tolerance, convert};
/// let mut patch = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// patch.control[1][1][2] = 1.0;
/// let coarse = convert::patches_to_mesh(&[patch], &Budget::length(Tolerance::new(1e-2)?), &Job::default()).unwrap();
/// let fine = convert::patches_to_mesh(&[patch], &Budget::length(Tolerance::new(1e-4)?), &Job::default()).unwrap();
/// assert!(fine.bound.at_most().unwrap() <= 1e-4);
/// // A hundredth of the error costs up to a hundred times the triangles.
/// assert!(fine.shape.faces().len() > 30 * coarse.shape.faces().len());
/// # Ok::<(), chordal::budget::InvalidTolerance>(())
/// ```
///
/// Source: D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*, 1986, extended.
pub fn patches_to_mesh(patches: &[Patch], budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failed> {
    check_input(patches, budget)?;
    let patches: Vec<Patch> = patches.iter().map(positive_zeros).collect();
    job.run(|| {
        let mesher = Mesher::new(&patches, job);
        let allowance = Allowance {
            length: budget.length.map(Tolerance::get),
            pixels: budget.pixels.map(|p| (p.pixels, p.view.lens())),
        };
        if allowance.length.is_none() && allowance.pixels.is_none() {
            return by_count(&mesher, &allowance, budget.triangles.unwrap_or(u64::MAX), job);
        }
        check_size(&mesher, &allowance, job)?;
        let planned = mesher.plan(&allowance)?;
        let most = budget.triangles.unwrap_or(u64::MAX);
        if planned.count(&mesher) <= most {
            let proved = mesher.prove(planned)?;
            if proved.count() <= most {
                return Ok(mesher.finish(&proved, &allowance));
            }
        }
        let best = by_count(&mesher, &allowance, most, job).or_else(|failure| match failure {
            Failure::Unmet(best) => Ok(*best),
            other => Err(other),
        })?;
        // A coarser mesh than the plan for the budget may still come out within it.
        if best.shape.faces().len() as u64 <= most && meets(&best, budget) {
            return Ok(best);
        }
        Err(Failure::Unmet(Box::new(best)))
    })
}

fn meets(mesh: &Bounded<Mesh>, budget: &Budget) -> bool {
    let Some(most) = mesh.bound.at_most() else { return false };
    let by_length = budget.length.is_none_or(|length| most <= length.get());
    let by_pixels = |asked: f64| mesh.bound.pixels.is_some_and(|pixels| pixels <= asked);
    by_length && budget.pixels.is_none_or(|asked| by_pixels(asked.pixels.get()))
}

fn check_input(patches: &[Patch], budget: &Budget) -> Result<(), Failed> {
    if !budget.has_limit() {
        return Err(Failure::refused(
            Code::Budget,
            "a budget needs a length, pixels at a view, or a number of triangles",
        ));
    }
    if budget.angle_deg.is_some() {
        return Err(Failure::refused(
            Code::Unsupported,
            "patches cannot be meshed to an angle yet; give a length or pixels",
        ));
    }
    if patches.is_empty() {
        return Err(Failure::refused(Code::Empty, "there are no patches"));
    }
    if let Some(index) = patches.iter().position(|patch| !patch.is_finite()) {
        return Err(Failure::refused(
            Code::NotFinite,
            format!("patch {index} has a control point that is not finite"),
        ));
    }
    if let Some(index) = patches.iter().position(|patch| patch.size() > LARGEST) {
        let message = format!(
            "patch {index} has a coordinate beyond {LARGEST:e}, where squares leave the range of numbers"
        );
        return Err(Failure::refused(Code::NotFinite, message));
    }
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(Failure::refused(Code::FlushesSubnormals, message));
    }
    Ok(())
}

/// Derivatives multiply coordinates by less than 1e3, and squares of those must stay below 1e308.
const LARGEST: f64 = 1e150;

/// −0 and 0 are the same place; equal bits make equal curves.
fn positive_zeros(patch: &Patch) -> Patch {
    Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| x + 0.0))) }
}

/// Bytes a triangle, everything counted, at the peak; measured on the teapot at 1e6 triangles.
const BYTES_PER_TRIANGLE: f64 = 200.0;

/// Says before the work that a budget needs more than the job allows.
fn check_size(mesher: &Mesher<'_>, allowance: &Allowance, job: &Job) -> Result<(), Failed> {
    let (triangles, memory) = (job.triangle_limit as f64, job.memory_limit as f64);
    let limit = if triangles < memory / BYTES_PER_TRIANGLE { triangles } else { memory / BYTES_PER_TRIANGLE };
    let needed = mesher.estimate(allowance, limit)?;
    if needed > triangles {
        let message = format!("the budget needs about {needed:.1e} triangles; the limit is {triangles:.1e}");
        return Err(Failure::refused(Code::TooManyTriangles, message));
    }
    if needed > limit {
        let bytes = needed * BYTES_PER_TRIANGLE;
        let message =
            format!("the budget needs about {bytes:.1e} bytes of memory; the limit is {memory:.1e}");
        return Err(Failure::refused(Code::TooMuchMemory, message));
    }
    Ok(())
}

/// Rungs an octave of the ladder of lengths: neighbours differ by 2.2 %. With 16 the referee found small meshes
/// whose bound was more than 1.15 times what a length reaches with as many triangles.
const RUNGS: u32 = 32;
/// A ladder of 100 octaves reaches below the rounding of any shape.
const MOST_RUNGS: u32 = 100 * RUNGS;
/// How far a count may rise above a finer rung's, seen on coarse meshes; rungs are tried from here down.
const COUNT_NOISE: u64 = 2;
/// Meshes below this size have bounds well below their rung, so all coarser rungs are compared.
const SMALL: u64 = 2000;

/// The mesh with the smallest bound among those of the ladder with at most `most` triangles.
fn by_count(mesher: &Mesher<'_>, asked: &Allowance, most: u64, job: &Job) -> Result<Bounded<Mesh>, Failed> {
    let most = most.min(job.triangle_limit).min((job.memory_limit as f64 / BYTES_PER_TRIANGLE) as u64);
    let size = mesher.longest_diagonal();
    // The length of a rung: exact powers of two, times one of as many fixed factors as an octave has rungs.
    let rung = |k: u32| {
        let step = libm::exp2(-f64::from(k % RUNGS) / f64::from(RUNGS));
        Allowance { length: Some(4.0 * size * step * libm::exp2(-f64::from(k / RUNGS))), pixels: None }
    };
    let count = |k: u32| -> Result<u64, Failed> {
        match mesher.plan(&rung(k)) {
            Ok(planned) => Ok(planned.count(mesher)),
            Err(Failure::Refused(refusal)) if refusal.code == Code::BelowPrecision => Ok(u64::MAX),
            Err(other) => Err(other),
        }
    };
    // Finer by octaves until even a noisy count cannot fit, then down rung by rung.
    let mut fine = 0;
    while fine < MOST_RUNGS && count(fine)? <= COUNT_NOISE.saturating_mul(most) {
        fine += RUNGS / 4;
    }
    let mut k = fine;
    while k > 0 && count(k)? > most {
        k -= 1;
    }
    let mut best: Option<Proved> = None;
    for k in (0..=k).rev() {
        let proved = mesher.prove(mesher.plan(&rung(k))?)?;
        let count = proved.count();
        if count <= most && best.as_ref().is_none_or(|best| proved.bound() < best.bound()) {
            best = Some(proved);
        } else if count > most && k == 0 && best.is_none() {
            let best = mesher.finish(&proved, asked);
            return Err(Failure::Unmet(Box::new(best)));
        }
        let settled =
            best.as_ref().is_some_and(|best| rung(k).length.is_some_and(|rung| 0.8 * rung > best.bound()));
        if settled && count > SMALL {
            break;
        }
    }
    match best {
        Some(best) => Ok(mesher.finish(&best, asked)),
        None => Err(Failure::refused(Code::Budget, "no mesh of these patches has so few triangles")),
    }
}
