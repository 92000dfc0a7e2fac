//! Cuts meshes along each other and keeps the pieces that bound the combined solid, with the engines of the
//! crate `manifold-rust`.
use super::BooleanOp;
use super::operand::Operand;
use super::result::BooleanSource;
use crate::budget::{Job, Progress};
use manifold_rust::cancel::CancelToken;
use manifold_rust::manifold::Manifold;
use manifold_rust::progress::ProgressReporter;
use manifold_rust::types::{BooleanEngine, Error, MeshGLP, OpType};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Engines {
    FloatingPoint,
    Rational,
}

/// Why an engine has no result.
#[derive(Debug)]
pub(super) enum EngineFailure {
    Cancelled,
    Failed(String),
}

/// The surface of the combined solid.
pub(super) struct CutSurface {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    /// For each face what it was cut from.
    pub sources: Vec<BooleanSource>,
}

/// Combines operands from left to right.
pub(super) fn combine(
    operands: &[Operand],
    ops: &[BooleanOp],
    engine: Engines,
    job: &Job,
) -> Result<CutSurface, EngineFailure> {
    // The engines answer hostile input with a panic in rare cases, which is no reason to end a program.
    let work = || combine_by_engine(operands, ops, engine, job);
    // On the threads of the job.
    job.run(|| catch_unwind(AssertUnwindSafe(work)))
        .unwrap_or_else(|_| Err(EngineFailure::Failed("the cutting stopped half way".to_owned())))
}

fn combine_by_engine(
    operands: &[Operand],
    ops: &[BooleanOp],
    engine: Engines,
    job: &Job,
) -> Result<CutSurface, EngineFailure> {
    let kind = match engine {
        Engines::FloatingPoint => BooleanEngine::Exact,
        Engines::Rational => BooleanEngine::Robust,
    };
    let mut numbered = (0..).zip(operands);
    let first = numbered.next().map_or_else(|| Ok(Manifold::empty()), |(n, first)| imported(n, first))?;
    if ops.is_empty() || operands.iter().all(|operand| operand.faces.is_empty()) {
        return Ok(exported(&first, operands));
    }
    let others = numbered.map(|(number, operand)| imported(number, operand));
    let made = in_a_row(first, others.zip(ops), kind, (job, &Job::is_cancelled))?;
    Ok(exported(&made, operands))
}

/// Combines solids from left to right until a job says that it is over.
pub(super) fn in_a_row<'a>(
    first: Manifold,
    others: impl Iterator<Item = (Result<Manifold, EngineFailure>, &'a BooleanOp)>,
    kind: BooleanEngine,
    (job, is_over): (&Job, &'static (dyn Fn(&Job) -> bool + Sync)),
) -> Result<Manifold, EngineFailure> {
    let token = CancelToken::new();
    let reporter = {
        let (token, job) = (token.clone(), job.clone());
        ProgressReporter::new(move |_, _| {
            if is_over(&job) {
                token.cancel();
            }
        })
    };
    let mut made = first;
    let total = others.size_hint().0 as u64;
    for (done, (other, op)) in (0..).zip(others) {
        job.report(Progress { stage: "combine", done, total });
        let op = match op {
            BooleanOp::Union => OpType::Add,
            BooleanOp::Difference => OpType::Subtract,
            BooleanOp::Intersection => OpType::Intersect,
        };
        made = made.boolean_with_engine_and_progress(&other?, op, kind, Some(&token), Some(&reporter));
        if is_over(job) || made.status() == Error::Cancelled {
            return Err(EngineFailure::Cancelled);
        }
        succeeded(&made)?;
    }
    Ok(made)
}

pub(super) fn succeeded(made: &Manifold) -> Result<(), EngineFailure> {
    match made.status() {
        Error::NoError => Ok(()),
        error => Err(EngineFailure::Failed(error.to_str().to_lowercase())),
    }
}

/// An operand as the engines take it: each face remembers its row, and that it is of operand `number`.
fn imported(number: u32, operand: &Operand) -> Result<Manifold, EngineFailure> {
    // Fewer than four points or faces enclose nothing.
    if operand.points.len() < 4 || operand.faces.len() < 4 {
        return Ok(Manifold::empty());
    }
    let mesh = MeshGLP::<f64, u32> {
        num_prop: 3,
        vert_properties: operand.points.as_flattened().to_vec(),
        tri_verts: operand.faces.as_flattened().to_vec(),
        run_original_id: vec![number],
        face_id: (0..operand.faces.len() as u32).collect(),
        ..MeshGLP::default()
    };
    let made = Manifold::from_mesh_glp_robust(&mesh);
    succeeded(&made)?;
    Ok(made)
}

fn exported(made: &Manifold, operands: &[Operand]) -> CutSurface {
    let out: MeshGLP<f64, u32> = made.get_mesh_glp(-1);
    let stride = out.num_prop as usize;
    let rows = out.vert_properties.chunks_exact(if stride == 0 { 3 } else { stride });
    let positions = rows.map(|row| [row[0], row[1], row[2]]).collect();
    let faces: Vec<[u32; 3]> = out.tri_verts.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect();
    let mut sources = vec![BooleanSource { operand: 0, face: 0 }; faces.len()];
    for (run, operand) in out.run_original_id.iter().enumerate() {
        let end = out.run_index.get(run + 1).map_or(faces.len(), |end| *end as usize / 3);
        let start = out.run_index.get(run).map_or(0, |start| *start as usize / 3);
        for (source, own) in sources[start..end].iter_mut().zip(&out.face_id[start..end]) {
            let face = operands[*operand as usize].face_of[*own as usize];
            *source = BooleanSource { operand: *operand, face };
        }
    }
    CutSurface { positions, faces, sources }
}
