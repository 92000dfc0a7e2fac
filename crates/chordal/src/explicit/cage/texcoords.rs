//! `CornerTexcoords`: texture coordinates at the corners of a cage's faces, and `Chart`: the same as a
//! separate cage.
//!
//! They have their own topology: two faces are connected across an edge if their corners refer to the same
//! rows at both ends of it; otherwise a seam separates them. So they form a second, flat cage with the same
//! faces over other vertices: one for each pair of a vertex and a row that a corner at that vertex refers to.
//! Its border consists of the border of the first cage and the seams. Sharpness carries over to the second
//! cage where the two agree, and a rule determines which vertices of the second cage's border are fixed.
//!
//! Source: the rules are those of OpenSubdiv for face-varying data (its
//! `Sdc::Options::FVarLinearInterpolation`, and `vtr/fvarLevel.cpp` for their meaning).
use super::edges::{CageEdges, VertexIncidence, csr_lists, csr_row};
use super::sharpness::{CageSharpness, is_hole, n_fans};
use super::{Boundary, Cage, INFINITELY_SHARP, InvalidCage, Scheme};
use crate::math::greater;

/// Texture coordinates with their own topology: corners of neighbouring faces that refer to the same row are
/// connected, others are separated by a seam.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal::explicit::subdivision::{CornerTexcoords, LinearTexcoords};
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let values = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// let linear = LinearTexcoords::CornersOnly;
/// let cage = Cage::new(points, [[0, 1, 2, 3]])?
///     .with_texcoords(CornerTexcoords { values, corners: vec![0, 1, 2, 3], linear })?;
/// let once = cage.refined()?;
/// let texcoords = once.texcoords().unwrap();
/// // Corners of the border stay, the middle of the face is theirs.
/// assert_eq!((texcoords.values[0], texcoords.values[8]), ([0.0, 0.0], [0.5, 0.5]));
/// assert_eq!(texcoords.corners.len(), 16);
/// # Ok::<(), chordal::explicit::InvalidCage>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CornerTexcoords {
    /// n × 2, finite.
    pub values: Vec<[f64; 2]>,
    /// One row of `values`, or [`CornerTexcoords::NONE`], for each corner of the cage, face by face.
    pub corners: Vec<u32>,
    /// The places where refinement interpolates linearly.
    pub linear: LinearTexcoords,
}

impl CornerTexcoords {
    /// Marks a corner without texture coordinates. A face with such a corner has none after a round.
    pub const NONE: u32 = u32::MAX;

    fn check(&self, n_corners: usize) -> Result<(), InvalidCage> {
        if self.corners.len() != n_corners {
            return Err(InvalidCage::WrongCorners { expected: n_corners, found: self.corners.len() });
        }
        if let Some(row) = self.values.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(InvalidCage::TexcoordNotFinite { row });
        }
        let is_wrong = |row: &u32| *row != Self::NONE && *row as usize >= self.values.len();
        match self.corners.iter().find(|row| is_wrong(row)) {
            Some(&row) => Err(InvalidCage::NoSuchTexcoord { row }),
            None => Ok(()),
        }
    }
}

/// The places where refinement interpolates texture coordinates linearly, so that they are fixed: the rules
/// of OpenSubdiv's `Sdc::Options::FVarLinearInterpolation`, numbered as in the tag
/// `facevaryinginterpolateboundary`.
///
/// The *border* is that of the texture coordinates: seams and the border of the cage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearTexcoords {
    /// 0: nowhere.
    None,
    /// 1: at corners of their borders, which have only one face.
    CornersOnly,
    /// 2: also where more than two pieces meet, or one piece meets a vertex twice.
    CornersPlus1,
    /// 3: also where a seam ends within the surface, and on the other side of a corner.
    CornersPlus2,
    /// 4: along all borders.
    Boundaries,
    /// 5: everywhere.
    #[default]
    All,
}

impl LinearTexcoords {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 6] =
        [Self::None, Self::CornersOnly, Self::CornersPlus1, Self::CornersPlus2, Self::Boundaries, Self::All];
}

/// The texture coordinates of a cage as a separate cage in the plane z = 0, with the same faces.
///
/// Its limit surface has one sheet for each sheet of the cage, in the same order, whose points are the
/// texture coordinates.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal::explicit::subdivision::{CornerTexcoords, LinearTexcoords};
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 2.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let values = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// let linear = LinearTexcoords::Boundaries;
/// let cage = Cage::new(points, [[0, 1, 2, 3]])?
///     .with_texcoords(CornerTexcoords { values, corners: vec![0, 1, 2, 3], linear })?;
/// let chart = cage.chart().unwrap();
/// let jet = chart.cage().limit()?.sheet(0)?.at(0.25, 0.5)?;
/// assert!((jet.point[0] - 0.25).abs() < 1e-12 && (jet.point[1] - 0.5).abs() < 1e-12);
/// # Ok::<(), chordal::explicit::InvalidCage>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    cage: Cage,
    linear: LinearTexcoords,
    /// Faces without texture coordinates, in ascending order.
    bare: Vec<u32>,
}

impl Cage {
    /// The same cage with these texture coordinates at its corners, which replace existing ones.
    ///
    /// # Errors
    /// [`InvalidCage::WrongCorners`], [`InvalidCage::NoSuchTexcoord`] and [`InvalidCage::TexcoordNotFinite`].
    pub fn with_texcoords(mut self, texcoords: CornerTexcoords) -> Result<Self, InvalidCage> {
        texcoords.check(self.corners.len())?;
        self.texcoords = Some(texcoords);
        Ok(self)
    }

    /// The texture coordinates at its corners.
    #[must_use]
    pub fn texcoords(&self) -> Option<&CornerTexcoords> {
        self.texcoords.as_ref()
    }

    /// Its texture coordinates as a separate cage, if it has any.
    ///
    /// Edges and vertices of the chart are as sharp as those of the cage where the two coincide. Seams and
    /// the border are sharp forever, as borders are. A vertex that the cage fixes is fixed in the chart; the
    /// rule determines the others. This follows OpenSubdiv, except where its treatment would not persist
    /// beyond a round (for two pieces that fix each other, if both are creased) and where there is no
    /// surface: where edges of more than two faces are cut, or one piece meets a vertex twice, the chart
    /// decides. With [`CreasingMethod::Chaikin`](super::CreasingMethod::Chaikin) sharpness evens out within
    /// the chart.
    ///
    /// *Cost.* As for [`Cage::refined`].
    #[must_use]
    pub fn chart(&self) -> Option<Chart> {
        let texcoords = self.texcoords.as_ref()?;
        let edges = CageEdges::new(self);
        let around = VertexIncidence::new(self, &edges);
        let sharp = CageSharpness::new(self, &edges, &around);
        Some(Chart::from_texcoords(self, texcoords, &edges, &around, &sharp))
    }
}

impl Chart {
    /// The chart's vertices with texture coordinates as x and y, and its faces in the order of the cage's.
    #[must_use]
    pub fn cage(&self) -> &Cage {
        &self.cage
    }

    /// Whether a face has texture coordinates at all of its corners; otherwise its values in the chart are
    /// meaningless.
    #[must_use]
    pub fn has_face(&self, face: usize) -> bool {
        self.bare.binary_search(&(face as u32)).is_err()
    }

    pub(super) fn from_texcoords(
        cage: &Cage,
        texcoords: &CornerTexcoords,
        edges: &CageEdges,
        around: &VertexIncidence,
        sharp: &CageSharpness,
    ) -> Self {
        let mut rows = texcoords.corners.clone();
        let mut bare = Vec::new();
        for face in 0..cage.n_faces() {
            // One missing corner leaves the whole face without texture coordinates: the rules need
            // all of its corners.
            let face_rows = &mut rows[cage.sizes.range(face)];
            if face_rows.contains(&CornerTexcoords::NONE) {
                face_rows.fill(CornerTexcoords::NONE);
                bare.push(face as u32);
            }
        }
        // One vertex for each pair, so that a row used by several vertices is split.
        let pairs = || rows.iter().copied().zip(cage.corners.iter().copied());
        let mut vertices: Vec<(u32, u32)> = pairs().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |pair| vertices.binary_search(&pair).unwrap_or_default() as u32;
        let corners: Vec<u32> = pairs().map(number).collect();
        let position = |(row, _): &(u32, u32)| {
            texcoords.values.get(*row as usize).map_or([0.0; 3], |[u, v]| [*u, *v, 0.0])
        };
        let is_hole = |face: &u32| is_hole(cage, edges, around, *face as usize);
        let mut flat = Cage {
            positions: vertices.iter().map(position).collect(),
            sizes: cage.sizes.clone(),
            corners,
            scheme: cage.scheme,
            boundary: Boundary::EdgeOnly,
            creasing: cage.creasing,
            creases: Vec::new(),
            sharp_vertices: Vec::new(),
            holes: (0..cage.n_faces() as u32).filter(is_hole).collect(),
            // Vertices fixed by topology are listed here, once for all rounds.
            is_refined: true,
            texcoords: None,
        };
        let linear = texcoords.linear;
        match (linear, cage.scheme) {
            (LinearTexcoords::All, Scheme::CatmullClark) => flat.scheme = Scheme::Bilinear,
            (_, Scheme::Bilinear) => {}
            _ => {
                let flat_edges = CageEdges::new(&flat);
                let flat_incidence = VertexIncidence::new(&flat, &flat_edges);
                let sharpness = ChartSharpness {
                    cage,
                    edges,
                    incidence: around,
                    sharp,
                    flat: &flat,
                    flat_edges: &flat_edges,
                    flat_incidence: &flat_incidence,
                };
                let sharp_edges = sharpness.edges();
                let sharp_vertices = sharpness.vertices(linear, &sharp_edges);
                flat.creases = flat_edges.sharp_edges(&sharpness.creases(linear, sharp_edges));
                flat.sharp_vertices = sharp_vertices;
            }
        }
        Self { cage: flat, linear, bare }
    }

    /// Converts back to texture coordinates after some rounds, from the values and the corners of the refined
    /// chart.
    pub(super) fn texcoords(
        &self,
        rounds: u32,
        mut values: Vec<[f64; 2]>,
        mut corners: Vec<u32>,
    ) -> CornerTexcoords {
        if !self.bare.is_empty() {
            // Each corner becomes four in each round, and those of a face are consecutive.
            let grown = |corner: usize| corner << (2 * rounds);
            for face in &self.bare {
                let range = self.cage.sizes.range(*face as usize);
                corners[grown(range.start)..grown(range.end)].fill(CornerTexcoords::NONE);
            }
            drop_unused_rows(&mut values, &mut corners);
        }
        CornerTexcoords { values, corners, linear: self.linear }
    }

    /// The values at its vertices.
    pub(super) fn values(&self) -> Vec<[f64; 2]> {
        self.cage.positions.iter().map(|p| [p[0], p[1]]).collect()
    }
}

/// Removes rows that no corner refers to.
fn drop_unused_rows(values: &mut Vec<[f64; 2]>, corners: &mut [u32]) {
    let mut is_named = vec![false; values.len()];
    for row in corners.iter() {
        if let Some(is_named) = is_named.get_mut(*row as usize) {
            *is_named = true;
        }
    }
    let mut number = vec![CornerTexcoords::NONE; values.len()];
    let named: Vec<usize> = (0..values.len()).filter(|row| is_named[*row]).collect();
    named.iter().enumerate().for_each(|(new, row)| number[*row] = new as u32);
    *values = named.iter().map(|row| values[*row]).collect();
    for row in corners.iter_mut() {
        *row = number.get(*row as usize).copied().unwrap_or(CornerTexcoords::NONE);
    }
}

/// A cage and its chart.
struct ChartSharpness<'a> {
    cage: &'a Cage,
    edges: &'a CageEdges,
    incidence: &'a VertexIncidence,
    sharp: &'a CageSharpness,
    flat: &'a Cage,
    flat_edges: &'a CageEdges,
    flat_incidence: &'a VertexIncidence,
}

/// The faces at a vertex of the chart.
struct ChartSpan {
    vertex: u32,
    n_faces: usize,
    /// Its faces are not all connected, or are separated by an edge that is sharp forever.
    is_parted: bool,
    /// Its faces are not all connected.
    is_many: bool,
    /// The number of rounds for which edges between its faces fix it, 0 for none.
    rounds: f64,
}

impl ChartSharpness<'_> {
    /// The sharpness of the chart's inner edges: that of the cage's edges.
    fn edges(&self) -> Vec<f64> {
        let mut sharp = vec![0.0; self.flat_edges.ends.len()];
        for (edge, flat_edge) in self.edges.of_corner.iter().zip(&self.flat_edges.of_corner) {
            if self.flat_edges.faces(*flat_edge as usize).len() > 1 {
                sharp[*flat_edge as usize] = self.sharp.edges[*edge as usize];
            }
        }
        sharp
    }

    fn creases(&self, linear: LinearTexcoords, sharp: Vec<f64>) -> Vec<f64> {
        // With linear interpolation everywhere, no point of a triangle moves.
        if linear == LinearTexcoords::All { vec![INFINITELY_SHARP; sharp.len()] } else { sharp }
    }

    /// Edges of the cage that are seams at one end or at both.
    fn seams(&self) -> Vec<bool> {
        let mut first = vec![u32::MAX; self.edges.ends.len()];
        let mut is_seam = vec![false; first.len()];
        for (edge, flat_edge) in self.edges.of_corner.iter().zip(&self.flat_edges.of_corner) {
            let first = &mut first[*edge as usize];
            if *first == u32::MAX {
                *first = *flat_edge;
            }
            is_seam[*edge as usize] |= *first != *flat_edge;
        }
        is_seam
    }

    /// Vertices of the chart with a sharpness above 0.
    fn vertices(&self, linear: LinearTexcoords, sharp_edges: &[f64]) -> Vec<(u32, f64)> {
        if linear == LinearTexcoords::All {
            return (0..self.flat.positions.len() as u32).map(|v| (v, INFINITELY_SHARP)).collect();
        }
        let is_seam = self.seams();
        let pairs = self.cage.corners.iter().copied().zip(self.flat.corners.iter().copied());
        let (ends, chart_vertices) = csr_lists(self.cage.positions.len(), pairs);
        let mut sharp_vertices = Vec::new();
        let (mut vertices_here, mut spans): (Vec<u32>, Vec<ChartSpan>) = (Vec::new(), Vec::new());
        for vertex in 0..self.cage.positions.len() {
            vertices_here.clear();
            vertices_here.extend_from_slice(csr_row(&ends, &chart_vertices, vertex));
            vertices_here.sort_unstable();
            vertices_here.dedup();
            spans.clear();
            spans.extend(vertices_here.iter().map(|flat_vertex| self.span(*flat_vertex, sharp_edges)));
            self.add_sharp_vertices(vertex, linear, &is_seam, &spans, &mut sharp_vertices);
        }
        sharp_vertices.sort_unstable_by_key(|(vertex, _)| *vertex);
        sharp_vertices
    }

    fn span(&self, vertex: u32, sharp_edges: &[f64]) -> ChartSpan {
        let of_edges = self.flat_incidence.edges(vertex as usize);
        let sharp = of_edges.iter().map(|edge| sharp_edges[*edge as usize]);
        let is_many = n_fans(self.flat_edges, self.flat_incidence, vertex as usize) > 1;
        ChartSpan {
            vertex,
            n_faces: self.flat_incidence.faces(vertex as usize).len(),
            is_parted: is_many || sharp.clone().any(|sharp| sharp >= INFINITELY_SHARP),
            is_many,
            rounds: lasting_sharpness(sharp),
        }
    }

    /// Adds the chart's vertices at a vertex of the cage that are sharp or fixed.
    fn add_sharp_vertices(
        &self,
        vertex: usize,
        linear: LinearTexcoords,
        is_seam: &[bool],
        spans: &[ChartSpan],
        sharp_vertices: &mut Vec<(u32, f64)>,
    ) {
        let of_edges = self.incidence.edges(vertex);
        let has_seam = of_edges.iter().any(|edge| is_seam[*edge as usize]);
        let is_border = of_edges.iter().any(|edge| self.edges.faces(*edge as usize).len() == 1);
        let on_border = has_seam || is_border;
        let plus2 = linear == LinearTexcoords::CornersPlus2;
        let is_tied = plus2 || linear == LinearTexcoords::CornersPlus1;
        let stays = match (linear, spans) {
            (LinearTexcoords::Boundaries, _) => on_border,
            (_, [span]) => plus2 && has_seam && !is_border && span.n_faces > 0,
            (_, [a, b]) if is_tied => {
                a.is_parted || b.is_parted || plus2 && (a.n_faces == 1 || b.n_faces == 1)
            }
            _ => is_tied && spans.len() > 2,
        };
        for span in spans {
            let is_corner = on_border && span.n_faces == 1 && linear != LinearTexcoords::None;
            if stays || is_corner || has_seam && span.is_many {
                sharp_vertices.push((span.vertex, INFINITELY_SHARP));
                continue;
            }
            // If there are two pieces, then as long as creases fix one of them, the other is fixed as well.
            let longest = match spans {
                [a, b] if is_tied => greater(a.rounds, b.rounds),
                _ => 0.0,
            };
            let borrowed = if longest > span.rounds { longest } else { 0.0 };
            let vertex_sharpness = self.sharp.vertices[vertex];
            let sharpness = greater(vertex_sharpness, borrowed);
            if sharpness > 0.0 {
                sharp_vertices.push((span.vertex, sharpness));
            }
        }
    }
}

/// The sharpness of a vertex that is fixed as long as any edge with these sharpnesses is sharp: the number of
/// rounds before the last one, plus the mean of the fractions that remain for the last one.
fn lasting_sharpness(sharp: impl Iterator<Item = f64> + Clone) -> f64 {
    let ends = sharp.filter(|sharp| *sharp > 0.0 && *sharp < INFINITELY_SHARP);
    let largest = ends.clone().fold(0.0, |largest, sharp| greater(sharp, largest));
    if largest <= 0.0 {
        return 0.0;
    }
    let before = largest.ceil() - 1.0;
    let (mut sum, mut count) = (0.0, 0);
    for sharp in ends.filter(|sharp| *sharp > before) {
        sum += sharp - before;
        count += 1;
    }
    before + sum / f64::from(count)
}
