//! The arrow from a field to the text of a shader: `field_to_shader`.
use super::shaders::glsl::{GlslDuals, GlslValues, glsl_number};
use super::shaders::statements::statements;
use crate::budget::Evidence;
use crate::implicit::{DistanceQuality, Dual, Expr, ExprGraph, Field, LeafError, Tape, Term, leaf_as_expr};
use crate::math::{Box3, Interval, add_up, greater, mul_up, sqrt_up};
use std::collections::BTreeSet;
use std::fmt;

/// A field as functions of GLSL ES 3.00 (WebGL 2), with the facts that sphere tracing needs.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldShader {
    /// The text: constants, helpers and two functions, without a version and a precision, so that it can be put into any
    /// shader whose precision of `float` is `highp`.
    pub source: String,
    /// The number of terms that a value takes.
    pub n_terms: usize,
    /// The Lipschitz constant in the box: the value changes by no more than this times the distance. Above 0.
    pub slope: f64,
    /// How the constant is known.
    pub slope_evidence: Evidence,
    /// A box around the shape, with room for rays to start outside of it.
    pub bounds: Box3,
}

/// The reason why a field has no shader.
#[derive(Clone, Debug)]
pub enum ShaderRefusal {
    /// It has no finite box.
    Unbounded,
    /// A part of it is no expression: a mesh, samples, a user's function.
    NoExpression,
    /// A leaf failed.
    Leaf(LeafError),
}

impl fmt::Display for ShaderRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unbounded => f.write_str(
                "the field has no finite box; give a region to look in, as in -1,-1,-1 to 1,1,1",
            ),
            Self::NoExpression => f.write_str(
                "a part of the field is no expression, which a shader needs: a mesh, samples, a function of a program, or an \
                 outline that crosses itself",
            ),
            Self::Leaf(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ShaderRefusal {}

impl From<LeafError> for ShaderRefusal {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

/// Writes a field as GLSL: `float NAME(vec3 p)`, its value, and `vec4 NAME_dual(vec3 p)`, its gradient in xyz and its
/// value in w. `NAME_slope` is the Lipschitz constant between `NAME_low` and `NAME_high`, so that `NAME(p) / NAME_slope` is
/// a step that cannot cross the surface.
///
/// The value is that of the field, or of [`Field::sign`] if only that is an expression; both have the same surface. Graphics
/// processors compute in single precision: where a value is the difference of large numbers, it is off by their rounding.
/// The functions' text depends only on the operations and their order, apart from the numbers in it.
///
/// `name` becomes a name of GLSL: characters other than letters and digits are left out.
///
/// *Cost.* Linear in the terms; if the field does not promise its slope, intervals of the gradient in some thousand boxes.
///
/// # Errors
/// [`ShaderRefusal`].
///
/// ```
/// use chordal::convert::shader::field_to_shader;
/// use chordal::implicit::shapes::{cuboid, cylinder};
/// let block = cuboid([2.0, 2.0, 1.0])?.difference(&cylinder(0.4, 2.0)?);
/// let shader = field_to_shader(&block, "block")?;
/// assert!(shader.source.contains("float block(vec3 p) {") && shader.source.contains("vec4 block_dual(vec3 p) {"));
/// assert_eq!(shader.slope, 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source of forward-mode derivatives beside values: R. E. Wengert, *A simple automatic derivative evaluation program*,
/// 1964. Source of steps by the value over its Lipschitz constant: J. C. Hart, *Sphere tracing*, 1996.
pub fn field_to_shader(field: &Field, name: &str) -> Result<FieldShader, ShaderRefusal> {
    let bounds = field.bounds();
    if !bounds.min.iter().chain(&bounds.max).all(|x| x.is_finite()) {
        return Err(ShaderRefusal::Unbounded);
    }
    let bounds = with_room(&bounds);
    let (graph, is_value) = match plain_graph(field.expr()) {
        Some(graph) => (graph, true),
        None => (plain_graph(field.sign()).ok_or(ShaderRefusal::NoExpression)?, false),
    };
    let is_bound = is_value && field.distance().weakest() >= DistanceQuality::Bound;
    let (slope, slope_evidence) = if is_bound {
        (1.0, field.distance_evidence())
    } else {
        let expr = if is_value { field.expr() } else { field.sign() };
        steepest(&Tape::new(expr), &bounds)?
    };
    let name = glsl_name(name);
    let facts = ShaderFacts { name: &name, bounds, slope, slope_evidence: &slope_evidence };
    let source = glsl_source(graph.terms(), &facts).ok_or(ShaderRefusal::NoExpression)?;
    Ok(FieldShader { source, n_terms: graph.terms().len(), slope, slope_evidence, bounds })
}

/// The box, larger by a 128th of its diagonal on all sides.
fn with_room(bounds: &Box3) -> Box3 {
    let room = bounds.diagonal() / 128.0;
    Box3 { min: bounds.min.map(|x| x - room), max: bounds.max.map(|x| x + room) }
}

/// What the text states beside the functions.
struct ShaderFacts<'a> {
    name: &'a str,
    bounds: Box3,
    slope: f64,
    slope_evidence: &'a Evidence,
}

/// The expression's terms, with leaves replaced by their expressions. None if a leaf has none.
fn plain_graph(expr: &Expr) -> Option<ExprGraph> {
    let graph = ExprGraph::from_expr(expr);
    if !graph.terms().iter().any(|term| matches!(term, Term::Leaf(..))) {
        return Some(graph);
    }
    let axes = Expr::axes();
    let mut exprs: Vec<Expr> = Vec::with_capacity(graph.terms().len());
    for term in graph.terms() {
        let of = |k: &u32| &exprs[*k as usize];
        exprs.push(match term {
            Term::Const(value) => Expr::constant(*value),
            Term::Axis(axis) => axes[usize::from(*axis)].clone(),
            Term::Unary(op, a) => Expr::unary(*op, of(a)),
            Term::Binary(op, a, b) => Expr::binary(*op, of(a), of(b)),
            Term::Leaf(leaf, at) => {
                let at = at.each_ref().map(|k| of(k).clone());
                leaf_as_expr(&**leaf)?.with_axes(at)
            }
        });
    }
    Some(ExprGraph::from_expr(exprs.last()?))
}

/// The most boxes in which the gradient is enclosed. Chosen: a tenth of a second for a thousand terms.
const MOST_BOXES: usize = 4096;
/// The boxes of the first division along each axis.
const FIRST: usize = 4;

/// An upper bound of the gradient's length in a box. If ranges have none, the largest one at points of a lattice, with a
/// margin.
fn steepest(tape: &Tape, bounds: &Box3) -> Result<(f64, Evidence), LeafError> {
    let mut boxes = divided(bounds, FIRST);
    let mut slopes = lengths_over(tape, &boxes)?;
    // The steepest boxes are divided, as long as there are not too many.
    while boxes.len() + 8 <= MOST_BOXES {
        let n = (boxes.len() / 8).clamp(1, (MOST_BOXES - boxes.len()) / 7);
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        order.sort_by(|a, b| slopes[*b].total_cmp(&slopes[*a]).then(a.cmp(b)));
        let mut steep: Vec<usize> = order[..n].to_vec();
        steep.sort_unstable();
        let parts: Vec<Box3> = steep.iter().flat_map(|k| divided(&boxes[*k], 2)).collect();
        let part_slopes = lengths_over(tape, &parts)?;
        for k in steep.into_iter().rev() {
            boxes.swap_remove(k);
            slopes.swap_remove(k);
        }
        boxes.extend(parts);
        slopes.extend(part_slopes);
    }
    let most = slopes.iter().fold(0.0, |most, slope| greater(*slope, most));
    if most > 0.0 && most.is_finite() {
        return Ok((most, tape.evidence()));
    }
    let points: Vec<[f64; 3]> = divided(bounds, 16).iter().map(Box3::centre).collect();
    let mut duals = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
    tape.gradient_at(&points, &mut duals)?;
    let length = |dual: &Dual<f64>| dual.gradient.iter().fold(0.0, |sum, d| sum + d * d).sqrt();
    let most = duals.iter().map(length).filter(|slope| slope.is_finite()).fold(0.0, greater);
    // Half as much again, for what lies between the points: chosen.
    Ok((if most > 0.0 { 1.5 * most } else { 1.0 }, Evidence::Measured { samples: points.len() as u64 }))
}

/// The box in `n` parts along each axis.
fn divided(bounds: &Box3, n: usize) -> Vec<Box3> {
    let at = |k: usize, i: usize| {
        let share = i as f64 / n as f64;
        // Neighbours share their sides, and the last side is that of the box.
        if i == n { bounds.max[k] } else { bounds.min[k] + share * (bounds.max[k] - bounds.min[k]) }
    };
    let part = |i: usize| {
        let cell = [i % n, i / n % n, i / n / n];
        let corner = |step: usize| [0, 1, 2].map(|k| at(k, cell[k] + step));
        Box3 { min: corner(0), max: corner(1) }
    };
    (0..n * n * n).map(part).collect()
}

/// Upper bounds of the gradient's length in boxes; infinite where it has none.
fn lengths_over(tape: &Tape, boxes: &[Box3]) -> Result<Vec<f64>, LeafError> {
    let mut duals = vec![Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] }; boxes.len()];
    tape.gradient_over(boxes, &mut duals)?;
    let length = |dual: &Dual<Interval>| {
        // Where it is not defined it may jump.
        if !dual.value.is_defined() {
            return f64::INFINITY;
        }
        let most = |d: &Interval| greater(d.lo().abs(), d.hi().abs());
        sqrt_up(dual.gradient.iter().map(most).fold(0.0, |sum, d| add_up(sum, mul_up(d, d))))
    };
    Ok(duals.iter().map(length).map(|slope| if slope.is_nan() { f64::INFINITY } else { slope }).collect())
}

/// Words of GLSL ES 3.00 and names of its functions that somebody may give to a file.
const TAKEN: [&str; 41] = [
    "abs", "active", "all", "any", "atan", "bool", "buffer", "cast", "ceil", "cross", "discard", "distance",
    "do", "dot", "else", "exp", "filter", "fixed", "flat", "float", "for", "half", "if", "in", "input",
    "int", "length", "main", "max", "min", "mix", "mod", "not", "out", "output", "sample", "sign", "sin",
    "smooth", "texture", "void",
];

/// A text as a name of GLSL: letters and digits, with single underscores between them.
fn glsl_name(text: &str) -> String {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let name = words.collect::<Vec<_>>().join("_");
    let is_free = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && !name.starts_with("gl_")
        && !TAKEN.contains(&name.as_str());
    if is_free {
        name
    } else if name.is_empty() {
        "field".to_owned()
    } else {
        format!("field_{name}")
    }
}

/// The text. None if a term is a leaf.
fn glsl_source(terms: &[Term], facts: &ShaderFacts) -> Option<String> {
    let ShaderFacts { name, bounds: Box3 { min, max }, slope, slope_evidence } = facts;
    let mut values = GlslValues { name, helpers: BTreeSet::new() };
    let (value_lines, value) = statements(terms, &mut values)?;
    let mut duals = GlslDuals { name, helpers: BTreeSet::new() };
    let (dual_lines, dual) = statements(terms, &mut duals)?;
    let is_constant = matches!(terms.last(), Some(Term::Const(_)));
    let known = slope_evidence.as_str();
    let vector = |p: [f64; 3]| format!("vec3({})", p.map(glsl_number).join(", "));
    let mut text = format!(
        "// {name}: a shape, the points where {name}(p) is negative. GLSL ES 3.00; float has to be highp.\n\
         // A box around it. Inside the box {name}(p) changes by no more than {name}_slope times the distance\n\
         // ({known}), so a ray may step by {name}(p) / {name}_slope.\n\
         const vec3 {name}_low = {};\nconst vec3 {name}_high = {};\nconst float {name}_slope = {};\n\n",
        vector(*min),
        vector(*max),
        // Rounded up, so that steps are not too long.
        glsl_number(f64::from((*slope as f32).next_up())),
    );
    values.helpers.iter().for_each(|helper| text.push_str(&helper.of_values(name)));
    let indented =
        |lines: &[String]| -> String { lines.iter().map(|line| format!("    {line}\n")).collect() };
    text.push_str(&format!(
        "float {name}(vec3 p) {{\n{}    return {value};\n}}\n\n// The gradient in xyz, the value in w.\n",
        indented(&value_lines)
    ));
    duals.helpers.iter().for_each(|helper| text.push_str(&helper.of_duals(name)));
    let dual = if is_constant { format!("vec4(0, 0, 0, {dual})") } else { dual };
    text.push_str(&format!("vec4 {name}_dual(vec3 p) {{\n{}    return {dual};\n}}\n", indented(&dual_lines)));
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::shapes::{ThreadForm, cuboid, cylinder, polygon, sphere, thread};
    use crate::implicit::{Binary, Leaf, Unary};

    /// A leaf that nothing is known of.
    #[derive(Debug)]
    struct UserFunction;

    impl Leaf for UserFunction {
        fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
            points.iter().zip(out).for_each(|(p, value)| *value = p[0]);
            Ok(())
        }

        fn evidence(&self) -> Evidence {
            Evidence::Measured { samples: 0 }
        }
    }

    fn cube(half: f64) -> Box3 {
        Box3 { min: [-half; 3], max: [half; 3] }
    }

    fn source_of(field: &Field) -> String {
        field_to_shader(field, "shape").expect("a shader").source
    }

    /// The text with every number replaced by the same letter.
    fn without_numbers(text: &str) -> String {
        let mut out = String::new();
        for line in text.lines().filter(|line| !line.starts_with("const")) {
            let words = line.split_inclusive([' ', '(', ')', ',', ';']);
            words.for_each(|word| {
                let is_number = word.starts_with(|c: char| c.is_ascii_digit()) && word.contains('.');
                out.push_str(if is_number { "N " } else { word });
            });
        }
        out
    }

    #[test]
    fn writes_every_operation_for_values_and_for_gradients() {
        let [x, y, z] = Expr::axes();
        let sum = &x + &y * 0.5;
        let unary = Unary::ALL.iter().map(|(op, name)| (Expr::unary(*op, &sum), *name));
        let binary = Binary::ALL.iter().map(|(op, name)| (Expr::binary(*op, &sum, &z), *name));
        for (expr, name) in unary.chain(binary) {
            let source = source_of(&Field::new(expr).known_bounds(cube(1.0)));
            assert_eq!(source.matches('{').count(), source.matches('}').count(), "{name}: {source}");
            assert_eq!(source.matches('(').count(), source.matches(')').count(), "{name}: {source}");
            assert!(source.is_ascii() && source.contains("float shape(vec3 p) {"), "{name}: {source}");
            // Whatever is called is defined before.
            let called = format!("shape_{}(", name.replace('-', "_"));
            if let Some(first) = source.find(&called) {
                let line = source[..first].rfind('\n').map_or(0, |at| at + 1);
                assert!(
                    source[line..].starts_with("float shape_") || source[line..].starts_with("vec4 shape_")
                );
            }
        }
    }

    #[test]
    fn a_shared_part_is_computed_once() {
        let [x, y, _] = Expr::axes();
        let shared = Expr::unary(Unary::Sin, &(&x + &y));
        let source = source_of(&Field::new(shared.max(&(&shared * 0.5 + 0.25))).known_bounds(cube(1.0)));
        assert_eq!(source.matches("sin(p.x + p.y)").count(), 1, "{source}");
        assert!(
            source.contains("float t0 = sin(p.x + p.y);\n    return max(t0, (t0 * 0.5) + 0.25);"),
            "{source}"
        );
    }

    #[test]
    fn other_numbers_leave_the_operations_as_they_are() {
        let block = |width: f64, radius: f64| {
            let hole = cylinder(radius, 3.0).and_then(|hole| hole.moved([0.25 * width, 0.0, 0.0]));
            let hole = hole.expect("a hole");
            source_of(&cuboid([width, 2.0, 1.0]).expect("a box").difference(&hole))
        };
        let (one, other) = (block(2.0, 0.4), block(3.531_25, 0.712_345));
        assert!(one != other && without_numbers(&one) == without_numbers(&other), "{one}\n{other}");
    }

    #[test]
    fn the_slope_is_that_of_the_field() {
        let [x, y, z] = Expr::axes();
        // The gradient of half the square is the point itself, which is longest at the corners of the box.
        let field = Field::new((x.square() + y.square() + z.square()) * 0.5 - 0.5).known_bounds(cube(1.0));
        let shader = field_to_shader(&field, "ball").expect("a shader");
        let corner = 3.0_f64.sqrt() * shader.bounds.max[0];
        assert_eq!(shader.slope_evidence, Evidence::Proved);
        assert!((corner..corner * 1.000_001).contains(&shader.slope), "{} for {corner}", shader.slope); // rounding
        let ball = field_to_shader(&sphere(1.0).expect("a ball"), "ball").expect("a shader");
        assert_eq!(ball.slope, 1.0);
        // A jump has no slope.
        let steps = Field::new(Expr::unary(Unary::Floor, &(x * 2.0)) + y).known_bounds(cube(1.0));
        let shader = field_to_shader(&steps, "steps").expect("a shader");
        assert!(
            matches!(shader.slope_evidence, Evidence::Measured { .. }) && shader.slope == 1.5,
            "{shader:?}"
        );
        assert!(shader.source.contains("(measured)"), "{}", shader.source);
    }

    #[test]
    fn outlines_are_written_by_their_half_planes_and_threads_by_their_turns() {
        let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.0, 0.5]];
        let plate = polygon(&corners).expect("a polygon").extruded(1.0).expect("a plate");
        let source = source_of(&plate);
        assert!(source.contains("max(") && !source.contains("atan"), "{source}");
        let form = ThreadForm { diameter: 8.0, pitch: 1.25, clearance: 0.0 };
        assert!(source_of(&thread(form, 10.0).expect("a thread")).contains("atan("));
    }

    #[test]
    fn refuses_what_is_no_expression_or_has_no_end() {
        let endless = Field::new(Expr::axes()[0].clone());
        assert!(matches!(field_to_shader(&endless, "half"), Err(ShaderRefusal::Unbounded)));
        let leaf = Expr::leaf(std::sync::Arc::new(UserFunction), Expr::axes());
        let refused = field_to_shader(&Field::new(leaf).known_bounds(cube(1.0)), "grid");
        assert!(matches!(refused, Err(ShaderRefusal::NoExpression)), "{refused:?}");
    }

    #[test]
    fn names_are_those_of_the_language() {
        let names =
            [("gear", "gear"), ("my-part v2", "my_part_v2"), ("2gears", "field_2gears"), ("齿轮", "field")];
        for (text, name) in
            names.into_iter().chain([("smooth", "field_smooth"), ("__x", "x"), ("gl_x", "field_gl_x")])
        {
            assert_eq!(glsl_name(text), name);
        }
        let numbers = [
            (1.0, "1.0"),
            (-0.25, "(-0.25)"),
            (1e-7, "1e-7"), // a small number to be printed
            (-0.0, "0.0"),
            (1e300, "uintBitsToFloat(0x7f800000u)"),
        ];
        numbers.into_iter().for_each(|(number, text)| assert_eq!(glsl_number(number), text));
    }
}
