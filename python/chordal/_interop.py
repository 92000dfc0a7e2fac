"""Conversion of meshes from and to other libraries. Libraries are imported only for conversions to them: their objects are
recognized by their attributes.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from chordal._arguments import warn
from chordal._registry import registered
from chordal._scene import first_of
from chordal._trimesh_materials import material_to_trimesh
from chordal._units import TRIMESH_NAMES

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._scene import _Kind


class Interoperable:
    """Conversions of a mesh from and to other libraries."""

    __slots__ = ()
    vertices: Any
    faces: Any
    normals: Any
    uv: Any
    colors: Any
    parts: Any
    attributes: Any
    materials: Any
    unit: Any

    @classmethod
    def from_(cls, thing: Any, *, weld: bool = False) -> Mesh:
        """The mesh of an object of trimesh, PyVista, Open3D, manifold3d or meshio, or of any object with `vertices` and
        `faces`: positions, faces, and normals, texture coordinates and colours of vertices; for trimesh also the unit, the
        material, and the nodes of a scene. Other data is dropped with a `UserWarning`; a bound is not taken over, either.
        `weld` is as for `Mesh`.

        >>> import chordal, types
        >>> other = types.SimpleNamespace(vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces=[(0, 1, 2)])
        >>> chordal.Mesh.from_(other)
        <Mesh: 1 triangle, 3 vertices, from arrays>
        """
        mesh = registered.mesh_of(thing, weld=weld)
        if mesh is None:
            raise TypeError(f"thing: a mesh of another library, not {type(thing).__name__}")
        return mesh

    def _vertex_rows(self, kind: _Kind) -> Any:
        """The rows of an attribute of the only part with one row for each vertex; None if there is no such attribute."""
        if len(self.parts) != 1:
            return None
        attribute = first_of(self.attributes, kind)
        fits = attribute is not None and attribute.domain == "vertex" and len(attribute.values) == len(self.vertices)
        return attribute.values if attribute is not None and fits else None

    def to_trimesh(self) -> Any:
        """A `trimesh.Trimesh` with the same vertices and faces, unmerged, with normals, texture coordinates and colours of
        vertices, and with the material if all faces have the same. The bound is in its `metadata["chordal"]`. Other data is
        dropped with a `UserWarning`.
        """
        import numpy as np
        trimesh = importlib.import_module("trimesh")

        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        visual = None
        material = material_to_trimesh(self)  # type: ignore[arg-type]
        if uv is not None or material is not None:
            rows = np.zeros((len(self.vertices), 2)) if uv is None else np.array(uv)
            visual = trimesh.visual.TextureVisuals(uv=rows, material=material)
        # trimesh has colours of vertices or a texture, not both.
        result = trimesh.Trimesh(
            vertices=np.array(self.vertices),
            faces=self.faces.astype(np.int64),
            vertex_normals=None if normals is None else np.array(normals),
            vertex_colors=None if colors is None or visual is not None else np.rint(np.array(colors) * 255).astype(np.uint8),
            visual=visual,
            # Processing would merge vertices.
            process=False,
            metadata={"chordal": self._about()},
        )
        if self.unit is not None:
            result.units = TRIMESH_NAMES[self.unit][0]
        lost = [] if colors is None or visual is None else ["colours beside texture coordinates or a material"]
        self._warn_of_loss(lost, keeps_materials=material is not None)
        return result

    def to_pyvista(self) -> Any:
        """A `pyvista.PolyData` with the same vertices and faces, and with normals, texture coordinates and colours of
        vertices. The bound is in its field data "chordal".
        """
        import numpy as np
        pyvista = importlib.import_module("pyvista")

        poly_data = pyvista.PolyData.from_regular_faces(np.array(self.vertices), self.faces.astype(np.int64))
        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        if normals is not None:
            poly_data.point_data["Normals"] = np.array(normals)
        if uv is not None:
            poly_data.active_texture_coordinates = np.array(uv)
        if colors is not None:
            poly_data.point_data["colors"] = np.array(colors)
        poly_data.add_field_data([str(self._about())], "chordal")
        self._warn_of_loss([])
        return poly_data

    def to_open3d(self) -> Any:
        """An `open3d.geometry.TriangleMesh` with the same vertices and faces, and normals and colours of vertices."""
        import numpy as np
        open3d = importlib.import_module("open3d")

        result = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(np.array(self.vertices)), open3d.utility.Vector3iVector(np.array(self.faces))
        )
        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        if normals is not None:
            result.vertex_normals = open3d.utility.Vector3dVector(np.array(normals))
        if colors is not None:
            result.vertex_colors = open3d.utility.Vector3dVector(np.array(colors[:, :3]))
        # Open3D has texture coordinates of corners.
        if uv is not None:
            result.triangle_uvs = open3d.utility.Vector2dVector(np.array(uv)[self.faces.ravel()])
        self._warn_of_loss(["alpha of colours"] if colors is not None and colors.shape[1] == 4 and np.any(colors[:, 3] != 1) else [])
        return result

    def to_manifold3d(self) -> Any:
        """A `manifold3d.Manifold` of closed triangles. Raises `ValueError` if manifold3d does not accept them as a solid."""
        manifold3d = importlib.import_module("manifold3d")
        import numpy as np

        mesh = manifold3d.Mesh64(np.array(self.vertices), self.faces.astype(np.uint64))
        manifold = manifold3d.Manifold(mesh)
        status = manifold.status()
        if status != manifold3d.Error.NoError:
            raise ValueError(f"manifold3d takes this for no solid: {status.name}")
        return manifold

    def to_meshio(self) -> Any:
        """A `meshio.Mesh` with the same vertices and faces, and with normals, texture coordinates and colours of vertices."""
        meshio = importlib.import_module("meshio")
        import numpy as np

        names: tuple[tuple[_Kind, str], ...] = (("normal", "normals"), ("uv", "uv"), ("color", "colors"))
        rows = {name: self._vertex_rows(kind) for kind, name in names}
        data = {name: np.array(values) for name, values in rows.items() if values is not None}
        self._warn_of_loss([])
        return meshio.Mesh(np.array(self.vertices), [("triangle", np.array(self.faces))], point_data=data)

    def _warn_of_loss(self, lost: list[str], keeps_materials: bool = False) -> None:
        """Warns of data that the conversion to another library drops."""
        lost = [*lost, *(["materials"] if self.materials and not keeps_materials else [])]
        names = {"normal": "normals", "uv": "texture coordinates", "color": "colours"}
        if len(self.parts) > 1:
            kinds = {attribute.kind for part in self.parts for attribute in part.attributes} & names.keys()
            lost = [*lost, *(f"{names[kind]} of several parts" for kind in sorted(kinds))]
        else:
            vertex_kinds: tuple[_Kind, ...] = ("normal", "uv", "color")
            missing = (k for k in vertex_kinds if first_of(self.attributes, k) is not None and self._vertex_rows(k) is None)
            lost = [*lost, *(f"{names[kind]} of faces or corners" for kind in missing)]
        others = (row for part in self.parts for row in part.attributes if row.kind in ("custom", "blended"))
        lost = [*lost, *dict.fromkeys(str(attribute.of) for attribute in others)]
        if lost:
            warn(f"{', '.join(lost)}: these stay behind; a file keeps them, as mesh.export(\"a.glb\") does")

    def _about(self) -> dict[str, Any]:
        bound = self.bound  # type: ignore[attr-defined]
        return {"at_least": bound.at_least, "at_most": bound.at_most, "evidence": bound.evidence}
