//! What there is to know of a format by its row in the table: names, what content looks like, what it holds.
use crate::SceneAssets;
use crate::format::Format;
use crate::format_columns::{PositionPrecision, VertexRows};
use crate::format_table::{BY_CONTENT, FormatRow, TABLE};
use crate::unknown_format::UnknownFormat;
use crate::volume::inflate::{MAGIC, peek};
use chordal::explicit::Topology;
use std::fmt;
use std::str::FromStr;

impl Format {
    /// All formats.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.format)
    }

    pub(crate) fn row(self) -> &'static FormatRow {
        &TABLE[self as usize]
    }

    /// The format of an extension, with or without its dot, in any case; `nii.gz` is one too.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        let name = extension.strip_prefix('.').unwrap_or(extension);
        let is_name = |known: &&str| known.eq_ignore_ascii_case(name);
        let has_name = |row: &&FormatRow| is_name(&row.name) || row.extensions.iter().any(is_name);
        TABLE.iter().find(has_name).map(|row| row.format)
    }

    /// The format of an extension of a file that is read: [`crate::read`] unpacks what is gzipped, so that
    /// `obj.gz` is one too.
    ///
    /// ```
    /// use chordal_io::Format;
    /// assert_eq!(Format::from_packed_extension("obj.gz"), Some(Format::Obj));
    /// assert_eq!(Format::from_extension("obj.gz"), None);
    /// ```
    #[must_use]
    pub fn from_packed_extension(extension: &str) -> Option<Self> {
        let packed = || {
            let at = extension.len().checked_sub(".gz".len())?;
            let is_packed = extension.get(at..)?.eq_ignore_ascii_case(".gz");
            if is_packed { Self::from_extension(&extension[..at]) } else { None }
        };
        Self::from_extension(extension).or_else(packed)
    }

    /// The format that the content looks like, whatever its extension. Looks only at as much as it must; of a
    /// gzipped file at its first 64 KiB. A reader may still refuse the file.
    #[must_use]
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        /// What is unpacked, which is more than any format needs that is told by its first bytes.
        const HEAD: usize = 1 << 16;
        if bytes.starts_with(&MAGIC) {
            let head = peek(bytes, HEAD);
            return BY_CONTENT.into_iter().find(|format| (format.row().looks_like)(&head));
        }
        BY_CONTENT.into_iter().find(|format| (format.row().looks_like)(bytes))
    }

    /// Whether triangles can be written in it.
    ///
    /// ```
    /// use chordal_io::Format;
    /// assert!(Format::Glb.holds_triangles() && !Format::Bpt.holds_triangles());
    /// ```
    #[must_use]
    pub fn holds_triangles(self) -> bool {
        self.row().triangles.is_some()
    }

    /// Whether what it names can stand in files beside it, instead of in it; see [`crate::write_files`].
    #[must_use]
    pub fn has_side_files(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.write_files.is_some())
    }

    /// Whether the format names files beside it for what these assets have: an OBJ its materials. A document
    /// alone is then less than the whole.
    #[must_use]
    pub fn names_files(self, assets: &SceneAssets) -> bool {
        let has_some = self.row().triangles.as_ref().is_some_and(|held| held.has_materials_beside);
        has_some && !assets.materials.is_empty()
    }

    /// Whether polygons of any number of corners can be written in it.
    #[must_use]
    pub fn holds_polygons(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.polygons.is_some())
    }

    /// Whether polygons in a file of it may be a cage, whose surface is smooth.
    #[must_use]
    pub fn may_hold_cages(self) -> bool {
        matches!(self, Self::Obj | Self::Usda | Self::Usdc | Self::Usdz)
    }

    /// Whether polylines can be written in it.
    #[must_use]
    pub fn holds_polylines(self) -> bool {
        self.row().polylines.is_some()
    }

    /// Whether samples on a lattice can be written in it.
    #[must_use]
    pub fn holds_volumes(self) -> bool {
        self.row().volumes.is_some()
    }

    /// Whether parts stay apart, with their names.
    #[must_use]
    pub fn has_parts(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.has_parts)
    }

    /// Whether its nodes place parts, so that instances share triangles.
    #[must_use]
    pub fn has_nodes(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.has_nodes)
    }

    /// Whether readers of it want normals rather than compute their own.
    #[must_use]
    pub fn wants_normals(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.wants_normals)
    }

    /// Whether a file of it may hold points and no triangle.
    #[must_use]
    pub fn holds_points(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.holds_points)
    }

    /// Whether triangles lose no digit: every bit of their positions is kept.
    #[must_use]
    pub fn keeps_every_digit(self) -> bool {
        self.holds_triangles() && self.precision() == PositionPrecision::Double
    }

    /// Whether it is glTF, in either container: its numbers can be packed, and it holds levels of detail.
    #[must_use]
    pub fn is_gltf(self) -> bool {
        matches!(self, Self::Glb | Self::Gltf)
    }

    /// How vertices lie in a file of it.
    #[must_use]
    pub fn vertex_rows(self) -> VertexRows {
        self.row().triangles.as_ref().map_or(VertexRows::Mesh, |format| format.rows)
    }

    /// The precision of its positions.
    #[must_use]
    pub fn precision(self) -> PositionPrecision {
        self.row().triangles.as_ref().map_or(PositionPrecision::Double, |format| format.precision)
    }

    /// How its files identify positions: by their own indices where they have some, else by their bits.
    #[must_use]
    pub fn topology(self) -> Topology {
        match self.vertex_rows() {
            VertexRows::Mesh | VertexRows::Positions => Topology::Indices,
            VertexRows::Split | VertexRows::Soup => Topology::Positions,
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().name)
    }
}

impl FromStr for Format {
    type Err = UnknownFormat;
    fn from_str(name: &str) -> Result<Self, UnknownFormat> {
        Self::from_extension(name).ok_or_else(|| UnknownFormat::new(name, TABLE.iter().map(|row| row.name)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_is_found_by_its_own_name() {
        for (i, format) in Format::all().enumerate() {
            assert_eq!(format as usize, i, "the table is in the order of the enum");
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(
                Format::from_extension(&format!(".{}", format.to_string().to_uppercase())),
                Some(format)
            );
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_those_that_are_known() {
        let message = "dwg".parse::<Format>().unwrap_err().to_string();
        assert_eq!(
            message,
            "'dwg' is no format; they are bpt, bez, teaset, json, obj, ply, stl, glb, gltf, b3dm, i3dm, cmpt, tileset, drc, off, 3mf, amf, dae, vtp, vtu, vtk, gii, usda, usdc, usdz, svg, ttf, vm, npy, nrrd, nii, npz, mha, vti, dcm, slc and star"
        );
        assert_eq!(Format::from_extension(""), None);
    }
}
