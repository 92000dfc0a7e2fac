"""What a file says beside its triangles, read by a few lines for each format and, for USD, by OpenUSD.

`traits(path)` is a set of words (`normals`, `texcoords 0`, `animations` …), `names(path)` the names of materials and
parts.
"""

import json
import re
import zipfile
from pathlib import Path

WORD_OF_ATTRIBUTE = {"NORMAL": "normals", "TANGENT": "tangents", "JOINTS_0": "joints", "JOINTS_1": "joints 1"}
SILENT_ATTRIBUTES = ("POSITION", "WEIGHTS_0", "WEIGHTS_1")
COORDINATES = {"x", "y", "z"}
# Names of PLY and VTP that mean one trait.
WORD_OF_PROPERTY = {
    "nx": "normals", "ny": "normals", "nz": "normals", "red": "colors", "green": "colors", "blue": "colors", "alpha": "colors",
    "r": "colors", "g": "colors", "b": "colors", "a": "colors", "s": "texcoords 0", "t": "texcoords 0", "u": "texcoords 0",
    "v": "texcoords 0", "texture_u": "texcoords 0", "texture_v": "texcoords 0", "diffuse_red": "colors",
    "diffuse_green": "colors", "diffuse_blue": "colors",
}


def tree_of(path):
    """The JSON of a glTF."""
    data = Path(path).read_bytes()
    if data[:4] == b"glTF":
        data = data[20:20 + int.from_bytes(data[12:16], "little")]
    return json.loads(data)


def shown_nodes(tree):
    """The nodes of the scene that is shown, or all."""
    nodes, scenes = tree.get("nodes", []), tree.get("scenes", [])
    below = list(scenes[tree.get("scene", 0)].get("nodes", [])) if scenes else list(range(len(nodes)))
    seen = set()
    while below:
        at = below.pop()
        if at not in seen:
            seen.add(at)
            below.extend(nodes[at].get("children", []))
    return [nodes[at] for at in sorted(seen)]


def of_gltf(path):
    """Traits of a glTF's shown nodes and of the primitives that have triangles."""
    tree = tree_of(path)
    nodes, meshes, materials = shown_nodes(tree), tree.get("meshes", []), tree.get("materials", [])
    found, looks, parts = set(), set(), set()
    for at in {node["mesh"] for node in nodes if "mesh" in node}:
        mesh = meshes[at]
        parts.add(mesh.get("name", ""))
        found |= {"extras of meshes"} if "extras" in mesh else set()
        for primitive in mesh["primitives"]:
            if primitive.get("mode", 4) < 4:
                found.add("points and lines")
                continue
            for name in primitive["attributes"]:
                if name not in SILENT_ATTRIBUTES:
                    word = WORD_OF_ATTRIBUTE.get(name, name.lower().replace("_", " ", 1))
                    word = f"property{word}" if word.startswith(" ") else word
                    found.add(word.replace("texcoord ", "texcoords ").replace("color 0", "colors"))
            found |= {"morph targets"} if primitive.get("targets") else set()
            if "material" in primitive:
                looks.add(materials[primitive["material"]].get("name", ""))
                found |= {"textures"} if "exture" in json.dumps(materials[primitive["material"]]) else set()
    # The names of groups of faces.
    groups = tree.get("asset", {}).get("extras", {}).get("groups", {})
    parts |= {name for names in groups.values() for name in names} if isinstance(groups, dict) else set()
    found |= {"animations"} if tree.get("animations") else set()
    found |= {"skins"} if any("skin" in node for node in nodes) else set()
    found |= {"cameras"} if any("camera" in node for node in nodes) else set()
    found |= {"lights"} if any("KHR_lights_punctual" in node.get("extensions", {}) for node in nodes) else set()
    found |= {"extras of nodes"} if any("extras" in node for node in nodes) else set()
    return found, looks, parts, {node["name"] for node in nodes if "name" in node}


def of_obj(path):
    """Traits of an OBJ: what its faces name."""
    text = Path(path).read_bytes().decode("utf-8", "replace").replace("\r\n", "\n").replace("\\\n", " ")
    found, looks, parts, look, inside = set(), set(), set(), None, {}
    has_faces = re.search(r"^\s*f\s", text, re.MULTILINE) is not None
    for words in (line.split("#")[0].split() for line in text.split("\n")):
        if not words:
            continue
        if words[0] == "v" and len(words) >= 7:
            found.add("colors")
        elif words[0] == "usemtl":
            look = " ".join(words[1:])
        elif words[0] in ("o", "g"):
            # "default" is the group that faces are in when nothing is said.
            inside[words[0]] = " ".join(words[1:]) if words[1:] != ["default"] else None
        elif words[0] in ("l", "p"):
            found.add("points and lines")
        elif words[0] == "vn" and not has_faces:
            found.add("normals")
        elif words[0] == "mtllib" and (library := Path(path).parent / " ".join(words[1:])).is_file():
            found |= {"textures"} if b"map_" in library.read_bytes() else set()
        elif words[0] == "f" and len(words) > 3:
            corner = (words[1] + "//").split("/")
            found |= {"texcoords 0"} if corner[1] else set()
            found |= {"normals"} if corner[2] else set()
            looks |= {look} if look else set()
            parts |= {part for part in inside.values() if part}
    return found, looks, parts, set()


def of_ply(path):
    """Traits of a PLY's header."""
    head = re.split(rb"end_header", Path(path).read_bytes(), maxsplit=1)[0].decode("latin1")
    found, element = set(), ""
    for words in (line.split() for line in re.split(r"[\r\n]+", head)):
        if words[:1] == ["element"]:
            element, rows = words[1], int(words[2])
            if rows and element not in ("vertex", "face", "tristrips"):
                found.add(f"element {element}")
        elif words[:1] == ["property"] and words[-1] not in COORDINATES and rows:
            if element == "vertex":
                found.add(WORD_OF_PROPERTY.get(words[-1], f"property {words[-1].lower()}"))
            elif element == "face" and words[-1] not in ("vertex_indices", "vertex_index"):
                found.add("colors of faces" if words[-1] in WORD_OF_PROPERTY else f"face property {words[-1]}")
    return found, set(), set(), set()


def of_off(path):
    """Traits of an OFF's keyword."""
    data = Path(path).read_bytes()[:4096].decode("latin1")
    key = re.search(r"^\s*(ST)?(C)?(N)?(4)?(n)?OFF", data, re.MULTILINE)
    words = ("texcoords 0", "colors", "normals")
    return {word for word, got in zip(words, key.groups() if key else ()) if got}, set(), set(), set()


def of_stl(path):
    """An STL holds triangles and no more."""
    del path
    return set(), set(), set(), set()


def of_3mf(path):
    """Traits of the models in a package."""
    found, looks, parts = set(), set(), set()
    with zipfile.ZipFile(path) as package:
        for name in package.namelist():
            if name.lower().endswith(".model"):
                text = package.read(name).decode("utf-8", "replace")
                looks |= set(re.findall(r'<(?:\w+:)?base [^>]*?name="([^"]*)"', text))
                parts |= set(re.findall(r'<(?:\w+:)?object [^>]*?name="([^"]*)"', text))
                found |= {"colors"} if "colorgroup" in text else set()
    return found, looks, parts, set()


def of_usd(path):
    """Traits of the meshes of a USD."""
    from pxr import Usd, UsdGeom, UsdShade

    found, looks, parts, nodes = set(), set(), set(), set()
    stage = Usd.Stage.Open(str(path))
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdShade.Material):
            looks.add(prim.GetDisplayName() or prim.GetName())
        elif prim.IsA(UsdGeom.Mesh):
            parts.add(prim.GetDisplayName() or prim.GetName())
            names = {primvar.GetPrimvarName() for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvars() if primvar.HasValue()}
            names |= {"normals"} if UsdGeom.Mesh(prim).GetNormalsAttr().HasValue() else set()
            words = {"displayColor": "colors", "displayOpacity": "colors", "st": "texcoords 0", "st1": "texcoords 1", "normals": "normals"}
            found |= {words.get(name, f"primvar {name}") for name in names}
        elif prim.IsA(UsdGeom.Xform):
            nodes.add(prim.GetDisplayName() or prim.GetName())
        elif prim.GetTypeName() == "GeomSubset":
            parts.add(prim.GetDisplayName() or prim.GetName())
        elif prim.GetTypeName() == "Shader":
            found |= {"textures"} if UsdShade.Shader(prim).GetIdAttr().Get() == "UsdUVTexture" else set()
    return found, looks, parts, nodes


def of_vtp(path):
    """Traits of a VTP's arrays."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data, found = reader.GetOutput(), set()
    for i in range(data.GetPointData().GetNumberOfArrays()):
        name = data.GetPointData().GetArrayName(i)
        low = name.lower()
        word = next((word for key, word in (("normal", "normals"), ("tangent", "tangents"), ("color", "colors")) if key in low), None)
        if word is None and ("texcoord" in low or "tcoords" in low):
            word = "texcoords " + (re.findall(r"\d+", low) or ["0"])[0]
        found.add(word or f"property {low}")
    for i in range(data.GetCellData().GetNumberOfArrays()):
        found.add(f"face property {data.GetCellData().GetArrayName(i)}")
    return found, set(), set(), set()


OF_FORMAT = {
    ".gltf": of_gltf, ".glb": of_gltf, ".obj": of_obj, ".ply": of_ply, ".off": of_off, ".stl": of_stl, ".3mf": of_3mf,
    ".usda": of_usd, ".vtp": of_vtp,
}


def traits(path):
    """Traits, names of materials that faces have, names of parts, names of nodes."""
    return OF_FORMAT[Path(path).suffix.lower()](path)
