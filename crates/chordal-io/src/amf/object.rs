//! `AmfObject`: the vertices and triangles of an object, and its colours.
use crate::assemble::{RawMesh, mesh};
use crate::grow::{push, with_room};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, MATERIAL, Part, ReadError};
use chordal::explicit::{Attribute, Domain, Semantic};
use std::collections::BTreeMap;

/// Red, green, blue and opacity.
pub(super) type AmfColor = [f64; 4];

/// The colour of objects without one.
const WHITE: AmfColor = [1.0; 4];

/// A material.
#[derive(Clone, Debug)]
pub(super) struct AmfMaterial {
    /// Its number in the list of names, from 1.
    pub number: u32,
    pub color: Option<AmfColor>,
}

/// A volume: a run of triangles.
#[derive(Clone, Debug, Default)]
pub(super) struct AmfVolume {
    pub first: usize,
    pub name: String,
    pub material: Option<String>,
    pub color: Option<AmfColor>,
    pub line: u32,
}

/// Colours by row; most objects have none.
#[derive(Clone, Debug, Default)]
pub(super) struct RowColors(Vec<Option<AmfColor>>);

impl RowColors {
    /// Sets the colour of a row, whether or not the rows before it are set.
    pub(super) fn set(&mut self, row: usize, color: AmfColor) -> Result<(), ReadError> {
        while self.0.len() < row {
            push(&mut self.0, None)?;
        }
        match self.0.get_mut(row) {
            Some(known) => *known = Some(color),
            None => push(&mut self.0, Some(color))?,
        }
        Ok(())
    }

    fn get(&self, row: usize) -> Option<AmfColor> {
        self.0.get(row).copied().flatten()
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// An object.
#[derive(Clone, Debug, Default)]
pub(super) struct AmfObject {
    pub name: String,
    pub color: Option<AmfColor>,
    pub positions: Vec<[f64; 3]>,
    pub vertex_colors: RowColors,
    pub faces: Vec<[u32; 3]>,
    pub face_colors: RowColors,
    pub volumes: Vec<AmfVolume>,
}

/// The names shared by the objects of a file.
#[derive(Debug, Default)]
pub(super) struct AmfNames {
    pub materials: BTreeMap<String, AmfMaterial>,
    /// The names of volumes, for all objects that have several.
    pub volumes: Vec<String>,
}

/// The kind of the face groups that represent volumes.
pub(super) const VOLUME: &str = "volume";

impl AmfObject {
    /// The part for this object.
    ///
    /// # Errors
    /// If a material is missing.
    pub(super) fn part(
        self,
        names: &mut AmfNames,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Part, ReadError> {
        let n = self.faces.len();
        let mut attributes = Vec::new();
        attributes.extend(self.colors(names, warnings)?);
        let face = |kind: &str, values| Attribute {
            semantic: Semantic::Group(kind.to_owned()),
            domain: Domain::Face,
            width: 1,
            values,
        };
        let has_material = self.volumes.iter().any(|volume| volume.material.is_some());
        if has_material && n > 0 {
            let mut values = with_room(n)?;
            for (volume, n_faces) in self.runs() {
                let number = material(volume, names)?.map_or(0, |material| material.number);
                values.resize(values.len() + n_faces, f64::from(number));
            }
            attributes.push(face(MATERIAL, values));
        }
        // One volume is the object itself, and needs no group.
        if self.volumes.len() > 1 && n > 0 {
            let mut values = with_room(n)?;
            for (volume, n_faces) in self.runs() {
                push(&mut names.volumes, volume.name.clone())?;
                values.resize(values.len() + n_faces, names.volumes.len() as f64);
            }
            attributes.push(face(VOLUME, values));
        }
        let raw = RawMesh { positions: self.positions, position_id: None, faces: self.faces, attributes };
        Ok(Part { name: self.name, mesh: mesh(raw, limits, warnings)?, indexed: true, ..Part::default() })
    }

    /// The volumes with the number of their triangles. All triangles are in volumes.
    fn runs(&self) -> impl Iterator<Item = (&AmfVolume, usize)> {
        let ends = self.volumes.iter().skip(1).map(|volume| volume.first).chain([self.faces.len()]);
        self.volumes.iter().zip(ends).map(|(volume, end)| (volume, end - volume.first))
    }

    /// The colours of corners, if there are any. The colour of a triangle takes precedence over that of a
    /// vertex, then follow those of the volume, the object and the material.
    fn colors(&self, names: &AmfNames, warnings: &mut Warnings) -> Result<Option<Attribute>, ReadError> {
        let mut has_any =
            self.color.is_some() || !self.vertex_colors.is_empty() || !self.face_colors.is_empty();
        for volume in &self.volumes {
            has_any |= volume.color.is_some() || material(volume, names)?.is_some_and(|m| m.color.is_some());
        }
        if !has_any || self.faces.is_empty() {
            return Ok(None);
        }
        let mut values = with_room(12 * self.faces.len())?;
        let (mut row, mut n_white) = (0, 0);
        for (volume, n_faces) in self.runs() {
            let of_material = material(volume, names)?.and_then(|material| material.color);
            let volume_color = volume.color.or(self.color).or(of_material);
            for face in &self.faces[row..row + n_faces] {
                let face_color = self.face_colors.get(row);
                let corner = |vertex: u32| {
                    face_color.or_else(|| self.vertex_colors.get(vertex as usize)).or(volume_color)
                };
                n_white += u64::from(face.iter().any(|vertex| corner(*vertex).is_none()));
                values.extend(face.iter().flat_map(|vertex| corner(*vertex).unwrap_or(WHITE)));
                row += 1;
            }
        }
        let message = "triangles without a colour of their own are white, since others have one";
        warnings.count_all("triangles-without-colour", n_white, message);
        let semantic = Semantic::Color(0);
        Ok(Some(Attribute { semantic, domain: Domain::Corner, width: 4, values }))
    }
}

fn material<'n>(volume: &AmfVolume, names: &'n AmfNames) -> Result<Option<&'n AmfMaterial>, ReadError> {
    let Some(id) = &volume.material else { return Ok(None) };
    names.materials.get(id).map(Some).ok_or_else(|| {
        let message = format!("the material {} is not there", crate::text::show(id.as_bytes()));
        ReadError::new("missing-material", FileLocation::Line(u64::from(volume.line)), message)
    })
}
