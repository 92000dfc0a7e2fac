//! `Format`: the formats of files.

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
    /// Bézier patches of any degree in Geomview's format, text or binary.
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
    /// glTF 2.0 as JSON, with embedded or separate buffers and pictures.
    Gltf,
    /// A tile of 3D Tiles 1.0 that holds a GLB.
    B3dm,
    /// A tile of 3D Tiles 1.0 whose GLB is instanced at several places.
    I3dm,
    /// Several tiles of 3D Tiles 1.0 in one file.
    Cmpt,
    /// A tileset of 3D Tiles; its finest tiles are read.
    Tileset,
    /// Triangles compressed by Draco.
    Drc,
    /// Geomview's OFF, text or binary.
    Off,
    /// 3MF, the format of 3D printing.
    ThreeMf,
    /// AMF, an older format of 3D printing, zipped or not.
    Amf,
    /// COLLADA.
    Dae,
    /// VTK PolyData in XML.
    Vtp,
    /// VTK UnstructuredGrid in XML; its surface is read.
    Vtu,
    /// VTK's legacy format, for surfaces, unstructured grids and volumes.
    Vtk,
    /// GIFTI, brain surfaces in XML.
    Gii,
    /// USD as text, or a `.usd` file that holds text or binary.
    Usda,
    /// USD in its binary form.
    Usdc,
    /// A USD package with its pictures.
    Usdz,
    /// Scalable Vector Graphics.
    Svg,
    /// A TrueType or OpenType font, or a collection of them. A text set in it is a drawing of its glyphs.
    Ttf,
    /// An expression graph as an op list, in fidget's text format.
    Vm,
    /// NumPy array with three axes.
    Npy,
    /// NRRD volume.
    Nrrd,
    /// NIfTI volume, gzipped or not.
    Nii,
    /// NumPy arrays in a zip file, one of which has three axes.
    Npz,
    /// MetaImage volume, in one file or with its samples in other files.
    MetaImage,
    /// VTK ImageData in XML.
    Vti,
    /// A DICOM series: slices in files of their own, and a list of them.
    Dicom,
    /// VolVis volume.
    Slc,
    /// A shape script; it is run, not read.
    Star,
}
