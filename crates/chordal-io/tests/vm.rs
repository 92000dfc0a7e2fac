//! Op lists: the models that come with fidget, every operation, and what is refused, with its line and
//! column.
use chordal::budget::Evidence;
use chordal::implicit::evaluation::{Binary, Unary};
use chordal::implicit::{Distance, Field};
use chordal_io::{Content, Format, Limits, ReadError, read, vm};
use chordal_testkit::corpus;

fn load(text: &str) -> Result<Field, ReadError> {
    match read(text.as_bytes(), Format::Vm, &Limits::default())?.content {
        Content::Field { field, region, .. } => {
            assert_eq!(region, Some(vm::REGION));
            Ok(field)
        }
        other => panic!("{other:?}"),
    }
}

fn value(field: &Field, p: [f64; 3]) -> f64 {
    let mut out = [0.0];
    field.tape().at(&[p], &mut out).unwrap();
    out[0]
}

#[test]
fn the_models_of_fidget_have_their_shapes() {
    let Some(folder) = corpus::find("implicit/fidget/models") else { return };
    let model = |name: &str| {
        let bytes = std::fs::read(folder.join(name).with_extension("vm")).unwrap();
        assert_eq!(Format::sniff(&bytes), Some(Format::Vm), "{name}");
        load(std::str::from_utf8(&bytes).unwrap()).unwrap()
    };
    let quarter = model("quarter");
    // A quarter of the disc of radius √½, at the lower left.
    assert_eq!(value(&quarter, [-0.25, -0.5, 7.0]), -0.1875);
    assert!(value(&quarter, [0.1, -0.5, 0.0]) > 0.0 && value(&quarter, [-0.6, -0.6, 0.0]) > 0.0);
    assert_eq!(quarter.tape().axes(), [true, true, false]);
    let tangle = model("tanglecube");
    let f = |t: f64| t * t * t * t - 5.0 * t * t;
    assert_eq!(value(&tangle, [1.5, -0.5, 0.25]), f(1.5) + f(0.5) + f(0.25) + 10.0);
    assert_eq!(tangle.tape().axes(), [true; 3]);
    assert_eq!(tangle.distance(), Distance::SIGN);
    let prospero = model("prospero");
    assert_eq!(prospero.tape().axes(), [true, true, false]);
    // Some of it is ink, most is paper.
    let at = |k: i32| -0.95 + 0.02 * f64::from(k);
    let places: Vec<[f64; 3]> = (0..95 * 95).map(|k| [at(k % 95), at(k / 95), 0.0]).collect();
    let mut values = vec![0.0; places.len()];
    prospero.tape().at(&places, &mut values).unwrap();
    let inked = values.iter().filter(|v| **v < 0.0).count();
    assert!((300..3000).contains(&inked), "{inked}");
    let _ = (model("bear"), model("hi"));
    assert_eq!(prospero.tape().evidence(), Evidence::Proved);
}

/// The bits of a number; no number has one pattern here, since the sign of a NaN is the machine's.
fn bits(x: f64) -> u64 {
    if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
}

#[test]
fn every_operation_has_its_name() {
    for (op, name) in Unary::ALL {
        let field = load(&format!("x var-x\nv {name} x\n")).unwrap();
        for x in [-1.5, 0.0, 0.25, 3.0] {
            assert_eq!(bits(value(&field, [x, 9.0, 9.0])), bits(op.apply(x)), "{name} {x}");
        }
    }
    for (op, name) in Binary::ALL {
        let field = load(&format!("x var-x\ny var-y\nv {name} x y\n")).unwrap();
        for (x, y) in [(-1.5, 0.5), (0.5, -1.5), (0.0, 2.0), (2.0, 2.0)] {
            assert_eq!(bits(value(&field, [x, y, 9.0])), bits(op.apply(x, y)), "{name} {x} {y}");
        }
    }
}

#[test]
fn comments_blank_lines_and_line_ends_of_any_kind_are_fine() {
    let field = load("# one\r\n\r\n  a var-z # two\r\n#\n\tb   neg\ta").unwrap();
    assert_eq!(value(&field, [0.0, 0.0, 2.5]), -2.5);
}

#[test]
fn steps_that_nothing_uses_are_counted() {
    let loaded = read(b"a var-x\nb var-y\nc const 1\nd neg a\n", Format::Vm, &Limits::default()).unwrap();
    let [warning] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
    assert_eq!((warning.code, warning.count), ("unused-steps", 2));
    assert_eq!(warning.place.to_string(), "line 2");
}

#[test]
fn what_is_refused_says_where_and_why() {
    for (text, code, message) in [
        ("# nothing\n\n", "empty", "there is no step: no line is 'name op argument…'"),
        (
            "a var-x\nb",
            "argument-count",
            "line 2, column 2: the line ends before an operation after the name",
        ),
        ("a  var-w\n", "unknown-operation", "line 1, column 4: 'var-w' is no operation"),
        ("é SIN x\n", "unknown-operation", "line 1, column 3: 'SIN' is no operation"),
        (
            "a var-x\nb sin\n",
            "argument-count",
            "line 2, column 6: the line ends before the arguments of 'sin'",
        ),
        (
            "a var-x\nb add a # a",
            "argument-count",
            "line 2, column 8: the line ends before the arguments of 'add'",
        ),
        ("a var-x\nb sin a a\n", "argument-count", "line 2, column 9: 'a' is one argument too many"),
        ("a var-x x\n", "argument-count", "line 1, column 9: 'x' is one argument too many"),
        ("a const\n", "argument-count", "line 1, column 8: the line ends before a number after 'const'"),
        (
            "a const 1,5\n",
            "not-a-number",
            "line 1, column 9: '1,5' is not a number; a decimal comma must be a point, as in 1.5",
        ),
        (
            "a const nan\n",
            "not-finite",
            "line 1, column 9: number 'nan' is not finite, or over the limit of 1.8e308",
        ),
        ("a neg b\nb var-x\n", "unknown-name", "line 1, column 7: 'b' is no name of an earlier line"),
        ("a neg a\n", "unknown-name", "line 1, column 7: 'a' is no name of an earlier line"),
        ("a var-x\nb neg a\na neg b\n", "name-twice", "line 3, column 1: 'a' is the name of line 1 already"),
    ] {
        let error = load(text).unwrap_err();
        assert_eq!((error.code, error.to_string().as_str()), (code, message), "{text:?}");
    }
    let limits = Limits { rows: 2, ..Limits::default() };
    let error = read(b"a var-x\nb neg a\nc neg b\n", Format::Vm, &limits).unwrap_err();
    assert_eq!(error.to_string(), "line 3, column 1: more steps than the limit of 2");
}

#[test]
fn long_chains_and_much_sharing_are_no_problem() {
    let mut chain = "s0 var-x\n".to_owned();
    (0..200_000).for_each(|k| chain += &format!("s{} sqrt s{k}\n", k + 1));
    assert_eq!(load(&chain).unwrap().tape().len(), 200_001);
    // 2^200 times x, were it written out.
    let mut doubled = "s0 var-x\n".to_owned();
    (0..200).for_each(|k| doubled += &format!("s{} add s{k} s{k}\n", k + 1));
    assert_eq!(value(&load(&doubled).unwrap(), [1.0, 0.0, 0.0]), 2.0_f64.powi(200));
}
