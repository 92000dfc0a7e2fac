//! Cuts meshes along each other and keeps the pieces that bound the combined solid, with the engines of the
//! crate `manifold-rust`.
use super::BooleanOp;
use super::operand::{BooleanSource, Operand};
use crate::budget::{Job, Progress};
use manifold_rust::cancel::CancelToken;
use manifold_rust::manifold::Manifold;
use manifold_rust::progress::ProgressReporter;
use manifold_rust::types::{BooleanEngine, Error, MeshGLP, OpType};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The engine that cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Engine {
    FloatingPoint,
    Rational,
}

/// The reason why an engine has no result.
#[derive(Debug)]
pub(super) enum EngineFailure {
    Cancelled,
    Failed(String),
}

/// The surface of the combined solid.
pub(super) struct CutSurface {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    /// For each face, the face from which it was cut.
    pub sources: Vec<BooleanSource>,
}

/// Combines operands from left to right.
pub(super) fn combine(
    operands: &[Operand],
    ops: &[BooleanOp],
    engine: Engine,
    job: &Job,
) -> Result<CutSurface, EngineFailure> {
    // In rare cases the engines panic on malformed input, which must not end the program.
    let work = || combine_by_engine(operands, ops, engine, job);
    // On the threads of the job.
    job.run(|| catch_unwind(AssertUnwindSafe(work)))
        .unwrap_or_else(|_| Err(EngineFailure::Failed("the cutting stopped half way".to_owned())))
}

fn combine_by_engine(
    operands: &[Operand],
    ops: &[BooleanOp],
    engine: Engine,
    job: &Job,
) -> Result<CutSurface, EngineFailure> {
    // `manifold-rust` calls its floating-point engine exact.
    let kind = match engine {
        Engine::FloatingPoint => BooleanEngine::Exact,
        Engine::Rational => BooleanEngine::Robust,
    };
    let mut numbered = (0..).zip(operands);
    let first = numbered.next().map_or_else(|| Ok(Manifold::empty()), |(n, first)| imported(n, first))?;
    if ops.is_empty() || operands.iter().all(|operand| operand.faces.is_empty()) {
        return Ok(exported(&first, operands));
    }
    let others = numbered.map(|(number, operand)| imported(number, operand));
    let combined = combine_in_order(first, others.zip(ops), kind, (job, &Job::is_cancelled))?;
    Ok(exported(&combined, operands))
}

/// Combines solids from left to right until `is_over`.
pub(super) fn combine_in_order<'a>(
    first: Manifold,
    others: impl Iterator<Item = (Result<Manifold, EngineFailure>, &'a BooleanOp)>,
    kind: BooleanEngine,
    (job, is_over): (&Job, &'static (dyn Fn(&Job) -> bool + Sync)),
) -> Result<Manifold, EngineFailure> {
    let token = CancelToken::new();
    // The engine looks at the token, and only its reports of progress are moments at which the job
    // can be asked.
    let reporter = {
        let (token, job) = (token.clone(), job.clone());
        ProgressReporter::new(move |_, _| {
            if is_over(&job) {
                token.cancel();
            }
        })
    };
    let mut combined = first;
    let total = others.size_hint().0 as u64;
    for (done, (other, op)) in (0..).zip(others) {
        job.report(Progress { stage: "combine", done, total });
        let op = match op {
            BooleanOp::Union => OpType::Add,
            BooleanOp::Difference => OpType::Subtract,
            BooleanOp::Intersection => OpType::Intersect,
        };
        combined =
            combined.boolean_with_engine_and_progress(&other?, op, kind, Some(&token), Some(&reporter));
        // Asked once more, since a small solid may be done before its first report. The engine
        // returns a solid in any case; whether it is whole is in its status.
        if is_over(job) || combined.status() == Error::Cancelled {
            return Err(EngineFailure::Cancelled);
        }
        check_status(&combined)?;
    }
    Ok(combined)
}

pub(super) fn check_status(result: &Manifold) -> Result<(), EngineFailure> {
    match result.status() {
        Error::NoError => Ok(()),
        error => Err(EngineFailure::Failed(error.to_str().to_lowercase())),
    }
}

/// An operand in the engines' form: each face carries its row and the operand's `number`.
fn imported(number: u32, operand: &Operand) -> Result<Manifold, EngineFailure> {
    // With fewer than four points or faces nothing is enclosed.
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
    let imported_solid = Manifold::from_mesh_glp_robust(&mesh);
    check_status(&imported_solid)?;
    Ok(imported_solid)
}

fn exported(solid: &Manifold, operands: &[Operand]) -> CutSurface {
    let arrays: MeshGLP<f64, u32> = solid.get_mesh_glp(-1);
    let stride = arrays.num_prop as usize;
    let rows = arrays.vert_properties.chunks_exact(if stride == 0 { 3 } else { stride });
    let positions = rows.map(|row| [row[0], row[1], row[2]]).collect();
    let faces: Vec<[u32; 3]> = arrays.tri_verts.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect();
    let mut sources = vec![BooleanSource { operand: 0, face: 0 }; faces.len()];
    for (run, operand) in arrays.run_original_id.iter().enumerate() {
        // A run is a stretch of triangles from one operand. Its ends count corners, not triangles.
        let end = arrays.run_index.get(run + 1).map_or(faces.len(), |end| *end as usize / 3);
        let start = arrays.run_index.get(run).map_or(0, |start| *start as usize / 3);
        for (source, face_row) in sources[start..end].iter_mut().zip(&arrays.face_id[start..end]) {
            let face = operands[*operand as usize].face_of[*face_row as usize];
            *source = BooleanSource { operand: *operand, face };
        }
    }
    CutSurface { positions, faces, sources }
}
