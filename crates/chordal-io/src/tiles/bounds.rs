//! Bounding boxes of tiles: around a GLB that Chordal writes, as a viewer shows it.
use crate::glb::{StoredPositions, storage_of};
use crate::matrix::IDENTITY;
use crate::{Axis, CoordinateOverflow, Part, Scene, WriteError};
use chordal::math::{Box3, Interval, greater, mul_down, mul_up};

/// The box, in tile coordinates, of a scene as [`crate::glb::write`] writes it.
///
/// Tiles are z-up and in metres. GLB is y-up and in metres, and a viewer rotates it by (x, y, z) → (x, −z,
/// y). So a z-up scene keeps its coordinates, any other is rotated, and a known unit scales both, as the
/// writer's frame nodes and a viewer do together. The box holds every stored position, taken exactly, with
/// all rounding outward. It is the smallest such box if no node has a transform, no unit is known, and parts
/// are not far from zero compared with their size.
///
/// Linear in the number of vertices. Empty for a scene that shows nothing.
///
/// # Errors
/// [`WriteError::Unsupported`] if the writer would refuse the scene: nodes are not a tree or not affine, the
/// unit is not a valid length, or coordinates overflow.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Frame, Scene, tiles};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], vec![[0, 1, 2]])?;
/// let bounds = tiles::content_bounds(&Scene::from_mesh("flat", mesh, Frame::default()))?;
/// assert_eq!((bounds.min, bounds.max), ([0.0, 0.0, 0.0], [1.0, 0.0, 2.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn content_bounds(scene: &Scene) -> Result<Box3, WriteError> {
    let stored_as = |part: &Part| StoredPositions::new(&part.mesh, storage_of(part, scene.packing));
    let stored: Vec<StoredPositions> = scene.parts.iter().map(stored_as).collect();
    let mut seen = vec![false; scene.nodes.len()];
    let mut open: Vec<(usize, IntervalAffine)> =
        scene.roots.iter().map(|root| (*root, IntervalAffine::identity())).collect();
    let mut bounds = Box3::EMPTY;
    while let Some((index, parent)) = open.pop() {
        let unsupported = |what: &str| WriteError::Unsupported(format!("node {index} {what}"));
        let node = scene.nodes.get(index).ok_or_else(|| unsupported("is not there"))?;
        if std::mem::replace(&mut seen[index], true) {
            return Err(unsupported("is reached twice: nodes must be a tree"));
        }
        let local = IntervalAffine::from_matrix(&node.matrix)
            .ok_or_else(|| unsupported("has a matrix that is not affine"))?;
        let place = parent.times(&local);
        if let Some(part) = node.part {
            let shown = scene.parts.get(part).ok_or_else(|| unsupported("shows a part that is not there"))?;
            bounds = bounds.union(place.bounds(shown, &stored[part])?);
        }
        open.extend(node.children.iter().map(|child| (*child, place.clone())));
    }
    in_tile_space(bounds, scene)
}

/// Converts a box to a tile's: the centre, then the half axes along x, y and z. Computing centre ± half axis,
/// in double precision or exactly, gives a box that contains this one and is larger by about two units in the
/// last place.
///
/// ```
/// use chordal::math::Box3;
/// let unit = Box3 { min: [0.0; 3], max: [1.0; 3] };
/// let volume = chordal_io::tiles::aligned_box(&unit);
/// assert_eq!(volume, [0.5, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.5]);
/// ```
#[must_use]
pub fn aligned_box(bounds: &Box3) -> [f64; 12] {
    let centre = bounds.centre();
    let mut volume = [0.0; 12];
    volume[..3].copy_from_slice(&centre);
    for k in 0..3 {
        let (below, above) = (centre[k] - bounds.min[k], bounds.max[k] - centre[k]);
        let half = greater(above, below);
        // The rounded difference may be half a step short, unless adding it back exactly shows that it was
        // not rounded.
        let exact = centre[k] - half <= bounds.min[k]
            && centre[k] + half >= bounds.max[k]
            && (half == 0.0 || is_sum(centre[k], half));
        volume[3 + 4 * k] = if exact { half } else { half.next_up() };
    }
    volume
}

/// Whether `a − b` and `a + b` are computed without rounding: the error of a sum is itself a floating-point
/// number, and can be computed.
///
/// Source: Knuth, The Art of Computer Programming, volume 2, 4.2.2, theorem B.
fn is_sum(a: f64, b: f64) -> bool {
    let error = |a: f64, b: f64| {
        let sum = a + b;
        let part = sum - a;
        (a - (sum - part)) + (b - part)
    };
    error(a, b) == 0.0 && error(a, -b) == 0.0
}

/// Converts a box from scene to tile coordinates.
fn in_tile_space(bounds: Box3, scene: &Scene) -> Result<Box3, WriteError> {
    if bounds.is_empty() {
        return Ok(bounds);
    }
    let unit = scene.frame.metres_per_unit.unwrap_or(1.0);
    if !(unit.is_normal() && unit > 0.0) {
        return Err(WriteError::Unsupported(format!("a unit of {unit} m is no length")));
    }
    let turned = match scene.frame.up {
        Some(Axis::Z) => bounds,
        Some(Axis::Y) | None => Box3 {
            min: [bounds.min[0], 0.0 - bounds.max[2], bounds.min[1]],
            max: [bounds.max[0], 0.0 - bounds.min[2], bounds.max[1]],
        },
    };
    let scaled = if unit == 1.0 {
        turned
    } else {
        Box3 { min: turned.min.map(|x| mul_down(x, unit)), max: turned.max.map(|x| mul_up(x, unit)) }
    };
    match scaled.min.iter().chain(&scaled.max).find(|x| !x.is_finite()) {
        Some(value) => Err(CoordinateOverflow { value: *value }.into()),
        None => Ok(scaled),
    }
}

/// An affine map whose numbers are known up to rounding: three rows of four.
#[derive(Clone)]
struct IntervalAffine {
    rows: [[Interval; 4]; 3],
    is_identity: bool,
}

impl IntervalAffine {
    fn identity() -> Self {
        let rows =
            std::array::from_fn(|i| std::array::from_fn(|j| Interval::point(if i == j { 1.0 } else { 0.0 })));
        Self { rows, is_identity: true }
    }

    fn from_matrix(matrix: &[f64; 16]) -> Option<Self> {
        let is_affine = matrix.iter().all(|x| x.is_finite())
            && [matrix[3], matrix[7], matrix[11], matrix[15]] == [0.0, 0.0, 0.0, 1.0];
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| Interval::point(matrix[4 * j + i])));
        is_affine.then_some(Self { rows, is_identity: *matrix == IDENTITY })
    }

    fn times(&self, inner: &Self) -> Self {
        if self.is_identity {
            return inner.clone();
        }
        if inner.is_identity {
            return self.clone();
        }
        let column = |j: usize| std::array::from_fn(|i| inner.rows[i][j]);
        let columns = [self.turn(column(0)), self.turn(column(1)), self.turn(column(2)), self.map(column(3))];
        Self { rows: std::array::from_fn(|i| columns.map(|column| column[i])), is_identity: false }
    }

    /// Maps a direction.
    fn turn(&self, v: [Interval; 3]) -> [Interval; 3] {
        self.rows.map(|row| (row[0] * v[0] + row[1] * v[1]) + row[2] * v[2])
    }

    /// Maps a point.
    fn map(&self, p: [Interval; 3]) -> [Interval; 3] {
        let turned = self.turn(p);
        std::array::from_fn(|i| turned[i] + self.rows[i][3])
    }

    /// The box of a part as it is stored.
    fn bounds(&self, part: &Part, stored: &StoredPositions) -> Result<Box3, WriteError> {
        let mut bounds = Box3::EMPTY;
        for position in part.mesh.positions() {
            let point = stored.placed(*position);
            let point: [Interval; 3] = if self.is_identity { point } else { self.map(point) };
            if point.iter().any(|x| !(x.lo().is_finite() && x.hi().is_finite())) {
                let value = position.iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
                return Err(CoordinateOverflow { value }.into());
            }
            let ends = Box3 { min: point.map(Interval::lo), max: point.map(Interval::hi) };
            bounds = bounds.union(ends);
        }
        // Adding zero removes the sign of −0.
        Ok(Box3 { min: bounds.min.map(|x| x + 0.0), max: bounds.max.map(|x| x + 0.0) })
    }
}
