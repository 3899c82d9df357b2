"""The caustic plate by LuxCore, in a process and a virtual environment of its own.

usage: luxcore_plate.py light|hybrid SAMPLES_PER_PIXEL OUTPUT MESH.ply

OUTPUT holds the irradiance [W/m2] at 1 W/sr: 32-bit floats, rows from the top. LuxCore's balls are meshes.
"""
import array
import math
import os
import sys

import pyluxcore

SIZE, HALF_WIDTH, EYE, REFLECTANCE = 128, 0.2, 0.19, 0.01
ROW = 2 / SIZE  # of the picture, which lies a row off where the camera looks

engine, samples, output, mesh = sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4]


def properties(values):
    result = pyluxcore.Properties()
    for name, value in values.items():
        result.Set(pyluxcore.Property(name, value))
    return result


pyluxcore.Init(lambda message: None)
scene = pyluxcore.Scene()
scene.Parse(properties({
    "scene.camera.type": "perspective",
    "scene.camera.lookat.orig": [0.0, EYE, 0.0],
    "scene.camera.lookat.target": [0.0, 0.0, 0.0],
    "scene.camera.up": [0.0, 0.0, 1.0],
    "scene.camera.fieldofview": 2 * math.degrees(math.atan(HALF_WIDTH / EYE)),
    "scene.camera.screenwindow": [-1.0, 1.0, -1.0 - ROW, 1.0 - ROW],
    "scene.camera.autofocus.enable": False,
    "scene.camera.cliphither": 1e-3,
    "scene.materials.glass.type": "glass",
    "scene.materials.glass.kr": [1.0, 1.0, 1.0],
    "scene.materials.glass.kt": [1.0, 1.0, 1.0],
    "scene.materials.glass.interiorior": 1.5,
    "scene.materials.glass.exteriorior": 1.0,
    "scene.materials.lawn.type": "matte",
    "scene.materials.lawn.kd": [REFLECTANCE] * 3,
    "scene.objects.ball.ply": mesh,
    "scene.objects.ball.material": "glass",
    "scene.objects.lawn.vertices": [-100.0, 0.0, -100.0, -100.0, 0.0, 100.0, 100.0, 0.0, 100.0, 100.0, 0.0, -100.0],
    "scene.objects.lawn.faces": [0, 1, 2, 0, 2, 3],
    "scene.objects.lawn.material": "lawn",
    "scene.lights.lamp.type": "point",
    "scene.lights.lamp.position": [0.0, 1.0, 0.0],
    "scene.lights.lamp.gain": [4 * math.pi] * 3,  # spread over all directions
}))
# All samples go to paths from the light, since nothing else is seen; the halt counts those from the eye and the light.
engines = {
    "light": {"renderengine.type": "LIGHTCPU"},
    "hybrid": {"renderengine.type": "PATHCPU", "path.hybridbackforward.enable": True,
               "path.hybridbackforward.partition": 0.0},
}
session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties({
    "film.width": SIZE,
    "film.height": SIZE,
    "film.filter.type": "NONE",
    "film.imagepipelines.0.0.type": "NOP",
    "sampler.type": "RANDOM",
    "path.pathdepth.total": 20,
    "path.pathdepth.diffuse": 20,
    "path.pathdepth.glossy": 20,
    "path.pathdepth.specular": 20,
    "light.maxdepth": 20,
    "batch.haltspp": [0, samples],
    **engines[engine],
}), scene))
session.Start()
while not session.HasDone():
    session.WaitNewFrame()
    session.UpdateStats()  # halts it
session.Stop()
pixels = array.array("f", bytes(4 * 3 * SIZE * SIZE))
session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB_IMAGEPIPELINE, pixels, 0, True)
red = pixels[::3]
with open(output, "wb") as file:
    for row in reversed(range(SIZE)):
        array.array("f", (math.pi / REFLECTANCE * value for value in red[SIZE * row:SIZE * (row + 1)])).tofile(file)
    file.flush()
os._exit(0)  # Python's own end finds LuxCore's threads, and aborts
