//! `PropertyGroup`: materials and colours of a model, and the attributes of a mesh from them.
use super::meshes::{ModelMesh, NOTHING, TriangleProperties};
use crate::grow::with_room;
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{FileLocation, ReadError};
use chordal::explicit::{Attribute, Domain, Semantic};
use std::collections::BTreeMap;

/// The kind of the face groups that represent materials.
pub(super) const MATERIAL: &str = "material";
/// The largest value of a channel. Defined: colours are bytes.
pub(super) const CHANNEL: f64 = 255.0;

/// A colour: red, green, blue and opacity, as sRGB bytes.
pub(super) type ColorBytes = [u8; 4];

/// The colour if none is known.
pub(super) const WHITE: ColorBytes = [0xFF; 4];

/// A property group; triangles refer to it by its id.
#[derive(Clone, Debug)]
pub(super) enum PropertyGroup {
    /// Materials; the first one has this number, the others follow.
    Materials {
        first: u32,
        colors: Vec<ColorBytes>,
    },
    Colors(Vec<ColorBytes>),
    /// Textures and mixtures; only their count matters.
    Skipped(u32),
}

impl PropertyGroup {
    fn len(&self) -> u32 {
        match self {
            Self::Materials { colors, .. } | Self::Colors(colors) => colors.len() as u32,
            Self::Skipped(n) => *n,
        }
    }
}

/// Parses `#RRGGBB` or `#RRGGBBAA`.
pub(super) fn color(text: &str) -> Option<ColorBytes> {
    let digits = text.trim().strip_prefix('#')?;
    if !matches!(digits.len(), 6 | 8) || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let value = u32::from_str_radix(digits, 16).ok()?;
    Some(if digits.len() == 6 { (value << 8 | 0xFF).to_be_bytes() } else { value.to_be_bytes() })
}

/// The attributes of the meshes of a model.
pub(super) struct PropertyReader<'a> {
    pub groups: &'a BTreeMap<u32, PropertyGroup>,
    /// The name of the model part.
    pub part: &'a str,
    pub warnings: &'a mut Warnings,
}

impl<'a> PropertyReader<'a> {
    /// The colours of a mesh's corners, and the materials of its faces.
    ///
    /// A missing group, or a property beyond its end, is counted, and the triangle gets the default of its
    /// object: a wrong colour should not keep a shape from being read.
    ///
    /// # Errors
    /// If memory runs out.
    pub(super) fn attributes(&mut self, mesh: &ModelMesh) -> Result<Vec<Attribute>, ReadError> {
        let default = TriangleProperties { group: mesh.group, corners: [mesh.property; 3] };
        if mesh.properties.is_empty() && default.corners[0] == NOTHING {
            return Ok(Vec::new());
        }
        let (mut colors, mut materials) = (Vec::new(), Vec::new());
        let mut n_plain = 0;
        for row in 0..mesh.faces.len() {
            let stated = mesh.properties.get(row).copied().unwrap_or(TriangleProperties::NONE);
            let properties = if stated.corners[0] == NOTHING {
                default
            } else {
                TriangleProperties {
                    group: if stated.group == NOTHING { default.group } else { stated.group },
                    ..stated
                }
            };
            let mut properties = properties;
            let mut resolved = self.resolve(mesh, properties, row);
            if resolved.is_none() && properties != default {
                properties = default;
                resolved = self.resolve(mesh, default, row);
            }
            match resolved {
                Some(PropertyGroup::Materials { first, colors: group_colors }) => {
                    let property = properties.corners[0];
                    begin(&mut materials, mesh.faces.len(), 0.0)?;
                    // Group 0 is that of faces without a material.
                    materials[row] = f64::from(first + property) + 1.0;
                    begin(&mut colors, 12 * mesh.faces.len(), 1.0)?;
                    fill(&mut colors, row, [group_colors[property as usize]; 3]);
                }
                Some(PropertyGroup::Colors(group_colors)) => {
                    begin(&mut colors, 12 * mesh.faces.len(), 1.0)?;
                    fill(&mut colors, row, properties.corners.map(|corner| group_colors[corner as usize]));
                }
                Some(PropertyGroup::Skipped(_)) | None => n_plain += 1,
            }
        }
        let attribute = |semantic, domain, width, values| Attribute { semantic, domain, width, values };
        let mut attributes = Vec::new();
        if !colors.is_empty() {
            self.warnings.count_many("triangles-without-colour", n_plain, || {
                let message = "triangles without a colour of their own are white, since others have one";
                (FileLocation::File, format!("{}: {message}", self.part))
            });
            attributes.push(attribute(Semantic::Color(0), Domain::Corner, 4, colors));
        }
        if !materials.is_empty() {
            attributes.push(attribute(Semantic::Group(MATERIAL.to_owned()), Domain::Face, 1, materials));
        }
        Ok(attributes)
    }

    /// The group of a triangle, with its properties in range; `None` if it has none, or an invalid one.
    fn resolve(
        &mut self,
        mesh: &ModelMesh,
        TriangleProperties { group, corners }: TriangleProperties,
        row: usize,
    ) -> Option<&'a PropertyGroup> {
        if corners[0] == NOTHING {
            return None;
        }
        let Self { groups, part, warnings } = self;
        let place = || FileLocation::Row { list: "triangle", row: row as u64 };
        let whose = || format!("{part}: object {}", mesh.id);
        if group == NOTHING {
            let message = || format!("{}: properties of triangles without a group were skipped", whose());
            warnings.count("property-without-group", || (place(), message()));
            return None;
        }
        let mut missing = |what: String| {
            warnings.count("property-missing", || {
                let then = "such triangles have the default of their object, or none";
                (place(), format!("{}: {what}: {then}", whose()))
            });
            None
        };
        let Some(property_group) = groups.get(&group) else {
            return missing(format!("the property group {group} is not there"));
        };
        if let Some(bad) = corners.iter().find(|corner| **corner >= property_group.len()) {
            return missing(format!(
                "property {} of group {group}, which has {}",
                grouped(u64::from(*bad)),
                grouped(u64::from(property_group.len()))
            ));
        }
        Some(property_group)
    }
}

/// Fills the list with `n` values, unless it is filled already.
fn begin(list: &mut Vec<f64>, n: usize, value: f64) -> Result<(), ReadError> {
    if list.is_empty() {
        *list = with_room(n)?;
        list.resize(n, value);
    }
    Ok(())
}

/// Sets the colours of the three corners of a triangle, four channels each.
fn fill(colors: &mut [f64], row: usize, corners: [ColorBytes; 3]) {
    let bytes = corners.into_iter().flatten();
    colors[12 * row..][..12]
        .iter_mut()
        .zip(bytes)
        .for_each(|(value, byte)| *value = f64::from(byte) / CHANNEL);
}
