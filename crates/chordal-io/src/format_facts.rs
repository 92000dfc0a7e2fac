//! Queries about a format, answered from its row in the table: names, signatures, the data it holds.
use crate::SceneAssets;
use crate::format::Format;
use crate::format_columns::{PositionPrecision, VertexRows};
use crate::format_table::{BY_CONTENT, FormatRow, TABLE};
use crate::frame::Axis;
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

    /// The format of an extension, with or without its dot, in any case. `nii.gz` also counts as an
    /// extension.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        let name = extension.strip_prefix('.').unwrap_or(extension);
        let is_name = |known: &&str| known.eq_ignore_ascii_case(name);
        let has_name = |row: &&FormatRow| is_name(&row.name) || row.extensions.iter().any(is_name);
        TABLE.iter().find(has_name).map(|row| row.format)
    }

    /// The format of the extension of an input file. [`crate::read`] unpacks gzipped files, so `obj.gz` is an
    /// OBJ.
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

    /// The format that the content looks like, whatever its extension. Inspects as few bytes as possible, and
    /// only the first 64 KiB of a gzipped file. A reader may still refuse the file.
    #[must_use]
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        /// The bytes that are unpacked. Chosen: more than the signature of any format that is recognised by
        /// its first bytes.
        const HEAD: usize = 1 << 16;
        if bytes.starts_with(&MAGIC) {
            let head = peek(bytes, HEAD);
            return BY_CONTENT.into_iter().find(|format| (format.row().looks_like)(&head));
        }
        BY_CONTENT.into_iter().find(|format| (format.row().looks_like)(bytes))
    }

    /// Whether the format can hold triangles.
    ///
    /// ```
    /// use chordal_io::Format;
    /// assert!(Format::Glb.holds_triangles() && !Format::Bpt.holds_triangles());
    /// ```
    #[must_use]
    pub fn holds_triangles(self) -> bool {
        self.row().triangles.is_some()
    }

    /// Whether the pictures and buffers of the format can be separate files; see [`crate::write_files`].
    #[must_use]
    pub fn has_side_files(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.write_files.is_some())
    }

    /// Whether the format puts some of these assets into separate files, as OBJ does with materials. Without
    /// those files the document is then incomplete.
    #[must_use]
    pub fn names_files(self, assets: &SceneAssets) -> bool {
        let has_some = self.row().triangles.as_ref().is_some_and(|held| held.has_materials_beside);
        has_some && !assets.materials.is_empty()
    }

    /// Whether the format can hold polygons with any number of corners.
    #[must_use]
    pub fn holds_polygons(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.polygons.is_some())
    }

    /// Whether polygons of the format may be a control cage, which defines a smooth surface.
    #[must_use]
    pub fn may_hold_cages(self) -> bool {
        self.row().may_hold_cages
    }

    /// Whether the format can hold polylines.
    #[must_use]
    pub fn holds_polylines(self) -> bool {
        self.row().polylines.is_some()
    }

    /// Whether the format can hold cubic curves.
    #[must_use]
    pub fn holds_cubics(self) -> bool {
        self.row().polylines.as_ref().is_some_and(|format| format.holds_cubics)
    }

    /// Whether the format can hold polylines in space.
    #[must_use]
    pub fn holds_space_curves(self) -> bool {
        self.row().polylines.as_ref().is_some_and(|format| format.holds_space)
    }

    /// Whether y grows downwards in drawings of the format.
    #[must_use]
    pub fn is_y_down(self) -> bool {
        self.row().polylines.as_ref().is_some_and(|format| format.is_y_down)
    }

    /// Whether the format keeps the elements of a drawing: their names, how they are filled, the box of view.
    #[must_use]
    pub fn holds_elements(self) -> bool {
        self.row().polylines.as_ref().is_some_and(|format| format.holds_elements)
    }

    /// Whether the shape of a file is a field.
    #[must_use]
    pub fn holds_fields(self) -> bool {
        self.row().holds_fields
    }

    /// Whether the format is that of scripts, which have to be run to get a shape.
    #[must_use]
    pub fn is_script(self) -> bool {
        self.row().read.is_none()
    }

    /// Whether the format is that of fonts, which set a text.
    #[must_use]
    pub fn is_font(self) -> bool {
        self == Self::Ttf
    }

    /// Whether a file is one slice of a volume, which is a folder of them.
    #[must_use]
    pub fn is_slice(self) -> bool {
        self == Self::Dicom
    }

    /// Whether the first bytes of a file tell the format; otherwise files of other formats may look like it.
    #[must_use]
    pub fn has_signature(self) -> bool {
        self.row().has_signature
    }

    /// Whether the format can hold samples on a lattice.
    #[must_use]
    pub fn holds_volumes(self) -> bool {
        self.row().volumes.is_some()
    }

    /// Whether volumes are written as an array of samples alone: without the lattice's origin and step,
    /// without names and without a certificate.
    #[must_use]
    pub fn is_array(self) -> bool {
        self.row().volumes.as_ref().is_some_and(|format| format.is_array)
    }

    /// Whether a volume of the format can state its unit, of so many metres.
    #[must_use]
    pub fn names_unit(self, metres: f64) -> bool {
        self.row().volumes.as_ref().is_some_and(|format| (format.names_unit)(metres))
    }

    /// Whether the format keeps parts separate, with their names.
    #[must_use]
    pub fn has_parts(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.has_parts)
    }

    /// Whether the triangles of a file are one mesh: it has no parts, or they are names of faces that share
    /// vertices.
    #[must_use]
    pub fn is_one_mesh(self) -> bool {
        self.row().triangles.as_ref().is_none_or(|format| !format.has_parts || format.shares_vertices)
    }

    /// Whether the format forbids triangles that have the same corner twice.
    #[must_use]
    pub fn forbids_collapsed_faces(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.forbids_collapsed_faces)
    }

    /// The axis that is always up in the format, so that its writer turns other scenes.
    #[must_use]
    pub fn up(self) -> Option<Axis> {
        self.row().triangles.as_ref().and_then(|format| format.up)
    }

    /// Whether the format has nodes that place parts, so that instances share triangles.
    #[must_use]
    pub fn has_nodes(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.has_nodes)
    }

    /// Whether programs that read the format expect normals in the file, instead of computing their own.
    #[must_use]
    pub fn wants_normals(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.wants_normals)
    }

    /// Whether a file of the format may hold points without any triangle.
    #[must_use]
    pub fn holds_points(self) -> bool {
        self.row().triangles.as_ref().is_some_and(|format| format.holds_points)
    }

    /// Whether the format keeps every bit of the positions of triangles.
    #[must_use]
    pub fn keeps_every_digit(self) -> bool {
        self.holds_triangles() && self.precision() == PositionPrecision::Double
    }

    /// Whether the format is glTF, in either container, which can be packed and can hold levels of detail.
    #[must_use]
    pub fn is_gltf(self) -> bool {
        matches!(self, Self::Glb | Self::Gltf)
    }

    /// Whether a file of the format carries the scripts that it was made from, in its certificate. Chosen: the formats in
    /// which parts are kept and passed on, and whose certificates have no limit of lines.
    #[must_use]
    pub fn carries_sources(self) -> bool {
        self.is_gltf() || self == Self::ThreeMf
    }

    /// How a file of the format arranges its vertices.
    #[must_use]
    pub fn vertex_rows(self) -> VertexRows {
        self.row().triangles.as_ref().map_or(VertexRows::Mesh, |format| format.rows)
    }

    /// The precision of the format's positions.
    #[must_use]
    pub fn precision(self) -> PositionPrecision {
        self.row().triangles.as_ref().map_or(PositionPrecision::Double, |format| format.precision)
    }

    /// How files of the format tell which vertices share a position: by position indices if the format has
    /// them, else by equal bits.
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
