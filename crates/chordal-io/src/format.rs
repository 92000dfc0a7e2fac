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
    /// Such a tile whose GLB is shown at several places.
    I3dm,
    /// Several such tiles in one file.
    Cmpt,
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
