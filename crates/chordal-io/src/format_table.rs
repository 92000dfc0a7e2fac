//! The table of formats: names, signatures, readers, writers, and the data that each format holds.
use crate::error::ReadError;
use crate::format::Format;
use crate::format_columns::{
    FormatReader, PolygonFormat, PolylineFormat, PositionPrecision, TriangleFormat, VertexRows, VolumeFormat,
};
use crate::frame::Axis;
use crate::limits::Limits;
use crate::scene::ReadOutcome;
use crate::text::text_start;
use crate::unpack_cap::UnpackCap;
use crate::{
    amf, bez, bpt, collada, dicom, drc, font, gii, glb, mha, nii, npy, nrrd, obj, off, ply, shape_json, slc,
    stl, svg, teaset, threemf, tiles, usd, vm, vti, vtk,
};

/// A row of the table of formats. All differences between formats are here.
pub(crate) struct FormatRow {
    pub format: Format,
    /// The name. The options `from` and `to` take it, and it is also an extension.
    pub name: &'static str,
    /// Other extensions.
    pub extensions: &'static [&'static str],
    /// Whether the bytes of a file look like this format.
    pub looks_like: fn(&[u8]) -> bool,
    /// The reader. `None` for scripts: they must be run to get a shape, which this crate does not do.
    pub read: Option<FormatReader>,
    pub triangles: Option<TriangleFormat>,
    pub polylines: Option<PolylineFormat>,
    pub volumes: Option<VolumeFormat>,
    /// Whether polygons may be a control cage, which defines a smooth surface.
    pub may_hold_cages: bool,
    /// Whether the shape is a field.
    pub holds_fields: bool,
    /// Whether a file is told from those of all other formats by its first bytes, or only looks like this one.
    pub has_signature: bool,
    /// Whether the reader unpacks a gzipped file itself, as far as it needs it.
    pub unpacks: bool,
    /// The size to which a gzipped file of the format may unpack.
    pub cap: UnpackCap,
}

/// The row of a format that is read but never written.
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
        may_hold_cages: false,
        holds_fields: false,
        has_signature: true,
        unpacks: false,
        cap: UnpackCap::MODEL,
    }
}

/// The row of a format for samples on a lattice.
const fn volume_row(
    format: Format,
    name: &'static str,
    looks_like: fn(&[u8]) -> bool,
    read: fn(&[u8], &Limits) -> Result<ReadOutcome, ReadError>,
) -> FormatRow {
    FormatRow { cap: UnpackCap::VOLUME, ..only_read(format, name, looks_like, read) }
}

/// How glTF holds triangles, in either container.
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
    shares_vertices: false,
    forbids_collapsed_faces: false,
    up: Some(Axis::Y),
    keeps: None,
    changes: None,
};

/// How USD holds triangles, as text or in a package.
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
    shares_vertices: false,
    forbids_collapsed_faces: false,
    up: None,
    keeps: Some(usd::keeps),
    changes: Some(usd::changes),
};

/// The table of formats, in the order of the enum.
pub(crate) static TABLE: [FormatRow; 37] = [
    FormatRow {
        has_signature: false,
        ..only_read(Format::Bpt, "bpt", |bytes| bpt::looks_like(text_start(bytes)), bpt::read)
    },
    FormatRow {
        extensions: &["bbp"],
        ..only_read(Format::Bez, "bez", |bytes| bez::looks_like(text_start(bytes)), bez::read)
    },
    FormatRow {
        has_signature: false,
        ..only_read(Format::Teaset, "teaset", |bytes| teaset::looks_like(text_start(bytes)), teaset::read)
    },
    FormatRow {
        polylines: Some(PolylineFormat {
            write: shape_json::write,
            holds_cubics: false,
            holds_space: true,
            is_y_down: false,
            holds_elements: false,
        }),
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
            shares_vertices: true,
            forbids_collapsed_faces: false,
            up: None,
            keeps: Some(obj::keeps),
            changes: Some(obj::lost_looks),
        }),
        may_hold_cages: true,
        has_signature: false,
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
            shares_vertices: false,
            forbids_collapsed_faces: false,
            up: None,
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
            shares_vertices: false,
            forbids_collapsed_faces: false,
            up: None,
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
    only_read(Format::B3dm, "b3dm", |bytes| bytes.starts_with(b"b3dm"), tiles::old_tile::read),
    only_read(Format::I3dm, "i3dm", |bytes| bytes.starts_with(b"i3dm"), tiles::old_tile::read),
    only_read(Format::Cmpt, "cmpt", |bytes| bytes.starts_with(b"cmpt"), tiles::old_tile::read),
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
            shares_vertices: false,
            forbids_collapsed_faces: false,
            up: None,
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
            shares_vertices: false,
            forbids_collapsed_faces: true,
            up: Some(Axis::Z),
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
            shares_vertices: false,
            forbids_collapsed_faces: false,
            up: None,
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
        may_hold_cages: true,
        ..only_read(Format::Usda, "usda", usd::looks_like_text, usd::read)
    },
    FormatRow {
        read: Some(FormatReader::WithOthers(usd::read_with)),
        may_hold_cages: true,
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
        may_hold_cages: true,
        ..only_read(Format::Usdz, "usdz", usd::looks_like_package, usd::read)
    },
    FormatRow {
        polylines: Some(PolylineFormat {
            write: svg::write,
            holds_cubics: true,
            holds_space: false,
            is_y_down: true,
            holds_elements: true,
        }),
        ..only_read(Format::Svg, "svg", |bytes| svg::looks_like(text_start(bytes)), svg::read)
    },
    FormatRow {
        extensions: &["otf", "ttc", "otc"],
        ..only_read(Format::Ttf, "ttf", font::looks_like, font::read)
    },
    FormatRow {
        holds_fields: true,
        has_signature: false,
        ..only_read(
            Format::Vm,
            "vm",
            |bytes| !bytes.starts_with(b"{") && vm::looks_like(text_start(bytes)),
            vm::read,
        )
    },
    FormatRow {
        volumes: Some(VolumeFormat {
            write: |volume, _, out| npy::write(volume, out),
            write_sparse: |grid, _, _, out| npy::write_sparse(grid, out),
            is_array: true,
            names_unit: |_| false,
        }),
        ..volume_row(Format::Npy, "npy", |bytes| bytes.starts_with(npy::MAGIC), npy::read)
    },
    FormatRow {
        volumes: Some(VolumeFormat {
            write: nrrd::write,
            write_sparse: nrrd::write_sparse,
            is_array: false,
            names_unit: nrrd::names_unit,
        }),
        ..volume_row(Format::Nrrd, "nrrd", |bytes| bytes.starts_with(nrrd::MAGIC), nrrd::read)
    },
    FormatRow {
        extensions: &["nii.gz", "hdr"],
        read: Some(FormatReader::WithOthers(nii::read_with)),
        unpacks: true,
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
        may_hold_cages: false,
        holds_fields: true,
        has_signature: true,
        unpacks: false,
        cap: UnpackCap::MODEL,
    },
];

/// The order in which content is compared with formats: formats with a magic number come before texts, and
/// formats that nearly any text could match come last.
pub(crate) const BY_CONTENT: [Format; 36] = [
    Format::Glb,
    Format::B3dm,
    Format::I3dm,
    Format::Cmpt,
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
