//! The convex hull of shapes that are hulls of points, or of balls of one radius.
use super::hull::{MOST_POINTS, hull, planar_corners};
use super::{InvalidShape, not_negative};
use crate::implicit::construction::{Construction, ConstructionNode, PlanarForm, SolidForm};
use crate::implicit::{Affine3, Field};
use crate::math::{difference, dot, greater, length, lesser};

/// Corners closer to a segment between two others than this, relative to the largest coordinate, are left
/// out. Derived: some dozen roundings of placements, which would otherwise create faces of their own.
const FLAT: f64 = 1.0 / (1_u64 << 48) as f64;
/// The most corners of all shapes, of which many may be the same. Chosen: far more than a hull has.
const MOST_CORNERS: usize = 4096;
/// Radii are equal if they differ by less than this, relative to the larger one. Derived: far above the
/// rounding of turns and moves.
const SAME: f64 = 1e-12;

/// The shapes that have a hull here.
const TAKEN: &str = "boxes, rounded boxes, prisms, extruded polygons, balls and capsules, moved, turned, \
                     scaled evenly and joined";
/// The equivalent for other shapes, by its names in scripts.
const INSTEAD: &str = "hull(points, radius) takes points in their place, extrude(segment(a, b, radius), height) is the \
                       hull of two equal cylinders along z, and loft(shapes, height) goes from one section to others";

/// The convex hull of shapes, grown by a radius. Each shape must be the hull of points or of balls around
/// them, with the same radius for all: boxes, rounded boxes, prisms, extruded polygons, balls and capsules,
/// moved, turned, mirrored, scaled evenly, repeated and joined. The value is the exact distance to the hull
/// of their rounded corners, without corners closer to a segment between two others than 2⁻⁴⁸ of the largest
/// coordinate.
/// # Errors
/// When a shape is none of these, when radii differ, or as for [`hull`].
///
/// ```
/// use chordal::implicit::shapes::{cuboid, hull_of};
/// let [low, high] = [0.0, 3.0].map(|x| cuboid([1.0; 3]).and_then(|one| one.moved([x, 0.0, x])));
/// let bridge = hull_of(&[low?, high?], 0.0)?;
/// assert!(bridge.expr().at([1.5, 0.0, 1.5]).unwrap() < -0.4);
/// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
/// ```
pub fn hull_of(shapes: &[Field], radius: f64) -> Result<Field, InvalidShape> {
    let grown = not_negative("a hull's radius", radius)?;
    let mut corners = HullCorners::default();
    for shape in shapes {
        let Some(construction) = shape.construction() else {
            return Err(refused("one here was made or changed in another way"));
        };
        corners.join(HullCorners::new(construction)?)?;
    }
    let HullCorners { mut points, radius } = corners;
    points
        .sort_by(|a, b| a.iter().zip(b).fold(std::cmp::Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y))));
    points.dedup();
    let largest = points.as_flattened().iter().fold(0.0, |most, x| greater(x.abs(), most));
    // `hull` refuses more points than that.
    if points.len() <= MOST_POINTS {
        points = without_flat_corners(points, FLAT * largest);
    }
    Ok(hull(&points, radius.unwrap_or(0.0) + grown)?.with_promises_of(shapes))
}

/// Different points without those that are closer than a length to the segment between two others, which
/// rounding leaves along an edge or at one place. Points are removed one at a time.
fn without_flat_corners(mut points: Vec<[f64; 3]>, near: f64) -> Vec<[f64; 3]> {
    let mut k = 0;
    while k < points.len() {
        let others = |at: usize| points[at + 1..].iter().enumerate().filter(move |(j, _)| at + 1 + j != k);
        let is_between = (0..points.len())
            .filter(|at| *at != k)
            .any(|at| others(at).any(|(_, end)| distance_to_segment(points[k], [points[at], *end]) < near));
        if is_between {
            points.remove(k);
        } else {
            k += 1;
        }
    }
    points
}

fn distance_to_segment(p: [f64; 3], [a, b]: [[f64; 3]; 2]) -> f64 {
    let (along, from) = (difference(b, a), difference(p, a));
    let t = lesser(greater(dot(from, along) / dot(along, along), 0.0), 1.0);
    length([0, 1, 2].map(|k| from[k] - t * along[k]))
}

fn refused(what: &str) -> InvalidShape {
    InvalidShape::Number(format!("a hull of shapes takes {TAKEN}, and {what}: {INSTEAD}"))
}

/// Points, and the radius of the balls around them; None as long as there are no points.
#[derive(Debug, Default)]
struct HullCorners {
    points: Vec<[f64; 3]>,
    radius: Option<f64>,
}

impl HullCorners {
    /// The corners of a solid, in its own coordinates.
    fn new(construction: &Construction) -> Result<Self, InvalidShape> {
        match construction.node() {
            ConstructionNode::Solid(form) => Self::of_solid(form),
            ConstructionNode::Placed(map, below) => Ok(Self::new(below)?.placed(map)),
            ConstructionNode::Union(parts) => {
                let mut corners = Self::default();
                parts.iter().try_for_each(|part| corners.join(Self::new(part)?))?;
                Ok(corners)
            }
            ConstructionNode::Planar(_) => {
                Err(refused("one here is a shape of the plane, for which there is planar_hull(points)"))
            }
            ConstructionNode::Intersection(_) | ConstructionNode::Complement(_) => {
                Err(refused("one here is cut"))
            }
            ConstructionNode::Other(_) => Err(refused("one here was made or changed in another way")),
        }
    }

    fn of_solid(form: &SolidForm) -> Result<Self, InvalidShape> {
        let corners = |points: Vec<[f64; 3]>, radius: f64| Ok(Self { points, radius: Some(radius) });
        let of_box = |half: &[f64; 3]| {
            let corner =
                |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { half[axis] } else { -half[axis] });
            (0..8).map(corner).collect::<Vec<_>>()
        };
        match form {
            SolidForm::Cuboid { half } => corners(of_box(half), 0.0),
            SolidForm::RoundedCuboid { half, radius } => corners(of_box(half), *radius),
            SolidForm::Sphere { radius } => corners(vec![[0.0; 3]], *radius),
            SolidForm::Capsule { ends, radius } => corners(ends.to_vec(), *radius),
            SolidForm::Extruded { profile, half } => {
                let outline = match profile {
                    PlanarForm::Contours(contours) => {
                        // Each corner of a closed contour begins one edge.
                        planar_corners(&contours.edges.iter().map(|edge| edge.a).collect::<Vec<_>>())
                    }
                    PlanarForm::Rectangle { half: [x, y], radius: 0.0 } => {
                        vec![[-x, -y], [*x, -y], [*x, *y], [-x, *y]]
                    }
                    _ => return Err(refused("one here is extruded from something round")),
                };
                let at = |z: f64| outline.iter().map(move |[x, y]| [*x, *y, z]);
                corners(at(-half).chain(at(*half)).collect(), 0.0)
            }
            SolidForm::Cone { .. } => Err(refused("one here is a cylinder or a cone")),
            SolidForm::Torus { .. } | SolidForm::Revolved { .. } => {
                Err(refused("one here is turned on a lathe"))
            }
            SolidForm::Tapered { .. } | SolidForm::Twisted { .. } => {
                Err(refused("one here is tapered or twisted"))
            }
            SolidForm::HalfSpace { .. } => Err(refused("one here has no end")),
            SolidForm::Thread { .. } => Err(refused("one here is a thread")),
        }
    }

    /// The same under a similarity map.
    fn placed(self, map: &Affine3) -> Self {
        let [x, y, z] = map.steps()[0];
        let stretch = (x * x + y * y + z * z).sqrt();
        // Rotations are rounded, and change no length.
        let stretch = if (stretch - 1.0).abs() < SAME { 1.0 } else { stretch };
        Self {
            points: self.points.into_iter().map(|point| map.at(point)).collect(),
            radius: self.radius.map(|radius| radius * stretch),
        }
    }

    /// Adds the corners of another shape.
    fn join(&mut self, other: Self) -> Result<(), InvalidShape> {
        match (self.radius, other.radius) {
            (Some(a), Some(b)) if (a - b).abs() > SAME * greater(a, b) => {
                let message = format!(
                    "the shapes of a hull have corners of one radius, and here are {a} and {b}: those of a \
                     box have the radius 0, those of rounded_box(x, y, z, radius) another one"
                );
                return Err(InvalidShape::Number(message));
            }
            (a, b) => self.radius = a.or(b),
        }
        self.points.extend(other.points);
        if self.points.len() > MOST_CORNERS {
            let message = format!("the shapes of a hull have more than {MOST_CORNERS} corners: {INSTEAD}");
            return Err(InvalidShape::Number(message));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        capsule, cuboid, cylinder, prism, rectangle, regular_polygon, rounded_cuboid, sphere, torus,
    };
    use super::*;
    use crate::budget::Evidence;
    use crate::implicit::csg::Csg;

    fn value(field: &Field, p: [f64; 3]) -> f64 {
        field.expr().at(p).unwrap()
    }

    /// Points all over a box around the origin.
    fn points(half: f64) -> Vec<[f64; 3]> {
        let at = |k: usize| half * (k as f64 / 3.5 - 1.0);
        (0..512).map(|k| [at(k % 8), at(k / 8 % 8), at(k / 64)]).collect()
    }

    fn assert_same(a: &Field, b: &Field) {
        for p in points(4.0) {
            let (x, y) = (value(a, p), value(b, p));
            assert!((x - y).abs() < 1e-13, "{p:?}: {x} {y}");
        }
    }

    #[test]
    fn boxes_in_a_row_make_a_longer_box_however_they_are_turned() {
        let cuboid_in_row = cuboid([1.0, 1.0, 2.0]).unwrap();
        let row = [-1.0, 0.3, 1.0].map(|x| cuboid_in_row.moved([x, 0.0, 0.0]).unwrap());
        let expected = cuboid([3.0, 1.0, 2.0]).unwrap();
        assert_same(&hull_of(&row, 0.0).unwrap(), &expected);
        let turn = |field: &Field| field.rotated_deg([1.0, 2.0, 0.5], 33.0).unwrap();
        let turned = hull_of(&row.each_ref().map(turn), 0.0).unwrap();
        assert_same(&turned, &turn(&expected));
        // A corner that rounding moved off an edge is not a corner.
        let n = Csg::from_expr(turned.sign()).primitives().len();
        assert!(n <= 12, "{n} planes");
    }

    #[test]
    fn balls_and_rounded_boxes_of_one_radius_make_one_of_that_radius() {
        let balls = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(|at| sphere(0.5).unwrap().moved(at).unwrap());
        let pill = capsule([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.5).unwrap();
        assert_same(&hull_of(&balls, 0.0).unwrap(), &pill);
        // A union, a scaled ball, and an offset of all of it.
        let joined = balls[0].union(&sphere(0.25).unwrap().scaled([2.0; 3]).unwrap()).union(&balls[1]);
        let grown = capsule([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.75).unwrap();
        assert_same(&hull_of(&[joined], 0.25).unwrap(), &grown);
        let halves =
            [-1.0, 1.0].map(|z| rounded_cuboid([2.0, 3.0, 1.0], 0.25).unwrap().moved([0.0, 0.0, z]).unwrap());
        assert_same(&hull_of(&halves, 0.0).unwrap(), &rounded_cuboid([2.0, 3.0, 3.0], 0.25).unwrap());
    }

    #[test]
    fn a_promise_about_a_shape_holds_for_its_hull() {
        let part = cuboid([1.0; 3]).unwrap().standing_for("it stands for another".into());
        let joined = hull_of(&[part, cuboid([2.0; 3]).unwrap()], 0.0).unwrap();
        assert!(matches!(joined.evidence(), Evidence::ProvedIf(_)));
    }

    #[test]
    fn prisms_and_extruded_polygons_have_corners() {
        let parts = [-1.0, 1.0].map(|z| prism(6, 1.0, 1.0).unwrap().moved([0.0, 0.0, z]).unwrap());
        assert_same(&hull_of(&parts, 0.0).unwrap(), &prism(6, 1.0, 3.0).unwrap());
        let flat = [rectangle([2.0, 2.0]).unwrap(), regular_polygon(4, 1.0).unwrap()];
        let raised = flat.map(|shape| shape.extruded(1.0).unwrap());
        assert_same(&hull_of(&raised, 0.0).unwrap(), &cuboid([2.0, 2.0, 1.0]).unwrap());
    }

    #[test]
    fn a_shape_without_hull_is_refused_with_advice() {
        let (block, post) = (cuboid([1.0; 3]).unwrap(), cylinder(1.0, 1.0).unwrap());
        for (shapes, what) in [
            (vec![block.clone(), post.clone()], "one here is a cylinder or a cone: hull(points, radius)"),
            (vec![torus(2.0, 0.5).unwrap()], "turned on a lathe"),
            (vec![block.difference(&post)], "one here is cut"),
            (vec![block.scaled([1.0, 2.0, 1.0]).unwrap()], "made or changed in another way"),
            (vec![rectangle([1.0, 1.0]).unwrap()], "planar_hull(points)"),
            (vec![block, sphere(0.5).unwrap()], "radius, and here are 0 and 0.5: those of a box"),
            (vec![], "a hull has 0 points"),
        ] {
            let message = hull_of(&shapes, 0.0).unwrap_err().to_string();
            assert!(message.contains(what), "{message}");
        }
    }
}
