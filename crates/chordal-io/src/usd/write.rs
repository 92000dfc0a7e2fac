//! Writes scenes as USD's text form.
use super::write_material::UsdMaterialWriter;
use super::write_mesh::{UsdPartRequest, UsdSubsets, part};
use super::write_text::{UsdNames, UsdaWriter, display_name, quoted, transform};
use crate::forest::check_forest;
use crate::matrix::IDENTITY;
use crate::number::ShortestDecimal;
use crate::side_file::side_stem;
use crate::{Axis, FileSet, Frame, Node, Scene, SceneAssets, WriteError};
use chordal::budget::advice::{Message, Setting};
use chordal::explicit::{Attribute, Domain, Semantic};
use serde_json::{Value, json};
use std::io::Write;

/// Writes a scene as USDA. The same scene gives the same bytes.
///
/// Each node becomes a prim, under one root; a node that only shows a part is itself the mesh. A part that
/// several nodes show is written once, and the others inherit it. Positions are the shortest decimals that
/// read back to the same f64; but the type of USD's points is `float`, so programs round them, and
/// [`crate::snap`] and [`crate::polygon_rounding`] bound that error. The unit and the up axis are those of
/// the scene, or a metre and y. Materials become preview surfaces, and face groups subsets. The certificate
/// is in `customLayerData`. [`crate::losses`] lists the losses; pictures are referred to only if
/// [`crate::write_files`] writes them beside the file.
///
/// # Errors
/// If the sink fails, the nodes are not a forest, or a matrix is a projection.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Content, Frame, Limits, Scene, usd};
/// let mesh = Mesh::new(vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut file = Vec::new();
/// usd::write(&Scene::from_mesh("part", mesh.clone(), Frame::default()), None, &mut file)?;
/// assert!(file.starts_with(b"#usda 1.0\n"));
/// let Content::Scene(scene) = usd::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!((&scene.parts[0].mesh, &*scene.parts[0].name), (&mesh, "part"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let assets = scene.assets_for_gltf(|_| plain());
    SceneWriter::new(scene, &assets)?.write(certificate, out).map(|_| ())
}

/// Writes a scene, and its pictures beside it.
///
/// # Errors
/// As for [`write`].
pub(crate) fn write_files<'a>(
    scene: &'a Scene,
    certificate: Option<&Value>,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    let prefix = picture_prefix(stem);
    let assets = scene.assets_for_gltf(|_| plain()).with_pictures_beside(&prefix);
    let mut document = Vec::new();
    SceneWriter::new(scene, &assets)?.write(certificate, &mut document)?;
    Ok(FileSet { document, beside: scene.assets.picture_files(&prefix) })
}

/// The prefix of the names of pictures: characters that need no escape in USD paths.
pub(super) fn picture_prefix(stem: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' };
    format!("{}_", side_stem(stem).chars().map(letter).collect::<String>())
}

/// A material for which only the name is known.
pub(super) fn plain() -> Value {
    json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.5 } })
}

/// The changes that the writer makes, as sentences.
pub(crate) fn changes(scene: &Scene) -> Vec<Message> {
    // The document is written with references to separate picture files.
    let assets = scene.assets_for_gltf(|_| plain()).with_pictures_beside("");
    let lost = SceneWriter::new(scene, &assets).and_then(|writer| writer.write(None, &mut std::io::sink()));
    let mut lost: Vec<Message> = lost.unwrap_or_default().into_iter().map(Message::from).collect();
    if scene.frame.metres_per_unit.is_none() {
        let message = Message::from("USDA needs a unit: the metre was taken; ");
        lost.push(message.setting(Setting::Unit).words(" says another"));
    }
    if scene.frame.up.is_none() {
        lost.push("USDA needs an axis that is up: y was taken".into());
    }
    lost
}

/// Whether the writer keeps an attribute.
pub(crate) fn keeps(attribute: &Attribute, _first_rows: &[u32]) -> bool {
    let Attribute { semantic, domain, width, .. } = attribute;
    match semantic {
        Semantic::Normal => *width == 3,
        // The reader supports the same number of sets.
        Semantic::TexCoord(set) => *set < 2 && *width == 2,
        Semantic::Color(0) => *width == 3 || *width == 4,
        Semantic::Group(_) => *domain == Domain::Face && *width == 1,
        _ => false,
    }
}

/// The header and the metadata of a file.
pub(super) fn header(
    frame: &Frame,
    root: &str,
    certificate: Option<&Value>,
    writer: &mut UsdaWriter<'_>,
) -> Result<(), WriteError> {
    writer.line("#usda 1.0\n(")?;
    writer.depth = 1;
    if let Some(certificate) = certificate {
        writer.line("customLayerData = {")?;
        writer.line(&format!("    string {} = {}", super::CERTIFICATE, quoted(&certificate.to_string())))?;
        writer.line("}")?;
    }
    writer.line(&format!("defaultPrim = \"{root}\""))?;
    let unit = frame.metres_per_unit.filter(|unit| unit.is_finite() && *unit > 0.0).unwrap_or(1.0);
    writer.line(&format!("metersPerUnit = {}", ShortestDecimal(unit)))?;
    writer.line(&format!("upAxis = \"{}\"", if frame.up == Some(Axis::Z) { "Z" } else { "Y" }))?;
    writer.depth = 0;
    writer.line(")\n")
}

struct SceneWriter<'a> {
    scene: &'a Scene,
    materials: UsdMaterialWriter<'a>,
    root: String,
    /// Whether the root is an extra prim and not a node.
    is_wrapped: bool,
    /// The path of the first prim that shows each part.
    first: Vec<Option<String>>,
}

impl<'a> SceneWriter<'a> {
    fn new(scene: &'a Scene, assets: &'a SceneAssets) -> Result<Self, WriteError> {
        check_forest(scene)?;
        for (i, node) in scene.nodes.iter().enumerate() {
            let m = &node.matrix;
            if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] || m.iter().any(|x| !x.is_finite()) {
                return Err(WriteError::Unsupported(format!("node {i} has a matrix that is not affine")));
            }
        }
        let only = match &scene.roots[..] {
            [root] => Some(&scene.nodes[*root]),
            _ => None,
        };
        // A root that is itself a mesh is no place for materials that other meshes could share.
        let is_wrapped = only
            .is_none_or(|only| is_mesh(only) && has_one_name(only, scene) && !assets.materials.is_empty());
        let name = only.filter(|_| !is_wrapped).map_or("Scene", |only| &*only.name);
        let root = UsdNames::default().unique(name, "Node");
        let materials = UsdMaterialWriter::new(assets, format!("/{root}/Materials"));
        Ok(Self { scene, materials, root, is_wrapped, first: vec![None; scene.parts.len()] })
    }

    /// Writes the file. Returns the properties of materials that no input can express.
    fn write(mut self, certificate: Option<&Value>, out: &mut dyn Write) -> Result<Vec<String>, WriteError> {
        let mut writer = UsdaWriter::new(out);
        header(&self.scene.frame, &self.root, certificate, &mut writer)?;
        let mut names = UsdNames::default();
        // The scope of materials has this name.
        names.unique("Materials", "");
        let mut open = Vec::new();
        if self.is_wrapped {
            let root = self.root.clone();
            writer.open("Xform", &root, &[])?;
            self.scope(&mut writer)?;
            let path = format!("/{root}");
            for node in self.scene.roots.iter().rev() {
                open.push(WriteStep::Node(*node, path.clone()));
            }
            // At the bottom of the stack, so that the root is closed last.
            open.insert(0, WriteStep::Close);
        } else {
            open.extend(self.scene.roots.iter().map(|root| WriteStep::Node(*root, String::new())));
        }
        // The names of the children of the open prims.
        let mut taken = vec![names];
        while let Some(step) = open.pop() {
            let WriteStep::Node(number, above) = step else {
                writer.close()?;
                taken.pop();
                continue;
            };
            let scene = self.scene;
            let node = &scene.nodes[number];
            let shown = if node.name.is_empty() {
                node.part.map_or("", |part| &*scene.parts[part].name)
            } else {
                &node.name
            };
            let name = match taken.last_mut() {
                Some(taken) => taken.unique(shown, "Node"),
                None => UsdNames::default().unique(shown, "Node"),
            };
            let path = format!("{above}/{name}");
            let is_known = node.part.is_some_and(|part| self.first[part].is_some());
            if is_mesh(node) && (is_known || has_one_name(node, scene)) {
                self.mesh(node, &UsdPrimName { name: &name, shown, path: &path }, &mut writer)?;
                continue;
            }
            writer.open("Xform", &name, &display_name(shown, &name))?;
            transform(&node.matrix, &mut writer)?;
            let mut below = UsdNames::default();
            if !self.is_wrapped && above.is_empty() {
                below.unique("Materials", "");
                self.scope(&mut writer)?;
            }
            if let Some(part) = node.part {
                let shown = &*scene.parts[part].name;
                let name = below.unique(shown, "Mesh");
                let only = Node { part: Some(part), ..Node::default() };
                let path = format!("{path}/{name}");
                self.mesh(&only, &UsdPrimName { name: &name, shown, path: &path }, &mut writer)?;
            }
            taken.push(below);
            open.push(WriteStep::Close);
            open.extend(node.children.iter().rev().map(|child| WriteStep::Node(*child, path.clone())));
        }
        writer.out.flush()?;
        Ok(self.materials.lost.into_iter().collect())
    }

    /// Writes the materials.
    fn scope(&mut self, writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
        if self.materials.names.is_empty() {
            return Ok(());
        }
        writer.open("Scope", "Materials", &[])?;
        self.materials.write(writer)?;
        writer.close()
    }

    /// Writes a node as a mesh, or as one that inherits from another one.
    fn mesh(
        &mut self,
        node: &Node,
        at: &UsdPrimName<'_>,
        writer: &mut UsdaWriter<'_>,
    ) -> Result<(), WriteError> {
        let Some(number) = node.part else { return Ok(()) };
        let UsdPrimName { name, shown, path } = *at;
        let mut about = display_name(shown, name);
        if let Some(first) = &self.first[number] {
            // Otherwise it would inherit the display name too.
            about = vec![format!("displayName = {}", quoted(shown)), format!("inherits = <{first}>")];
            writer.open("Mesh", name, &about)?;
            // Without an order of its own, it would inherit the transform of the first mesh.
            if *node.matrix == IDENTITY {
                writer.line("uniform token[] xformOpOrder = []")?;
            }
            transform(&node.matrix, writer)?;
            return writer.close();
        }
        self.first[number] = Some(path.to_owned());
        let part_of = &self.scene.parts[number];
        let subsets = UsdSubsets::new(part_of.mesh.attributes(), &self.scene.groups, &self.materials);
        about.extend(subsets.about());
        writer.open("Mesh", name, &about)?;
        let request =
            UsdPartRequest { mesh: &part_of.mesh, frame: &self.scene.frame, subsets: &subsets, node };
        part(&request, &self.materials, writer)?;
        writer.close()
    }
}

/// A prim that is to be written.
struct UsdPrimName<'n> {
    name: &'n str,
    /// The display name.
    shown: &'n str,
    path: &'n str,
}

/// A step that is still to be done.
enum WriteStep {
    /// A node below a path.
    Node(usize, String),
    /// The end of the open prim.
    Close,
}

/// Whether a node can be written as a mesh: it shows a part and nothing else.
fn is_mesh(node: &Node) -> bool {
    node.part.is_some() && node.children.is_empty()
}

/// Whether the prim's name serves for the node and for its part.
fn has_one_name(node: &Node, scene: &Scene) -> bool {
    let part = node.part.and_then(|part| scene.parts.get(part));
    part.is_none_or(|part| node.name.is_empty() || part.name.is_empty() || part.name == node.name)
}
