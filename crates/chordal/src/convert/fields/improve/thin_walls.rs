//! Thin walls: if another sheet is nearer than the tolerance, the aim is a fraction of the distance to it.
use super::face_tree::FaceBox;
use super::{FaceLabel, SurfaceImprover, area_normal};
use crate::budget::par_map;
use crate::implicit::LeafError;
use crate::math::IntegerMap;
use crate::math::{greater, lesser};
use glam::DVec3;

/// The aim relative to the distance to the other sheet. Derived: less than half, so that copies of the surface displaced
/// by the aim do not meet.
const OF_WALL: f64 = 0.4;
/// Walls that would lower the aim below this fraction are ignored. Chosen: sheets that touch would be split without
/// end.
const LEAST: f64 = 1.0 / 256.0;
/// The first search is at least within this fraction of the reach, if the faces around a vertex are smaller. Chosen: each
/// further search doubles it.
const FIRST: f64 = 1.0 / 64.0;
/// The search for walls ends if it finds more faces than this. Chosen: within a coarse tolerance there may be most of
/// the surface.
const CROWD: usize = 1024;
/// Vertices in one task.
const CHUNK: usize = 1024;
/// Normals face away from each other if their cosine is below this: 120°. Chosen: the sides of a thin wall are near
/// 180°, curved walls have a margin.
const OPPOSITE: f64 = -0.5;
/// A face in more cubes than this counts as being in all cubes. Chosen: such faces are few.
const MANY: i64 = 64;

impl SurfaceImprover<'_> {
    /// Lowers the aim at vertices near a sheet that faces the other way. Sheets that join the vertex's own in a crease are
    /// ignored, since they come arbitrarily near.
    pub(super) fn aim_at_walls(&mut self) -> Result<(), LeafError> {
        let joined = self.joined_labels();
        // A sheet farther away would not lower the aim.
        let reach = self.aim / OF_WALL;
        let vertices = self.vertices();
        let chunks: Vec<&[u32]> = vertices.chunks(CHUNK).collect();
        // Where only labels of cubes nearby join the vertex's own, no search in the tree is needed.
        let near = self.labels_by_cube(reach);
        let open = par_map(self.job, &chunks, |_, part| {
            let is_alone = |v: u32| near.around(self.at(v)).all(|label| self.joins(v, label, &joined));
            let first = |v: &u32| {
                let size = self.size_around(*v, &self.position);
                (*v, greater(size, FIRST * reach))
            };
            part.iter().filter(|v| !is_alone(**v)).map(first).collect::<Vec<(u32, f64)>>()
        });
        // Searches first about as far as the faces around a vertex reach, then farther, until a sheet is found.
        let mut open = open.concat();
        while !open.is_empty() {
            let chunks: Vec<&[(u32, f64)]> = open.chunks(CHUNK).collect();
            let opposing = par_map(self.job, &chunks, |_, part| {
                let look = |(v, size): &(u32, f64)| self.labels_across(*v, lesser(*size, reach), &joined);
                part.iter().map(look).collect::<Vec<OpposingFaces>>()
            })
            .concat();
            let by_vertex = open.iter().zip(&opposing);
            let across: Vec<(u32, FaceLabel)> = by_vertex
                .flat_map(|((v, _), opposing)| opposing.labels.iter().map(|label| (*v, *label)))
                .collect();
            self.aim_below(&across)?;
            // Beyond the first sheet that is found, others are farther and would lower the aim less.
            let left = open
                .into_iter()
                .zip(opposing)
                .filter(|((_, size), opposing)| *size < reach && !opposing.is_enough());
            open = left.map(|((v, size), _)| (v, 2.0 * size)).collect();
        }
        Ok(())
    }

    /// Lowers the aim at vertices to a fraction of their distance from these primitives, if they face the other way.
    fn aim_below(&mut self, across: &[(u32, FaceLabel)]) -> Result<(), LeafError> {
        let queries: Vec<_> = across.iter().map(|(v, label)| (*label, self.at(*v))).collect();
        let samples = self.sample(&queries)?;
        for ((v, _), sample) in across.iter().zip(samples) {
            let faces_away = self.constraints_of(*v).iter().any(|on| on.normal.dot(sample.normal) < OPPOSITE);
            let aim = OF_WALL * sample.distance.abs();
            if faces_away && aim > LEAST * self.aim && aim < self.aim_at[*v as usize] {
                self.aim_at[*v as usize] = aim;
            }
        }
        Ok(())
    }

    /// Pairs of labels that meet in creases, sorted.
    fn joined_labels(&self) -> Vec<[FaceLabel; 2]> {
        let pair = |h: u32| {
            let (a, b) = (self.label_of(h), self.label_of(self.surface.twin(h)));
            if a < b { [a, b] } else { [b, a] }
        };
        let mut pairs: Vec<[FaceLabel; 2]> = self.edges().filter(|h| self.is_crease(*h)).map(pair).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Whether a label is one of the vertex's, or joins one of these in a crease.
    fn joins(&self, v: u32, label: FaceLabel, joined: &[[FaceLabel; 2]]) -> bool {
        let joins = |other: FaceLabel| {
            let pair = if label < other { [label, other] } else { [other, label] };
            label == other || joined.binary_search(&pair).is_ok()
        };
        self.constraints_of(v).iter().any(|on| joins(on.label))
    }

    /// The labels of the faces in each cube of a lattice with this step.
    fn labels_by_cube(&self, step: f64) -> CubeLabels {
        let mut cubes = CubeLabels::new(step);
        for face in (0..self.surface.face_slots() as u32).filter(|f| self.surface.has_face(*f)) {
            let points = self.points(face);
            let low = cubes.cube(points[0].min(points[1]).min(points[2]));
            let high = cubes.cube(points[0].max(points[1]).max(points[2]));
            cubes.add(self.label[face as usize], low, high);
        }
        cubes
    }

    /// The labels of faces within reach of a vertex that face the other way and do not join the vertex's own labels in
    /// creases.
    fn labels_across(&self, v: u32, reach: f64, joined: &[[FaceLabel; 2]]) -> OpposingFaces {
        let mut across = OpposingFaces { labels: Vec::new(), n_faces: 0 };
        let at = self.at(v);
        let on = self.constraints_of(v);
        // The vertex's labels and those that join them, to be skipped.
        let mut beside: Vec<FaceLabel> = on.iter().map(|on| on.label).collect();
        self.tree.for_each_near(&FaceBox { min: at - reach, max: at + reach }, |face| {
            across.n_faces += 1;
            let label = self.label[face as usize];
            if beside.contains(&label) || across.labels.contains(&label) {
                return;
            }
            if self.joins(v, label, joined) {
                beside.push(label);
                return;
            }
            let normal = area_normal(self.points(face));
            if on.iter().any(|on| on.normal.dot(normal) < OPPOSITE * normal.length()) {
                across.labels.push(label);
            }
        });
        across
    }
}

/// The faces near a vertex.
#[derive(Clone)]
struct OpposingFaces {
    /// The labels of sheets that face the other way.
    labels: Vec<FaceLabel>,
    /// The number of faces near the vertex.
    n_faces: usize,
}

impl OpposingFaces {
    /// Whether the search can end.
    fn is_enough(&self) -> bool {
        !self.labels.is_empty() || self.n_faces > CROWD
    }
}

/// The labels of faces by cubes.
struct CubeLabels {
    step: f64,
    /// By cube: the number of its set of labels.
    cubes: IntegerMap<[i64; 3], u32>, // No order depends on it.
    /// The sets of labels; the first is empty.
    sets: Vec<LabelSet>,
    /// The labels of faces that are in many cubes.
    everywhere: Vec<FaceLabel>,
}

/// The labels of a cube. Sets are shared, since many cubes have equal ones.
#[derive(Default)]
struct LabelSet {
    labels: Vec<FaceLabel>,
    /// The numbers of the sets with one more label.
    larger: Vec<(FaceLabel, u32)>,
}

impl CubeLabels {
    fn new(step: f64) -> Self {
        Self { step, cubes: IntegerMap::default(), sets: vec![LabelSet::default()], everywhere: Vec::new() }
    }

    fn cube(&self, at: DVec3) -> [i64; 3] {
        at.to_array().map(|x| (x / self.step).floor() as i64)
    }

    fn add(&mut self, label: FaceLabel, low: [i64; 3], high: [i64; 3]) {
        let n = (0..3).map(|k| high[k].saturating_sub(low[k]).saturating_add(1)).fold(1, i64::saturating_mul);
        if n > MANY {
            if !self.everywhere.contains(&label) {
                self.everywhere.push(label);
            }
            return;
        }
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let set = self.cubes.entry([x, y, z]).or_default();
                    *set = with_label(&mut self.sets, *set, label);
                }
            }
        }
    }

    /// The labels of all faces within a step of a point.
    fn around(&self, at: DVec3) -> impl Iterator<Item = FaceLabel> + '_ {
        let [x, y, z] = self.cube(at);
        let beside = (0..27).map(move |k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
        let sets = beside.filter_map(|cube| self.cubes.get(&cube));
        let labels = sets.flat_map(|set| &self.sets[*set as usize].labels);
        labels.chain(&self.everywhere).copied()
    }
}

/// The number of the set with one more label, which is added if it is new.
fn with_label(sets: &mut Vec<LabelSet>, set: u32, label: FaceLabel) -> u32 {
    let smaller = &sets[set as usize];
    if smaller.labels.contains(&label) {
        return set;
    }
    if let Some((_, larger)) = smaller.larger.iter().find(|(other, _)| *other == label) {
        return *larger;
    }
    let mut labels = smaller.labels.clone();
    labels.push(label);
    labels.sort_unstable();
    let known = sets.iter().position(|other| other.labels == labels);
    let number = known.unwrap_or(sets.len()) as u32;
    if known.is_none() {
        sets.push(LabelSet { labels, larger: Vec::new() });
    }
    sets[set as usize].larger.push((label, number));
    number
}
