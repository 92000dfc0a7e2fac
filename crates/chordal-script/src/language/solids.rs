//! Primitive solids and 2D shapes.
use super::bind::{
    BoundArgs, Function, ParameterDefault, ParameterKind as Kind, defaulting, optional, required,
};
use super::{Arg, CallError, paths, sweep};
use chordal::implicit::{Field, shapes};

const EXACT: &str = "exact distance";
const BOUND: &str = "lower bound";

/// Solids.
pub(super) const SOLIDS: &[Function] = &[
    Function {
        name: "sphere",
        parameters: &[required("radius")],
        about: "A ball centred on the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::sphere(args.number(0)?), &[]),
    },
    Function {
        name: "box",
        parameters: &[required("x"), required("y"), required("z")],
        about: "A box with the side lengths x, y and z, centred on the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::cuboid(args.numbers(0)?), &[]),
    },
    Function {
        name: "rounded_box",
        parameters: &[required("x"), required("y"), required("z"), required("radius")],
        about: "A box with the side lengths x, y and z, centred on the origin, whose edges are rounded to \
            this radius.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::rounded_cuboid(args.numbers(0)?, args.number(3)?), &[]),
    },
    Function {
        name: "cylinder",
        parameters: &[required("radius"), required("height")],
        about: "A cylinder along the z axis, centred on the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::cylinder(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "cone",
        parameters: &[required("bottom"), required("top"), required("height")],
        about: "A cone along the z axis, centred on the origin, with one radius at the bottom and one at \
            the top; one of them may be 0.",
        distance: EXACT,
        make: |args| {
            let [bottom, top, height] = args.numbers(0)?;
            args.shape_result(shapes::capped_cone(bottom, top, height), &[])
        },
    },
    Function {
        name: "capsule",
        parameters: &[required("a").of(Kind::Vector), required("b").of(Kind::Vector), required("radius")],
        about: "All points closer than the radius to the segment from a to b.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::capsule(args.point(0)?, args.point(1)?, args.number(2)?), &[]),
    },
    Function {
        name: "torus",
        parameters: &[required("major"), required("minor")],
        about: "A torus around the z axis: major is the radius of its circle, minor that of its tube.",
        distance: "exact distance; inside a lower bound if the tube intersects itself",
        make: |args| args.shape_result(shapes::torus(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "ellipsoid",
        parameters: &[required("x"), required("y"), required("z")],
        about: "An ellipsoid with the semi-axes x, y and z, centred on the origin.",
        distance: BOUND,
        make: |args| args.shape_result(shapes::ellipsoid(args.numbers(0)?), &[]),
    },
    Function {
        name: "prism",
        parameters: &[required("sides"), required("radius"), required("height")],
        about: "A regular prism along the z axis, centred on the origin. The radius is the distance of its \
            corners from the axis; one of them is on the x axis.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::prism(args.count(0)?, args.number(1)?, args.number(2)?), &[]),
    },
    Function {
        name: "octahedron",
        parameters: &[required("radius")],
        about: "A regular octahedron whose corners are on the axes, at this radius from the origin.",
        distance: "exact distance inside, lower bound outside",
        make: |args| args.shape_result(shapes::octahedron(args.number(0)?), &[]),
    },
    Function {
        name: "tetrahedron",
        parameters: &[required("radius")],
        about: "A regular tetrahedron whose corners are at this radius from the origin, one of them in the \
            direction (1, 1, 1).",
        distance: "exact distance inside, lower bound outside",
        make: |args| args.shape_result(shapes::tetrahedron(args.number(0)?), &[]),
    },
    Function {
        name: "plane",
        parameters: &[required("normal").of(Kind::Vector), optional("offset", 0.0)],
        about: "The half-space below a plane, which is at this offset from the origin along its normal.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::plane(args.point(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "triangle",
        parameters: &[
            required("a").of(Kind::Vector),
            required("b").of(Kind::Vector),
            required("c").of(Kind::Vector),
            required("thickness"),
        ],
        about: "All points closer than half the thickness to a triangle in space.",
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
        parameters: &[required("points").of(Kind::PointsOrShapes), optional("radius", 0.0)],
        about: "The convex hull of points, or of balls of this radius around them. Also the hull of a list \
            of shapes that are such hulls themselves: boxes, prisms, extruded polygons, balls, capsules.",
        distance: EXACT,
        make: hull,
    },
    Function {
        name: "sweep",
        parameters: &[
            required("path").of(Kind::Path),
            required("profile").of(Kind::ShapeOrNumber),
            defaulting("tolerance", ParameterDefault::Nothing),
        ],
        about: "If the profile is a radius, a tube: all points closer than the radius to a path, or to the \
            polyline through points. If it is a 2D shape, that shape swept along the path or polyline, \
            with mitres at the corners. A path is replaced by a polyline within the tolerance, by default \
            1/4096 of the diagonal of its box.",
        distance: "for a tube exact distance to the polyline outside, lower bound inside; for a swept shape lower bound",
        make: sweep::sweep,
    },
    Function {
        name: "thread",
        parameters: &[required("name").of(Kind::Text), required("height"), optional("clearance", 0.0)],
        about: "A metric thread along the z axis, named as in \"M6\" (coarse) or \"M6x0.75\". Its sides \
            are moved inward by the clearance; use a negative one for the hole of a nut.",
        distance: "sign only",
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
        about: "The infinite solid on one side of the gyroid; shell() turns it into a wall.",
        distance: BOUND,
        make: |args| args.shape_result(shapes::gyroid(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "schwarz_p",
        parameters: &[required("period"), optional("level", 0.0)],
        about: "The infinite solid on one side of the Schwarz P surface.",
        distance: BOUND,
        make: |args| args.shape_result(shapes::schwarz_p(args.number(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "diamond",
        parameters: &[required("period"), optional("level", 0.0)],
        about: "The infinite solid on one side of the Schwarz D surface.",
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

/// 2D shapes.
pub(super) const FLAT: &[Function] = &[
    Function {
        name: "circle",
        parameters: &[required("radius")],
        about: "A disc centred on the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::circle(args.number(0)?), &[]),
    },
    Function {
        name: "rectangle",
        parameters: &[required("x"), required("y")],
        about: "A rectangle with the side lengths x and y, centred on the origin.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::rectangle(args.numbers(0)?), &[]),
    },
    Function {
        name: "rounded_rectangle",
        parameters: &[required("x"), required("y"), required("radius")],
        about: "A rectangle with the side lengths x and y, centred on the origin, whose corners are \
            rounded to this radius.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::rounded_rectangle(args.numbers(0)?, args.number(2)?), &[]),
    },
    Function {
        name: "segment",
        parameters: &[required("a").of(Kind::Vector), required("b").of(Kind::Vector), required("radius")],
        about: "All points closer than the radius to the segment from a to b.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::segment(args.point(0)?, args.point(1)?, args.number(2)?), &[]),
    },
    Function {
        name: "polygon",
        parameters: &[required("points").of(Kind::Path), defaulting("tolerance", ParameterDefault::Nothing)],
        about: "The polygon with these corners, each of two numbers. Or the area that a 2D path encloses; \
            the path is replaced by a polygon within the tolerance, by default 1/4096 of the diagonal of \
            its box.",
        distance: "exact distance; lower bound if it crosses itself",
        make: paths::polygon,
    },
    Function {
        name: "regular_polygon",
        parameters: &[required("sides"), required("radius")],
        about: "A regular polygon centred on the origin. The radius is the distance of its corners from \
            the origin; one of them is on the x axis.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::regular_polygon(args.count(0)?, args.number(1)?), &[]),
    },
    Function {
        name: "planar_hull",
        parameters: &[required("points").of(Kind::Points)],
        about: "The convex hull of 2D points.",
        distance: EXACT,
        make: |args| args.shape_result(shapes::planar_hull(&args.points(0)?), &[]),
    },
];
