//! `FaceMaterials`: the materials of a CSG tree, by the labels of faces.
use super::border_functions::PartPairs;
use super::improve::FaceLabel;
use crate::budget::Job;
use crate::implicit::csg::{BlendPart, CsgMaterials, MaterialChoice};
use crate::implicit::{Csg, Membership};

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
    pub(super) fn first(&self, label: FaceLabel, at: [f64; 3]) -> u32 {
        let nearest = |parts: &[BlendPart]| nearest_part(parts, at);
        match self.materials.first(self.csg.tree(), primitive(label), nearest) {
            MaterialChoice::One(number) => number,
            _ => 0,
        }
    }

    /// The label of the primitive that determines the field's value.
    pub(super) fn nearest_label(&self, values: &[f64]) -> FaceLabel {
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
