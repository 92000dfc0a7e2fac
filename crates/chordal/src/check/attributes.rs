//! How far what two meshes carry is apart, measured: texture coordinates, colours, normals, at points close together.
use crate::budget::{Job, Stopped, Tolerance, par_map};
use crate::explicit::{
    Attribute, Bvh, Domain, Mesh, Semantic, Topology, nearest_on_triangle, nearest_with_distance,
};
use crate::math::elementary::atan2;
use crate::math::{Box3, cross, difference, dot, exponent, length, power_of_two};

/// How far one attribute of two meshes is apart. All of it is measured: at samples, and rounded.
#[derive(Clone, Debug, PartialEq)]
pub struct AttributeDeviation {
    /// Which attribute.
    pub semantic: Semantic,
    /// The largest difference that was found: between samples there may be larger ones. Infinite where a value is not a
    /// number.
    pub largest: f64,
    /// The root of the mean square of the differences, each sample with its share of the area of both meshes.
    pub rms: f64,
    /// Where the largest was found: a point of one of the two meshes. `None` where nothing differs.
    pub at: Option<[f64; 3]>,
    /// How many samples were taken, on both meshes together.
    pub samples: u64,
}

impl AttributeDeviation {
    /// Whether differences are angles in degrees, as for directions; else they are lengths in the attribute's own numbers.
    #[must_use]
    pub fn is_angle(&self) -> bool {
        Kind::of(&self.semantic) == Some(Kind::Direction)
    }
}

/// How far values at points of one mesh are from those at the nearest points of the other, both ways, for each attribute of
/// vertices or corners that both have with one width: a measure, with no promise about what lies between samples.
///
/// A difference is the Euclidean length of that of two rows in the attribute's own numbers (a texture coordinate of 0.01 is a
/// hundredth of the texture); for normals and tangents it is the angle in degrees, and 180 where the sign of the bitangent
/// differs or only one has a direction. Attributes of faces and names of groups are not interpolated, and left out.
///
/// *Samples.* Four a face, of both meshes: its middle, and one near each corner, a tenth of the way from either side. They are
/// inside, so that each has one value also beside a line at which values jump.
///
/// *Seams.* Beside such a line (texture coordinates that differ at one position, colours by more than two steps of eight
/// bits, directions by more than 30°) the nearest point may lie on the line's other side, where values belong to
/// something else. So beside a line of the other mesh a sample is held against each face that touches the line and is as
/// near as the nearest, and against those that are farther by at most `moved`, and the least difference counts: `moved` is
/// how far the line may have moved, as the bound that came with a simplified mesh, and `None` for meshes whose lines are in one place. It
/// forgives differences of a slide by `moved` beside lines, and nowhere else; a line that went lost is found.
///
/// *Thin walls.* Where the nearest face faces the other way, as on the back of a sheet, the nearest of those that face the same
/// way counts, if one is as near or farther by at most `moved`. Layers that lie upon each other and face alike are not told apart.
///
/// Without a face on either side there is nothing to compare, and the list is empty.
///
/// *Cost.* A tree over each mesh, 4 queries a face and 130 bytes: about 6 µs a face on one core. The same on any number of
/// threads.
///
/// # Errors
/// As for [`Bvh::build`].
///
/// ```
/// use chordal::{Job, Mesh, check::attribute_deviation, explicit::{Attribute, Domain, Semantic}};
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
) -> Result<Vec<AttributeDeviation>, Stopped> {
    let pairs: Vec<[&Attribute; 2]> = a
        .attributes()
        .iter()
        .filter_map(|of_a| Some([of_a, b.attribute(&of_a.semantic)?]))
        .filter(|[p, q]| p.width == q.width && Kind::of(&p.semantic).is_some_and(|kind| kind.fits(p.width)))
        .filter(|pair| pair.iter().all(|of| of.domain != Domain::Face))
        .collect();
    if pairs.is_empty() || a.faces().is_empty() || b.faces().is_empty() {
        return Ok(Vec::new());
    }
    job.run(|| {
        let place = a.bounds().union(b.bounds());
        let sides = [
            Side::new(a, pairs.iter().map(|pair| pair[0]), job)?,
            Side::new(b, pairs.iter().map(|pair| pair[1]), job)?,
        ];
        let looked = Look { scale: Look::scale_of(&place), reach: moved.map_or(0.0, Tolerance::get), job };
        let mut all = vec![Tally::default(); pairs.len()];
        for [from, to] in [[&sides[0], &sides[1]], [&sides[1], &sides[0]]] {
            looked.from(from, to).iter().for_each(|chunk| add(&mut all, chunk));
        }
        if job.is_cancelled() {
            return Err(Stopped::Cancelled);
        }
        let said = |(pair, tally): (&[&Attribute; 2], &Tally)| tally.said(&pair[0].semantic);
        Ok(pairs.iter().zip(&all).map(said).collect())
    })
}

/// Weights of the samples of a face. Chosen: a tenth from each side near a corner.
const SAMPLES: [[f64; 3]; 4] = [[1.0 / 3.0; 3], [0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]];
/// Faces a chunk. Chosen: a millisecond of work.
const CHUNK: usize = 256;
/// Faces around that are looked at for one sample at most, so that no mesh of lines alone takes forever; what is cut off only
/// leaves a difference larger. Chosen.
const MOST_AROUND: usize = 2048;
/// Directions that are farther apart than 30° make a line: that of a crease, as for meshes without normals.
const CREASE_COSINE: f64 = 0.866_025_403_784_438_6;
/// Colours that are no farther apart are one: two steps of eight bits.
const COLOR_STEP: f64 = 2.0 / 255.0;

/// How values are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The angle between the first three numbers.
    Direction,
    /// The length of the difference; a line only beyond a step.
    Color,
    /// The length of the difference; a line wherever values differ.
    Value,
}

impl Kind {
    /// `None` for numbers that name something.
    fn of(semantic: &Semantic) -> Option<Self> {
        match semantic {
            Semantic::Normal | Semantic::Tangent => Some(Self::Direction),
            Semantic::Color(_) => Some(Self::Color),
            Semantic::TexCoord(_) | Semantic::Custom(_) => Some(Self::Value),
            Semantic::Group(_) => None,
        }
    }

    fn fits(self, width: usize) -> bool {
        if self == Self::Direction { width == 3 || width == 4 } else { width > 0 }
    }

    /// Whether two rows at one position are so far apart that they make a line.
    fn jumps(self, a: &[f64], b: &[f64]) -> bool {
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

/// One mesh with its tree and what it carries.
struct Side<'a> {
    mesh: &'a Mesh,
    bvh: Bvh,
    carried: Vec<Carried<'a>>,
}

impl<'a> Side<'a> {
    fn new(mesh: &'a Mesh, carried: impl Iterator<Item = &'a Attribute>, job: &Job) -> Result<Self, Stopped> {
        let bvh = Bvh::build(mesh, job)?;
        // Rows at one place are one position, whatever the file says: values at a seam are often rows of their own.
        let ids = Topology::Positions.ids(mesh).unwrap_or_default();
        let carried = carried.map(|attribute| Carried::new(mesh, attribute, (&ids, job)));
        Ok(Self { mesh, bvh, carried: carried.collect::<Result<_, _>>()? })
    }
}

/// One attribute, and the faces beside its lines.
struct Carried<'a> {
    attribute: &'a Attribute,
    kind: Kind,
    beside: Option<Beside>,
}

/// The faces that touch a line, in a tree of their own.
struct Beside {
    bvh: Bvh,
    /// By the tree's faces: those of the mesh.
    faces: Vec<u32>,
}

impl<'a> Carried<'a> {
    fn new(mesh: &'a Mesh, attribute: &'a Attribute, (ids, job): (&[u32], &Job)) -> Result<Self, Stopped> {
        let kind = Kind::of(&attribute.semantic).unwrap_or(Kind::Value);
        let mut carried = Self { attribute, kind, beside: None };
        // Every corner against the first at its position.
        let mut first = vec![u32::MAX; ids.len()];
        let mut on_line = vec![false; ids.len()];
        let rows = mesh.faces().as_flattened();
        for (corner, row) in rows.iter().enumerate() {
            let id = ids[*row as usize] as usize;
            if first[id] == u32::MAX {
                first[id] = corner as u32;
            } else if !on_line[id] {
                let [p, q] = [first[id] as usize, corner].map(|c| carried.row(c, rows[c]));
                on_line[id] = kind.jumps(p, q);
            }
        }
        let touches = |face: &[u32; 3]| face.iter().any(|row| on_line[ids[*row as usize] as usize]);
        let faces = mesh.faces().iter().enumerate().filter(|(_, face)| touches(face));
        let faces: Vec<u32> = faces.map(|(face, _)| face as u32).collect();
        if !faces.is_empty() {
            let corners = faces.iter().map(|face| mesh.faces()[*face as usize]).collect();
            let part = Mesh::by_construction(mesh.positions().to_vec(), corners);
            carried.beside = Some(Beside { bvh: Bvh::build(&part, job)?, faces });
        }
        Ok(carried)
    }

    /// The row of a corner, which stands at a row of the positions.
    fn row(&self, corner: usize, position: u32) -> &[f64] {
        self.attribute.row(if self.attribute.domain == Domain::Corner { corner } else { position as usize })
    }

    /// Number `k` of the value at a point of a face. Where all corners have one value, that.
    fn at(&self, mesh: &Mesh, point: &OnFace, k: usize) -> f64 {
        let of = |i: usize| self.row(3 * point.face as usize + i, mesh.faces()[point.face as usize][i])[k];
        let [a, b, c] = [of(0), of(1), of(2)];
        a + point.weights[1] * (b - a) + point.weights[2] * (c - a)
    }
}

/// A point of a face by its weights.
struct OnFace {
    face: u32,
    weights: [f64; 3],
}

/// The difference between the values at a point of each side.
fn apart([a, b]: [(&Mesh, &Carried, &OnFace); 2]) -> f64 {
    let at = |(mesh, carried, point): (&Mesh, &Carried, &OnFace), k| carried.at(mesh, point, k);
    let width = a.1.attribute.width;
    let found = if a.1.kind == Kind::Direction {
        let [p, q] = [a, b].map(|side| std::array::from_fn(|k| at(side, k)));
        let signs_differ = width == 4 && at(a, 3) * at(b, 3) < 0.0;
        angle_deg(p, q, signs_differ)
    } else {
        let squares = (0..width).map(|k| at(a, k) - at(b, k)).map(|x| x * x);
        squares.fold(0.0, |sum, x| sum + x).sqrt()
    };
    if found.is_nan() { f64::INFINITY } else { found }
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

/// What was found of one attribute.
#[derive(Clone, Debug, Default)]
struct Tally {
    largest: f64,
    at: Option<[f64; 3]>,
    /// Squares times weights, and weights.
    sum: f64,
    weight: f64,
    samples: u64,
}

impl Tally {
    fn see(&mut self, off: f64, p: [f64; 3], weight: f64) {
        if off > self.largest {
            (self.largest, self.at) = (off, Some(p));
        }
        // What has no area has no share, whatever it carries.
        if weight > 0.0 {
            self.sum += weight * off * off;
            self.weight += weight;
        }
        self.samples += 1;
    }

    fn said(&self, semantic: &Semantic) -> AttributeDeviation {
        let Self { largest, at, sum, weight, samples } = *self;
        let rms = if weight > 0.0 { (sum / weight).sqrt() } else { largest };
        // Rounding of the mean takes it past the largest where all differences are one.
        let rms = if rms < largest { rms } else { largest };
        AttributeDeviation { semantic: semantic.clone(), largest, rms, at, samples }
    }
}

fn add(all: &mut [Tally], more: &[Tally]) {
    for (all, more) in all.iter_mut().zip(more) {
        if more.largest > all.largest {
            (all.largest, all.at) = (more.largest, more.at);
        }
        all.sum += more.sum;
        all.weight += more.weight;
        all.samples += more.samples;
    }
}

/// How it is looked.
struct Look<'a> {
    /// Brings the extent to about 1, so that no product leaves the range of f64: a power of two.
    scale: f64,
    /// By how much a line may have moved.
    reach: f64,
    job: &'a Job,
}

/// Two distances are one if they differ by a share of this of themselves, and by no more than this of the extent: a nearest point is
/// rounded by some dozens of units in the last place. Chosen: 2⁻⁴⁰, far more than that.
const AS_NEAR: f64 = 1.0 / (1_u64 << 40) as f64;

impl Look<'_> {
    fn scale_of(place: &Box3) -> f64 {
        let largest = place.min.iter().chain(&place.max);
        let largest = largest.fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most });
        // A scale and its inverse are normal numbers.
        power_of_two(-exponent(largest).clamp(-1000, 1000))
    }

    /// What samples of one side find on the other, by chunk and attribute.
    fn from(&self, from: &Side, to: &Side) -> Vec<Vec<Tally>> {
        let chunks: Vec<&[[u32; 3]]> = from.mesh.faces().chunks(CHUNK).collect();
        par_map(self.job, &chunks, |number, chunk| {
            let mut found = vec![Tally::default(); from.carried.len()];
            if !self.job.is_cancelled() {
                for i in 0..chunk.len() {
                    self.face(from, to, ((CHUNK * number + i) as u32, &mut found));
                }
            }
            found
        })
    }

    fn face(&self, from: &Side, to: &Side, (face, found): (u32, &mut [Tally])) {
        let corners = from.mesh.corners(face as usize);
        let normal = self.normal(corners);
        let share = length(normal) / SAMPLES.len() as f64;
        for weights in SAMPLES {
            let p = std::array::from_fn(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum());
            let here = OnFace { face, weights };
            let Some(near) = to.bvh.closest_point(p) else { continue };
            let at = (p, near.distance_sq.sqrt());
            let mut there = OnFace { face: near.face, weights: near.barycentric };
            if dot(normal, self.normal(to.mesh.corners(near.face as usize))) < 0.0 {
                there = self.facing(&to.bvh, at, normal).unwrap_or(there);
            }
            for ((own, other), found) in from.carried.iter().zip(&to.carried).zip(&mut *found) {
                let apart_from = |there: &OnFace| apart([(from.mesh, own, &here), (to.mesh, other, there)]);
                let mut least = apart_from(&there);
                if let Some(beside) = other.beside.as_ref().filter(|_| least > 0.0) {
                    self.around(&beside.bvh, at, |near| {
                        let face = beside.faces[near.face as usize];
                        let off =
                            apart_from(&OnFace { face, weights: nearest_on_triangle(near.q, near.corners) });
                        least = if off < least { off } else { least };
                    });
                }
                found.see(least, p, share);
            }
        }
    }

    /// Twice the area of a triangle along its normal, scaled.
    fn normal(&self, corners: [[f64; 3]; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|p| p.map(|x| x * self.scale));
        cross(difference(b, a), difference(c, a))
    }

    /// The nearest point on faces that face a direction, where one is about as near as the nearest of all.
    fn facing(&self, bvh: &Bvh, at: ([f64; 3], f64), normal: [f64; 3]) -> Option<OnFace> {
        let mut best: Option<(f64, OnFace)> = None;
        self.around(bvh, at, |near| {
            let [a, b, c] = near.corners;
            if dot(normal, cross(difference(b, a), difference(c, a))) <= 0.0 {
                return;
            }
            let is_better = best.as_ref().is_none_or(|(least, known)| {
                near.off_sq < *least || (near.off_sq == *least && near.face < known.face)
            });
            if is_better {
                let weights = nearest_on_triangle(near.q, near.corners);
                best = Some((near.off_sq, OnFace { face: near.face, weights }));
            }
        });
        best.map(|(_, point)| point)
    }

    /// The faces of a tree that are as near to `p` as the nearest of all, at that distance, or may have been.
    fn around(&self, bvh: &Bvh, (p, distance): ([f64; 3], f64), mut see: impl FnMut(&Near)) {
        let radius = distance + AS_NEAR * distance + self.reach + AS_NEAR / self.scale;
        let q = p.map(|x| x * self.scale);
        let limit = (radius * self.scale) * (radius * self.scale);
        let mut n_seen = 0;
        bvh.around(p, radius, |row| {
            n_seen += 1;
            if n_seen > MOST_AROUND {
                return;
            }
            let (corners, face) = bvh.triangle_of(row);
            let corners = corners.map(|p| p.map(|x| x * self.scale));
            let off_sq = nearest_with_distance(q, corners);
            if off_sq <= limit {
                see(&Near { q, corners, face, off_sq });
            }
        });
    }
}

/// A face of a tree near a point, scaled.
struct Near {
    q: [f64; 3],
    corners: [[f64; 3]; 3],
    face: u32,
    off_sq: f64,
}
