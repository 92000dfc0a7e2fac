//! `chain`: a shape as levels with growing errors and fewer triangles, each with its own bound.
use super::reduction::ReductionStats;
use super::simplified_mesh::SimplifiedMesh;
use super::simplify::{ProgressiveSimplifier, SimplifyInput};
use super::zero_area::ZeroAreaFaces;
use crate::budget::{
    AttributeLimits, Bound, Bounded, ErrorLimit, Evidence, Job, JobError, Message, Reference, Refusal,
    RefusalCode, Tolerance,
};
use crate::check::findings::AttributeDeviation;
use crate::explicit::{Mesh, Topology};
use crate::math::{greater, sub_down};
use std::borrow::Cow;

/// One level of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct LodLevel {
    /// The triangles.
    pub mesh: Mesh,
    /// The distance of the triangles from the true shape: proved.
    pub bound: Bound,
    /// Parts that could not be collapsed, and parts that were dropped.
    pub stats: ReductionStats,
    /// The deviation of attributes from those of the original, measured if the steps limit them.
    pub attributes: Vec<AttributeDeviation>,
}

impl LodLevel {
    /// The proved error.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.bound.at_most().unwrap_or(f64::INFINITY)
    }
}

/// A shape from which levels are built.
pub enum LodSource<'a> {
    /// Triangles, which are the true shape.
    Triangles(&'a Mesh, Topology),
    /// A smooth shape: a function that builds triangles within a length of it, with a proof.
    Smooth(&'a mut dyn FnMut(Tolerance) -> Result<Bounded<Mesh>, JobError>),
}

/// The levels to build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LodSteps {
    /// The tolerance of the finest level.
    pub finest: Tolerance,
    /// The ratio of the errors of successive levels, > 1. 2 halves the triangles of a smooth surface.
    pub factor: f64,
    /// A level with at most this many triangles is the last one.
    pub stop_at_triangles: usize,
    /// If the finest level has more triangles than this, it is the only level: [`tree`](super::tiling::tree)
    /// can split it in space and build coarser levels of it.
    pub max_untiled_triangles: usize,
    /// The fraction of the finest error that tessellating a smooth shape may use, between 0 and 1.
    /// Simplification gets the rest and makes better use of it.
    pub tessellation_share: f64,
    /// The limits of the attributes' deviation from those of the original, for every level.
    pub attributes: AttributeLimits,
}

impl LodSteps {
    /// Levels from `finest` on, each twice as coarse, until 64 triangles or fewer, without a size limit.
    /// Tessellation of a smooth shape gets half of the finest error.
    #[must_use]
    pub fn from_finest(finest: Tolerance) -> Self {
        Self {
            finest,
            factor: 2.0,
            stop_at_triangles: 64,
            max_untiled_triangles: usize::MAX,
            tessellation_share: 0.5,
            attributes: AttributeLimits::default(),
        }
    }
}

/// A level is dropped if it has more than this fraction of the triangles of the previous one. Chosen: a
/// larger value keeps levels that save little.
const WORTH_IT: f64 = 0.8;
/// The largest number of levels: 2⁴⁸ between the finest and the coarsest error.
const MOST_STEPS: u32 = 48;

/// Levels of a shape, the finest first. Errors grow strictly from level to level, and triangles become fewer.
///
/// A smooth shape is tessellated once, within a fraction of the finest error, and its triangles are
/// simplified; the two proofs are added. Simplification continues from level to level, so all levels together
/// take little longer than the coarsest alone. The error of each level is measured and proved against the
/// initial triangles, never against the previous level. The first level is within `steps.finest`; if a source
/// does not reach that, it is the source's result. The chain ends once `steps.stop_at_triangles` triangles
/// are left, or once the error is the extent of the shape: at a distance where that error is one pixel, the
/// shape is one pixel, too.
///
/// Cost: that of one [`simplify`](super::simplify()) for the finest level, and for each further level 0.7 µs
/// a triangle of the original on smooth shapes, up to 5 µs on noisy ones; for a smooth shape also its
/// tessellation.
///
/// # Errors
/// As for [`simplify`](super::simplify()), and those of the source; [`RefusalCode::Budget`] for a factor that
/// is not larger than 1 and for an invalid share; [`RefusalCode::Unsupported`] if a source gives triangles
/// without an upper bound.
///
/// ```
/// use chordal::{Job, Mesh, Tolerance, explicit::Topology, lod::{LodSource, LodSteps, chain}};
/// // A roof over a square of 32 × 32 cells.
/// let at = |i: u32, j: u32| [f64::from(i), f64::from(j), 16.0 - (f64::from(i) - 16.0).powi(2) / 16.0];
/// let positions = (0..33).flat_map(|i| (0..33).map(move |j| at(i, j))).collect();
/// let cell = |i: u32, j: u32| { let a = 33 * i + j; [[a, a + 33, a + 34], [a, a + 34, a + 1]] };
/// let roof = Mesh::new(positions, (0..32).flat_map(|i| (0..32).flat_map(move |j| cell(i, j))).collect())?;
/// let source = LodSource::Triangles(&roof, Topology::Indices);
/// let steps = LodSteps { stop_at_triangles: 4, ..LodSteps::from_finest(Tolerance::new(0.1)?) };
/// let levels = chain(source, &steps, &Job::default()).expect("proved");
/// assert!(levels.len() > 3 && levels[0].error() <= 0.1);
/// assert!(levels.windows(2).all(|w| w[0].error() < w[1].error()));
/// assert!(levels.windows(2).all(|w| w[0].mesh.faces().len() > w[1].mesh.faces().len()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn chain(mut source: LodSource<'_>, steps: &LodSteps, job: &Job) -> Result<Vec<LodLevel>, JobError> {
    if steps.factor.is_nan() || steps.factor <= 1.0 {
        return refuse(
            RefusalCode::Budget,
            format!("the factor between errors is larger than 1, not {}", steps.factor),
        );
    }
    if !(steps.tessellation_share > 0.0 && steps.tessellation_share < 1.0) {
        let message = format!(
            "the share of the error for the triangles of a smooth shape is between 0 and 1, not {}",
            steps.tessellation_share
        );
        return refuse(RefusalCode::Budget, message);
    }
    let (finest, topology): (Bounded<Cow<'_, Mesh>>, Topology) = match &mut source {
        LodSource::Triangles(mesh, topology) => {
            let bound = Bound::proved(0.0, 0.0, Reference::InputTriangles);
            (Bounded { shape: Cow::Borrowed(*mesh), bound }, *topology)
        }
        LodSource::Smooth(make) => {
            let share = Tolerance::new(steps.finest.get() * steps.tessellation_share).unwrap_or(steps.finest);
            (make(share)?.map(Cow::Owned), Topology::Indices)
        }
    };
    if finest.bound.at_most().is_none() {
        return refuse(RefusalCode::Unsupported, needs_a_proof("levels", &finest.bound));
    }
    let used = finest.bound.at_most().unwrap_or(f64::INFINITY);
    let mesh: &Mesh = &finest.shape;
    let is_smooth = matches!(source, LodSource::Smooth(_));
    if mesh.faces().is_empty() {
        return refuse(RefusalCode::Empty, "there is no triangle to simplify");
    }
    job.run(|| {
        let aside = ZeroAreaFaces::set_aside(mesh, topology);
        let input = SimplifyInput {
            mesh: aside.as_ref().map_or(mesh, |faces| &faces.rest),
            topology,
            fixed_rows: &[],
            limit: ErrorLimit::uniform(steps.finest.get()),
            attributes: steps.attributes,
            job,
        };
        let mut progress = ProgressiveSimplifier::new(&input)?;
        let mut levels: Vec<LodLevel> = Vec::new();
        let mut error = steps.finest;
        let extent = mesh.bounds().diagonal();
        for _ in 0..MOST_STEPS {
            // The error that remains beside the source's bound; not rounded down if that is 0.
            let remaining_error = if used == 0.0 { error.get() } else { sub_down(error.get(), used) };
            let fewer = if remaining_error > 0.0 {
                progress.simplify_within(&ErrorLimit::uniform(remaining_error), job)?
            } else {
                None
            };
            // The finest level exists even if nothing could be collapsed.
            let fewer = fewer.or_else(|| levels.is_empty().then(|| progress.unchanged()));
            let fewer = match (fewer, &aside) {
                (Some(fewer), Some(faces)) => {
                    let within = ErrorLimit::uniform(greater(remaining_error, 0.0));
                    Some(faces.restore(fewer, Some(&within), job)?)
                }
                (fewer, _) => fewer,
            };
            let level = fewer.map(|fewer| level_of(fewer, is_smooth.then_some(&finest.bound)));
            let is_new = |level: &LodLevel| {
                levels.last().is_none_or(|finer| {
                    let fewer = level.mesh.faces().len() as f64 <= WORTH_IT * finer.mesh.faces().len() as f64;
                    fewer && level.error() > finer.error()
                })
            };
            levels.extend(level.filter(is_new));
            let is_last = |level: &LodLevel| {
                let n = level.mesh.faces().len();
                n <= steps.stop_at_triangles || (n > steps.max_untiled_triangles && levels.len() == 1)
            };
            let few = levels.last().is_some_and(is_last);
            match Tolerance::new(error.get() * steps.factor) {
                Ok(coarser) if !few && error.get() < extent => error = coarser,
                _ => break,
            }
        }
        Ok(levels)
    })
}

/// A level; `tessellation` is the bound of a smooth shape's triangles before they were simplified.
fn level_of(fewer: Bounded<SimplifiedMesh>, tessellation: Option<&Bound>) -> LodLevel {
    let bound = tessellation.map_or(fewer.bound.clone(), |bound| bound.then(&fewer.bound));
    let SimplifiedMesh { mesh, stats, attributes, .. } = fewer.shape;
    LodLevel { mesh, bound, stats, attributes }
}

/// The message if levels or tiles are requested of triangles without an upper bound: why there is none, and
/// what to do. Each level adds its error to that of the triangles, so an unknown error leaves nothing to add
/// to.
pub(super) fn needs_a_proof(what: &str, bound: &Bound) -> String {
    let why = match (bound.evidence(), bound.open.as_deref()) {
        (_, Some(open)) => {
            let places =
                if open.count == 1 { "1 place".to_owned() } else { format!("{} places", open.count) };
            let near = open.largest.first().map_or(String::new(), |point| {
                let [x, y, z] = point.at;
                format!(", the largest about ({x:.4}, {y:.4}, {z:.4})")
            });
            let touch = open.tangent().map_or(String::new(), |contact| format!("; {contact}"));
            format!("its proof is left open at {places}{near}, and they are only measured{touch}")
        }
        (Evidence::Measured { samples }, None) => format!("they are only measured, at {samples} points"),
        _ => "their distance from it is only estimated".to_owned(),
    };
    format!(
        "{what} need a proved bound, and the finest triangles of this shape have none: {why}; allow a \
         larger error, or promise a Lipschitz constant of a function, or mesh the shape first and make \
         {what} of that mesh, so that errors count from its triangles"
    )
}

fn refuse<T>(code: RefusalCode, message: impl Into<Message>) -> Result<T, JobError> {
    Err(JobError::Refused(Refusal::new(code, message)))
}
