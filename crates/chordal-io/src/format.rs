//! `Format`: the formats of files, in one table of what they are, what reads and writes them and what they hold.
// Long because the table has a row for each format.
use crate::error::ReadError;
use crate::format_columns::{
    FormatReader, PolygonFormat, PolylineWriter, PositionPrecision, TriangleFormat, VertexRows, VolumeWriter,
};
use crate::scene::ReadOutcome;
use crate::text::text_start;
use crate::unknown_format::UnknownFormat;
use crate::unpack_cap::UnpackCap;
use crate::volume::inflate::{MAGIC, peek};
use crate::{Limits, SceneAssets};
use crate::{
    amf, bez, bpt, collada, dicom, drc, font, gii, glb, mha, nii, npy, nrrd, obj, off, ply, shape_json, slc,
    stl, svg, teaset, threemf, tiles, usd, vm, vti, vtk,
};
use chordal::explicit::Topology;
use std::fmt;
use std::str::FromStr;

/// A file format.
///
/// ```
/// use chordal_io::Format;
/// assert_eq!(Format::from_extension("STL"), Some(Format::Stl));
/// assert_eq!(Format::sniff(b"1\n1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16\n"), Some(Format::Teaset));
/// assert_eq!("ply".parse(), Ok(Format::Ply));
/// assert_eq!(Format::Json.to_string(), "json");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Bicubic Bézier patches, one block of 4 × 4 points each.
    Bpt,
    /// Bézier patches of any degree, as Geomview has them, text or binary.
    Bez,
    /// Newell's teaset text: patches as indices, then points.
    Teaset,
    /// Patches, curves or polylines in JSON.
    Json,
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// STL, text or binary.
    Stl,
    /// Binary glTF 2.0.
    Glb,
    /// glTF 2.0 as JSON, with buffers and pictures in it or beside it.
    Gltf,
    /// A tile of 3D Tiles 1.0, with a GLB in it.
    B3dm,
    /// The list of the tiles of 3D Tiles, of which the finest are read.
    Tileset,
    /// Draco's compressed triangles.
    Drc,
    /// Geomview's OFF, text or binary.
    Off,
    /// 3MF, the format of 3D printing.
    ThreeMf,
    /// AMF, an older format of 3D printing, zipped or not.
    Amf,
    /// Collada.
    Dae,
    /// VTK PolyData in XML.
    Vtp,
    /// VTK UnstructuredGrid in XML, of which the surface is read.
    Vtu,
    /// VTK's legacy form of both, and of volumes.
    Vtk,
    /// GIFTI, surfaces of brains in XML.
    Gii,
    /// USD as text, or a `.usd` file in either form.
    Usda,
    /// USD in its binary form.
    Usdc,
    /// A package of USD with its pictures.
    Usdz,
    /// Scalable Vector Graphics.
    Svg,
    /// A font of TrueType or OpenType, or a collection of some: its letters are a drawing once a text is set.
    Ttf,
    /// An expression graph as an op list, in fidget's text format.
    Vm,
    /// NumPy array with three axes.
    Npy,
    /// NRRD volume.
    Nrrd,
    /// NIfTI volume, gzipped or not.
    Nii,
    /// NumPy arrays in a zip file, one of them with three axes.
    Npz,
    /// MetaImage volume, in one file or with its samples beside.
    MetaImage,
    /// Image data of VTK in XML.
    Vti,
    /// A series of DICOM: slices in files of their own, and the list of them.
    Dicom,
    /// Volume of VolVis.
    Slc,
    /// A shape script, which is run instead of read.
    Star,
}

/// A row of the table of formats: everything that differs from format to format.
pub(crate) struct FormatRow {
    format: Format,
    /// The name, which `from` and `to` take and which is also an extension.
    name: &'static str,
    /// Other extensions.
    extensions: &'static [&'static str],
    /// Whether a file's bytes look like it.
    looks_like: fn(&[u8]) -> bool,
    /// The reader; none where a file has a shape only once it has run, which this crate does not do.
    pub read: Option<FormatReader>,
    pub triangles: Option<TriangleFormat>,
    pub polylines: Option<PolylineWriter>,
    pub volumes: Option<VolumeWriter>,
    /// How much a gzipped file of it may unpack to.
    pub cap: UnpackCap,
}

/// A format that is only read.
const fn only_read(
    format: Format,
    name: &'static str,
    looks_like: fn(&[u8]) -> bool,
    read: fn(&[u8], &Limits) -> Result<ReadOutcome, ReadError>,
) -> FormatRow {
    let read = Some(FormatReader::OneFile(read));
    FormatRow {
        format,
        name,
        extensions: &[],
        looks_like,
        read,
        triangles: None,
        polylines: None,
        volumes: None,
        cap: UnpackCap::MODEL,
    }
}

/// The same for samples on a lattice.
const fn volume_row(
    format: Format,
    name: &'static str,
    looks_like: fn(&[u8]) -> bool,
    read: fn(&[u8], &Limits) -> Result<ReadOutcome, ReadError>,
) -> FormatRow {
    FormatRow { cap: UnpackCap::VOLUME, ..only_read(format, name, looks_like, read) }
}

/// How glTF holds triangles, whatever its container.
const GLTF_TRIANGLES: TriangleFormat = TriangleFormat {
    write: glb::write,
    write_files: None,
    rows: VertexRows::Split,
    precision: PositionPrecision::SingleAboutOrigin,
    polygons: None,
    has_materials_beside: false,
    has_parts: true,
    has_nodes: true,
    wants_normals: true,
    has_certificate: true,
    holds_points: false,
    keeps: None,
    changes: None,
};

/// How USD holds triangles, in a text or a package.
const USD_TRIANGLES: TriangleFormat = TriangleFormat {
    write: usd::write,
    write_files: Some(usd::write_files),
    rows: VertexRows::Positions,
    precision: PositionPrecision::Single,
    polygons: Some(PolygonFormat {
        write: usd::write_polygons,
        write_files: Some(usd::write_polygons_files),
        is_cage: true,
    }),
    has_materials_beside: true,
    has_parts: true,
    has_nodes: true,
    wants_normals: true,
    has_certificate: true,
    holds_points: true,
    keeps: Some(usd::keeps),
    changes: Some(usd::changes),
};

/// The table of formats, in the order of the enum.
static TABLE: [FormatRow; 35] = [
    only_read(Format::Bpt, "bpt", |bytes| bpt::looks_like(text_start(bytes)), bpt::read),
    FormatRow {
        extensions: &["bbp"],
        ..only_read(Format::Bez, "bez", |bytes| bez::looks_like(text_start(bytes)), bez::read)
    },
    only_read(Format::Teaset, "teaset", |bytes| teaset::looks_like(text_start(bytes)), teaset::read),
    FormatRow {
        polylines: Some(shape_json::write),
        ..only_read(Format::Json, "json", |bytes| shape_json::looks_like(text_start(bytes)), shape_json::read)
    },
    FormatRow {
        read: Some(FormatReader::WithOthers(obj::read_with)),
        triangles: Some(TriangleFormat {
            write: obj::write,
            write_files: Some(obj::write_files),
            rows: VertexRows::Positions,
            precision: PositionPrecision::Double,
            polygons: Some(PolygonFormat {
                write: obj::write_polygons,
                write_files: Some(obj::write_polygons_files),
                is_cage: true,
            }),
            has_materials_beside: true,
            has_parts: true,
            has_nodes: false,
            wants_normals: true,
            has_certificate: true,
            holds_points: true,
            keeps: Some(obj::keeps),
            changes: Some(obj::lost_looks),
        }),
        ..only_read(Format::Obj, "obj", obj::looks_like, obj::read)
    },
    FormatRow {
        triangles: Some(TriangleFormat {
            write: ply::write,
            write_files: None,
            rows: VertexRows::Mesh,
            precision: PositionPrecision::Double,
            polygons: Some(PolygonFormat { write: ply::write_polygons, write_files: None, is_cage: false }),
            has_materials_beside: false,
            has_parts: false,
            has_nodes: false,
            wants_normals: false,
            has_certificate: true,
            holds_points: true,
            keeps: Some(|attribute, _| ply::keeps(attribute)),
            changes: None,
        }),
        ..only_read(Format::Ply, "ply", |bytes| ply::looks_like(text_start(bytes)), ply::read)
    },
    FormatRow {
        triangles: Some(TriangleFormat {
            write: stl::write,
            write_files: None,
            rows: VertexRows::Soup,
            precision: PositionPrecision::Single,
            polygons: None,
            has_materials_beside: false,
            has_parts: false,
            has_nodes: false,
            wants_normals: false,
            has_certificate: false,
            holds_points: false,
            keeps: Some(|_, _| false),
            changes: None,
        }),
        ..only_read(Format::Stl, "stl", stl::looks_like, stl::read)
    },
    FormatRow {
        read: Some(FormatReader::WithOthers(glb::read_with)),
        triangles: Some(TriangleFormat { write: glb::write, ..GLTF_TRIANGLES }),
        ..only_read(Format::Glb, "glb", |bytes| bytes.starts_with(b"glTF"), glb::read)
    },
    FormatRow {
        read: Some(FormatReader::WithOthers(glb::read_with)),
        triangles: Some(TriangleFormat {
            write: glb::write_embedded,
            write_files: Some(glb::write_files),
            ..GLTF_TRIANGLES
        }),
        ..only_read(Format::Gltf, "gltf", |bytes| glb::looks_like_json(text_start(bytes)), glb::read)
    },
    FormatRow {
        extensions: &["i3dm", "cmpt"],
        ..only_read(Format::B3dm, "b3dm", tiles::old_tile::looks_like, tiles::old_tile::read)
    },
    FormatRow {
        read: Some(FormatReader::WithOthers(tiles::scene::read_scene)),
        ..only_read(
            Format::Tileset,
            "tileset",
            |bytes| tiles::scene::looks_like(text_start(bytes)),
            |bytes, limits| tiles::scene::read_scene(bytes, None, limits),
        )
    },
    only_read(Format::Drc, "drc", |bytes| bytes.starts_with(drc::MAGIC), drc::read),
    FormatRow {
        triangles: Some(TriangleFormat {
            write: off::write,
            write_files: None,
            rows: VertexRows::Positions,
            precision: PositionPrecision::Double,
            polygons: Some(PolygonFormat { write: off::write_polygons, write_files: None, is_cage: false }),
            has_materials_beside: false,
            has_parts: false,
            has_nodes: false,
            wants_normals: false,
            has_certificate: true,
            holds_points: true,
            keeps: Some(off::keeps),
            changes: None,
        }),
        ..only_read(Format::Off, "off", |bytes| off::looks_like(text_start(bytes)), off::read)
    },
    FormatRow {
        triangles: Some(TriangleFormat {
            write: threemf::write,
            write_files: None,
            rows: VertexRows::Positions,
            precision: PositionPrecision::Double,
            polygons: None,
            has_materials_beside: false,
            has_parts: true,
            has_nodes: true,
            wants_normals: false,
            has_certificate: true,
            holds_points: false,
            keeps: Some(threemf::keeps),
            changes: Some(threemf::changes),
        }),
        ..only_read(Format::ThreeMf, "3mf", threemf::looks_like, threemf::read)
    },
    only_read(Format::Amf, "amf", amf::looks_like, amf::read),
    only_read(Format::Dae, "dae", |bytes| collada::looks_like(text_start(bytes)), collada::read),
    FormatRow {
        triangles: Some(TriangleFormat {
            write: vtk::write,
            write_files: None,
            rows: VertexRows::Mesh,
            precision: PositionPrecision::Double,
            polygons: Some(PolygonFormat { write: vtk::write_polygons, write_files: None, is_cage: false }),
            has_materials_beside: false,
            has_parts: false,
            has_nodes: false,
            wants_normals: false,
            has_certificate: true,
            holds_points: true,
            keeps: Some(|attribute, _| vtk::keeps(attribute)),
            changes: None,
        }),
        ..only_read(Format::Vtp, "vtp", |bytes| vtk::looks_xml(text_start(bytes), "PolyData"), vtk::read_xml)
    },
    only_read(
        Format::Vtu,
        "vtu",
        |bytes| vtk::looks_xml(text_start(bytes), "UnstructuredGrid"),
        vtk::read_xml,
    ),
    only_read(Format::Vtk, "vtk", vtk::looks_legacy, vtk::read),
    FormatRow {
        read: Some(FormatReader::WithOthers(gii::read_with)),
        ..only_read(Format::Gii, "gii", |bytes| gii::looks_like(text_start(bytes)), gii::read)
    },
    FormatRow {
        read: Some(FormatReader::WithOthers(usd::read_with)),
        extensions: &["usd"],
        triangles: Some(USD_TRIANGLES),
        ..only_read(Format::Usda, "usda", usd::looks_like_text, usd::read)
    },
    FormatRow {
        read: Some(FormatReader::WithOthers(usd::read_with)),
        ..only_read(Format::Usdc, "usdc", usd::looks_like_crate, usd::read)
    },
    FormatRow {
        triangles: Some(TriangleFormat {
            write: usd::write_package,
            write_files: None,
            polygons: Some(PolygonFormat {
                write: usd::write_polygons_package,
                write_files: None,
                is_cage: true,
            }),
            has_materials_beside: false,
            ..USD_TRIANGLES
        }),
        ..only_read(Format::Usdz, "usdz", usd::looks_like_package, usd::read)
    },
    FormatRow {
        polylines: Some(svg::write),
        ..only_read(Format::Svg, "svg", |bytes| svg::looks_like(text_start(bytes)), svg::read)
    },
    FormatRow {
        extensions: &["otf", "ttc", "otc"],
        ..only_read(Format::Ttf, "ttf", font::looks_like, font::read)
    },
    only_read(
        Format::Vm,
        "vm",
        |bytes| !bytes.starts_with(b"{") && vm::looks_like(text_start(bytes)),
        vm::read,
    ),
    FormatRow {
        volumes: Some(|volume, _, out| npy::write(volume, out)),
        ..volume_row(Format::Npy, "npy", |bytes| bytes.starts_with(npy::MAGIC), npy::read)
    },
    FormatRow {
        volumes: Some(nrrd::write),
        ..volume_row(Format::Nrrd, "nrrd", |bytes| bytes.starts_with(nrrd::MAGIC), nrrd::read)
    },
    FormatRow {
        extensions: &["nii.gz", "hdr"],
        read: Some(FormatReader::WithOthers(nii::read_with)),
        ..volume_row(Format::Nii, "nii", nii::looks_like, nii::read)
    },
    volume_row(Format::Npz, "npz", npy::looks_like_npz, npy::read_npz),
    FormatRow {
        extensions: &["mhd"],
        read: Some(FormatReader::WithOthers(mha::read_with)),
        ..volume_row(Format::MetaImage, "mha", |bytes| mha::looks_like(text_start(bytes)), mha::read)
    },
    volume_row(Format::Vti, "vti", |bytes| vti::looks_like(text_start(bytes)), vti::read),
    FormatRow {
        extensions: &["dicom"],
        read: Some(FormatReader::WithOthers(dicom::read_with)),
        ..volume_row(Format::Dicom, "dcm", dicom::looks_like, dicom::read)
    },
    volume_row(Format::Slc, "slc", slc::looks_like, slc::read),
    FormatRow {
        format: Format::Star,
        name: "star",
        extensions: &[],
        looks_like: |_| false,
        read: None,
        triangles: None,
        polylines: None,
        volumes: None,
        cap: UnpackCap::MODEL,
    },
];

/// The order in which content is compared with formats: those that begin with a number of their own come before
/// texts, and what nearly any text could be comes last.
const BY_CONTENT: [Format; 34] = [
    Format::Glb,
    Format::B3dm,
    Format::Drc,
    Format::Usdc,
    Format::Usdz,
    Format::ThreeMf,
    Format::Npz,
    Format::Amf,
    Format::Dae,
    Format::Npy,
    Format::Nrrd,
    Format::Nii,
    Format::MetaImage,
    Format::Dicom,
    Format::Slc,
    Format::Ttf,
    Format::Vtp,
    Format::Vtu,
    Format::Vtk,
    Format::Gii,
    Format::Ply,
    Format::Off,
    Format::Bez,
    Format::Stl,
    Format::Usda,
    Format::Tileset,
    Format::Gltf,
    Format::Json,
    Format::Vti,
    Format::Svg,
    Format::Vm,
    Format::Teaset,
    Format::Bpt,
    Format::Obj,
];

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
            "'dwg' is no format; they are bpt, bez, teaset, json, obj, ply, stl, glb, gltf, b3dm, tileset, drc, off, 3mf, amf, dae, vtp, vtu, vtk, gii, usda, usdc, usdz, svg, ttf, vm, npy, nrrd, nii, npz, mha, vti, dcm, slc and star"
        );
        assert_eq!(Format::from_extension(""), None);
    }
}
