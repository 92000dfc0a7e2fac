//! `FaceMaterials`: gives the faces of a field's mesh the numbers of their materials.
use super::border_functions::PartPairs;
use super::improve::FaceLabel;
use super::material_borders::{BorderedMesh, cut_at_borders};
use super::mesher::leaf_failure;
use crate::budget::{Bound, Bounded, Failure, Job, Reference, Tolerance, par_map};
use crate::explicit::{Attribute, Domain, Mesh, Semantic};
use crate::implicit::csg::{BlendPart, CsgMaterials, MaterialChoice};
use crate::implicit::{Csg, LeafError, Membership, PrimitiveEvaluator};

/// The kind of the group of faces that names their materials.
const MATERIAL: &str = "material";
/// The kind of the group of faces that holds their labels on the way.
const LABEL: &str = "primitive";
/// Faces in one task.
const CHUNK: usize = 1024;
/// Borders are this share of the diagonal off where the budget has no length and nothing is known. Chosen.
const COARSE: f64 = 1.0 / 1024.0;

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
    pub(super) csg: &'a Csg,
    pub(super) job: &'a Job,
    pub(super) pairs: PartPairs<'a>,
    materials: &'a CsgMaterials,
    /// By label: what holds wherever a face is.
    everywhere: Vec<MaterialChoice>,
}

impl<'a> FaceMaterials<'a> {
    /// None if the tree has none.
    pub fn new(csg: &'a Csg, job: &'a Job) -> Option<Self> {
        let materials = csg.materials()?;
        let pairs = PartPairs::new(csg, materials);
        let mut own = Self { csg, job, pairs, materials, everywhere: Vec::new() };
        let of_places = materials.of_places(csg.tree(), csg.primitives().len());
        let everywhere = (0..).zip(of_places).map(|(label, places)| match places {
            // A material of its own stays wherever a face is; none may be filled in.
            MaterialChoice::One(0) | MaterialChoice::Several => {
                own.choice(label, |_| Membership::Unknown, None)
            }
            known => known,
        });
        let everywhere: Vec<MaterialChoice> = everywhere.collect();
        own.everywhere = everywhere;
        Some(own)
    }

    /// The mesh of a result with the numbers of the materials of its faces, 0 for none, as the group `material`, in
    /// their order. Faces that several materials share are cut within a length.
    pub fn paint(
        &self,
        made: Result<Bounded<Mesh>, Failure<Mesh>>,
        length: Option<Tolerance>,
    ) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        let paint = |made: Bounded<Mesh>| -> Result<Bounded<Mesh>, Failure<Mesh>> {
            let at_most = made.bound.at_most().filter(|most| *most > 0.0);
            let coarse = COARSE * made.shape.bounds().diagonal();
            let tol = length.map(Tolerance::get).or(at_most).unwrap_or(coarse);
            let (shape, moved) = self.paint_mesh(&made.shape, tol).map_err(leaf_failure)?;
            let step = Bound::proved(0.0, moved, Reference::InputTriangles);
            let bound = if moved > 0.0 { made.bound.then(&step) } else { made.bound };
            Ok(Bounded { shape, bound })
        };
        let is_within = |made: &Bounded<Mesh>| {
            length.is_none_or(|length| made.bound.at_most().is_none_or(|most| most <= length.get()))
        };
        match made {
            // What rounding adds may be too much for a length that was met by a hair.
            Ok(made) => match paint(made)? {
                painted if is_within(&painted) => Ok(painted),
                painted => Err(Failure::Unmet(Box::new(painted))),
            },
            Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(paint(*best)?))),
            other => other,
        }
    }

    /// The mesh, and how far it was moved at most. Where its faces have no labels, each belongs to the primitive
    /// that has the value of the whole in its middle.
    fn paint_mesh(&self, mesh: &Mesh, tol: f64) -> Result<(Mesh, f64), LeafError> {
        let Some(labels) = mesh.attribute(&Semantic::Group(LABEL.to_owned())) else {
            let numbers = self.by_middles(mesh, None, vec![None; mesh.faces().len()])?;
            return Ok((with_group(mesh.clone(), MATERIAL, &numbers), 0.0));
        };
        let labels: Vec<FaceLabel> = labels.values.iter().map(|x| *x as FaceLabel).collect();
        let BorderedMesh { positions, faces, labels, materials, moved } =
            cut_at_borders(mesh, labels, self, tol)?;
        let whole = Mesh::new(positions, faces).expect("its vertices are those of a mesh, or on its edges");
        let numbers = self.by_middles(&whole, Some(&labels), materials)?;
        let mut order: Vec<usize> = (0..numbers.len()).collect();
        order.sort_by_key(|face| numbers[*face]);
        let faces = order.iter().map(|face| whole.faces()[*face]).collect();
        let sorted = Mesh::new(whole.positions().to_vec(), faces).expect("it has the same faces");
        let numbers: Vec<u32> = order.into_iter().map(|face| numbers[face]).collect();
        Ok((with_group(sorted, MATERIAL, &numbers), moved))
    }

    /// The materials of faces; those that are not known by the sides in their middles.
    fn by_middles(
        &self,
        mesh: &Mesh,
        labels: Option<&[FaceLabel]>,
        mut known: Vec<Option<u32>>,
    ) -> Result<Vec<u32>, LeafError> {
        let open: Vec<usize> = (0..known.len()).filter(|face| known[*face].is_none()).collect();
        let n_primitives = self.csg.primitives().len();
        let mut evaluator = PrimitiveEvaluator::new(self.csg, &mesh.bounds(), self.job);
        for faces in open.chunks(CHUNK) {
            let middles: Vec<[f64; 3]> = faces.iter().map(|face| middle(mesh.corners(*face))).collect();
            let asks: Vec<(u32, [f64; 3])> =
                middles.iter().flat_map(|at| (0..n_primitives as u32).map(|p| (p, *at))).collect();
            let values = evaluator.values(&asks)?;
            let rows: Vec<(usize, &[f64])> = faces.iter().copied().zip(values.chunks(n_primitives)).collect();
            let found = par_map(self.job, &rows, |k, (face, values)| {
                let label = labels.map_or_else(|| self.nearest_label(values), |labels| labels[*face]);
                let side = |p: u32| Membership::from_value(values[p as usize]);
                let at = Some(middles[k]);
                // Near another primitive the middle of a face may be on its wrong side.
                let tried = [self.choice(label, side, at), self.choice(label, |_| Membership::Unknown, at)];
                let number = tried.into_iter().find_map(|choice| match choice {
                    MaterialChoice::One(number) => Some(number),
                    _ => None,
                });
                number.unwrap_or_else(|| self.first(label, middles[k]))
            });
            faces.iter().zip(found).for_each(|(face, number)| known[*face] = Some(number));
        }
        Ok(known.into_iter().map(Option::unwrap_or_default).collect())
    }

    /// What holds for a label wherever a face is.
    pub(super) fn everywhere(&self, label: FaceLabel) -> MaterialChoice {
        self.everywhere[label as usize]
    }

    /// The materials of a face, by the sides of the other primitives; of blends at a point, if there is one, else by
    /// the sides of their pairs of parts.
    pub(super) fn choice(
        &self,
        label: FaceLabel,
        side: impl Fn(u32) -> Membership,
        at: Option<[f64; 3]>,
    ) -> MaterialChoice {
        let nearest = |parts: &[BlendPart]| match at {
            Some(at) => nearest_part(parts, at),
            None => self.pairs.nearest(parts, &side),
        };
        self.materials.of_face(self.csg.tree(), primitive(label), &side, nearest)
    }

    /// The material where the primitive occurs first.
    fn first(&self, label: FaceLabel, at: [f64; 3]) -> u32 {
        let nearest = |parts: &[BlendPart]| nearest_part(parts, at);
        match self.materials.first(self.csg.tree(), primitive(label), nearest) {
            MaterialChoice::One(number) => number,
            _ => 0,
        }
    }

    /// The primitive that has the value of the whole.
    fn nearest_label(&self, values: &[f64]) -> FaceLabel {
        let active = self.csg.tree().active(|p| [values[p as usize]; 2]);
        active.first().map_or(0, |(p, is_complement)| 2 * p + u32::from(*is_complement))
    }
}

/// The primitive of a label, and whether it occurs as its complement.
fn primitive(label: FaceLabel) -> (u32, bool) {
    (label / 2, label % 2 == 1)
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
