"""The caustic plate by Mitsuba's particle tracer, in a process and a virtual environment of its own.

usage: mitsuba_plate.py PARTICLES_PER_PIXEL OUTPUT [MESH.ply]

OUTPUT holds the irradiance [W/m2] at 1 W/sr: 32-bit floats, rows from the top.
"""
import array
import math
import sys

import mitsuba

mitsuba.set_variant("llvm_ad_rgb")

SIZE, HALF_WIDTH, EYE, REFLECTANCE = 128, 0.2, 0.19, 0.01

particles, output, mesh = int(sys.argv[1]), sys.argv[2], sys.argv[3:]
turned = mitsuba.ScalarTransform4f
scene = mitsuba.load_dict({
    "type": "scene",
    "sensor": {
        "type": "perspective",
        "fov": 2 * math.degrees(math.atan(HALF_WIDTH / EYE)),
        "near_clip": 1e-3,
        "to_world": turned().look_at(origin=[0, EYE, 0], target=[0, 0, 0], up=[0, 0, 1]),
        "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                 "component_format": "float32"},
    },
    "lamp": {"type": "point", "position": [0, 1, 0], "intensity": {"type": "rgb", "value": 1}},
    "lawn": {
        "type": "rectangle",
        "to_world": turned().rotate([1, 0, 0], -90).scale(100),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": REFLECTANCE}},
    },
    "ball": {
        **({"type": "ply", "filename": mesh[0]} if mesh else {"type": "sphere", "center": [0, 0.5, 0], "radius": 0.3}),
        "bsdf": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0},
    },
})
picture = mitsuba.render(scene, integrator=mitsuba.load_dict({"type": "ptracer"}), spp=particles)
with open(output, "wb") as file:
    array.array("f", (math.pi / REFLECTANCE * picture[:, :, 0]).array).tofile(file)
