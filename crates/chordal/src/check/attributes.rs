//! Measured differences between the attributes of two meshes: texture coordinates, colours, normals, at
//! nearest points.
use crate::budget::{Job, JobError, Tolerance, par_map};
use crate::explicit::{
    Attribute, Bvh, Domain, Mesh, Semantic, Topology, closest_on_triangle, distance_sq_to_triangle,
};
use crate::math::elementary::atan2;
use crate::math::{Box3, cross, difference, dot, exponent, greater, length, lesser, power_of_two};

/// The difference of one attribute between two meshes. All values are measured: at samples, and rounded.
#[derive(Clone, Debug, PartialEq)]
pub struct AttributeDeviation {
    /// The attribute.
    pub semantic: Semantic,
    /// The largest difference found; there may be larger ones between samples. Infinite if a value is not
    /// a number.
    pub largest: f64,
    /// The root mean square of the differences, each sample weighted by its share of the area of both meshes.
    pub rms: f64,
    /// The location of the largest difference: a point of one of the two meshes. `None` if no value
    /// differs.
    pub at: Option<[f64; 3]>,
    /// The number of samples on both meshes together.
    pub samples: u64,
}

impl AttributeDeviation {
    /// Whether differences are angles in degrees, as for directions; otherwise they are lengths in the
    /// attribute's units.
    #[must_use]
    pub fn is_angle(&self) -> bool {
        AttributeMetric::from_semantic(&self.semantic) == Some(AttributeMetric::Direction)
    }
}

/// Measures how far attribute values at points of one mesh are from those at the nearest points of the other,
/// in both directions, for each vertex or corner attribute that both have with the same width. It promises
/// nothing about points between samples.
///
/// A difference is the Euclidean distance between two rows in the attribute's units (a texture coordinate of
/// 0.01 is a hundredth of the texture). For normals and tangents it is the angle in degrees, and 180 if
/// the sign of the bitangent differs or only one has a direction. Face attributes and group names are not
/// interpolated, and are ignored.
///
/// *Samples.* Four a face, on both meshes: its centre, and one near each corner, a tenth of the way from
/// either side. They lie inside the face, so each has one value even beside a seam.
///
/// *Seams.* At a seam values jump: texture coordinates differ at one position, colours by more than two steps
/// of eight bits, directions by more than 30°. Beside a seam the nearest point may lie on its other side,
/// where the values are unrelated. So beside a seam of the other mesh a sample is compared with every face
/// that touches the seam and is at most `moved` farther than the nearest face, and the least
/// difference counts. `moved` bounds the movement of the seam, such as the bound of a simplified mesh, and is
/// `None` for meshes whose seams coincide. It forgives differences of a slide by `moved` beside seams, and
/// nowhere else; a lost seam is found.
///
/// *Thin walls.* If the nearest face faces the other way, as on the back of a sheet, the nearest face that
/// faces the same way is used, if it is at most `moved` farther. Coincident layers that face the
/// same way are not distinguished.
///
/// If either mesh has no face, there is nothing to compare, and the list is empty.
///
/// *Cost.* A bounding volume hierarchy over each mesh, 4 queries a face and 130 bytes: about 6 µs a face on
/// one core. The result is the same on any number of threads.
///
/// # Errors
/// As for [`Bvh::build`].
///
/// ```
/// use chordal::{Job, Mesh};
/// use chordal::check::findings::attribute_deviation;
/// use chordal::explicit::{Attribute, Domain, Semantic};
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]])?;
/// let uv = |values: [f64; 8]| Attribute {
///     semantic: Semantic::TexCoord(0), domain: Domain::Vertex, width: 2, values: values.to_vec(),
/// };
/// let a = mesh.clone().with_attribute(uv([0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]))?;
/// let b = mesh.with_attribute(uv([0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.9]))?;
/// let off = &attribute_deviation(&a, &b, None, &Job::default())?[0];
/// assert!(off.largest > 0.07 && off.largest < 0.1 && off.rms < 0.04);
/// assert_eq!(off.samples, 16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn attribute_deviation(
    a: &Mesh,
    b: &Mesh,
    moved: Option<Tolerance>,
    job: &Job,
) -> Result<Vec<AttributeDeviation>, JobError> {
    attribute_deviation_within(a, b, moved, &|_| None, job).map(|(found, _)| found)
}

/// The same, with the faces of either mesh that have a sample beyond the limit of its attribute, ascending.
pub(crate) fn attribute_deviation_within(
    a: &Mesh,
    b: &Mesh,
    moved: Option<Tolerance>,
    limit: &dyn Fn(&Semantic) -> Option<f64>,
    job: &Job,
) -> Result<(Vec<AttributeDeviation>, [Vec<u32>; 2]), JobError> {
    let pairs: Vec<[&Attribute; 2]> = a
        .attributes()
        .iter()
        .filter_map(|of_a| Some([of_a, b.attribute(&of_a.semantic)?]))
        .filter(|[p, q]| {
            p.width == q.width
                && AttributeMetric::from_semantic(&p.semantic).is_some_and(|kind| kind.fits(p.width))
        })
        .filter(|pair| pair.iter().all(|attribute| attribute.domain != Domain::Face))
        .collect();
    if pairs.is_empty() || a.faces().is_empty() || b.faces().is_empty() {
        return Ok(Default::default());
    }
    // An attribute without a limit is measured all the same, and no face is beyond it.
    let limits: Vec<f64> =
        pairs.iter().map(|pair| limit(&pair[0].semantic).unwrap_or(f64::INFINITY)).collect();
    job.run(|| {
        // One scale for both directions, so that they agree on which distances count as equal.
        let bounds = a.bounds().union(b.bounds());
        let sides = [
            AttributeMesh::new(a, pairs.iter().map(|pair| pair[0]), job)?,
            AttributeMesh::new(b, pairs.iter().map(|pair| pair[1]), job)?,
        ];
        let comparison = AttributeComparison {
            scale: AttributeComparison::scale_of(&bounds),
            reach: moved.map_or(0.0, Tolerance::get),
            limits,
            job,
        };
        let mut totals = vec![AttributeErrorStats::default(); pairs.len()];
        let mut beyond = [Vec::new(), Vec::new()];
        for ([from, to], beyond) in
            [[&sides[0], &sides[1]], [&sides[1], &sides[0]]].into_iter().zip(&mut beyond)
        {
            for chunk in comparison.sample(from, to) {
                add(&mut totals, &chunk.of_attributes);
                beyond.extend(chunk.beyond);
            }
        }
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let finished =
            |(pair, tally): (&[&Attribute; 2], &AttributeErrorStats)| tally.finished(&pair[0].semantic);
        Ok((pairs.iter().zip(&totals).map(finished).collect(), beyond))
    })
}

/// Barycentric weights of the samples of a face. Chosen: a tenth from each side near a corner.
const SAMPLES: [[f64; 3]; 4] = [[1.0 / 3.0; 3], [0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]];
/// Faces in one task. Chosen: a millisecond of work.
const CHUNK: usize = 256;
/// The most faces tested for one sample. Chosen: so that a mesh full of seams is still fast; the cutoff can
/// only make a difference larger.
const MOST_AROUND: usize = 2048;
/// Directions that are farther apart than 30° make a seam: the crease angle used for meshes without normals.
const CREASE_COSINE: f64 = 0.866_025_403_784_438_6;
/// Colours that are no farther apart count as equal: two steps of eight bits.
const COLOR_STEP: f64 = 2.0 / 255.0;

/// The way in which values are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AttributeMetric {
    /// The angle between the first three components.
    Direction,
    /// The length of the difference; a seam only beyond [`COLOR_STEP`].
    Color,
    /// The length of the difference; a seam wherever values differ.
    Value,
}

impl AttributeMetric {
    /// `None` for values that name something.
    fn from_semantic(semantic: &Semantic) -> Option<Self> {
        match semantic {
            Semantic::Normal | Semantic::Tangent => Some(Self::Direction),
            Semantic::Color(_) => Some(Self::Color),
            Semantic::TexCoord(_) | Semantic::Custom(_) | Semantic::Blended(_) => Some(Self::Value),
            Semantic::Group(_) => None,
        }
    }

    fn fits(self, width: usize) -> bool {
        if self == Self::Direction { width == 3 || width == 4 } else { width > 0 }
    }

    /// Whether two rows at one position are so far apart that they make a seam.
    fn is_discontinuous(self, a: &[f64], b: &[f64]) -> bool {
        match self {
            Self::Direction => {
                let [p, q] = [a, b].map(|v| [v[0], v[1], v[2]]);
                let turned = dot(p, q) < CREASE_COSINE * (dot(p, p) * dot(q, q)).sqrt();
                turned || (a.len() == 4 && a[3] != b[3])
            }
            Self::Color => a.iter().zip(b).any(|(a, b)| (a - b).abs() > COLOR_STEP),
            Self::Value => a != b,
        }
    }
}

/// A mesh with its bounding volume hierarchy and attributes.
struct AttributeMesh<'a> {
    mesh: &'a Mesh,
    bvh: Bvh,
    carried: Vec<SeamedAttribute<'a>>,
}

impl<'a> AttributeMesh<'a> {
    fn new(
        mesh: &'a Mesh,
        carried: impl Iterator<Item = &'a Attribute>,
        job: &Job,
    ) -> Result<Self, JobError> {
        let bvh = Bvh::build(mesh, job)?;
        // Rows with equal coordinates are one position, whatever their indices, since values at a seam often
        // have separate rows.
        let ids = Topology::Positions.ids(mesh).unwrap_or_default();
        let carried = carried.map(|attribute| SeamedAttribute::new(mesh, attribute, &ids, job));
        Ok(Self { mesh, bvh, carried: carried.collect::<Result<_, _>>()? })
    }
}

/// An attribute and the faces beside its seams.
struct SeamedAttribute<'a> {
    attribute: &'a Attribute,
    kind: AttributeMetric,
    seam: Option<SeamFaces>,
}

/// The faces that touch a seam, in a separate hierarchy.
struct SeamFaces {
    bvh: Bvh,
    /// Maps the hierarchy's faces to those of the mesh.
    faces: Vec<u32>,
}

impl<'a> SeamedAttribute<'a> {
    fn new(mesh: &'a Mesh, attribute: &'a Attribute, ids: &[u32], job: &Job) -> Result<Self, JobError> {
        let kind = AttributeMetric::from_semantic(&attribute.semantic).unwrap_or(AttributeMetric::Value);
        let mut carried = Self { attribute, kind, seam: None };
        // Compare every corner with the first one at its position.
        let mut first = vec![u32::MAX; ids.len()];
        let mut on_line = vec![false; ids.len()];
        let rows = mesh.faces().as_flattened();
        for (corner, row) in rows.iter().enumerate() {
            let id = ids[*row as usize] as usize;
            if first[id] == u32::MAX {
                first[id] = corner as u32;
            // One difference from the first corner is enough: if all equal the first, they equal
            // each other.
            } else if !on_line[id] {
                let [p, q] = [first[id] as usize, corner].map(|c| carried.row(c, rows[c]));
                on_line[id] = kind.is_discontinuous(p, q);
            }
        }
        let touches = |face: &[u32; 3]| face.iter().any(|row| on_line[ids[*row as usize] as usize]);
        let faces = mesh.faces().iter().enumerate().filter(|(_, face)| touches(face));
        let faces: Vec<u32> = faces.map(|(face, _)| face as u32).collect();
        if !faces.is_empty() {
            let corners = faces.iter().map(|face| mesh.faces()[*face as usize]).collect();
            // Rows keep their numbers; only faces are renumbered, and `faces` leads back.
            let part = Mesh::by_construction(mesh.positions().to_vec(), corners);
            carried.seam = Some(SeamFaces { bvh: Bvh::build(&part, job)?, faces });
        }
        Ok(carried)
    }

    /// The attribute row of a corner whose position has the given row.
    fn row(&self, corner: usize, position: u32) -> &[f64] {
        self.attribute.row(if self.attribute.domain == Domain::Corner { corner } else { position as usize })
    }

    /// Component `k` of the value at a point of a face. Exact if all corners have the same value.
    fn at(&self, mesh: &Mesh, point: &BarycentricPoint, k: usize) -> f64 {
        let corner_value =
            |i: usize| self.row(3 * point.face as usize + i, mesh.faces()[point.face as usize][i])[k];
        let [a, b, c] = [corner_value(0), corner_value(1), corner_value(2)];
        a + point.weights[1] * (b - a) + point.weights[2] * (c - a)
    }
}

/// A point of a face by barycentric weights.
struct BarycentricPoint {
    face: u32,
    weights: [f64; 3],
}

/// The difference between the values at a point of each mesh.
fn value_difference([a, b]: [(&Mesh, &SeamedAttribute, &BarycentricPoint); 2]) -> f64 {
    let at =
        |(mesh, carried, point): (&Mesh, &SeamedAttribute, &BarycentricPoint), k| carried.at(mesh, point, k);
    let width = a.1.attribute.width;
    let difference_found = if a.1.kind == AttributeMetric::Direction {
        let [p, q] = [a, b].map(|side| std::array::from_fn(|k| at(side, k)));
        let signs_differ = width == 4 && at(a, 3) * at(b, 3) < 0.0;
        angle_deg(p, q, signs_differ)
    } else {
        let squares = (0..width).map(|k| at(a, k) - at(b, k)).map(|x| x * x);
        squares.fold(0.0, |sum, x| sum + x).sqrt()
    };
    // Values may overflow: that must not pass as no difference.
    if difference_found.is_nan() { f64::INFINITY } else { difference_found }
}

fn angle_deg(p: [f64; 3], q: [f64; 3], is_mirrored: bool) -> f64 {
    let [has_p, has_q] = [p, q].map(|v| v != [0.0; 3]);
    match (has_p || has_q, has_p && has_q) {
        (false, _) => 0.0,
        (true, false) => 180.0,
        _ if is_mirrored => 180.0,
        _ => atan2(length(cross(p, q)), dot(p, q)).to_degrees(),
    }
}

/// Accumulated differences of one attribute.
#[derive(Clone, Debug, Default)]
struct AttributeErrorStats {
    largest: f64,
    at: Option<[f64; 3]>,
    /// The sum of weighted squares, and of the weights.
    sum: f64,
    weight: f64,
    samples: u64,
}

impl AttributeErrorStats {
    fn add_sample(&mut self, difference: f64, p: [f64; 3], weight: f64) {
        if difference > self.largest {
            (self.largest, self.at) = (difference, Some(p));
        }
        // Faces without area have no weight, whatever their values.
        if weight > 0.0 {
            self.sum += weight * difference * difference;
            self.weight += weight;
        }
        self.samples += 1;
    }

    fn finished(&self, semantic: &Semantic) -> AttributeDeviation {
        let Self { largest, at, sum, weight, samples } = *self;
        let rms = if weight > 0.0 { (sum / weight).sqrt() } else { largest };
        // If all differences are equal, rounding may make the mean larger than the largest.
        let rms = lesser(rms, largest);
        AttributeDeviation { semantic: semantic.clone(), largest, rms, at, samples }
    }
}

fn add(totals: &mut [AttributeErrorStats], more: &[AttributeErrorStats]) {
    for (total, more) in totals.iter_mut().zip(more) {
        if more.largest > total.largest {
            (total.largest, total.at) = (more.largest, more.at);
        }
        total.sum += more.sum;
        total.weight += more.weight;
        total.samples += more.samples;
    }
}

/// The differences in a chunk of faces.
struct ChunkDifferences {
    of_attributes: Vec<AttributeErrorStats>,
    /// Faces with a sample beyond a limit.
    beyond: Vec<u32>,
}

/// The parameters of a comparison.
struct AttributeComparison<'a> {
    /// A power of two that scales the extent to about 1, so that no product leaves the range of f64.
    scale: f64,
    /// A bound on the movement of a seam.
    reach: f64,
    /// By attribute: the largest difference that is no violation.
    limits: Vec<f64>,
    job: &'a Job,
}

/// Two distances count as equal if they differ by at most this share of themselves plus this share of the
/// extent. Chosen: 2⁻⁴⁰, far more than the rounding of a closest point, some dozens of units in the last
/// place.
const AS_NEAR: f64 = 1.0 / (1_u64 << 40) as f64;

impl AttributeComparison<'_> {
    fn scale_of(bounds: &Box3) -> f64 {
        let largest = bounds.min.iter().chain(&bounds.max);
        let largest = largest.fold(0.0, |most, x| greater(x.abs(), most));
        // The scale and its inverse are normal numbers.
        power_of_two(-exponent(largest).clamp(-1000, 1000))
    }

    /// Compares the samples of one mesh with the other, by chunk and attribute.
    fn sample(&self, from: &AttributeMesh, to: &AttributeMesh) -> Vec<ChunkDifferences> {
        let chunks: Vec<&[[u32; 3]]> = from.mesh.faces().chunks(CHUNK).collect();
        par_map(self.job, &chunks, |number, chunk| {
            let of_attributes = vec![AttributeErrorStats::default(); from.carried.len()];
            let mut differences = ChunkDifferences { of_attributes, beyond: Vec::new() };
            if !self.job.is_cancelled() {
                for i in 0..chunk.len() {
                    self.sample_face(from, to, (CHUNK * number + i) as u32, &mut differences);
                }
            }
            differences
        })
    }

    fn sample_face(
        &self,
        from: &AttributeMesh,
        to: &AttributeMesh,
        face: u32,
        differences: &mut ChunkDifferences,
    ) {
        let mut is_beyond = false;
        let corners = from.mesh.corners(face as usize);
        let normal = self.normal(corners);
        let share = length(normal) / SAMPLES.len() as f64;
        for weights in SAMPLES {
            let p = std::array::from_fn(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum());
            let sample = BarycentricPoint { face, weights };
            let Some(near) = to.bvh.closest_point(p) else { continue };
            let at = (p, near.distance_sq.sqrt());
            let mut nearest = BarycentricPoint { face: near.face, weights: near.barycentric };
            // The nearest face may be the far side of a thin wall. The counterpart is on the side
            // that faces the same way, if one is as near.
            if dot(normal, self.normal(to.mesh.corners(near.face as usize))) < 0.0 {
                nearest = self.nearest_facing(&to.bvh, at, normal).unwrap_or(nearest);
            }
            let pairs = from.carried.iter().zip(&to.carried).zip(&self.limits);
            for (((from_attribute, to_attribute), limit), stats) in pairs.zip(&mut differences.of_attributes)
            {
                let apart_from = |point: &BarycentricPoint| {
                    value_difference([(from.mesh, from_attribute, &sample), (to.mesh, to_attribute, point)])
                };
                let mut least = apart_from(&nearest);
                // At a seam two values meet at one place, and rounding decides on which of its
                // sides the nearest point falls. So the closer one of all values there counts; if
                // the first is equal already, none can be closer.
                if let Some(beside) = to_attribute.seam.as_ref().filter(|_| least > 0.0) {
                    self.faces_about(&beside.bvh, at, |near| {
                        let face = beside.faces[near.face as usize];
                        let candidate = apart_from(&BarycentricPoint {
                            face,
                            weights: closest_on_triangle(near.q, near.corners),
                        });
                        least = lesser(candidate, least);
                    });
                }
                stats.add_sample(least, p, share);
                is_beyond |= least > *limit;
            }
        }
        differences.beyond.extend(is_beyond.then_some(face));
    }

    /// The normal of a triangle with twice its area as length, scaled.
    fn normal(&self, corners: [[f64; 3]; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|p| p.map(|x| x * self.scale));
        cross(difference(b, a), difference(c, a))
    }

    /// The nearest point on a face that faces the direction `normal`, if it is about as near as the nearest
    /// point of all faces.
    fn nearest_facing(&self, bvh: &Bvh, at: ([f64; 3], f64), normal: [f64; 3]) -> Option<BarycentricPoint> {
        let mut best: Option<(f64, BarycentricPoint)> = None;
        self.faces_about(bvh, at, |near| {
            let [a, b, c] = near.corners;
            if dot(normal, cross(difference(b, a), difference(c, a))) <= 0.0 {
                return;
            }
            // The hierarchy visits faces in no useful order: the lower index decides between faces
            // at equal distances, as they occur along every shared edge.
            let is_better = best.as_ref().is_none_or(|(least, best_point)| {
                near.off_sq < *least || (near.off_sq == *least && near.face < best_point.face)
            });
            if is_better {
                let weights = closest_on_triangle(near.q, near.corners);
                best = Some((near.off_sq, BarycentricPoint { face: near.face, weights }));
            }
        });
        best.map(|(_, point)| point)
    }

    /// Visits the faces of a hierarchy that are about as near to `p` as the nearest face, which is at that
    /// distance, or may have been before seams moved.
    fn faces_about(&self, bvh: &Bvh, (p, distance): ([f64; 3], f64), mut see: impl FnMut(&NearbyFace)) {
        let radius = distance + AS_NEAR * distance + self.reach + AS_NEAR / self.scale;
        let q = p.map(|x| x * self.scale);
        let limit = (radius * self.scale) * (radius * self.scale);
        let mut n_seen = 0;
        bvh.rows_near(p, radius, |row| {
            n_seen += 1;
            if n_seen > MOST_AROUND {
                return;
            }
            let (corners, face) = bvh.triangle_of(row);
            let corners = corners.map(|p| p.map(|x| x * self.scale));
            let off_sq = distance_sq_to_triangle(q, corners);
            if off_sq <= limit {
                see(&NearbyFace { q, corners, face, off_sq });
            }
        });
    }
}

/// A face near a point, scaled.
struct NearbyFace {
    q: [f64; 3],
    corners: [[f64; 3]; 3],
    face: u32,
    off_sq: f64,
}
