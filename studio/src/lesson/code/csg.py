from chordal.shapes import box, cylinder

block = box(2, 2, 1)
hole = cylinder(0.4, 2)
part = block - hole  # max(block, -hole)
mesh = part.mesh(tol=0.01)
print(len(mesh.faces), "triangles, watertight:", mesh.is_watertight)
