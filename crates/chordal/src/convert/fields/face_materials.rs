//! `FaceMaterials`: assigns materials to the faces of a field's mesh.
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
/// The kind of the group of faces that holds their labels until materials are assigned.
const LABEL: &str = "primitive";
/// Faces in one task.
const CHUNK: usize = 1024;
/// The tolerance of borders, relative to the diagonal, if neither the budget nor the bound has a length. Chosen: smaller
/// gives more faces along borders.
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
    /// By label: the material if it is the same at every face.
    everywhere: Vec<MaterialChoice>,
}

impl<'a> FaceMaterials<'a> {
    /// `None` if the tree has no materials.
    pub fn new(csg: &'a Csg, job: &'a Job) -> Option<Self> {
        let materials = csg.materials()?;
        let pairs = PartPairs::new(csg, materials);
        let mut face_materials = Self { csg, job, pairs, materials, everywhere: Vec::new() };
        let of_places = materials.of_places(csg.tree(), csg.primitives().len());
        let everywhere = (0..).zip(of_places).map(|(label, places)| match places {
            // A material of its own holds at every face; a missing one may be filled in.
            MaterialChoice::One(0) | MaterialChoice::Several => {
                face_materials.choice(label, |_| Membership::Unknown, None)
            }
            decided => decided,
        });
        let everywhere: Vec<MaterialChoice> = everywhere.collect();
        face_materials.everywhere = everywhere;
        Some(face_materials)
    }

    /// The mesh of a result with the numbers of its faces' materials (0 for none) as the group `material`; faces are sorted
    /// by these. Faces that several materials share are cut along the borders, within a length.
    pub fn paint(
        &self,
        mesh: Result<Bounded<Mesh>, Failure<Mesh>>,
        length: Option<Tolerance>,
    ) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        let paint = |mesh: Bounded<Mesh>| -> Result<Bounded<Mesh>, Failure<Mesh>> {
            let at_most = mesh.bound.at_most().filter(|most| *most > 0.0);
            let coarse = COARSE * mesh.shape.bounds().diagonal();
            let tol = length.map(Tolerance::get).or(at_most).unwrap_or(coarse);
            let (shape, moved) = self.paint_mesh(&mesh.shape, tol).map_err(leaf_failure)?;
            let step = Bound::proved(0.0, moved, Reference::InputTriangles);
            let bound = if moved > 0.0 { mesh.bound.then(&step) } else { mesh.bound };
            Ok(Bounded { shape, bound })
        };
        let is_within = |mesh: &Bounded<Mesh>| {
            length.is_none_or(|length| mesh.bound.at_most().is_none_or(|most| most <= length.get()))
        };
        match mesh {
            // Rounding of the cuts is added to the bound, which may then exceed the length.
            Ok(mesh) => {
                let painted = paint(mesh)?;
                let is_met = is_within(&painted);
                painted.met_if(is_met)
            }
            Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(paint(*best)?))),
            other => other,
        }
    }

    /// The mesh, and the largest distance by which it was moved. If its faces have no labels, each belongs to the primitive
    /// that determines the field's value at its middle.
    fn paint_mesh(&self, mesh: &Mesh, tol: f64) -> Result<(Mesh, f64), LeafError> {
        let Some(labels) = mesh.attribute(&Semantic::Group(LABEL.to_owned())) else {
            let numbers = self.by_middles(mesh, None, vec![None; mesh.faces().len()])?;
            return Ok((with_group(mesh.clone(), MATERIAL, &numbers), 0.0));
        };
        let labels: Vec<FaceLabel> = labels.values.iter().map(|x| *x as FaceLabel).collect();
        let BorderedMesh { positions, faces, labels, materials, moved } =
            cut_at_borders(mesh, labels, self, tol)?;
        let bordered =
            Mesh::new(positions, faces).expect("its vertices are those of a mesh, or on its edges");
        let numbers = self.by_middles(&bordered, Some(&labels), materials)?;
        let mut order: Vec<usize> = (0..numbers.len()).collect();
        order.sort_by_key(|face| numbers[*face]);
        let faces = order.iter().map(|face| bordered.faces()[*face]).collect();
        let sorted = Mesh::new(bordered.positions().to_vec(), faces).expect("it has the same faces");
        let numbers: Vec<u32> = order.into_iter().map(|face| numbers[face]).collect();
        Ok((with_group(sorted, MATERIAL, &numbers), moved))
    }

    /// The materials of faces; unknown ones are decided by the sides of primitives at the faces' middles.
    fn by_middles(
        &self,
        mesh: &Mesh,
        labels: Option<&[FaceLabel]>,
        mut known: Vec<Option<u32>>,
    ) -> Result<Vec<u32>, LeafError> {
        let unknown: Vec<usize> = (0..known.len()).filter(|face| known[*face].is_none()).collect();
        let n_primitives = self.csg.primitives().len();
        let mut evaluator = PrimitiveEvaluator::new(self.csg, &mesh.bounds(), self.job);
        for faces in unknown.chunks(CHUNK) {
            let middles: Vec<[f64; 3]> = faces.iter().map(|face| middle(mesh.corners(*face))).collect();
            let queries: Vec<(u32, [f64; 3])> =
                middles.iter().flat_map(|point| (0..n_primitives as u32).map(|p| (p, *point))).collect();
            let values = evaluator.values(&queries)?;
            let rows: Vec<(usize, &[f64])> = faces.iter().copied().zip(values.chunks(n_primitives)).collect();
            let numbers = par_map(self.job, &rows, |k, (face, values)| {
                let label = labels.map_or_else(|| self.nearest_label(values), |labels| labels[*face]);
                let side = |p: u32| Membership::from_value(values[p as usize]);
                let point = Some(middles[k]);
                // Near another primitive the middle of a face may be on the wrong side of it.
                let choices =
                    [self.choice(label, side, point), self.choice(label, |_| Membership::Unknown, point)];
                let number = choices.into_iter().find_map(|choice| match choice {
                    MaterialChoice::One(number) => Some(number),
                    _ => None,
                });
                number.unwrap_or_else(|| self.first(label, middles[k]))
            });
            faces.iter().zip(numbers).for_each(|(face, number)| known[*face] = Some(number));
        }
        Ok(known.into_iter().map(Option::unwrap_or_default).collect())
    }

    /// The material of a label if it is the same at every face.
    pub(super) fn everywhere(&self, label: FaceLabel) -> MaterialChoice {
        self.everywhere[label as usize]
    }

    /// The material of a face, by the sides of the other primitives. In a blend the nearest part decides: at a point, if one
    /// is given, otherwise by the sides of the pairs of parts.
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

    /// The material at the primitive's first occurrence.
    fn first(&self, label: FaceLabel, at: [f64; 3]) -> u32 {
        let nearest = |parts: &[BlendPart]| nearest_part(parts, at);
        match self.materials.first(self.csg.tree(), primitive(label), nearest) {
            MaterialChoice::One(number) => number,
            _ => 0,
        }
    }

    /// The label of the primitive that determines the field's value.
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
        // A part whose leaf fails is skipped; the failure has been reported before.
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
