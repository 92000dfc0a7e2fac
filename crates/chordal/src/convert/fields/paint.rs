//! Assigns materials to the faces of a field's mesh.
use super::face_materials::FaceMaterials;
use super::improve::FaceLabel;
use super::material_borders::{BorderedMesh, cut_at_borders};
use super::mesher::leaf_failure;
use crate::budget::{Bound, Bounded, Failure, Reference, Tolerance, par_map};
use crate::explicit::{Attribute, Domain, Mesh, Semantic};
use crate::implicit::csg::MaterialChoice;
use crate::implicit::{LeafError, Membership, PrimitiveEvaluator};

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

impl FaceMaterials<'_> {
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
}

fn middle([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
}
