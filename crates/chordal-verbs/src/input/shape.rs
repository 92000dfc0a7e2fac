//! `Shape`: anything that a verb can be applied to, with its frame.
use super::implicit::ImplicitShape;
use crate::{SurfaceSpec, VolumeShape};
use chordal::budget::{Budget, Failure, Tolerance};
use chordal::convert::cage_to_mesh;
use chordal::explicit::nurbs::TrimmedSurface;
use chordal::explicit::{Curve, CurveSegment};
use chordal::math::{Box3, add_up, greater, mul_down, mul_up, sqrt_down, sub_down};
use chordal::{Job, Patch};
use chordal_io::{Content, Curves, Drawing, Frame, Polygons, Scene, WriteError};

/// Any shape that a file can hold.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Shape {
    /// Bicubic Bézier patches.
    Patches {
        /// The patches.
        patches: Vec<Patch>,
        /// The frame of their coordinates.
        frame: Frame,
    },
    /// NURBS surfaces.
    Surfaces {
        /// The surfaces.
        surfaces: Vec<TrimmedSurface>,
        /// The frame of their coordinates.
        frame: Frame,
    },
    /// Triangle meshes with their transforms.
    Scene(Scene),
    /// A polygon cage, representing its limit surface.
    Cage(Polygons),
    /// Plane curves.
    Drawing(Drawing),
    /// Space curves.
    Curves(Curves),
    /// An implicit shape.
    Field(ImplicitShape),
    /// Samples on a lattice.
    Volume(VolumeShape),
}

impl From<Content> for Shape {
    fn from(content: Content) -> Self {
        match content {
            Content::Patches(patches, frame) => Self::Patches { patches, frame },
            Content::Surfaces(surfaces, frame) => Self::Surfaces { surfaces, frame },
            Content::Scene(scene) => Self::Scene(scene),
            Content::Polygons(polygons) => Self::Cage(polygons),
            Content::Drawing(drawing) => Self::Drawing(drawing),
            Content::Curves(curves) => Self::Curves(curves),
            Content::Field { field, region, frame } => Self::Field(ImplicitShape::new(field, region, frame)),
            Content::Volume(volume) => Self::Volume(VolumeShape { volume, surface: SurfaceSpec::default() }),
        }
    }
}

impl Shape {
    /// The name of the kind in a report.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Patches { .. } => "patches",
            Self::Surfaces { .. } => "surfaces",
            Self::Scene(_) => "triangles",
            Self::Cage(_) => "cage",
            Self::Drawing(_) => "drawing",
            Self::Curves(_) => "curves",
            Self::Field(_) => "field",
            Self::Volume(_) => "volume",
        }
    }

    /// The kind in the plural, for sentences.
    #[must_use]
    pub fn kinds(&self) -> &'static str {
        match self {
            Self::Cage(_) => "cages",
            Self::Drawing(_) => "drawings",
            Self::Field(_) => "fields",
            Self::Volume(_) => "volumes",
            _ => self.kind(),
        }
    }

    /// The number of triangles; `None` for other shapes. A part that is shown several times counts once.
    #[must_use]
    pub fn n_triangles(&self) -> Option<u64> {
        let Self::Scene(scene) = self else { return None };
        Some(scene.parts.iter().map(|part| part.mesh.faces().len() as u64).sum())
    }

    /// The frame of the shape.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        match self {
            Self::Patches { frame, .. } | Self::Surfaces { frame, .. } => frame,
            Self::Scene(scene) => &scene.frame,
            Self::Cage(polygons) => &polygons.frame,
            Self::Drawing(drawing) => &drawing.frame,
            Self::Curves(curves) => &curves.frame,
            Self::Field(field) => &field.frame,
            Self::Volume(sampled) => &sampled.volume.frame,
        }
    }

    /// The frame, to add facts that a file does not state.
    pub fn frame_mut(&mut self) -> &mut Frame {
        match self {
            Self::Patches { frame, .. } | Self::Surfaces { frame, .. } => frame,
            Self::Scene(scene) => &mut scene.frame,
            Self::Cage(polygons) => &mut polygons.frame,
            Self::Drawing(drawing) => &mut drawing.frame,
            Self::Curves(curves) => &mut curves.frame,
            Self::Field(field) => &mut field.frame,
            Self::Volume(sampled) => &mut sampled.volume.frame,
        }
    }

    /// A bounding box of the shape in world coordinates: the hull of control points, or the box of the
    /// vertices. A drawing lies in the plane z = 0.
    ///
    /// # Errors
    /// If the nodes of a scene are not a tree, or take its coordinates out of range.
    pub fn bounds(&self) -> Result<Box3, WriteError> {
        match self {
            Self::Patches { patches, .. } => {
                Ok(patches.iter().fold(Box3::EMPTY, |hull, patch| hull.union(patch.bounds())))
            }
            Self::Surfaces { surfaces, .. } => {
                Ok(surfaces.iter().fold(Box3::EMPTY, |hull, surface| hull.union(surface.bounds())))
            }
            Self::Scene(scene) => {
                let meshes = scene.world_meshes()?;
                Ok(meshes.iter().fold(Box3::EMPTY, |hull, (_, mesh)| hull.union(mesh.bounds())))
            }
            // Every point of the surface is a mean of control points.
            Self::Cage(polygons) => Ok(Box3::from_points(polygons.cage.positions())),
            Self::Drawing(drawing) => Ok(hull_of(&drawing.lines)),
            Self::Curves(curves) => Ok(hull_of(&curves.lines)),
            Self::Field(field) => Ok(field.bounds()),
            Self::Volume(sampled) => Ok(sampled.bounds()),
        }
    }

    /// A lower bound for the diagonal of the shape's own box, so that a percentage of it is never more than requested.
    /// 0 if the box is a point, or so small that rounding may be all of it.
    ///
    /// For triangles the box is exact. A patch or curve is sampled, since its box can be much smaller than that of its
    /// control points; samples can only make the result too small, never too large.
    ///
    /// # Errors
    /// As for [`Shape::bounds`].
    pub fn diagonal(&self) -> Result<f64, WriteError> {
        match self {
            Self::Patches { patches, .. } => {
                let reach = patches.iter().fold(0.0, |most, p| greater(p.size(), most));
                // An evaluated coordinate is a sum of 16 terms with four roundings each and four sums on the way: its
                // error is less than 12 half steps of the largest control coordinate. 16 whole steps cover it.
                Ok(diagonal_below(&sampled_box(patches), mul_up(16.0 * f64::EPSILON, reach)))
            }
            Self::Surfaces { surfaces, .. } => Ok(surfaces_diagonal(surfaces)),
            Self::Scene(_) => Ok(diagonal_below(&self.bounds()?, 0.0)),
            Self::Cage(polygons) => Ok(diagonal_below(&inner_limit_box(polygons), 0.0)),
            Self::Drawing(drawing) => Ok(diagonal_of(&drawing.lines)),
            Self::Curves(curves) => Ok(diagonal_of(&curves.lines)),
            // The box may be larger than the shape. The extent of its surface is known only after meshing.
            Self::Field(field) => Ok(diagonal_below(&field.bounds(), 0.0)),
            Self::Volume(sampled) => {
                let bounds = sampled.bounds();
                let reach = bounds.min.iter().chain(&bounds.max);
                let reach = reach.fold(0.0, |most: f64, x| greater(x.abs(), most));
                // A corner is a sum of three products with less than 8 roundings of half a step each.
                Ok(diagonal_below(&bounds, mul_up(8.0 * f64::EPSILON, reach)))
            }
        }
    }
}

/// A lower bound for the diagonal of surfaces, from samples of them.
fn surfaces_diagonal(surfaces: &[TrimmedSurface]) -> f64 {
    let samples: Vec<[f64; 3]> = surfaces.iter().flat_map(|face| face.samples(SAMPLES as usize)).collect();
    let sampled = Box3::from_points(&samples);
    let bounds = surfaces.iter().fold(Box3::EMPTY, |hull, surface| hull.union(surface.bounds()));
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |most: f64, x| greater(x.abs(), most));
    // An evaluated coordinate is a weighted mean of control points, in fewer than 8 steps of 3 roundings for each degree
    // (at most 60 in both directions together), and a quotient. The exact surface may be farther off by the slack.
    let slack = surfaces.iter().fold(0.0, |most: f64, face| greater(face.surface().slack(), most));
    diagonal_below(&sampled, add_up(slack, mul_up(2048.0 * f64::EPSILON, reach)))
}

/// Samples along one side of a patch. Chosen: more samples bring the lower bound closer to the diagonal.
const SAMPLES: u32 = 16;

/// The box of points on the patches: all corners, and a lattice on the patches that could extend it.
fn sampled_box(patches: &[Patch]) -> Box3 {
    let corners = |patch: &Patch| [(0, 0), (0, 3), (3, 0), (3, 3)].map(|(i, j)| patch.control[i][j]);
    let sampled =
        patches.iter().fold(Box3::EMPTY, |hull, patch| hull.union(Box3::from_points(&corners(patch))));
    patches.iter().fold(sampled, |sampled, patch| {
        let hull = patch.bounds();
        if hull.is_empty() || sampled.contains(hull.min) && sampled.contains(hull.max) {
            return sampled;
        }
        let at = |i: u32| f64::from(i) / f64::from(SAMPLES);
        (0..=SAMPLES).fold(sampled, |sampled, i| {
            (0..=SAMPLES).fold(sampled, |sampled, j| sampled.with(patch.at(at(i), at(j))))
        })
    })
}

/// Embeds a point of the plane or of space in space.
pub(crate) fn in_space<const D: usize>(p: [f64; D]) -> [f64; 3] {
    std::array::from_fn(|k| p.get(k).copied().unwrap_or(0.0))
}

fn hull_of<const D: usize>(curves: &[Curve<D>]) -> Box3 {
    curves.iter().fold(Box3::EMPTY, |all, curve| {
        let [low, high] = curve.bounds();
        all.union(Box3 { min: in_space(low), max: in_space(high) })
    })
}

/// The diagonal of the box of points on the curves: the ends of all pieces, and samples of the pieces that could extend it.
fn diagonal_of<const D: usize>(curves: &[Curve<D>]) -> f64 {
    let pieces = || curves.iter().flat_map(|curve| curve.segments());
    let ends = curves.iter().fold(Box3::EMPTY, |hull, curve| hull.with(in_space(curve.start())));
    let ends = pieces().fold(ends, |hull, piece| hull.with(in_space(piece.end())));
    let sampled = pieces().fold(ends, |sampled, piece| {
        let [low, high] = piece.bounds().map(in_space);
        if matches!(piece, CurveSegment::Line(_)) || sampled.contains(low) && sampled.contains(high) {
            return sampled;
        }
        let at = |i: u32| f64::from(i) / f64::from(4 * SAMPLES);
        (1..4 * SAMPLES).fold(sampled, |sampled, i| sampled.with(in_space(piece.at(at(i)))))
    });
    let hull = hull_of(curves);
    let reach = hull.min.iter().chain(&hull.max).fold(0.0, |most: f64, x| greater(x.abs(), most));
    // An evaluated coordinate is a sum of at most 4 terms with fewer roundings than a patch's; an arc takes a sine and a
    // cosine, and its error is less than its own slack and 16 steps of its reach; a rational piece takes 3 roundings for
    // each degree, of which there are at most 30.
    let slack = |piece: &CurveSegment<D>| if let CurveSegment::Arc(arc) = piece { arc.slack() } else { 0.0 };
    let more = |most: f64, x: f64| greater(x, most);
    let of_arcs = pieces().map(slack).fold(0.0, more);
    let of_curves = curves.iter().map(Curve::slack).fold(0.0, more);
    diagonal_below(&sampled, add_up(add_up(of_arcs, of_curves), mul_up(512.0 * f64::EPSILON, reach)))
}

/// A lower bound for a box's diagonal, if each of its faces may be up to `error` too far out.
fn diagonal_below(bounds: &Box3, error: f64) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    let slack = add_up(error, error);
    let side: [f64; 3] = std::array::from_fn(|k| {
        let side = sub_down(sub_down(bounds.max[k], bounds.min[k]), slack);
        greater(side, 0.0)
    });
    let longest = side.into_iter().fold(0.0, |a, b| greater(b, a));
    if longest <= 0.0 || longest == f64::INFINITY {
        return 0.0;
    }
    // Scaled by the longest side, so that squares neither overflow nor underflow.
    let squares = side.map(|side| (side / longest).next_down()).map(|s| mul_down(s, s));
    let sum = squares.into_iter().fold(0.0, |sum, s| if s > 0.0 { (sum + s).next_down() } else { sum });
    let diagonal = mul_down(longest, sqrt_down(sum));
    // If a single side is not 0, it is the diagonal itself, which the scaled form only approaches from below.
    greater(diagonal, longest)
}

/// The precision of the size of a cage's limit surface, as a fraction of the diagonal of the control points.
/// Chosen: quick to mesh, and fine enough for a percentage.
const SIZE_SHARE: f64 = 1e-3;

/// A box that the limit surface of a cage certainly spans: the box of a mesh of it, less the mesh's bound.
/// Along an axis without a certain extent its width is 0.
fn inner_limit_box(polygons: &Polygons) -> Box3 {
    let control = Box3::from_points(polygons.cage.positions());
    let Ok(tolerance) = Tolerance::new(SIZE_SHARE * control.diagonal()) else { return Box3::EMPTY };
    let mesh = match cage_to_mesh(&polygons.cage, &Budget::length(tolerance), &Job::default()) {
        Ok(mesh) => mesh,
        Err(Failure::Unmet(best)) => *best,
        Err(Failure::Refused(_) | Failure::Cancelled) => return Box3::EMPTY,
    };
    let Some(error) = mesh.bound.at_most() else { return Box3::EMPTY };
    let Box3 { min, max } = mesh.shape.bounds();
    let low = min.map(|x| add_up(x, error));
    let high = max.map(|x| sub_down(x, error));
    if (0..3).any(|k| low[k] > high[k]) {
        // Thinner than twice the bound of the mesh: the surface may be flat along that axis.
        let middle = |k: usize| 0.5 * min[k] + 0.5 * max[k];
        let flat = |k: usize| low[k] > high[k];
        return Box3 {
            min: [0, 1, 2].map(|k| if flat(k) { middle(k) } else { low[k] }),
            max: [0, 1, 2].map(|k| if flat(k) { middle(k) } else { high[k] }),
        };
    }
    Box3 { min: low, max: high }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_diagonal_of_a_box_comes_from_below_and_close() {
        let bounds = |x, y, z| Box3 { min: [0.0; 3], max: [x, y, z] };
        for (b, true_length) in [
            (bounds(3.0, 4.0, 12.0), 13.0),
            (bounds(1e-200, 0.0, 0.0), 1e-200),
            (bounds(2e200, 1e200, 2e200), 3e200),
        ] {
            let diagonal = diagonal_below(&b, 0.0);
            assert!(diagonal <= true_length && diagonal > true_length * (1.0 - 1e-14), "{diagonal}");
        }
        assert_eq!(diagonal_below(&Box3::EMPTY, 0.0), 0.0);
        assert_eq!(diagonal_below(&bounds(1.0, 1.0, 1.0), 1.0), 0.0);
    }

    #[test]
    fn the_diagonal_of_a_patch_is_that_of_its_points_and_not_of_its_control_points() {
        // The middle control points rise to 1, the patch to 9/16 of that.
        let mut patch = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
            patch.control[i][j][2] = 1.0;
        }
        let true_height = 0.5625_f64;
        let true_diagonal = (2.0 + true_height * true_height).sqrt();
        let shape = Shape::Patches { patches: vec![patch], frame: Frame::default() };
        assert!(shape.diagonal().unwrap() <= true_diagonal);
        assert!(shape.diagonal().unwrap() > true_diagonal * (1.0 - 1e-12));
        assert_eq!(shape.bounds().unwrap().max[2], 1.0);
    }
}
