//! Primitive solids and plane shapes.
use super::bind::{BoundArgs, Function, ParameterDefault, defaulting, optional, required};
use super::{Arg, CallError, paths, sweep};
use chordal::implicit::{Field, shapes};

const EXACT: &str = "exact";
const BOUND: &str = "a lower bound";

/// Solids.
pub(super) const SOLIDS: &[Function] = &[
    Function {
        name: "sphere",
        parameters: &[required("radius")],
        about: "A ball around the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::sphere(args.number(0)?), &[]),
    },
    Function {
        name: "box",
        parameters: &[required("x"), required("y"), required("z")],
        about: "A box of these full sizes around the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::cuboid(args.numbers(0)?), &[]),
    },
    Function {
        name: "rounded_box",
        parameters: &[required("x"), required("y"), required("z"), required("radius")],
        about: "A box of these full sizes whose edges are rounded to a radius.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::rounded_cuboid(args.numbers(0)?, args.number(3)?), &[]),
    },
    Function {
        name: "cylinder",
        parameters: &[required("radius"), required("height")],
        about: "A cylinder along z, around the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::cylinder(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "cone",
        parameters: &[required("bottom"), required("top"), required("height")],
        about: "A cone along z with a radius at its bottom and one at its top, either of them 0 if you like.",
        distance: EXACT,
        make: |args| {
            let [bottom, top, height] = args.numbers(0)?;
            args.shape_result(shapes::capped_cone(bottom, top, height), &[])
        },
    },
    Function {
        name: "capsule",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "All points nearer than a radius to the segment between two points.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::capsule(args.point(0)?, args.point(1)?, args.number(2)?), &[]),
    },
    Function {
        name: "torus",
        parameters: &[required("major"), required("minor")],
        about: "A ring around z: the radius of its circle, and that of its tube.",
        distance: "exact; lower bound inside where the ring meets itself",
        make: |args| args.shape_result(shapes::torus(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "ellipsoid",
        parameters: &[required("x"), required("y"), required("z")],
        about: "An ellipsoid of these three radii.",
        distance: BOUND,
        make: |args| args.shape_result(shapes::ellipsoid(args.numbers(0)?), &[]),
    },
    Function {
        name: "prism",
        parameters: &[required("sides"), required("radius"), required("height")],
        about: "A regular prism along z; the radius is that of its corners, one of which is on the x axis.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::prism(args.count(0)?, args.number(1)?, args.number(2)?), &[]),
    },
    Function {
        name: "octahedron",
        parameters: &[required("radius")],
        about: "A regular octahedron with its corners on the axes.",
        distance: "exact inside, lower bound outside",
        make: |args| args.shape_result(shapes::octahedron(args.number(0)?), &[]),
    },
    Function {
        name: "tetrahedron",
        parameters: &[required("radius")],
        about: "A regular tetrahedron; the radius is that of its corners, one of them towards (1, 1, 1).",
        distance: "exact inside, lower bound outside",
        make: |args| args.shape_result(shapes::tetrahedron(args.number(0)?), &[]),
    },
    Function {
        name: "plane",
        parameters: &[required("normal"), optional("offset", 0.0)],
        about: "All points below a plane, which is that far from the origin along its normal.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::plane(args.point(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "triangle",
        parameters: &[required("a"), required("b"), required("c"), required("thickness")],
        about: "All points nearer than half of a thickness to a triangle in space.",
        distance: EXACT,
        make: |args| {
            args.shape_result(
                shapes::triangle([args.point(0)?, args.point(1)?, args.point(2)?], args.number(3)?),
                &[],
            )
        },
    },
    Function {
        name: "hull",
        parameters: &[required("points"), optional("radius", 0.0)],
        about: "The convex hull of points, or of balls of one radius around them. Or of a list of shapes that are such \
            hulls: boxes, prisms, extruded polygons, balls, capsules.",
        distance: EXACT,
        make: hull,
    },
    Function {
        name: "sweep",
        parameters: &[
            required("path"),
            required("profile"),
            defaulting("tolerance", ParameterDefault::Nothing),
        ],
        about: "A tube, where the profile is a radius: all points nearer than that to a path, or to the straight lines \
            through points. Or a shape of the plane swept along them, with mitres where lines meet. A path becomes \
            straight lines within the tolerance: a 4096th of its box's diagonal unless said.",
        distance: "of these lines outside exact, inside a lower bound; a lower bound for a shape",
        make: sweep::sweep,
    },
    Function {
        name: "thread",
        parameters: &[required("name"), required("height"), optional("clearance", 0.0)],
        about: "A metric thread along z, as \"M6\" (coarse) or \"M6x0.75\", all of its sides moved inward by a \
            clearance; a negative one is for the hole of a nut.",
        distance: "a sign",
        make: |args| {
            let form = shapes::ThreadForm::from_name(args.text(0)?);
            let (height, clearance) = (args.number(1)?, args.number(2)?);
            let field =
                form.and_then(|form| shapes::thread(shapes::ThreadForm { clearance, ..form }, height));
            args.shape_result(field, &[])
        },
    },
    Function {
        name: "gyroid",
        parameters: &[required("period"), optional("level", 0.0)],
        about: "One side of the gyroid, without end; with shell() it is a wall.",
        distance: BOUND,
        make: |args| args.shape_result(shapes::gyroid(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "schwarz_p",
        parameters: &[required("period"), optional("level", 0.0)],
        about: "One side of Schwarz' surface P, without end.",
        distance: BOUND,
        make: |args| args.shape_result(shapes::schwarz_p(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "diamond",
        parameters: &[required("period"), optional("level", 0.0)],
        about: "One side of Schwarz' surface D, without end.",
        distance: BOUND,
        make: |args| args.shape_result(shapes::diamond(args.number(0)?, args.number(1)?), &[]),
    },
];

fn hull(args: &BoundArgs) -> Result<Arg, CallError> {
    if !args.has_shapes(0) {
        return args.shape_result(shapes::hull(&args.points(0)?, args.number(1)?), &[]);
    }
    if args.has_shapes(1) {
        return Err(args.fault("takes several shapes as a list, as in hull([a, b])"));
    }
    let parts: Vec<Field> = args.shapes()?.into_iter().map(|solid| solid.field.clone()).collect();
    args.shape_result(shapes::hull_of(&parts, args.number(1)?), &[])
}

/// Plane shapes.
pub(super) const FLAT: &[Function] = &[
    Function {
        name: "circle",
        parameters: &[required("radius")],
        about: "A disc around the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::circle(args.number(0)?), &[]),
    },
    Function {
        name: "rectangle",
        parameters: &[required("x"), required("y")],
        about: "A rectangle of these full sizes around the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::rectangle(args.numbers(0)?), &[]),
    },
    Function {
        name: "rounded_rectangle",
        parameters: &[required("x"), required("y"), required("radius")],
        about: "A rectangle of these full sizes whose corners are rounded to a radius.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::rounded_rectangle(args.numbers(0)?, args.number(2)?), &[]),
    },
    Function {
        name: "segment",
        parameters: &[required("a"), required("b"), required("radius")],
        about: "All points nearer than a radius to the segment between two points.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::segment(args.point(0)?, args.point(1)?, args.number(2)?), &[]),
    },
    Function {
        name: "polygon",
        parameters: &[required("points"), defaulting("tolerance", ParameterDefault::Nothing)],
        about: "The polygon with these corners, each of two numbers. Or what a path of the plane encloses: its polygon \
            within the tolerance, a 4096th of its box's diagonal unless said.",
        distance: "exact; lower bound where it crosses itself",
        make: paths::polygon,
    },
    Function {
        name: "regular_polygon",
        parameters: &[required("sides"), required("radius")],
        about: "A regular polygon; the radius is that of its corners, one of which is on the x axis.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::regular_polygon(args.count(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "planar_hull",
        parameters: &[required("points")],
        about: "The convex hull of points of the plane.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::planar_hull(&args.points(0)?), &[]),
    },
];
