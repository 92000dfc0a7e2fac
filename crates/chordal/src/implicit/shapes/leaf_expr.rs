//! Leaves whose values are those of an expression, for programs that know only expressions.
use super::axis_distance::{axis_distance_as_root, is_axis_distance};
use super::thread::helix_as_expr;
use crate::implicit::{Expr, Leaf};

/// The value of a leaf as an expression in its own coordinates, the same up to rounding; its ranges may be
/// wider. None for a mesh, samples, a user's function, and shapes that search for their nearest part.
pub(crate) fn leaf_as_expr(leaf: &dyn Leaf) -> Option<Expr> {
    if is_axis_distance(leaf) { Some(axis_distance_as_root()) } else { helix_as_expr(leaf) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::shapes::{ThreadForm, thread};
    use crate::implicit::{ExprGraph, Term};

    #[test]
    fn has_the_values_of_the_leaves_of_a_thread() {
        let form = ThreadForm { diameter: 8.0, pitch: 1.25, clearance: 0.0 };
        let bolt = thread(form, 10.0).expect("a thread");
        let graph = ExprGraph::from_expr(bolt.expr());
        let mut n_leaves = 0;
        for term in graph.terms() {
            let Term::Leaf(leaf, _) = term else { continue };
            n_leaves += 1;
            let expr = leaf_as_expr(&**leaf).expect("an expression");
            for k in 0..500 {
                let p = [0.37, 0.61, 0.83].map(|step| 10.0 * ((k as f64 * step) % 1.0) - 5.0);
                let mut value = [0.0];
                leaf.at(&[p], &mut value).expect("a value");
                let same = expr.at(p).expect("a value");
                // Far more than the rounding of numbers below 10, far less than any wrong term.
                assert!((value[0] - same).abs() < 1e-9, "{leaf:?} at {p:?}: {} and {same}", value[0]);
            }
        }
        assert_eq!(n_leaves, 3);
    }
}
