//! The signed distance to a mesh minus an offset, at points, with its gradient.
use crate::budget::{Job, JobError};
use crate::explicit::{
    Bvh, Mesh, PointLocation, WindingMoments, distance_sq_to_triangle, nearest_on_triangle,
};
use crate::math::{cross, difference, distance, dot, length, unit};

/// The distance to a mesh, minus an offset: its zero set is the offset surface.
pub(super) struct OffsetDistance {
    bvh: Bvh,
    moments: WindingMoments,
    /// The offset, negative inward.
    pub by: f64,
}

/// A point with its value there.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffsetSample {
    pub at: [f64; 3],
    /// The signed distance minus the offset.
    pub value: f64,
    /// The gradient, of length 1; 0 on the mesh itself.
    pub normal: [f64; 3],
}

impl OffsetSample {
    /// The point of the surface that this sample predicts.
    pub fn foot(&self) -> [f64; 3] {
        along(self.at, -self.value, self.normal)
    }

    /// The tangent plane there.
    pub fn plane(&self) -> Plane {
        Plane { at: self.foot(), normal: self.normal }
    }
}

/// A plane by a point and a normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub at: [f64; 3],
    pub normal: [f64; 3],
}

/// p + t·n
pub(super) fn along(p: [f64; 3], t: f64, n: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| p[k] + t * n[k])
}

/// The last query, which makes the next one near it cheaper. It changes no answer.
#[derive(Clone, Copy, Default)]
pub(super) struct Hint {
    row: u32,
    last: Option<LastPoint>,
}

#[derive(Clone, Copy)]
struct LastPoint {
    at: [f64; 3],
    distance: f64,
    inside: bool,
}

impl OffsetDistance {
    pub fn new(mesh: &Mesh, by: f64, job: &Job) -> Result<Self, JobError> {
        let bvh = Bvh::build(mesh, job)?;
        let moments = WindingMoments::new(mesh, &bvh);
        Ok(Self { bvh, moments, by })
    }

    /// The sample at a point.
    pub fn at(&self, at: [f64; 3], hint: &mut Hint) -> OffsetSample {
        let Some((away, row)) = self.bvh.distance_with_hint(at, hint.row) else {
            return OffsetSample { at, value: f64::INFINITY, normal: [0.0; 3] };
        };
        hint.row = row;
        // Between two points whose balls without triangles overlap, the side does not change.
        let known = hint.last.filter(|last| distance(at, last.at) < (last.distance + away) * (1.0 - 1e-9));
        let inside = known.map_or_else(|| self.is_inside(at), |last| last.inside);
        hint.last = Some(LastPoint { at, distance: away, inside });
        let (corners, _) = self.bvh.triangle_of(row);
        let outward = difference(at, nearest_on_triangle(at, corners));
        let normal = unit(outward).map_or([0.0; 3], |n| if inside { n.map(|x| -x) } else { n });
        OffsetSample { at, value: if inside { -away } else { away } - self.by, normal }
    }

    fn is_inside(&self, at: [f64; 3]) -> bool {
        let found = self.moments.enclosure(&self.bvh).inside(at);
        match found.side {
            PointLocation::Inside => true,
            PointLocation::Ambiguous => found.winding.value > 0.5,
            _ => false,
        }
    }

    /// The unit normals of the faces that can be nearest to a point of a ball, if there are at most `most`.
    pub fn normals_near(&self, middle: &OffsetSample, radius: f64, most: usize) -> Option<Vec<[f64; 3]>> {
        let reach = (middle.value + self.by).abs() + 2.0 * radius;
        let mut normals = Vec::new();
        let mut n_seen = 0;
        self.bvh.rows_near(middle.at, reach, |row| {
            n_seen += 1;
            if n_seen > 8 * most || normals.len() > most {
                return;
            }
            let (corners, _) = self.bvh.triangle_of(row);
            if distance_sq_to_triangle(middle.at, corners) <= reach * reach {
                let [a, b, c] = corners;
                normals.extend(unit(cross(difference(b, a), difference(c, a))));
            }
        });
        (n_seen <= 8 * most && normals.len() <= most).then_some(normals)
    }
}

/// The least cosine between directions and their mean; −1 without directions.
pub(super) fn narrowness(directions: impl Iterator<Item = [f64; 3]> + Clone) -> f64 {
    let sum = directions.clone().fold([0.0; 3], |sum, n| along(sum, 1.0, n));
    let size = length(sum);
    if size == 0.0 {
        return -1.0;
    }
    directions.fold(1.0, |least: f64, n| least.min(dot(n, sum) / size))
}
