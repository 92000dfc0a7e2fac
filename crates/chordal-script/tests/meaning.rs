//! The results of scripts: shapes, operators, parameters, formulas, and error messages.
use chordal::Job;
use chordal::implicit::evaluation::ExprGraph;
use chordal::implicit::{Distance, DistanceQuality};
use chordal_script::{
    FileUse, OpenedFile, RunOptions, Script, ScriptError, ScriptFiles, language, run, run_with,
};

fn script(text: &str) -> Result<Script, ScriptError> {
    run(text, &RunOptions::default(), &Default::default())
}

fn value(script: &Script, p: [f64; 3]) -> f64 {
    let mut value = [0.0];
    script.field.tape().at(&[p], &mut value).unwrap();
    value[0]
}

fn at(text: &str, p: [f64; 3]) -> f64 {
    let script = script(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    value(&script, p)
}

#[test]
fn shapes_have_the_distances_of_their_formulas() {
    for (text, p, value) in [
        ("sphere(1)", [3.0, 0.0, 0.0], 2.0),
        ("sphere(radius=1/2)", [0.0, 0.0, 1.0], 0.5),
        ("box(2, 4, 6)", [2.0, 0.0, 0.0], 1.0),
        ("box(z=6, x=2, y=4)", [0.0, 0.0, 4.0], 1.0),
        ("cylinder(0.4, 2)", [0.0, 0.0, 0.0], -0.4),
        ("cylinder(0.4, 2)", [0.0, 0.0, 1.5], 0.5),
        ("cone(1, 0, 2)", [0.0, 0.0, 1.5], 0.5),
        ("capsule([0, 0, 0], [0, 0, 4], 1)", [0.0, 3.0, 2.0], 2.0),
        ("torus(2, 0.5)", [0.0, 2.0, 0.0], -0.5),
        ("plane([0, 0, 2], 1)", [5.0, 6.0, 3.0], 2.0),
        ("circle(1)", [0.0, 2.0, 99.0], 1.0),
        ("rectangle(2, 4)", [0.0, 3.0, 99.0], 1.0),
        ("polygon([[0, 0], (2, 0), [2, 2], [0, 2]])", [1.0, 1.5, 7.0], -0.5),
        ("box(2, 2, 1) - cylinder(0.4, 2)", [0.0, 0.0, 0.0], 0.4),
        ("sphere(1) | move(sphere(1), 3, 0, 0)", [3.0, 0.0, 0.0], -1.0),
        ("sphere(2) & move(sphere(2), 1, 0)", [0.0, 0.0, 0.0], -1.0),
        ("union(sphere(1), move(sphere(1), 3, 0, 0), sphere(0.5))", [3.0, 0.0, 0.0], -1.0),
        ("union([move(sphere(1), 3 * k, 0) for k in range(4)])", [9.0, 0.0, 0.0], -1.0),
        ("union(*[move(sphere(1), 3 * k, 0) for k in range(4)])", [9.0, 0.0, 0.0], -1.0),
        ("difference(sphere(2), sphere(1), move(sphere(1), 5, 0))", [0.0, 0.0, 0.0], 1.0),
        ("complement(sphere(1))", [0.0, 0.0, 3.0], -2.0),
        ("rotate_z(box(4, 2, 2), 90)", [0.0, 3.0, 0.0], 1.0),
        ("rotate_x(box(2, 2, 4), 90)", [0.0, 3.0, 0.0], 1.0),
        ("rotate_y(box(4, 2, 2), 90)", [0.0, 0.0, 3.0], 1.0),
        ("scale(sphere(1), 2)", [3.0, 0.0, 0.0], 1.0),
        ("offset(sphere(1), 0.5)", [3.0, 0.0, 0.0], 1.5),
        ("shell(sphere(1), 0.5)", [0.0, 0.0, 1.0], -0.25),
        ("extrude(circle(1), 2)", [0.0, 0.0, 3.0], 2.0),
        ("revolve(move(circle(1), 3, 0))", [0.0, 3.0, 0.0], -1.0),
        ("repeat(sphere(1), x=4)", [8.0, 0.0, 0.0], -1.0),
        ("repeat(sphere(1), x=4, nx=2)", [8.0, 0.0, 0.0], 3.0),
        ("mirror(move(sphere(1), 3, 0, 0), 1, 0, 0)", [-3.0, 0.0, 0.0], -1.0),
        ("field(x * x + 2 * y - z / 2 + 1 - (3 - x))", [2.0, 3.0, 4.0], 8.0),
        ("field(-x + abs(y) + sqrt(z) + minimum(x, 1))", [2.0, -3.0, 4.0], 4.0),
        ("field(atan2(y, x) - pi / 2)", [0.0, 1.0, 0.0], 0.0),
        ("sphere(sqrt(4) + radians(0) + sin(0) + max(1, 2) - min([1, 2]))", [0.0, 0.0, 0.0], -3.0),
        (
            "shape = sphere(1)\nshape |= move(sphere(1), 3, 0)\nshape -= sphere(0.5)\nshape",
            [3.0, 0.0, 0.0],
            -1.0,
        ),
        (
            "def ring(n, r=3):\n    parts = []\n    for k in range(n):\n        parts.append(rotate_z(move(sphere(1), r, 0), 360 * k / n))\n    return union(parts)\nring(4)",
            [-3.0, 0.0, 0.0],
            -1.0,
        ),
        ("a = [2, 3]\na[0] *= a[1]; a[0] += 1\na += [4]\nsphere(a[0] + len(a))", [0.0; 3], -10.0),
        ("sphere((lambda a, b=2: a * b)(3) // 2 + 7 % 4 - len([1, 2]))", [0.0, 0.0, 0.0], -4.0),
        ("sphere(1 if 2 in [1, 2] and not 'a' == 'b' else 5)", [0.0, 0.0, 0.0], -1.0),
    ] {
        let found = at(text, p);
        assert!((found - value).abs() <= 4.0 * f64::EPSILON * value.abs().max(1.0), "{text}: {found}");
    }
}

#[test]
fn distances_and_boxes_come_with_the_shape() {
    let drilled = script("box(2, 2, 1) - cylinder(0.4, 2)").unwrap().field;
    assert_eq!(
        drilled.distance(),
        Distance { outside: DistanceQuality::Bound, inside: DistanceQuality::Exact }
    );
    assert_eq!((drilled.bounds().min, drilled.bounds().max), ([-1.0, -1.0, -0.5], [1.0, 1.0, 0.5]));
    assert_eq!(script("field(x + 1)").unwrap().field.distance(), Distance::SIGN);
}

#[test]
fn parameters_have_defaults_and_can_be_set() {
    let text = "r = param('r', 0.4)\nh = param(\"height\", 2)\nbox(2, 2, 1) - cylinder(r, h)\n";
    let found = script(text).unwrap();
    let shown: Vec<_> = found.parameters.iter().map(|p| (p.name.as_str(), p.default, p.value)).collect();
    assert_eq!(shown, [("r", 0.4, 0.4), ("height", 2.0, 2.0)]);
    let options = RunOptions { set: [("r".to_owned(), 0.5)].into(), ..RunOptions::default() };
    let set = run(text, &options, &Default::default()).unwrap();
    assert_eq!(value(&set, [0.0; 3]), 0.5);
    assert_eq!((set.parameters[0].default, set.parameters[0].value), (0.4, 0.5));
    let options = RunOptions { set: [("q".to_owned(), 0.5)].into(), ..RunOptions::default() };
    let error = run(text, &options, &Default::default()).unwrap_err();
    assert_eq!(
        (error.code, error.to_string().as_str()),
        ("unknown-parameter", "the script has no parameter 'q'; it has r, height")
    );
}

#[test]
fn parameters_are_named_in_any_alphabet() {
    let text = "sphere(param('半径_1', 2) + param('größe', 1))";
    let options = RunOptions { set: [("半径_1".to_owned(), 4.0)].into(), ..RunOptions::default() };
    assert_eq!(value(&run(text, &options, &Default::default()).unwrap(), [0.0; 3]), -5.0);
    assert!(script(&format!("sphere(param('{}', 2))", "径".repeat(64))).is_ok());
    for name in ["", "a b", "a-b", "半径。", &"径".repeat(65)] {
        let error = script(&format!("sphere(param('{name}', 2))")).unwrap_err();
        assert!(error.to_string().contains("needs a name of up to 64 letters"), "{name}: {error}");
    }
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    for (text, code, message) in [
        (
            "",
            "script-value",
            "the script's value must be a shape, but it is None: it has no line with an expression",
        ),
        (
            "a = sphere(1)",
            "script-value",
            "the script's value must be a shape, but it is None: its last line must be an expression, not an assignment: add a line 'a'",
        ),
        (
            "x",
            "script-value",
            "the script's value must be a shape, but it is a formula: turn it into a shape with field()",
        ),
        (
            "[[sphere(1)]]",
            "script-value",
            "part 1: the script's value must be a shape, but it is a list of lists: combine the shapes of each with union()",
        ),
        ("sphere(1", "script-syntax", "line 1, column 9: "),
        ("a = 1\nsphere(a))", "script-syntax", "line 2, column 10: "),
        ("a = 1\n  sphere(b)", "script-syntax", "line 2, column 1: "),
        ("a = 1\nsphere(b)", "script-error", "line 2, column 8: Variable `b` not found"),
        ("é = 'ä'", "script-syntax", "line 1, column 1: "),
        ("a = 1\nbox(1, 2)", "script-error", "line 2, column 1: box() needs 'z'"),
        ("box(1, 2, 3, 4)", "script-error", "line 1, column 1: box() takes 3 arguments, but 4 were given"),
        (
            "box(1, 2, 3, w=4)",
            "script-error",
            "line 1, column 1: box() has no argument 'w': call it as box(x, y, z)",
        ),
        ("box(1, 2, 3, x=4)", "script-error", "line 1, column 1: box() got 'x' twice"),
        ("box(1, 2, [3])", "script-error", "line 1, column 1: box() needs a number for 'z', not a list"),
        ("box(1, 2, True)", "script-error", "line 1, column 1: box() needs a number for 'z', not a boolean"),
        (
            "box(1, 2, sphere(1))",
            "script-error",
            "line 1, column 1: box() needs a number for 'z', not a shape",
        ),
        ("box(1, 2, -3)", "script-error", "line 1, column 1: box(): "),
        ("sphere(0)", "script-error", "line 1, column 1: sphere(): "),
        ("sphere(1e308 * 10)", "script-error", "line 1, column 1: sphere(): "),
        (
            "prism(2.5, 1, 1)",
            "script-error",
            "line 1, column 1: prism() needs a whole number of at least 0 for 'sides', not 2.5",
        ),
        (
            "polygon([[0, 0], [1, 0], 3])",
            "script-error",
            "line 1, column 1: polygon() needs 2 numbers for 'points', not a number",
        ),
        ("union()", "script-error", "line 1, column 1: union() needs at least one shape"),
        ("union(1)", "script-error", "line 1, column 1: union() needs shapes, not a number"),
        (
            "sphere(1) + sphere(2)",
            "script-error",
            "line 1, column 1: '+' is not defined for a shape and a shape: use | to unite shapes",
        ),
        (
            "sphere(1) * 2",
            "script-error",
            "line 1, column 1: '*' is not defined for a shape and a number: use scale(), offset() or move() to change a shape by a number",
        ),
        ("-sphere(1)", "script-error", "line 1, column 1: '-' is not defined for a shape"),
        (
            "sphere(1) | 2",
            "script-error",
            "line 1, column 1: '|' is not defined for a shape and a number: use scale(), offset() or move() to change a shape by a number",
        ),
        ("smooth_union(field(x), sphere(1), 1)", "script-error", "line 1, column 1: smooth_union(): "),
        ("1 / 0", "script-error", "line 1, column 1: "),
        (
            "load('a', 'b')",
            "script-file",
            "line 1, column 6: 'a' cannot be loaded: this script has no folder to read files from",
        ),
        (
            "load('../a', 'b')",
            "script-file",
            "line 1, column 6: '../a' is not allowed: a path must be relative",
        ),
        (
            "svg('/a.svg', 1)",
            "script-error",
            "line 1, column 1: svg(): '/a.svg' is not allowed: a path must be relative",
        ),
        (
            "svg('a.svg', 1)",
            "script-file",
            "line 1, column 1: svg(): 'a.svg' cannot be used: this script has no folder",
        ),
        ("check(1 > 2, 'no %s' % 3)", "script-error", "line 1, column 1: no 3"),
        (
            "sphere(1)\n{(1, 2): 2}",
            "script-error",
            "line 2, column 3: the key of a dictionary must be a string or a number",
        ),
        (
            "union(sphere(1), fillet=1, chamfer=1)",
            "script-error",
            "line 1, column 1: union() takes a fillet or a chamfer, not both",
        ),
        ("thread('M6.5', 3)", "script-error", "line 1, column 1: thread(): the coarse series has no M6.5"),
        (
            "minkowski(ellipsoid(1, 2, 3), 1)",
            "script-error",
            "line 1, column 1: minkowski() needs a shape whose value outside is the exact distance",
        ),
        ("open('a')", "script-error", "line 1, column 1: Variable `open` not found"),
        ("print(1)", "script-value", "the script's value must be a shape, but it is None"),
        ("{1: 2}", "script-value", "1: the script's value must be a shape, but it is a number"),
        ("2 * 3", "script-value", "the script's value must be a shape, but it is a number"),
        ("sphere", "script-value", "the script's value must be a shape, but it is a function"),
        (
            "'a'.join([])",
            "script-syntax",
            "line 1, column 1: attributes are not supported, except append() of lists",
        ),
        ("a = 1\na += sphere(1) | 2", "script-error", "line 2, column 6: '|' is not defined"),
        ("a = [1]\na[0] *= 2; a[0] -= b", "script-error", "line 2, column 20: Variable `b` not found"),
        ("fail('too thin')", "script-error", "line 1, column 1: too thin"),
        (
            "def f():\n    return sphere(nothing)\nf()",
            "script-error",
            "line 2, column 19: Variable `nothing` not found",
        ),
        ("def f():\n    return sphere(-1)\nf()", "script-error", "line 2, column 12: sphere(): "),
    ] {
        let error = script(text).expect_err(text);
        assert_eq!(error.code, code, "{text}: {error}");
        assert!(error.to_string().starts_with(message), "{text}: {error}");
        assert!(!error.message.contains('\n'));
    }
    let error = script("a = 1\nb = sphere(-a)\n").unwrap_err();
    assert_eq!(error.excerpt().unwrap(), "b = sphere(-a)\n    ^");
}

/// What limits count must never be less than what is there.
#[test]
fn no_shape_has_more_terms_than_it_was_counted_with() {
    let solids = [
        "sphere(1)",
        "box(1, 2, 3)",
        "rounded_box(1, 2, 3, 0.1)",
        "cylinder(1, 2)",
        "cone(1, 0.5, 2)",
        "capsule([0, 1, 2], [3, 4, 6], 1)",
        "torus(2, 1)",
        "ellipsoid(1, 2, 3)",
        "prism(5, 1, 2)",
        "octahedron(1)",
        "tetrahedron(1)",
        "plane([1, 2, 3])",
        "triangle([0, 0, 0], [1, 0, 0], [0, 1, 2], 0.1)",
        "gyroid(1)",
        "schwarz_p(1)",
        "diamond(1)",
        "circle(1)",
        "rectangle(1, 2)",
        "rounded_rectangle(1, 2, 0.1)",
        "segment([0, 0], [1, 2], 1)",
        "polygon([[0, 0], [1, 0], [0, 1]])",
        "regular_polygon(7, 1)",
        "polygon(spline([[0, 0], [1, 0], [0, 1]], closed=True))",
        "sweep(spline([[0, 0, 0], [1, 0, 2], [0, 1, 3]]), 0.1, tolerance=0.01)",
    ];
    let changes = [
        "move(S, 1, 2, 3)",
        "rotate(S, [1, 2, 3], 40)",
        "stretch(S, 1, 2, 3)",
        "mirror(S, 1, 2, 3)",
        "shell(S, 0.1)",
        "offset(S, 0.1)",
        "extrude(S, 2)",
        "extrude(S, 2, bevel=0.3)",
        "extrude(S, 2, rounded=0.3)",
        "sweep([[0, 0, 0], [20, 0, 0], [30, 20, 10]], S)",
        "twist(S, 20)",
        "bend(S, 20)",
        "revolve(S)",
        "displace(S, sin(9 * x) / 9, 0.2)",
        "smooth_union(S, sphere(2), 0.5)",
        "smooth_difference(S, sphere(2), 0.5)",
        "union(S, box(1, 2, 4), fillet=0.3)",
        "difference(S, box(1, 2, 4), S, chamfer=0.3)",
        "intersection(S, union(box(1, 2, 4), box(4, 1, 1), fillet=0.1), fillet=0.3)",
        "linear(S, 5, 1)",
        "polar(S, 3)",
        "symmetric(S, 1, 2, 3)",
        "repeat(S, x=5, y=5, z=5)",
        "repeat(S, x=1, y=0.7, nx=3, ny=2)",
        "S & sphere(2)",
    ];
    let mut texts: Vec<String> = solids.map(str::to_owned).into();
    for change in changes {
        for solid in solids {
            texts.push(change.replace('S', solid));
        }
    }
    let mut shapes = 0;
    for text in texts {
        // Not every change goes with every shape.
        let Ok(found) = script(&text) else { continue };
        shapes += 1;
        let terms = ExprGraph::from_expr(found.field.expr()).terms().len()
            + ExprGraph::from_expr(found.field.sign()).terms().len();
        let counted = (1..60).find(|k| {
            let limits = chordal_script::Limits { terms: 1 << k, ..Default::default() };
            run(&text, &RunOptions { limits, ..RunOptions::default() }, &Default::default()).is_ok()
        });
        // Counted in powers of two from above, for the value; the sign may take as much again.
        let most = 2_usize << counted.expect("some limit is enough");
        assert!(terms <= most, "{text}: {terms} terms of {most}");
    }
    assert!(shapes > 200, "{shapes}");
}

#[test]
fn every_function_says_what_it_does() {
    for (group, functions) in language::groups() {
        for function in functions {
            assert!(function.about.ends_with('.'), "{}", function.name);
            let is_shape = group != "Paths" && (group != "Formulas" || function.name == "field");
            assert_eq!(function.distance.is_empty(), !is_shape, "{}", function.name);
        }
    }
    assert_eq!(language::function("gyroid").unwrap().usage(), "gyroid(period, level=0)");
    assert_eq!(language::function("union").unwrap().usage(), "union(*shapes, fillet=0, chamfer=0)");
    let spline = "spline(points, closed=False, knots=\"centripetal\", tangents=None)";
    assert_eq!(language::function("spline").unwrap().usage(), spline);
}

#[test]
fn parentheses_stay_with_what_is_in_them() {
    let p = [0.0, 0.0, 0.0];
    for (text, same) in [
        ("a = sphere(3)\na -= (box(1, 1, 1) | sphere(1))\na", "sphere(3) - (box(1, 1, 1) | sphere(1))"),
        ("a = sphere(3)\na &= (sphere(2)) - sphere(1) # )\na", "sphere(3) & (sphere(2) - sphere(1))"),
        ("a = sphere(3)\n(a) -= (  # -= (\n(sphere(1)))\na", "sphere(3) - sphere(1)"),
        ("a = [1, 2]\na[(0) + 1] += (1)\n(a)[(0)] *= (a[1]) * (2)\nsphere(a[1] * a[0])", "sphere(18)"),
        ("([sphere])[0](1)", "sphere(1)"),
        ("(lambda r: (sphere)(r))((1) + (1))", "sphere(2)"),
    ] {
        assert_eq!(at(text, p), at(same, p), "{text}");
    }
}

#[test]
fn a_union_of_which_the_last_shape_alone_is_cut_is_warned_about() {
    let before = "a = sphere(2)\nb = box(1, 1, 9)\nc = cylinder(0.2, 9)\n";
    for (line, columns) in [
        ("a | b - c", &[5][..]),
        ("a | a | b - c - c | a", &[9]),
        ("a | (a & b) - (c)", &[5]),
        ("(a & b) | b - c", &[11]),
        ("(a) | b - c", &[7]),
        ("(a |  # (\n b - c)", &[2]),
        ("union([a | b - c for k in range(9)] + [a | a - c])", &[12, 44]),
        ("a | b - (c | b - c)", &[5, 14]),
        // What says what it means, or means the same either way.
        ("a | (b - c)", &[]),
        ("a | ((b) - (c))", &[]),
        ("(a | b) - c", &[]),
        ("a - c | b", &[]),
        ("a & b - c", &[]),
        ("a | b & c", &[]),
        // What is not evaluated makes no shape.
        ("a if True else a | b - c", &[]),
    ] {
        let text = format!("{before}{line}\n");
        let made = script(&text).unwrap_or_else(|error| panic!("{line}: {error}"));
        let places: Vec<_> = made.warnings.iter().map(|warning| warning.place).collect();
        let at_line = if line.contains('\n') { 5 } else { 4 };
        let expected: Vec<(u64, u64)> = columns.iter().map(|column| (at_line, *column)).collect();
        assert_eq!(places, expected, "{line}");
        assert!(made.warnings.iter().all(|warning| warning.code == "last-operand-cut"));
        // Python's meaning stays: the hole goes through the last shape alone.
        if line == "a | b - c" {
            assert_eq!(value(&made, [0.0; 3]), at(&format!("{before}a | (b - c)"), [0.0; 3]));
            assert!(value(&made, [0.0; 3]) < 0.0);
        }
    }
    let assigned = script("a = sphere(2)\na |= a - sphere(1)\na").unwrap();
    assert_eq!(assigned.warnings, []);
    let own = script("last_operand__(sphere(1), 7)").unwrap();
    assert_eq!(own.warnings, []);
    let shown = script("sphere(1) | sphere(2) - sphere(3)").unwrap().warnings[0].to_string();
    assert!(shown.starts_with("line 1, column 13: ") && shown.contains("(a | b) - c"), "{shown}");
}

/// Files by name, as a shell would open them.
struct Files(Vec<(&'static str, &'static str)>);

impl ScriptFiles for Files {
    fn open(&self, name: &str, _: FileUse, _: &Job) -> Result<OpenedFile, String> {
        let known = self.0.iter().find(|(known, _)| *known == name);
        known.map(|(_, text)| OpenedFile::Script((*text).to_owned())).ok_or_else(|| "no such file".to_owned())
    }
}

fn with_files(text: &str, files: &[(&'static str, &'static str)]) -> Result<Script, ScriptError> {
    run_with(text, &RunOptions::default(), &Files(files.to_vec()), &Default::default())
}

#[test]
fn names_of_files_are_loaded_and_circles_are_refused() {
    let files = [
        ("a.star", "load('sub/b.star', 'r')\ndef ball(n):\n    return sphere(n * r)\n"),
        ("sub/b.star", "r = 2\n"),
        ("bad.star", "def f(n):\n    return box(1, n)\n"),
        ("c.star", "load('d.star', 'x')\n"),
        ("d.star", "load('c.star', 'x')\n"),
        ("broken.star", "a = 1\nb = (\n"),
    ];
    let made = with_files("load('a.star', 'ball')\nball(3)", &files).unwrap();
    assert_eq!(value(&made, [0.0; 3]), -6.0);
    for (text, message) in [
        ("load('bad.star', 'f')\nf(1)", "bad.star, line 2, column 12: box() needs 'z'"),
        ("load('c.star', 'x')\nsphere(1)", "d.star, line 1, column 6: 'c.star' is loaded in a cycle"),
        ("load('none.star', 'x')\nsphere(1)", "line 1, column 6: 'none.star' cannot be loaded: no such file"),
        ("load('broken.star', 'a')\nsphere(1)", "broken.star, line 3, column 1: "),
    ] {
        let error = with_files(text, &files).unwrap_err();
        assert!(error.to_string().starts_with(message), "{text}: {error}");
    }
}

#[test]
fn several_shapes_have_their_names_and_lines_are_kept() {
    let made = script("print('a', 1, 0.5, [1, 2], sphere(1))\n{'a': sphere(1), 'b': move(sphere(2), 5, 0)}")
        .unwrap();
    assert_eq!(made.said, ["a 1 0.5 [1, 2] a shape"]);
    let names: Vec<&str> = made.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["a", "b"]);
    assert_eq!((value(&made, [0.0; 3]), value(&made, [5.0, 0.0, 0.0])), (-1.0, -2.0));
    let listed = script("[sphere(1), sphere(2)]").unwrap();
    assert_eq!((listed.bodies[0].name.as_str(), listed.bodies[1].name.as_str()), ("part 1", "part 2"));
    assert!(script("sphere(1)").unwrap().bodies.is_empty());
}

#[test]
fn dictionaries_and_texts_work_as_in_python() {
    let text = "d = {'r': 2, 'n': 3}\nd['s'] = 4\ncheck('n' in d and 'q' not in d and len(d) == 3, 'wrong')\n\
                check([k for k in d] == list(d) and list(d) == ['r', 'n', 's'], 'keys')\n\
                check('%s is %.2f%%, %d' % ('a', 1.005, 7.9) == 'a is 1.00%, 7', 'text')\n\
                check(str(0.5) + str(3) + str(True) == '0.53True', 'str')\n\
                e = {str(k): k * d['r'] for k in range(3)}\nsphere(e['2'])";
    assert_eq!(at(text, [0.0; 3]), -4.0);
}

#[test]
fn a_script_reads_the_box_of_a_shape() {
    for (shape, min, max) in [
        ("box(2, 4, 6)", "[-1, -2, -3]", "[1, 2, 3]"),
        ("move(box(2, 4, 6), 1, 0, 3)", "[0, -2, 0]", "[2, 2, 6]"),
        ("sphere(1) | move(sphere(2), 8, 0)", "[-1, -2, -2]", "[10, 2, 2]"),
        ("cylinder(2, 5)", "[-2, -2, -2.5]", "[2, 2, 2.5]"),
        // What is cut off counts: the box holds the shape, and may be larger.
        ("box(2, 4, 6) - move(box(9, 9, 9), 0, 0, 4.5)", "[-1, -2, -3]", "[1, 2, 3]"),
        // 2D shapes have two numbers.
        ("move(rectangle(2, 4), 1, 5)", "[0, 3]", "[2, 7]"),
        ("circle(3)", "[-3, -3]", "[3, 3]"),
    ] {
        let text = format!(
            "b = box_of({shape})\nlow, high, n = b['min'], b['max'], len(b['min'])\n\
             def near(found, wanted):\n    return max([abs(found[k] - wanted[k]) for k in range(n)]) < 1e-12\n\
             check(n == len({min}) and near(low, {min}) and near(high, {max}), 'ends')\n\
             check(near(b['size'], [high[k] - low[k] for k in range(n)]), 'size')\n\
             check(near(b['center'], [(high[k] + low[k]) / 2 for k in range(n)]), 'center')\n\
             check(list(b) == ['min', 'max', 'size', 'center'], 'keys')\nsphere(1)"
        );
        script(&text).unwrap_or_else(|error| panic!("{shape}: {error}"));
    }
    // A lid on a case of which nobody knows the height.
    let lid = "case = rotate_z(box(30, 20, 9), 30) | cylinder(4, 17)\ntop = box_of(case)['max'][2]\n\
               move(box(5, 5, 2), 0, 0, top + 1)";
    assert_eq!(at(lid, [0.0, 0.0, 9.5]), -1.0);
    for (text, what) in [
        ("box_of(3)", "box_of() needs a shape, not a number"),
        ("box_of(x)", "box_of() needs a shape, not a formula"),
        ("box_of(gyroid(1))", "needs a shape with known bounds"),
        ("box_of(complement(sphere(1)))", "needs a shape with known bounds"),
        ("box_of(sphere(1) & move(sphere(1), 9, 0))", "needs a shape with points"),
        ("bounding_box(sphere(1))", "use box_of(shape)"),
    ] {
        let told = script(&format!("{text}\nsphere(1)\n")).unwrap_err();
        assert!(told.message.contains(what), "{text}: {told}");
    }
}

#[test]
fn every_script_on_the_page_for_users_of_openscad_is_a_shape() {
    let page = include_str!("../../../docs/shape-scripts-openscad.md");
    let scripts: Vec<&str> =
        page.split("```python\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(scripts.len() > 20, "{}", scripts.len());
    for text in scripts {
        let made = script(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(made.field.bounds().diagonal().is_finite(), "{text}");
    }
}

#[test]
fn a_hull_is_of_points_or_of_shapes() {
    let p = [2.0, 0.5, 0.2];
    for (text, same) in [
        ("hull([box(1, 1, 1), move(box(1, 1, 1), 3, 0, 0)])", "move(box(4, 1, 1), 1.5, 0, 0)"),
        ("hull([move(sphere(1), -2, 0, 0), move(sphere(1), 2, 0, 0)])", "capsule([-2, 0, 0], [2, 0, 0], 1)"),
        (
            "hull(box(1, 1, 1) | move(box(1, 1, 1), 3, 0, 0), 0.5)",
            "move(rounded_box(5, 2, 2, 0.5), 1.5, 0, 0)",
        ),
        ("hull([[-2, 0, 0], [2, 0, 0]], 1)", "capsule([-2, 0, 0], [2, 0, 0], 1)"),
    ] {
        assert!((at(text, p) - at(same, p)).abs() < 1e-14, "{text}");
    }
    for (text, what) in [
        ("hull([cylinder(1, 2), box(1, 1, 1)])", "hull(): a hull of shapes takes boxes"),
        ("hull([cylinder(1, 2), box(1, 1, 1)])", "extrude(segment(a, b, radius), height)"),
        ("hull([sphere(1), move(sphere(2), 3, 0, 0)])", "of one radius, and here are 1 and 2"),
        (
            "hull(box(1, 1, 1), move(box(1, 1, 1), 3, 0, 0))",
            "takes several shapes as a list, as in hull([a, b])",
        ),
        ("hull([[0, 0, 0], sphere(1)])", "hull() needs 3 numbers for 'points', not a shape"),
    ] {
        let told = script(text).unwrap_err();
        assert!(told.message.contains(what), "{text}: {told}");
    }
}
