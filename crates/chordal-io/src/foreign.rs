//! `ForeignFormat`: formats that are not supported, known by extensions and first bytes, with advice on
//! converting them.
use crate::format::Format;
use crate::text::text_start;

/// A format that is neither read nor written.
///
/// ```
/// use chordal_io::ForeignFormat;
/// assert_eq!(ForeignFormat::from_extension("STEP").unwrap().name, "STEP");
/// assert_eq!(ForeignFormat::sniff(b"\x89PNG\r\n\x1a\n").unwrap().name, "a PNG picture");
/// assert!(ForeignFormat::from_extension("obj").is_none());
/// ```
#[derive(Debug, PartialEq, Eq)]
pub struct ForeignFormat {
    /// Its name in a sentence.
    pub name: &'static str,
    extensions: &'static [&'static str],
    /// The signatures of its files; empty if they have none.
    starts: &'static [&'static [u8]],
    /// The usual way to convert it to a supported format.
    pub way: &'static str,
}

const CAD: &str = "export triangles from the CAD program, as 3MF, STL or glTF at the tolerance that you need";
const CAD_SCRIPT: &str = "examples/step_to_surfaces.py writes its faces as NURBS surfaces in JSON (with cadquery-ocp), or \
                          export triangles from the CAD program, as 3MF, STL or glTF at the tolerance that you need";
const RHINO: &str = "examples/rhino_to_surfaces.py writes its surfaces as JSON (with rhino3dm), or export triangles \
                     from Rhino, as 3MF, STL or glTF at the tolerance that you need";
const SCENE: &str = "export it as glTF (.glb) or USD from the program that it is of, or from Blender";
const PICTURE: &str = "a picture is no shape";
const OPENSCAD: &str = "docs/shape-scripts-openscad.md shows how its words are written in a shape script (.star), or export \
                        its part from OpenSCAD as 3MF or STL";
const UNPACK: &str = "fonttools unpacks it: TTFont(name), flavor = None, save as .ttf";
const POINTS: &str =
    "points have no surface: a program such as MeshLab or CloudCompare makes triangles of them (PLY)";

const fn row(
    name: &'static str,
    extensions: &'static [&'static str],
    starts: &'static [&'static [u8]],
    way: &'static str,
) -> ForeignFormat {
    ForeignFormat { name, extensions, starts, way }
}

/// The table. It lists only signatures that no text or binary file of a supported format could begin with.
static TABLE: [ForeignFormat; 39] = [
    row("a script of OpenSCAD", &["scad", "csg"], &[], OPENSCAD),
    row("FBX", &["fbx"], &[b"Kaydara FBX Binary", b"; FBX "], SCENE),
    row("STEP", &["step", "stp", "p21"], &[b"ISO-10303-21"], CAD_SCRIPT),
    row("IFC", &["ifc"], &[], "IfcConvert or FreeCAD exports its shapes as glTF"),
    row("IGES", &["iges", "igs"], &[], CAD_SCRIPT),
    row("a BREP of Open CASCADE", &["brep"], &[b"DBRep_DrawableShape", b"CASCADE Topology V"], CAD_SCRIPT),
    row("ACIS", &["sat", "sab"], &[b"ACIS BinaryFile", b"ASM BinaryFile"], CAD),
    row("Parasolid", &["x_t", "x_b"], &[b"**ABCDEFGHIJKLMNOPQRSTUVWXYZ"], CAD),
    row("JT", &["jt"], &[], CAD),
    row("a file of SolidWorks, Inventor or CATIA", &["sldprt", "sldasm", "ipt", "iam", "catpart"], &[], CAD),
    row("Rhino's 3DM", &["3dm"], &[b"3D Geometry File Format"], RHINO),
    row("DWG", &["dwg"], &[b"AC10"], CAD),
    row("DXF", &["dxf"], &[b"AutoCAD Binary DXF", b"0\nSECTION", b"0\r\nSECTION"], CAD),
    row(
        "a model of SketchUp",
        &["skp"],
        &[b"\xFF\xFE\xFF\x0ES\0k\0e\0t\0c\0h\0U\0p"],
        "export it from SketchUp as glTF or Collada",
    ),
    row("a scene of Blender", &["blend"], &[b"BLENDER"], "export it from Blender as glTF (.glb)"),
    row("a scene of 3ds Max", &["max"], &[], "export it from 3ds Max as glTF or USD"),
    row("3DS", &["3ds"], &[], "Blender imports it, and exports glTF (.glb)"),
    row("a scene of Maya", &["ma", "mb"], &[b"//Maya ASCII"], "export it from Maya as USD, or as OBJ"),
    row("a scene of Cinema 4D", &["c4d"], &[b"QC4DC4D6"], "export it from Cinema 4D as glTF or USD"),
    row("a scene of LightWave", &["lwo", "lws"], &[], SCENE),
    row("OpenCTM", &["ctm"], &[b"OCTM"], "MeshLab opens it, and exports PLY"),
    row("X3D", &["x3d", "x3dv", "x3db"], &[b"#X3D "], "MeshLab or Blender opens it, and exports PLY or glTF"),
    row("VRML", &["wrl", "vrml"], &[b"#VRML "], "MeshLab or Blender opens it, and exports PLY or glTF"),
    row("Alembic", &["abc"], &[b"Ogawa"], SCENE),
    row(
        "OpenVDB",
        &["vdb", "nvdb"],
        &[b" BDV\0\0\0\0"],
        "the library openvdb copies a grid into an array for .npy",
    ),
    row(
        "HDF5",
        &["h5", "hdf5", "mnc"],
        &[b"\x89HDF\r\n\x1a\n"],
        "save the array as .npy, or the volume as NRRD or NIfTI",
    ),
    row("the samples of a pair of files", &["img"], &[], "open the header beside it (.hdr)"),
    row("an E57 point cloud", &["e57"], &[b"ASTM-E57"], POINTS),
    row("a LAS point cloud", &["las", "laz"], &[b"LASF"], POINTS),
    row("a point cloud", &["xyz", "pts", "ptx", "pcd", "asc"], &[b"# .PCD "], POINTS),
    row("a PNG picture", &["png"], &[b"\x89PNG\r\n\x1a\n"], PICTURE),
    row("a JPEG picture", &["jpg", "jpeg"], &[b"\xFF\xD8\xFF"], PICTURE),
    row(
        "a TIFF picture",
        &["tif", "tiff"],
        &[b"II*\0", b"MM\0*"],
        "a stack of slices is a volume as .npy or NRRD",
    ),
    row("a WebP picture", &["webp"], &[], PICTURE),
    row("a GIF picture", &["gif"], &[b"GIF87a", b"GIF89a"], PICTURE),
    row("a BMP picture", &["bmp"], &[], PICTURE),
    row("WOFF, a packed font", &["woff"], &[b"wOFF"], UNPACK),
    row("WOFF2, a packed font", &["woff2"], &[b"wOF2"], UNPACK),
    row("a PDF document", &["pdf"], &[b"%PDF-"], "export the drawing as SVG"),
];

impl ForeignFormat {
    /// The format of an extension, in any case; `None` if it belongs to a supported format.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<&'static Self> {
        if Format::from_extension(extension).is_some() {
            return None;
        }
        TABLE.iter().find(|row| row.extensions.iter().any(|known| known.eq_ignore_ascii_case(extension)))
    }

    /// Whether the format holds pictures.
    #[must_use]
    pub fn is_picture(&self) -> bool {
        self.name.ends_with(" picture")
    }

    /// The format whose signature the content begins with. No supported format begins like that.
    #[must_use]
    pub fn sniff(bytes: &[u8]) -> Option<&'static Self> {
        let text = text_start(bytes);
        let begins =
            |row: &&Self| row.starts.iter().any(|start| bytes.starts_with(start) || text.starts_with(start));
        let by_start = || TABLE.iter().find(begins);
        let is_webp = bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP");
        // The root element tells the kind of an XML file.
        let head = &text[..text.len().min(1024)];
        let is_x3d = text.starts_with(b"<") && memchr::memmem::find(head, b"<X3D").is_some();
        // A line of IGES has 80 columns. The last ones name the section and count its lines; the first
        // section is called S (U.S. Product Data Association, *IGES 5.3*, 1996, 2.2.1).
        let is_iges = matches!(bytes.get(72..80), Some(b"S      1" | b"S0000001"));
        let named = |name| TABLE.iter().find(|row| row.extensions.contains(&name));
        match (is_webp, is_x3d) {
            (true, _) => named("webp"),
            (_, true) => named("x3d"),
            _ if is_iges => named("iges"),
            _ => by_start(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_foreign_format_has_a_name_or_a_beginning_of_a_known_one() {
        for row in &TABLE {
            for extension in row.extensions {
                assert_eq!(Format::from_packed_extension(extension), None, "{extension}");
                assert_eq!(ForeignFormat::from_extension(&extension.to_uppercase()), Some(row));
            }
            for start in row.starts {
                let file = [start, &b" 1 2 3\n4 5 6\n"[..]].concat();
                assert_eq!(Format::sniff(&file), None, "{}", row.name);
                assert_eq!(ForeignFormat::sniff(&file), Some(row));
            }
        }
    }

    #[test]
    fn content_is_told_by_its_root_and_its_inner_mark_too() {
        let name = |bytes: &[u8]| ForeignFormat::sniff(bytes).map(|row| row.name);
        assert_eq!(name(b"RIFF\x10\0\0\0WEBPVP8L"), Some("a WebP picture"));
        assert_eq!(name(b"RIFF\x10\0\0\0WAVEfmt "), None);
        assert_eq!(name(b"<?xml version=\"1.0\"?>\n<!-- x -->\n<X3D profile='Full'>"), Some("X3D"));
        assert_eq!(name(b"  0\nSECTION\n  2\nHEADER\n"), Some("DXF"));
        let iges = [&[b' '; 72][..], b"S      1\n", &[b'x'; 72], b"G      1\n"].concat();
        assert_eq!(name(&iges), Some("IGES"));
        assert_eq!(name(&iges[1..]), None);
        assert_eq!(name(b"\nCASCADE Topology V1, (c) Matra-Datavision\n"), Some("a BREP of Open CASCADE"));
        assert_eq!(name(b"v 0 0 0\n"), None);
    }
}
