//! Pictures directly from a field: rays meet the surface where the field changes its sign, without triangles.
use super::camera::{frame_points, ray_generator};
use super::color::Backdrop;
use super::drawing::draw;
use super::field_picture::{FieldPicture, FieldRenderError, refusal};
use super::light::{Material, OcclusionTest, ShadingPoint, StudioLights, StudioShape};
use super::options::{CullMode, RenderOptions, RenderStyle, UpAxis, Viewpoint};
use super::picture_tile::TileRenderer;
use super::render_mesh::facing_normal;
use super::sample_pattern::SamplePattern;
use super::traced_surface::{TracedRay, TracedSurface};
use crate::budget::{Camera, Job, Projection, Screen};
use crate::explicit::Ray;
use crate::implicit::query::{Beam, BeamCounts, BeamRecord, FieldOctree, FieldTracer};
use crate::implicit::{Field, LeafError, Tape};
use glam::DVec3;

/// The radius of shadow rays at their start as a fraction of the size, and its growth: far below the lamp's.
const SHADOW_CONE: [f64; 2] = [2e-3, 1e-2]; // measured: a tenth of it takes five times as long, and looks the same
/// The height above the surface at which shadow rays start, as a fraction of the size: far above the rounding
/// of hits (2⁻⁴²) and far below a pixel.
const LIFT: f64 = 1e-6; // derived: see above

/// Renders a field.
///
/// The light is that of [`super::render`]. The surface is where the sign of the field changes, found on each
/// ray to 2⁻⁴² of the size, and its normal is the gradient. A field that does not depend on z is drawn in the
/// plane: dark inside, seen from straight above unless a camera is given. Of the styles in [`RenderStyle`],
/// triangle edges and lane counts are refused, and flat is the same as shaded.
///
/// The bytes are the same on any number of threads and every target.
///
/// Cost: the octree around the surface once; then as for a mesh, with about 5 values of the field per ray.
///
/// # Errors
/// [`FieldRenderError`]: as for [`super::render`]; if the field has no finite box; for edges and lanes; and
/// if a leaf fails.
///
/// ```
/// use chordal::implicit::{Distance, Expr, Field};
/// use chordal::Job;
/// use chordal::math::Box3;
/// use chordal::render::{Background, RenderOptions};
/// use chordal::render::fields::render_field;
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new((x.square() + y.square() + z.square()).sqrt() - 1.0)
///     .with_distance(Distance::EXACT)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let options = RenderOptions { background: Background::Transparent, ..RenderOptions::sized(40, 30) };
/// let drawn = render_field(&ball, &options, &Job::default())?;
/// assert_eq!(drawn.picture.pixel(20, 15)[3], 255);
/// // A few rays graze the outline.
/// assert!(drawn.counts.certified_share() > 0.99);
/// # Ok::<(), chordal::render::fields::FieldRenderError>(())
/// ```
pub fn render_field(
    field: &Field,
    options: &RenderOptions,
    job: &Job,
) -> Result<FieldPicture, FieldRenderError> {
    if options.show == RenderStyle::Wire {
        return Err(refusal("a field has no edges to show; wire is for meshes".to_owned()));
    }
    if options.show == RenderStyle::Overshade {
        return Err(refusal("a field has no triangles to shade: mesh it first".to_owned()));
    }
    // A field that does not depend on z is a drawing in the plane.
    if !Tape::new(field.sign()).axes()[2] {
        return draw(field, options, job);
    }
    let mut cells = FieldOctree::build(field, job)?;
    cells.sample_gradients(job)?;
    let camera = match options.viewpoint {
        Viewpoint::Automatic(screen) => frame_field(&cells, options.up, screen),
        Viewpoint::Camera(camera) => camera,
    };
    let eye = ray_generator(&camera, options, job)?;
    let pattern = SamplePattern::new(options.samples);
    let shape = StudioShape { bounds: cells.occupied(), up: options.up, material: Material::Clay };
    let surface = FieldSurface {
        tracer: FieldTracer::new(&cells),
        size: cells.size(),
        cone: pixel_cone(&camera),
        cull: options.cull,
    };
    let renderer = TileRenderer {
        surface,
        studio: StudioLights::new(&shape, &camera, &pattern),
        eye,
        pattern,
        options,
        screen: camera.screen,
        backdrop: Backdrop::new(camera.screen.height_px),
        heat: None,
        lines: None,
    };
    let (picture, counts) = renderer.picture(job)?;
    Ok(FieldPicture { picture, camera, counts })
}

/// The camera of the automatic viewpoint for the cells of a field, like [`super::frame`] for a mesh.
#[must_use]
pub fn frame_field(cells: &FieldOctree, up: UpAxis, screen: Screen) -> Camera {
    frame_points(|| cells.corners().map(DVec3::from), up, screen)
}

/// The cone of half a pixel, for rays whose direction has length 1 along the line of sight.
fn pixel_cone(camera: &Camera) -> [f64; 2] {
    let height = f64::from(camera.screen.height_px);
    match camera.projection {
        Projection::Perspective { fov_y_deg } => [0.0, libm::tan(fov_y_deg.to_radians() / 2.0) / height],
        Projection::Orthographic { height: length } => [0.5 * length / height, 0.0],
    }
}

/// The surface of a field, for rays.
struct FieldSurface<'a> {
    tracer: FieldTracer<'a>,
    size: f64,
    cone: [f64; 2],
    cull: CullMode,
}

/// Collects shadow rays.
struct ShadowRayCollector {
    beams: Vec<Beam>,
    size: f64,
}

/// Gives the results of shadow rays, in the order in which they were collected.
struct ShadowRayResults {
    answers: std::vec::IntoIter<bool>,
}

impl OcclusionTest for ShadowRayCollector {
    fn is_occluded(&mut self, origin: DVec3, direction: DVec3) -> bool {
        let cone = [SHADOW_CONE[0] * self.size, SHADOW_CONE[1]];
        let (origin, direction) = (origin.to_array(), direction.to_array());
        self.beams.push(Beam { origin, direction, from: 0.0, to: f64::INFINITY, cone });
        false
    }
}

impl OcclusionTest for ShadowRayResults {
    fn is_occluded(&mut self, _: DVec3, _: DVec3) -> bool {
        self.answers.next().unwrap_or(false)
    }
}

impl TracedSurface for FieldSurface<'_> {
    type Error = FieldRenderError;

    fn trace(&self, rays: &[Ray], counts: &mut BeamCounts) -> Result<Vec<TracedRay>, FieldRenderError> {
        let beam = |ray: &Ray| Beam {
            origin: ray.origin,
            direction: ray.direction,
            from: ray.t_min,
            to: ray.t_max,
            cone: self.cone,
        };
        let beams: Vec<Beam> = rays.iter().map(beam).collect();
        let records = self.visible_hits(&beams)?;
        *counts = records.iter().fold(*counts, BeamCounts::add_record);
        let spots = self.shading_points(&beams, &records)?;
        let points = spots.into_iter().zip(&records);
        Ok(points
            .map(|(spot, record)| TracedRay {
                spot,
                uncertain: record.hit.is_none() && (record.uncertain || record.capped),
            })
            .collect())
    }

    fn with_occlusion<R>(&self, work: impl Fn(&mut dyn OcclusionTest) -> R) -> Result<R, FieldRenderError> {
        // Two passes over the same work: the first collects the rays, and answers each with
        // `false`; the second gets the answers in the same order. So the rays that `work` asks for
        // must not depend on the answers.
        let mut collector = ShadowRayCollector { beams: Vec::new(), size: self.size };
        let result = work(&mut collector);
        if collector.beams.is_empty() {
            return Ok(result);
        }
        let answers = self.tracer.occluded(&collector.beams)?.into_iter();
        Ok(work(&mut ShadowRayResults { answers }))
    }

    fn ray_offset(&self) -> f64 {
        LIFT * self.size
    }

    fn nearest_line(&self, _: [i64; 2]) -> f64 {
        f64::INFINITY
    }

    fn corners(&self, _: &ShadingPoint) -> Option<[[f64; 3]; 3]> {
        None
    }
}

impl FieldSurface<'_> {
    /// The first hits that are not culled.
    fn visible_hits(&self, beams: &[Beam]) -> Result<Vec<BeamRecord>, LeafError> {
        let mut records = self.tracer.intersect(beams)?;
        let culled = match self.cull {
            CullMode::None => return Ok(records),
            CullMode::Back => false,
            CullMode::Front => true,
        };
        // A culled hit lets the ray go on behind it, as often as needed. The parameter is in
        // lengths of the direction.
        loop {
            let again: Vec<usize> = (0..records.len())
                .filter(|k| records[*k].hit.is_some_and(|met| met.entering == culled))
                .collect();
            if again.is_empty() {
                return Ok(records);
            }
            let next_beams: Vec<Beam> = again
                .iter()
                .map(|k| {
                    let from = records[*k].hit.map_or(f64::INFINITY, |met| met.t);
                    let length = DVec3::from(beams[*k].direction).length();
                    Beam { from: from + LIFT * self.size / length, ..beams[*k] }
                })
                .collect();
            for (k, record) in again.iter().zip(self.tracer.intersect(&next_beams)?) {
                let uncertain = records[*k].uncertain || record.uncertain;
                records[*k] = BeamRecord { uncertain, ..record };
            }
        }
    }

    fn shading_points(
        &self,
        beams: &[Beam],
        records: &[BeamRecord],
    ) -> Result<Vec<Option<ShadingPoint>>, LeafError> {
        let points: Vec<[f64; 3]> =
            records.iter().filter_map(|record| record.hit.map(|met| met.point)).collect();
        // One for each hit, in the order of the records, so that `next` below belongs to its
        // record.
        let mut normals = self.tracer.normals(&points)?.into_iter();
        let spot = |(beam, record): (&Beam, &BeamRecord)| {
            let met = record.hit?;
            let direction = DVec3::from(beam.direction);
            // Without a gradient the surface normal points to the eye.
            let outward = normals.next().flatten().map(DVec3::from);
            let away = if met.entering { 1.0 } else { -1.0 };
            let facing = outward.map_or(-direction.normalize(), |n| n * away);
            let normal = facing_normal(facing, -direction.normalize(), direction);
            let origin = DVec3::from(met.point) + normal * (LIFT * self.size);
            let at = DVec3::from(met.point);
            Some(ShadingPoint {
                face: 0,
                at,
                depth: met.t,
                origin,
                flat: normal,
                normal,
                front: met.entering,
            })
        };
        Ok(beams.iter().zip(records).map(spot).collect())
    }
}
