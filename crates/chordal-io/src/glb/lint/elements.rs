//! Rules for the data of accessors: bounds, unit vectors, indices, times.
use super::GltfLint;
use super::buffers::{AccessorConstraint, UseTable};
use super::nodes::{is_unit, to_single};
use crate::glb::accessor_rows::AccessorRows;
use crate::glb::format::ComponentType;
use crate::glb::model::{GltfAccessor, GltfModel, GltfPrimitive, item};
use chordal::math::{greater, lesser};
use std::collections::{BTreeMap, BTreeSet};

/// How far the length of a vector may be from 1. Defined by the validator, for vectors of bytes.
const UNIT_VECTOR: f64 = 0.00674;
/// The same for quaternions.
const UNIT_QUATERNION: f64 = 0.00769;
/// How far the sum of weights may be from 1, per weight. Defined by the validator.
const WEIGHT_STEP: f64 = 2e-7;

impl<'a> GltfLint<'a> {
    /// Decodes each accessor once and checks it against its declared bounds and its constraints.
    pub(super) fn check_elements(&mut self, model: &GltfModel<'a>, uses: &UseTable) {
        let mut constraints: Vec<&(usize, AccessorConstraint, String)> = uses.constraints.iter().collect();
        constraints.sort_by_key(|(accessor, ..)| *accessor);
        for (i, accessor) in model.accessors.iter().enumerate() {
            let Some(accessor) = accessor else { continue };
            let first = constraints.partition_point(|(a, ..)| *a < i);
            let accessor_constraints = &constraints[first..constraints.partition_point(|(a, ..)| *a <= i)];
            // Rows without data are zeros; the validator does not check them.
            if accessor.view.is_none() && accessor.sparse.is_none() {
                continue;
            }
            // Only rows in single precision can hold NaN or infinities, so others are read only if
            // something is claimed about them.
            let asks = accessor.min.is_some() || accessor.max.is_some() || !accessor_constraints.is_empty();
            if !asks && accessor.component != Some(ComponentType::F32) && accessor.sparse.is_none() {
                continue;
            }
            let Ok(rows) = AccessorRows::new(model, i) else { continue };
            let mut is_seen = false;
            self.within_path(&["accessors".into(), i.into()], |lint| {
                is_seen = lint.charge(rows.n_bytes());
                if !is_seen {
                    return;
                }
                lint.check_sparse_rows(&rows);
                lint.check_numbers(accessor, &rows);
            });
            if is_seen {
                self.check_constraints(accessor_constraints, &rows);
            }
        }
    }

    fn check_sparse_rows(&mut self, rows: &AccessorRows<'_>) {
        let mut last = None;
        for (i, index) in rows.sparse_indices().enumerate() {
            if last.is_some_and(|last| index <= last) {
                let what = format!("index {i} is {index}, not above the one before");
                self.issue("ACCESSOR_SPARSE_INDICES_NON_INCREASING", Some("sparse".into()), || what);
            }
            if index >= rows.count {
                let what = format!("index {i} is {index}, there are {} rows", rows.count);
                self.issue("ACCESSOR_SPARSE_INDEX_OOB", Some("sparse".into()), || what);
            }
            last = Some(index);
        }
    }

    fn check_numbers(&mut self, accessor: &GltfAccessor, rows: &AccessorRows<'_>) {
        let has_bounds = accessor.min.is_some() || accessor.max.is_some();
        if !has_bounds && rows.format.component != ComponentType::F32 {
            return;
        }
        let n = rows.format.kind.n_components();
        let mut least = vec![f64::INFINITY; n];
        let mut greatest = vec![f64::NEG_INFINITY; n];
        let mut not_finite = None;
        rows.each_block(|first, numbers| {
            // Without an early exit, many numbers are checked at once; the place is looked up only
            // if it is needed.
            let are_finite = numbers.iter().fold(true, |all, x| all & x.is_finite());
            if !are_finite && not_finite.is_none() {
                let position = numbers.iter().position(|x| !x.is_finite());
                not_finite = position.map(|at| (first + (at / n) as u64, numbers[at]));
            }
            if !has_bounds {
                return;
            }
            for row in numbers.chunks_exact(n) {
                for ((x, least), greatest) in row.iter().zip(&mut least).zip(&mut greatest) {
                    *least = lesser(*x, *least);
                    *greatest = greater(*x, *greatest);
                }
            }
        });
        if let Some((i, x)) = not_finite {
            self.issue("ACCESSOR_INVALID_FLOAT", None, || format!("row {i} holds {x}"));
            return;
        }
        let sides = [
            ("min", &accessor.min, &least, "ACCESSOR_MIN_MISMATCH"),
            ("max", &accessor.max, &greatest, "ACCESSOR_MAX_MISMATCH"),
        ];
        for (key, declared, actual, code) in sides {
            for (k, (said, found)) in declared.iter().flatten().zip(actual).enumerate() {
                if said != found {
                    let what = format!("{key} is declared as {said} and is {found}");
                    self.within(key, |lint| lint.issue(code, Some(k.into()), || what));
                }
            }
        }
    }

    fn check_constraints(
        &mut self,
        constraints: &[&(usize, AccessorConstraint, String)],
        rows: &AccessorRows<'_>,
    ) {
        let mut seen: Vec<&AccessorConstraint> = Vec::new();
        // The lowest of several limits on indices applies.
        let lowest = constraints
            .iter()
            .filter_map(|(_, constraint, pointer)| match constraint {
                AccessorConstraint::IndicesBelow(limit) => Some((*limit, pointer)),
                _ => None,
            })
            .min_by_key(|(limit, _)| *limit);
        if let Some((limit, pointer)) = lowest {
            self.check_indices(rows, limit, pointer);
        }
        for (_, constraint, pointer) in constraints {
            if matches!(constraint, AccessorConstraint::IndicesBelow(_)) || seen.contains(&constraint) {
                continue;
            }
            seen.push(constraint);
            let mut meaning = [0.0; 16];
            rows.each(|i, row| {
                meaning.iter_mut().zip(row).for_each(|(x, raw)| *x = rows.decode(*raw));
                self.check_row(constraint, i, &meaning[..row.len()], pointer);
            });
            if *constraint == AccessorConstraint::Times {
                self.check_times(rows, pointer);
            }
        }
    }

    fn check_row(&mut self, constraint: &AccessorConstraint, i: u64, row: &[f64], pointer: &str) {
        match constraint {
            AccessorConstraint::UnitVectors | AccessorConstraint::UnitVectorsWithSign => {
                let (vector, sign) = row.split_at(row.len().min(3));
                if !is_unit(vector, UNIT_VECTOR) {
                    self.issue_at("ACCESSOR_VECTOR3_NON_UNIT", pointer, || {
                        format!("row {i} is not of unit length")
                    });
                }
                if *constraint == AccessorConstraint::UnitVectorsWithSign
                    && sign.iter().any(|w| w.abs() != 1.0)
                {
                    self.issue_at("ACCESSOR_INVALID_SIGN", pointer, || {
                        format!("the sign of row {i} is not 1 or -1")
                    });
                }
            }
            AccessorConstraint::Clamped => {
                if row.iter().any(|x| *x < 0.0 || *x > 1.0) {
                    self.issue_at("ACCESSOR_NON_CLAMPED", pointer, || format!("row {i} is outside 0 to 1"));
                }
            }
            AccessorConstraint::Quaternions { cubic } => {
                // In a cubic spline only the second of three rows is a value.
                if (!cubic || i % 3 == 1) && !is_unit(row, UNIT_QUATERNION) {
                    let code = "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION";
                    self.issue_at(code, pointer, || format!("row {i} is no unit quaternion"));
                }
            }
            AccessorConstraint::BindMatrices => {
                if [row[3], row[7], row[11], row[15]] != [0.0, 0.0, 0.0, 1.0] {
                    self.issue_at("ACCESSOR_INVALID_IBM", pointer, || {
                        format!("matrix {i} has a perspective row")
                    });
                }
            }
            AccessorConstraint::IndicesBelow(_) | AccessorConstraint::Times => {}
        }
    }

    fn check_times(&mut self, rows: &AccessorRows<'_>, pointer: &str) {
        let mut last = 0.0;
        rows.each(|i, row| {
            if row[0] < 0.0 {
                self.issue_at("ACCESSOR_ANIMATION_INPUT_NEGATIVE", pointer, || {
                    format!("time {i} is {}", row[0])
                });
                return;
            }
            if i != 0 && row[0] <= last {
                let code = "ACCESSOR_ANIMATION_INPUT_NON_INCREASING";
                self.issue_at(code, pointer, || format!("time {i} is {}, not above {last}", row[0]));
            }
            last = row[0];
        });
    }

    fn check_indices(&mut self, rows: &AccessorRows<'_>, limit: u64, pointer: &str) {
        let restart = rows.format.component.range().1;
        let highest = limit as f64;
        let is_wrong = |index: f64| index >= highest || index == restart;
        rows.each_block(|first, indices| {
            if !indices.iter().fold(false, |any, index| any | is_wrong(*index)) {
                return;
            }
            for (i, index) in (first..).zip(indices) {
                if *index >= highest {
                    self.issue_at("ACCESSOR_INDEX_OOB", pointer, || {
                        format!("index {i} is {index}, there are {limit} vertices")
                    });
                }
                if *index == restart {
                    let code = "ACCESSOR_INDEX_PRIMITIVE_RESTART";
                    self.issue_at(code, pointer, || {
                        format!("index {i} is {restart}, which means \"restart\"")
                    });
                }
            }
        });
    }

    /// Checks the joints and weights of skinned meshes.
    pub(super) fn check_influences(&mut self, model: &GltfModel<'a>) {
        let mut n_joints = vec![None::<u64>; model.meshes.len()];
        let mut seen = BTreeSet::new();
        for node in model.nodes.iter().flatten() {
            let joints = item(&model.skins, node.skin()).and_then(|skin| skin.joints.as_ref());
            let (Some(joints), Some(slot)) = (joints, node.mesh.and_then(|mesh| n_joints.get_mut(mesh)))
            else {
                continue;
            };
            let n = joints.len() as u64;
            *slot = Some(slot.map_or(n, |least| least.min(n)));
        }
        for (m, mesh) in model.meshes.iter().enumerate() {
            let (Some(mesh), Some(limit)) = (mesh, n_joints[m].filter(|n| *n > 0)) else { continue };
            for (p, primitive) in mesh.primitives.iter().enumerate() {
                // Vertices shared by several primitives are checked once.
                let is_influence = |name: &str| name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
                let key: Vec<_> =
                    primitive.attributes.iter().filter(|(name, _)| is_influence(name)).collect();
                if !seen.insert((limit, key)) {
                    continue;
                }
                let path = ["meshes".into(), m.into(), "primitives".into(), p.into(), "attributes".into()];
                self.within_path(&path, |lint| lint.check_joints(model, primitive, limit));
            }
        }
    }

    fn check_joints(&mut self, model: &GltfModel<'a>, primitive: &GltfPrimitive<'a>, limit: u64) {
        let named: BTreeMap<&str, Option<usize>> = primitive.attributes.iter().copied().collect();
        let count = primitive.attributes.iter().find_map(|(_, a)| item(&model.accessors, *a));
        let count = count.and_then(|accessor| accessor.count);
        let mut sets = Vec::new();
        for set in 0..primitive.n_joints {
            let rows = |name: String| AccessorRows::new(model, named.get(&*name).copied().flatten()?).ok();
            let (Some(joints), Some(weights)) =
                (rows(format!("JOINTS_{set}")), rows(format!("WEIGHTS_{set}")))
            else {
                return;
            };
            if Some(joints.count) != count
                || Some(weights.count) != count
                || !joints.has_data()
                || !weights.has_data()
            {
                return;
            }
            sets.push((joints, weights));
        }
        let Some(count) = count.filter(|_| !sets.is_empty()) else { return };
        let n_bytes = sets.iter().map(|(joints, weights)| joints.n_bytes().saturating_add(weights.n_bytes()));
        if !self.charge(n_bytes.fold(0, u64::saturating_add)) {
            return;
        }
        for vertex in 0..count {
            self.check_vertex(&sets, vertex, limit);
        }
    }

    fn check_vertex(&mut self, sets: &[(AccessorRows<'_>, AccessorRows<'_>)], vertex: u64, limit: u64) {
        let mut used = Vec::with_capacity(4 * sets.len());
        let (mut sum, mut tolerance) = (0.0, 0.0);
        for k in 0..4 {
            for (set, (joints, weights)) in sets.iter().enumerate() {
                let (joint, weight) = (joints.number(vertex, k), weights.normalized(vertex, k));
                if joint >= limit as f64 {
                    let what = format!("vertex {vertex} names joint {joint} of {limit}");
                    self.issue_at_set("ACCESSOR_JOINTS_INDEX_OOB", "JOINTS", set, what);
                    continue;
                }
                if weight == 0.0 {
                    continue;
                }
                let is_new = !used.contains(&joint);
                if !is_new {
                    let what = format!("vertex {vertex} names joint {joint} twice");
                    self.issue_at_set("ACCESSOR_JOINTS_INDEX_DUPLICATE", "JOINTS", set, what);
                }
                used.push(joint);
                if weight < 0.0 {
                    let what = format!("vertex {vertex} has weight {weight}");
                    self.issue_at_set("ACCESSOR_WEIGHTS_NEGATIVE", "WEIGHTS", set, what);
                } else if is_new {
                    sum = to_single(sum + weight);
                    tolerance += WEIGHT_STEP;
                }
            }
        }
        if (sum - 1.0).abs() > tolerance {
            let what = format!("vertex {vertex} has weights of sum {sum}");
            self.issue_at_set("ACCESSOR_WEIGHTS_NON_NORMALIZED", "WEIGHTS", 0, what);
        }
    }

    /// Reports an issue with a set of joints or weights.
    fn issue_at_set(&mut self, code: &'static str, family: &str, set: usize, what: String) {
        self.issue(code, Some(format!("{family}_{set}").as_str().into()), || what);
    }
}
