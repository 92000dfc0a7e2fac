//! The digest of a field that is a formula: the digest of its terms, since it has no file.
use super::digest::Sha256Stream;
use crate::ImplicitShape;
use chordal::implicit::Expr;
use chordal::implicit::evaluation::{ExprGraph, Term};

/// The SHA-256 of the terms of a field, of its bodies and of its region; `None` if it calls a user's function, of which only
/// values are known.
pub(crate) fn field_digest(implicit: &ImplicitShape) -> Option<String> {
    let mut digest = Sha256Stream::new("field");
    add_terms(&mut digest, implicit.field.expr())?;
    add_terms(&mut digest, implicit.field.sign())?;
    for body in &implicit.bodies {
        add_terms(&mut digest, body.field.expr())?;
    }
    if let Some(region) = implicit.region {
        digest.add(&[region.min, region.max].concat().into_iter().map(f64::to_bits).collect::<Vec<_>>());
    }
    Some(digest.finish())
}

fn add_terms(digest: &mut Sha256Stream, expr: &Expr) -> Option<()> {
    let graph = ExprGraph::from_expr(expr);
    // Several expressions follow each other in one digest: the number of terms says where one ends.
    digest.add(&[graph.terms().len() as u64]);
    for term in graph.terms() {
        match term {
            Term::Const(number) => digest.add(&[0, number.to_bits()]),
            Term::Axis(axis) => digest.add(&[1, u64::from(*axis)]),
            Term::Unary(op, a) => add_operation(digest, &format!("{op:?}"), &[*a]),
            Term::Binary(op, a, b) => add_operation(digest, &format!("{op:?}"), &[*a, *b]),
            Term::Leaf(..) => return None,
        }
    }
    Some(())
}

fn add_operation(digest: &mut Sha256Stream, name: &str, operands: &[u32]) {
    // By its name: a number would depend on the order of operations in the source, and the digest is in files.
    digest.add(&name.bytes().map(u64::from).collect::<Vec<_>>());
    digest.add(&operands.iter().map(|at| u64::from(*at)).collect::<Vec<_>>());
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::implicit::Field;
    use chordal_io::Frame;

    fn digest_of(expr: Expr) -> Option<String> {
        field_digest(&ImplicitShape::new(Field::new(expr), None, Frame::default()))
    }

    #[test]
    fn another_number_or_operation_is_another_field() {
        let [x, y, _] = Expr::axes();
        let one = || x.square() + y.square() - 1.0;
        assert_eq!(digest_of(one()), digest_of(one()));
        let others =
            [x.square() + y.square() - 2.0, x.square() - y.square() - 1.0, x.abs() + y.square() - 1.0];
        for other in others {
            assert_ne!(digest_of(one()), digest_of(other));
        }
    }
}
