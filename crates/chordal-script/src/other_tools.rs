//! Function names of other tools (OpenSCAD, CadQuery, build123d, ManifoldCAD, SDF libraries), and their
//! equivalents.
use crate::language::{self, Function};

/// The equivalent of a name that scripts do not have: the calls to write, in half a sentence. Tools also
/// differ in capitals and underscores, so names are compared as they are spelled first, and then by their
/// letters alone.
pub(crate) fn equivalent_of(name: &str) -> Option<String> {
    let in_table = |is_same: &dyn Fn(&str) -> bool| {
        let row = NAMES.iter().find(|(names, _)| names.iter().any(|other| is_same(other)));
        row.map(|(_, equivalent)| (*equivalent).to_owned())
    };
    let letters = letters_of(name);
    let is_alike = |other: &str| letters_of(other) == letters;
    let in_language = || language::functions().find(|function| is_alike(function.name)).map(Function::usage);
    // A name that another tool has exactly so comes first; a name of this language that is only
    // spelled differently comes before other tools' names that are merely alike.
    in_table(&|other| other == name).or_else(in_language).or_else(|| in_table(&is_alike))
}

fn letters_of(name: &str) -> String {
    name.chars().filter(|c| *c != '_').map(|c| c.to_ascii_lowercase()).collect()
}

/// Names of other tools, with the call that does the same. A test checks that the calls exist in the
/// language.
pub(crate) const NAMES: &[(&[&str], &str)] = &[
    (&["ball", "Sphere", "sdSphere", "geodesic_sphere"], "sphere(radius)"),
    (
        &["cube", "cuboid", "Box", "brick", "block", "sdBox", "makeBox", "make_box"],
        "box(x, y, z), with full side lengths, centred on the origin",
    ),
    (&["rounded_cube", "roundedcube", "round_box", "rounded_cuboid"], "rounded_box(x, y, z, radius)"),
    (
        &["cyl", "Cylinder", "rod", "disk3d", "makeCylinder"],
        "cylinder(radius, height), along the z axis, centred on the origin",
    ),
    (&["capped_cone", "Cone", "frustum", "truncated_cone"], "cone(bottom, top, height)"),
    (&["pill", "sdCapsule", "stadium"], "capsule(a, b, radius)"),
    (&["donut", "doughnut", "ring", "Torus"], "torus(major, minor)"),
    (&["translate", "moved", "Pos", "Location", "shift", "trans"], "move(shape, x, y, z)"),
    (
        &["rotated", "Rot", "rot", "turn", "orient"],
        "rotate(shape, axis, degrees), or rotate_z(shape, degrees)",
    ),
    (&["xrot", "rotateX", "rotx"], "rotate_x(shape, degrees)"),
    (&["yrot", "rotateY", "roty"], "rotate_y(shape, degrees)"),
    (&["zrot", "rotateZ", "rotz"], "rotate_z(shape, degrees)"),
    (&["resize", "scaled", "scale_xyz"], "stretch(shape, x, y, z), or scale(shape, factor)"),
    (&["mirror_x", "reflect", "flip"], "mirror(shape, x, y, z), with the normal of the plane"),
    (&["linear_extrude", "linearExtrude", "extruded", "extrude_linear", "pad"], "extrude(shape, height)"),
    (
        &["bevel", "rounded_extrude", "extrude_rounded", "offset_sweep", "cyl_rounded", "rounded_prism"],
        "extrude(shape, height, bevel, rounded)",
    ),
    (&["rotate_extrude", "rotateExtrude", "revolved", "lathe", "extrude_rotate"], "revolve(shape)"),
    (&["sweep_extrude", "path_extrude", "path_sweep", "pipe", "tube"], "sweep(path, profile)"),
    (&["hull_3d", "hull3d", "convex_hull", "chain_hull"], "hull(points, radius)"),
    (&["hull_2d", "hull2d", "convexHull"], "planar_hull(points)"),
    (&["subtract", "cut", "minus", "subtraction", "Difference"], "difference(shape, other), or a - b"),
    (&["intersect", "common", "Intersection"], "intersection(a, b), or a & b"),
    (&["fuse", "add", "combine", "join", "unite", "Union", "assembly", "group"], "union(a, b), or a | b"),
    (&["smooth_min", "smin", "blend", "smoothUnion", "opSmoothUnion"], "smooth_union(a, b, radius)"),
    (&["invert", "negate", "inverse"], "complement(shape)"),
    (
        &["polyhedron", "Polyhedron", "of_mesh", "manifold"],
        "hull(points) if it is convex, or mesh(name) for the triangles of a file",
    ),
    (
        &["import", "import_stl", "import_mesh", "importStep", "load_mesh", "stl"],
        "mesh(name), for a file beside the script",
    ),
    (&["surface", "height_map", "heightfield", "lithophane"], "heightmap(name, size, height, base)"),
    (&["import_svg", "surface_svg"], "svg(name, tolerance)"),
    (
        &["square", "rect", "Rectangle", "Rect"],
        "rectangle(x, y), with full side lengths, centred on the origin",
    ),
    (&["rounded_rect", "RectangleRounded", "rounded_square", "slot2D"], "rounded_rectangle(x, y, radius)"),
    (&["disc", "disk", "Circle"], "circle(radius)"),
    (&["ngon", "RegularPolygon", "hexagon", "regular_ngon"], "regular_polygon(sides, radius)"),
    (&["Polygon", "polyline", "Polyline"], "polygon(points)"),
    (&["offset2d", "offset2D", "offset_2d", "offset3d", "inflate", "dilate", "grow"], "offset(shape, by)"),
    (
        &["round", "rounded", "round_edges", "round2d"],
        "minkowski(shape, radius), extrude(shape, height, rounded=…), or fillet= of union and difference",
    ),
    (
        &["fillet", "chamfer"],
        "fillet= and chamfer= of union, difference and intersection, or rounded_box(x, y, z, radius)",
    ),
    (&["minkowski_sum", "minkowskiSum"], "minkowski(shape, radius)"),
    (&["thicken", "hollow", "onion", "shelled"], "shell(shape, thickness)"),
    (&["projection", "slice", "cross_section", "cut_plane"], "section(shape, z)"),
    (
        &["array", "linear_array", "grid", "rarray", "GridLocations", "tile", "instances"],
        "repeat(shape, x, y, z, nx, ny, nz), or linear(shape, count, x)",
    ),
    (&["circular_array", "polar_array", "polarArray", "PolarLocations", "radial"], "polar(shape, count)"),
    (&["colour", "set_color", "paint"], "color(shape, color)"),
    (&["Text", "text3d", "write"], "text(text, font, tolerance)"),
    (&["wedge"], "extrude(polygon(points), height)"),
    (&["half_space", "halfspace", "Plane"], "plane(normal, offset)"),
    (&["helix", "spiral", "Thread", "IsoThread"], "thread(name, height), or sweep(path, profile)"),
    (&["bounding_box", "BoundingBox", "boundingBox", "bounds", "bbox", "aabb"], "box_of(shape)"),
    (&["echo", "log_message", "debug", "console"], "print(values)"),
    (&["assert", "require"], "check(condition, message)"),
    (&["norm", "length"], "sqrt(value), of a sum of squares"),
    (&["fabs", "absolute"], "abs(value)"),
    (&["arcsin"], "asin(value)"),
    (&["arccos"], "acos(value)"),
    (&["arctan"], "atan(value)"),
    (&["fmin", "clamp_max"], "minimum(a, b)"),
    (&["fmax", "clamp_min"], "maximum(a, b)"),
];
