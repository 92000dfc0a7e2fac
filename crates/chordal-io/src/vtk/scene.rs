//! The code shared by the two forms of VTK files: points, and parts of a scene.
use super::attributes::VtkAttributes;
use super::number_array::NumberArray;
use super::surface::VtkSurface;
use crate::assemble::{RawMesh, mesh, too_many_rows};
use crate::grow::{push_large, with_room};
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{FileLocation, Frame, Limits, Node, Part, ReadError, Scene, TextureOrigin};
use serde_json::Value;

/// The points of a piece.
pub(super) struct Positions<'n> {
    pub numbers: &'n NumberArray<'n>,
    pub n_points: u64,
    pub limits: &'n Limits,
}

impl Positions<'_> {
    /// The points, all finite unless the limits allow others.
    ///
    /// # Errors
    /// If there are fewer than the file declares, or too many.
    pub(super) fn read(
        &self,
        place: impl Fn() -> FileLocation,
        warnings: &mut Warnings,
    ) -> Result<Vec<[f64; 3]>, ReadError> {
        let n = self.n_points;
        // The highest index is reserved for "no vertex".
        let most = self.limits.rows.min(u64::from(u32::MAX) - 1);
        if n > most {
            return Err(too_many_rows(place(), "points", n, most));
        }
        let n_present = self.numbers.len() as u64;
        if n_present < 3 * n {
            let message = format!(
                "{} points need {} coordinates, and there are {}",
                grouped(n),
                grouped(3 * n),
                grouped(n_present)
            );
            return Err(ReadError::new("truncated", place(), message));
        }
        warnings.count_many("values-left-over", n_present - 3 * n, || {
            (place(), "coordinates after those of the last point were not used".to_owned())
        });
        let mut positions: Vec<[f64; 3]> = with_room(n as usize)?;
        self.numbers.each_block(3 * n as usize, |block| positions.extend_from_slice(block.as_chunks().0));
        let is_bad = |position: &[f64; 3]| position.iter().any(|x| !x.is_finite());
        if !self.limits.drop_nonfinite
            && let Some(row) = positions.iter().position(is_bad)
        {
            let k = (0..2).find(|k| !positions[row][*k].is_finite()).unwrap_or(2);
            let message = format!("{} = {} is not finite", ["x", "y", "z"][k], positions[row][k]);
            let place = FileLocation::Row { list: "point", row: row as u64 };
            return Err(ReadError::new("not-finite", place, message));
        }
        Ok(positions)
    }
}

/// The content of a piece.
pub(super) struct PieceMesh {
    pub positions: Vec<[f64; 3]>,
    pub surface: VtkSurface,
    pub attributes: VtkAttributes,
}

impl PieceMesh {
    /// The part for this piece.
    pub(super) fn part(self, limits: &Limits, warnings: &mut Warnings) -> Result<Part, ReadError> {
        let Self { positions, surface, attributes } = self;
        let place = |row| FileLocation::Row { list: "cell", row };
        let faces = surface.faces.cut(&positions, place, warnings);
        let VtkAttributes { list, position_id, .. } = attributes;
        let raw = RawMesh { positions, position_id, faces, attributes: list };
        Ok(Part { mesh: mesh(raw, limits, warnings)?, indexed: true, ..Part::default() })
    }
}

/// The scene of untransformed parts. In VTK, texture coordinates begin at the lower left corner.
pub(super) fn scene_of(parts: Vec<Part>, certificate: Option<Value>) -> Result<Scene, ReadError> {
    let frame = Frame { texture_origin: Some(TextureOrigin::LowerLeft), ..Frame::default() };
    let mut scene = Scene { frame, certificate, ..Scene::default() };
    for part in 0..parts.len() {
        push_large(&mut scene.nodes, Node { part: Some(part), ..Node::default() })?;
    }
    scene.roots = (0..parts.len()).collect();
    scene.parts = parts;
    Ok(scene)
}
