"""The systems that are compared: how each is installed and asked for the caustic plate.

A system has lines, a line being a system with one choice of settings. It renders a case ("ball": exact; "mesh") with an
amount of work, and gives the irradiance [W/m2] at 1 W/sr in 128 x 128 pixels, rows from the top.
"""
import array
import hashlib
import json
import math
import pathlib
import re
import shutil
import sys
import urllib.parse
from dataclasses import dataclass, field

from openexr import read_exr
from peer_systems import mesh_ball
from peer_systems.process import Failed, measured, output_of

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HERE = pathlib.Path(__file__).resolve().parent
PIXELS = 128 * 128


@dataclass(frozen=True)
class Line:
    name: str
    work: dict                  # case: amounts, ascending
    options: tuple = ()
    little: int = 1             # the amount of a run that does next to nothing
    per_pixel: bool = True      # amounts are photons for each of the picture's pixels, not photons


@dataclass
class Run:
    """What one run gave."""
    whole: float                # CPU seconds of the process
    irradiance: list
    passes: float | None = None  # CPU seconds of photons and camera rays, where the system tells


@dataclass
class System:
    key: str
    name: str
    settings: str               # a sentence for the document
    lines: tuple
    files: tuple                # that results depend on
    folder: pathlib.Path = None  # for what is installed and made, and is kept
    scratch: pathlib.Path = None
    version: str = None         # known once it is installed
    environment: dict = field(default_factory=dict)

    def install(self):
        """Makes it ready, in `folder`. Raises Failed."""

    def run(self, line, case, amount):
        """Raises Failed."""
        raise NotImplementedError

    def digest(self):
        """Of what was asked: results of another are not kept."""
        text = b"".join((HERE / name).read_bytes() for name in self.files) + repr(self.lines).encode()
        return hashlib.sha256(text).hexdigest()[:12]

    def mesh(self, name, write):
        path = self.folder / name
        if not path.exists():
            write(path)
        return path

    def measured(self, command):
        return measured(command, self.scratch / "log", self.environment)


def floats(path):
    values = array.array("f")
    with open(path, "rb") as file:
        values.fromfile(file, PIXELS)
    return values.tolist()


def unpack_debian(package, folder):
    """The folder in which the package lies unpacked, with those that it needs that are not installed. Raises Failed."""
    root = folder / package
    if root.exists():
        return root
    wanted = output_of("apt-get", "install", "--print-uris", "-qq", "--no-install-recommends", package)
    files = [urllib.parse.unquote(line.split()[1]) for line in wanted.splitlines() if line.startswith("'")]
    part = folder / f"{package}.part"
    shutil.rmtree(part, ignore_errors=True)
    (part / "deb").mkdir(parents=True)
    for name in {package, *(file.split("_")[0] for file in files)}:
        output_of("apt-get", "download", "-qq", "-o", "APT::Sandbox::User=root", name, cwd=part / "deb")
    for file in (part / "deb").iterdir():
        output_of("dpkg", "-x", file, part)
    shutil.rmtree(part / "deb")
    part.rename(root)
    return root


def virtual_environment(folder, *packages):
    """The Python of a virtual environment with the packages. Raises Failed."""
    root = folder / "python"
    if not root.exists():
        part = folder / "python.part"  # its scripts name this folder, but none of them is run
        shutil.rmtree(part, ignore_errors=True)
        output_of(sys.executable, "-m", "venv", part)
        output_of(part / "bin/python", "-m", "pip", "install", "-q", "--no-deps", *packages)
        part.rename(root)
    return root / "bin/python"


@dataclass
class Mitsuba(System):
    def install(self):
        self.python = virtual_environment(self.folder, "mitsuba==3.9.1", "drjit==1.5.0")
        llvm = unpack_debian("libllvm19", self.folder)
        found = sorted(llvm.glob("usr/lib/*/libLLVM.so.19*"))
        if not found:
            raise Failed("libllvm19 has no libLLVM.so.19")
        self.environment = {"DRJIT_LIBLLVM_PATH": str(found[0]), "LD_LIBRARY_PATH": str(found[0].parent)}
        self.version = "3.9.1, LLVM 19"

    def run(self, line, case, amount):
        picture = self.scratch / "picture"
        mesh = [self.mesh("ball.ply", mesh_ball.write_ply)] if case == "mesh" else []
        whole = self.measured([self.python, "-B", HERE / "mitsuba_plate.py", amount, picture, *mesh])
        return Run(whole, floats(picture))


@dataclass
class LuxCore(System):
    def install(self):
        self.python = virtual_environment(self.folder, "pyluxcore==2.11.2", "numpy==2.4.6")
        none = self.folder / "no_opencl"
        none.mkdir(exist_ok=True)
        self.environment = {"OCL_ICD_VENDORS": str(none)}  # it aborts when it sees PoCL
        self.version = "2.11.2"

    def run(self, line, case, amount):
        picture, mesh = self.scratch / "picture", self.mesh("ball.ply", mesh_ball.write_ply)
        whole = self.measured([self.python, "-B", HERE / "luxcore_plate.py", *line.options, amount, picture, mesh])
        return Run(whole, floats(picture))


@dataclass
class PovRay(System):
    def install(self):
        self.program = shutil.which("povray")
        if not self.program:
            root = unpack_debian("povray", self.folder)
            self.program = root / "usr/bin/povray"
            self.environment = {"LD_LIBRARY_PATH": ":".join(map(str, root.glob("usr/lib/*-linux-gnu")))}
        # It tells its version on the standard error, beside much else.
        self.measured([self.program, "--version"])
        self.version = re.search(r"POV-Ray (3[\w.]+)", (self.scratch / "log").read_text())[1]

    def run(self, line, case, amount):
        picture = self.scratch / "picture.ppm"
        mesh = []
        if case == "mesh":
            self.mesh("ball.inc", mesh_ball.write_pov)
            mesh = ["Declare=MeshBall=1"]
        whole = self.measured([self.program, f"+I{HERE}/caustic_plate.pov", f"+L{self.folder}", f"+O{picture}", "+W128",
                               "+H128", "-D", "+WT2", "+FP16", "File_Gamma=1", *line.options,
                               f"Declare=Photons={amount}", *mesh])
        values = array.array("H", picture.read_bytes()[-3 * 2 * PIXELS:])
        if sys.byteorder == "little":
            values.byteswap()
        return Run(whole, [400 * value / 65535 for value in values[::3]])


@dataclass
class Vitrum(System):
    program: pathlib.Path = None

    def install(self):
        """A benchmark tells its version and writes the truth."""
        report = self.scratch / "bench.json"
        self.truth_file = self.scratch / "truth.exr"
        self.measured([self.program, "bench", "photons", "--quick", "--report", report, "--truth", self.truth_file])
        told = json.loads(report.read_text())
        device = told["device"]
        self.version = f"{told['version']}, commit {told['commit']}, {device['platform']} {device['driver']}"

    def truth(self):
        return next(iter(read_exr(self.truth_file.read_bytes())[2].values()))

    def benchmark(self, name):
        """The report of `vitrum bench NAME`."""
        report = self.scratch / "bench.json"
        self.measured([self.program, "bench", name, "--report", report])
        return json.loads(report.read_text())

    def run(self, line, case, amount):
        picture, report = self.scratch / "picture.exr", self.scratch / "report.json"
        mesh = []
        if case == "mesh":
            path = self.mesh("ball.obj", mesh_ball.write_obj)
            mesh = ["--set", f'shape.ball={{type = "mesh", file = "{path}", material = "glass"}}']
        samples = line.samples or (min(max(amount >> 14, 4), 1024) if amount > line.little else 1)
        whole = self.measured([self.program, "render", ROOT / "models/caustic_plate/scene.toml", "--quiet",
                               "-o", picture, "--report", report, "--photons", amount, "--samples", samples,
                               *line.options, *mesh])
        radiance = read_exr(picture.read_bytes())[2]["R"]
        told = json.loads(report.read_text())
        # The scene's lamp has pi W/sr and its lawn a reflectance of .01, so that the pi of Lambert's law falls out.
        return Run(whole, [value / 0.01 for value in radiance], sum(told["cpu_seconds"].values()))


@dataclass(frozen=True)
class VitrumLine(Line):
    per_pixel: bool = False
    samples: int = 0            # of a pixel; 0: they grow with the photons; 256 would leave an error of .016


def photons(most):
    """4,096, and four times as many from run to run."""
    return tuple(4 ** k for k in range(6, most + 1))


def all_systems(folder, scratch, program):
    """Them all, vitrum first. What is installed lies in `folder`; `scratch` is for one run of the tool."""
    def in_folder(system):
        system.folder, system.scratch = folder / system.key, scratch
        return system

    return [in_folder(system) for system in (
        Vitrum("vitrum", "vitrum", "`photons.estimate` as named, the rest by default. With footprints one sample a pixel, which shows "
               "the mean over it; else samples grow with the photons as in `vitrum bench photons`, but to 1,024.",
               (VitrumLine("footprints", {"ball": photons(10), "mesh": photons(10)},
                           ("--set", "photons.estimate=footprints"), samples=1),
                VitrumLine("automatic radius", {"ball": photons(12), "mesh": photons(11)},
                           ("--set", "photons.estimate=automatic_radius"))),
               ("mesh_ball.py",), program=program),
        Mitsuba("mitsuba", "Mitsuba", "Integrator `ptracer`, variant `llvm_ad_rgb`, box filter, the rest by default.",
                (Line("ptracer", {"ball": (64, 256, 1024, 4096), "mesh": (64, 256, 1024, 2048)}),),
                ("mesh_ball.py", "mitsuba_plate.py")),
        LuxCore("luxcore", "LuxCore", "Sampler `RANDOM`, which is the best here; the hybrid gives all samples to paths "
                "from the light, there being nothing else to see. Balls are meshes to it.",
                (Line("LIGHTCPU", {"mesh": (64, 256, 1024, 2048)}, ("light",)),
                 Line("PATHCPU, hybrid back/forward", {"mesh": (64, 256, 1024)}, ("hybrid",))),
                ("mesh_ball.py", "luxcore_plate.py")),
        PovRay("povray", "POV-Ray", "`photons { count N }` and nothing else set; photons are those "
               "wanted on surfaces; one ray a pixel, or nine.",
               (Line("1 ray a pixel", {"ball": (10 ** 5, 10 ** 6, 4 * 10 ** 6), "mesh": (10 ** 5, 10 ** 6)}, ("-A",),
                     little=100, per_pixel=False),
                Line("9 rays a pixel", {"ball": (10 ** 6, 4 * 10 ** 6, 10 ** 7), "mesh": (10 ** 6, 4 * 10 ** 6)},
                     ("+A0.0", "+AM1", "+R3"), little=100, per_pixel=False)),
               ("mesh_ball.py", "caustic_plate.pov")),
    )]


def scored(irradiance, truth):
    """Root of the mean squared error over the pixels within .2 m of the axis, relative to the truth's mean there, as in
    src/verify/caustic_plate.hpp; and the flux that falls there, relative to the truth's."""
    size = math.isqrt(PIXELS)
    inside = [i for i in range(PIXELS)
              if math.hypot(i % size - (size - 1) / 2, i // size - (size - 1) / 2) < size / 2]
    mean = sum(truth[i] for i in inside) / len(inside)
    squares = sum((irradiance[i] - truth[i]) ** 2 for i in inside)
    return math.sqrt(squares / len(inside)) / mean, sum(irradiance[i] for i in inside) / (mean * len(inside))
