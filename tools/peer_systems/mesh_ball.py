"""The ball of the caustic plate as a mesh of 360 x 720 facets with the ball's own normals, in each system's format.

As mesh_ball() in src/verify/scenes.hpp, which `vitrum bench` has.
"""
import math
import struct

CENTRE, RADIUS = (0.0, 0.5, 0.0), 0.3
RINGS, SECTORS = 360, 720


def _normals():
    yield 0.0, 1.0, 0.0
    for ring in range(1, RINGS):
        theta = math.pi * ring / RINGS
        for sector in range(SECTORS):
            phi = 2 * math.pi * sector / SECTORS
            yield math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi)
    yield 0.0, -1.0, 0.0


def _triangles():
    def at(ring, sector):
        if ring == 0:
            return 0
        if ring == RINGS:
            return 1 + (RINGS - 1) * SECTORS
        return 1 + (ring - 1) * SECTORS + sector % SECTORS

    for ring in range(RINGS):
        for sector in range(SECTORS):
            if ring > 0:
                yield at(ring, sector), at(ring + 1, sector), at(ring, sector + 1)
            if ring < RINGS - 1:
                yield at(ring, sector + 1), at(ring + 1, sector), at(ring + 1, sector + 1)


def _position(normal):
    return tuple(c + RADIUS * n for c, n in zip(CENTRE, normal))


def write_ply(path):
    normals, triangles = list(_normals()), list(_triangles())
    with open(path, "wb") as file:
        coordinates = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(normals)}\n{coordinates}"
                    f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n").encode())
        for normal in normals:
            file.write(struct.pack("<6f", *_position(normal), *normal))
        for triangle in triangles:
            file.write(struct.pack("<B3i", 3, *triangle))


def write_obj(path):
    with open(path, "w") as file:
        for normal in _normals():
            file.write("v %.9g %.9g %.9g\n" % _position(normal))
            file.write("vn %.9g %.9g %.9g\n" % normal)
        for triangle in _triangles():
            file.write("f " + " ".join(f"{k + 1}//{k + 1}" for k in triangle) + "\n")


def write_pov(path):
    """As a declaration, `Ball`."""
    normals, triangles = list(_normals()), list(_triangles())

    def vectors(name, values):
        return f"{name} {{ {len(values)},\n" + ",\n".join("<%.9g, %.9g, %.9g>" % v for v in values) + "\n}\n"

    with open(path, "w") as file:
        file.write("#declare Ball = mesh2 {\n" + vectors("vertex_vectors", [_position(n) for n in normals]) +
                   vectors("normal_vectors", normals) + f"face_indices {{ {len(triangles)},\n" +
                   ",\n".join("<%d, %d, %d>" % t for t in triangles) + "\n}\n}\n")
