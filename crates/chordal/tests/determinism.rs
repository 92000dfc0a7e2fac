//! What would make the same input give other bytes on another machine is not written on a result path.
//!
//! The library, the readers and writers and the verbs are searched; test code is free. What std says has
//! "unspecified precision" differs between targets; fused products round once where others round twice; a
//! hash map has an order of its own in every process; a parallel sum depends on where the work was cut.
use crate::gates;

use gates::lines::Lines;
use gates::{Kind, Source, Token, expect_none};

/// The crates whose results are promised to the byte.
const RESULT_PATHS: [&str; 3] = ["crates/chordal/src", "crates/chordal-io/src", "crates/chordal-verbs/src"];

/// Methods of f32 and f64, and of glam's vectors, that std computes with unspecified precision. `sqrt`,
/// rounding, and the conversions of degrees are exact or one product.
const ELEMENTARY: &str = "
    acos acosh asin asinh atan atan2 atanh cbrt cos cosh exp exp2 exp_m1 exp10 gamma hypot ln ln_1p
    ln_gamma log log10 log2 powf powi sin sin_cos sinh tan tanh erf erfc algebraic_add algebraic_sub
    algebraic_mul algebraic_div algebraic_rem
";

/// Functions of glam that reach those inside.
const GLAM: &str = "
    angle_between angle_to from_angle to_angle from_axis_angle to_axis_angle from_euler to_euler
    from_rotation_x from_rotation_y from_rotation_z from_scale_angle from_scale_angle_translation
    to_scale_angle_translation from_angle_translation from_scaled_axis to_scaled_axis rotate_axis
    rotate_x rotate_y rotate_z rotate_towards slerp perspective_lh perspective_rh perspective_rh_gl
    perspective_infinite_rh
";

/// Fused products, by whatever name.
const FUSED: &str = "mul_add fma fmaf fmadd";

/// Steps of a parallel iterator whose result depends on where the work was cut or who was first.
const ORDERLESS: &str = "
    sum product reduce reduce_with try_reduce fold fold_with try_fold find_any find_map_any position_any
";

/// Collections, counts of threads and clocks that may stand only beside a comment on why no result and no
/// order depends on them (it says "result" or "order").
const EXCUSED: &str = "
    HashMap HashSet RandomState DefaultHasher par_bridge current_num_threads current_thread_index
    available_parallelism Instant SystemTime ThreadId
";

/// Whether `name` is one of the words of `list`.
fn lists(list: &str, name: &str) -> bool {
    list.split_whitespace().any(|word| word == name)
}

/// Everything in a source that could make results differ.
fn differences(source: &Source) -> Vec<String> {
    let lines = Lines::new(source);
    let tokens = &source.tokens;
    let mut found = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        let name = token.text.as_str();
        if lines.is_test(at) || token.kind != Kind::Word {
            continue;
        }
        let mut complain = |sentence: String| found.push(source.complain(token.line, &sentence));
        let called = is(tokens, at.wrapping_sub(1), ".") && !is(tokens, at.wrapping_sub(2), ".");
        let on_float = called || of_type(tokens, at).is_some_and(is_float);
        let on_glam = called || of_type(tokens, at).is_some_and(is_glam);
        if lists(ELEMENTARY, name) && (on_float || on_glam) && is_function(tokens, at, called) {
            complain(format!("std's `{name}` differs between targets; use libm's"));
        }
        if lists(GLAM, name) && on_glam {
            complain(format!("glam's `{name}` calls std's elementary functions"));
        }
        if lists(FUSED, name) || name.contains("_fmadd_") {
            complain(format!("`{name}` rounds once where other targets round twice"));
        }
        if ["min", "max"].contains(&name)
            && (is_float_owner(tokens, at) || (called && takes_float(tokens, at)))
        {
            complain(format!(
                "which zero `{name}` returns is not specified; write `if a < b {{ a }} else {{ b }}`"
            ));
        }
        let excused = || ["order", "result"].iter().any(|word| lines.comment_on(at).contains(word));
        if lists(EXCUSED, name) && !is_import(tokens, at) && !excused() {
            complain(format!("`{name}`: say beside it why no result and no order depends on it"));
        }
        if called && (name.starts_with("par_") || name.starts_with("into_par_")) {
            for step in orderless_steps(tokens, at) {
                complain(format!(
                    "`{name}` … `{step}` depends on where the work was cut; collect in order first"
                ));
            }
        }
    }
    found
}

fn is(tokens: &[Token], at: usize, text: &str) -> bool {
    tokens.get(at).is_some_and(|token| token.is(text))
}

/// The type before the `::` before `tokens[at]`, with or without `<` and `>`.
fn of_type(tokens: &[Token], at: usize) -> Option<&str> {
    if at < 3 || !is(tokens, at - 1, ":") || !is(tokens, at - 2, ":") {
        return None;
    }
    let owner = if is(tokens, at - 3, ">") { at.checked_sub(4)? } else { at - 3 };
    Some(tokens[owner].text.as_str())
}

fn is_float(owner: &str) -> bool {
    owner == "f64" || owner == "f32"
}

fn is_float_owner(tokens: &[Token], at: usize) -> bool {
    of_type(tokens, at).is_some_and(is_float)
}

fn is_glam(owner: &str) -> bool {
    ["DVec", "DMat", "DQuat", "DAffine", "Vec2", "Vec3", "Vec4", "Mat2", "Mat3", "Mat4", "Quat", "Affine"]
        .iter()
        .any(|start| owner.starts_with(start))
}

/// Whether a method named at `tokens[at]` is called, and not a field of that name read; a path needs no call.
fn is_function(tokens: &[Token], at: usize, called: bool) -> bool {
    !called || is(tokens, at + 1, "(") || (is(tokens, at + 1, ":") && is(tokens, at + 2, ":"))
}

/// Whether the call at `tokens[at]` has a number with a point as its whole argument.
fn takes_float(tokens: &[Token], at: usize) -> bool {
    let number = at + 2 + usize::from(is(tokens, at + 2, "-"));
    let float = |token: &Token| {
        let number = token.text.starts_with(|c: char| c.is_ascii_digit()) && !token.text.starts_with("0x");
        token.kind == Kind::Literal && number && token.text.contains(['.', 'e', 'f'])
    };
    is(tokens, at + 1, "(") && tokens.get(number).is_some_and(float) && is(tokens, number + 1, ")")
}

/// Whether the name stands in a `use`, where it is not used yet.
fn is_import(tokens: &[Token], at: usize) -> bool {
    tokens[..at]
        .iter()
        .rev()
        .find(|token| token.is(";") || token.is("use"))
        .is_some_and(|token| token.is("use"))
}

/// The orderless steps of the chain of calls that starts at `tokens[at]`, at its own level only: what a
/// closure inside the chain does with its own part is in order.
fn orderless_steps(tokens: &[Token], at: usize) -> Vec<&str> {
    let mut depth = 0_usize;
    let mut steps = Vec::new();
    for n in at..tokens.len() {
        match tokens[n].kind {
            Kind::Open => depth += 1,
            Kind::Close if depth == 0 => break,
            Kind::Close => depth -= 1,
            _ if depth > 0 => {}
            Kind::Punct if tokens[n].is(";") || tokens[n].is(",") => break,
            Kind::Word if is(tokens, n - 1, ".") && lists(ORDERLESS, &tokens[n].text) => {
                steps.push(tokens[n].text.as_str());
            }
            _ => {}
        }
    }
    steps
}

#[test]
fn result_paths_are_deterministic() {
    let all: Vec<&Source> = RESULT_PATHS.iter().flat_map(|folder| gates::sources(folder)).collect();
    assert!(all.len() > 10, "the sources are there");
    expect_none(&all.into_iter().flat_map(differences).collect::<Vec<_>>());
}

#[test]
fn every_source_of_difference_is_found() {
    for text in [
        "let y = x.sin();",
        "let y = (a + b).cos();",
        "let y = x\n.tan();",
        "let y = 2.0_f64.ln();",
        "let y = x.powf(0.5);",
        "let y = x.powi(3);",
        "let y = a.atan2(b);",
        "let y = a.hypot(b);",
        "let y = x.cbrt();",
        "let (s, c) = x.sin_cos();",
        "let y = f64::exp(x);",
        "let y = <f64>::exp(x);",
        "let y = std::f64::ln(x);",
        "xs.map(f64::sqrt).map(f64::log2);",
        "xs.map(f32::sinh);",
        "let y = v.exp();",
        "let y = DVec3::exp(v);",
        "vec![x.sin()];",
        "let y = format!(\"{}\", x.cos());",
        "let y = a.mul_add(b, c);",
        "let y = f64::mul_add(a, b, c);",
        "let y = libm::fma(a, b, c);",
        "let y = _mm256_fmadd_pd(a, b, c);",
        "let y = a.angle_between(b);",
        "let y = DQuat::from_rotation_z(x);",
        "let y = DMat4::from_axis_angle(a, x);",
        "let y = xs.fold(0.0, f64::max);",
        "let y = x.max(0.0);",
        "let y = x.min(-1.5);",
        "let y: HashMap<u32, u32> = z;",
        "let y = std::collections::HashSet::new();",
        "// It is fast.\nlet y = HashMap::new();",
        "let n = rayon::current_num_threads();",
        "let t = std::time::Instant::now();",
        "let y = x.par_iter().map(f).sum::<f64>();",
        "let y = x.par_chunks(8).map(|c| c.len()).reduce(|| 0, add);",
        "let y = x.into_par_iter().find_any(|x| x > y);",
    ] {
        let source = Source::new("a.rs", &format!("fn f() {{\n{text}\n}}"));
        assert_eq!(differences(&source).len(), 1, "{text}: {:?}", differences(&source));
    }
}

#[test]
fn deterministic_code_is_left_alone() {
    for text in [
        "let y = libm::sin(x) + libm::pow(a, b) + x.sqrt().abs().floor();",
        "use std::collections::HashMap;",
        "// Looked up only; the order of the result is that of the input.\nlet y = HashMap::new();",
        "let y: HashSet<u32> = z; // Its order is never seen.",
        "let y = i.max(1).min(n); let z = a.len().max(b.len());",
        "let y = self.exp + self.log; let r = 0..tan(x);",
        "let y = angle_between(a, b);",
        "let y = x.iter().sum::<f64>(); let z = x.iter().fold(0.0, f);",
        "let y: Vec<f64> = x.par_chunks(8).map(|c| c.iter().sum::<f64>()).collect(); let z = y.iter().sum();",
        "let y = x.clamp(0.0, 1.0).to_radians();",
        "let y = max(0.0, x);",
    ] {
        expect_none(&differences(&Source::new("a.rs", &format!("fn f() {{\n{text}\n}}"))));
    }
    expect_none(&differences(&Source::new(
        "a.rs",
        "#[cfg(test)] mod tests { fn f() { x.sin().max(0.0); } }",
    )));
}
