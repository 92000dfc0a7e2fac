//! `FaceMaterials`: gives the faces of a field's mesh the numbers of their materials.
use super::improve::FaceLabel;
use super::mesher::leaf_failure;
use crate::budget::{Bounded, Failure, Job, par_map};
use crate::explicit::{Attribute, Domain, Mesh, Semantic};
use crate::implicit::csg::{BlendPart, CsgMaterials, MaterialChoice};
use crate::implicit::{Csg, LeafError, Membership, PrimitiveEvaluator};

/// The kind of the group of faces that names their materials.
const MATERIAL: &str = "material";
/// The kind of the group of faces that holds their labels on the way.
const LABEL: &str = "primitive";
/// Faces in one task.
const CHUNK: usize = 1024;

/// The mesh with the labels of its faces, for [`FaceMaterials::paint`].
pub(super) fn with_labels(mesh: Mesh, labels: &[FaceLabel]) -> Mesh {
    with_group(mesh, LABEL, labels)
}

fn with_group(mesh: Mesh, kind: &str, numbers: &[u32]) -> Mesh {
    let group = Attribute {
        semantic: Semantic::Group(kind.to_owned()),
        domain: Domain::Face,
        width: 1,
        values: numbers.iter().map(|number| f64::from(*number)).collect(),
    };
    mesh.with_attribute(group).expect("one number for each face")
}

/// The materials of a CSG tree, for the faces of its mesh.
pub(in crate::convert) struct FaceMaterials<'a> {
    csg: &'a Csg,
    materials: &'a CsgMaterials,
    job: &'a Job,
}

impl<'a> FaceMaterials<'a> {
    /// None if the tree has none.
    pub fn new(csg: &'a Csg, job: &'a Job) -> Option<Self> {
        csg.materials().map(|materials| Self { csg, materials, job })
    }

    /// As [`Self::paint`], of the mesh of a result.
    pub fn paint_result(&self, made: Result<Bounded<Mesh>, Failure<Mesh>>) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        let paint = |made: Bounded<Mesh>| {
            let shape = self.paint(&made.shape).map_err(leaf_failure)?;
            Ok(Bounded { shape, ..made })
        };
        match made {
            Ok(made) => paint(made),
            Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(paint(*best)?))),
            other => other,
        }
    }

    /// The mesh with the numbers of the materials of its faces, 0 for none, as the group `material`. Where its
    /// faces have no labels, each belongs to the primitive that has the value of the whole in its middle.
    fn paint(&self, mesh: &Mesh) -> Result<Mesh, LeafError> {
        let n_primitives = self.csg.primitives().len();
        let labels = mesh.attribute(&Semantic::Group(LABEL.to_owned()));
        let labels = labels.map(|labels| labels.values.iter().map(|x| *x as FaceLabel).collect::<Vec<_>>());
        // What holds for a primitive wherever it is.
        let everywhere: Vec<MaterialChoice> =
            (0..2 * n_primitives as u32).map(|label| self.choice(label, |_| Membership::Unknown, None)).collect();
        let known = |face: usize| match labels.as_ref().map(|labels| everywhere[labels[face] as usize]) {
            Some(MaterialChoice::One(number)) => Some(number),
            _ => None,
        };
        let mut numbers: Vec<Option<u32>> = (0..mesh.faces().len()).map(known).collect();
        let open: Vec<usize> = (0..numbers.len()).filter(|face| numbers[*face].is_none()).collect();
        let mut evaluator = PrimitiveEvaluator::new(self.csg, &mesh.bounds(), self.job);
        for faces in open.chunks(CHUNK) {
            let middles: Vec<[f64; 3]> = faces.iter().map(|face| middle(mesh.corners(*face))).collect();
            let asks: Vec<(u32, [f64; 3])> =
                middles.iter().flat_map(|at| (0..n_primitives as u32).map(|p| (p, *at))).collect();
            let values = evaluator.values(&asks)?;
            let rows: Vec<(usize, &[f64])> = faces.iter().copied().zip(values.chunks(n_primitives)).collect();
            let found = par_map(self.job, &rows, |k, (face, values)| {
                let label = labels.as_ref().map_or_else(|| self.nearest_label(values), |labels| labels[*face]);
                let side = |p: u32| Membership::from_value(values[p as usize]);
                match self.choice(label, side, Some(middles[k])) {
                    MaterialChoice::One(number) => number,
                    // Near a border, where the middle of a face is off the surface.
                    _ => match everywhere[label as usize] {
                        MaterialChoice::One(number) => number,
                        _ => 0,
                    },
                }
            });
            faces.iter().zip(found).for_each(|(face, number)| numbers[*face] = Some(number));
        }
        let numbers: Vec<u32> = numbers.into_iter().map(Option::unwrap_or_default).collect();
        let others = mesh.attributes().iter().filter(|one| one.semantic != Semantic::Group(LABEL.to_owned()));
        let plain = mesh.with_only(others.cloned()).expect("it had these attributes");
        Ok(with_group(plain, MATERIAL, &numbers))
    }

    /// The material of a face; of blends at a point, if there is one.
    fn choice(
        &self,
        label: FaceLabel,
        side: impl FnMut(u32) -> Membership,
        at: Option<[f64; 3]>,
    ) -> MaterialChoice {
        let nearest = |parts: &[BlendPart]| match at {
            Some(at) => nearest_part(parts, at),
            None => MaterialChoice::Several,
        };
        self.materials.of_face(self.csg.tree(), (label / 2, label % 2 == 1), side, nearest)
    }

    /// The primitive that has the value of the whole.
    fn nearest_label(&self, values: &[f64]) -> FaceLabel {
        let ranges = |p: u32| [values[p as usize]; 2];
        let active = self.csg.tree().active(ranges);
        active.first().map_or(0, |(p, is_complement)| 2 * p + u32::from(*is_complement))
    }
}

/// The material of the part of a blend whose own surface is nearest, by its value.
fn nearest_part(parts: &[BlendPart], at: [f64; 3]) -> MaterialChoice {
    let mut best = (f64::INFINITY, MaterialChoice::Several);
    for part in parts {
        let mut value = [f64::NAN];
        // A leaf that fails says nothing; it has failed before.
        let size = part.tape.at(&[at], &mut value).map_or(f64::NAN, |()| (part.scale * value[0]).abs());
        if size < best.0 {
            best = (size, MaterialChoice::One(part.material));
        }
    }
    best.1
}

fn middle([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
}
