"""docs/performance.md and its figure, from the figures of tools/peers and the newest of tools/benchmark."""
import json
from statistics import median

from peer_systems.curves import curves_of
from peer_systems.figure import figure_svg
from peer_systems.process import Failed

CASES = {"ball": "Exact ball", "mesh": "Ball of 516,960 triangles"}
NOT_MEASURED = "not measured here"

HEAD = """\
# What vitrum's pictures cost

Error of the default scene's caustic against CPU time, by vitrum and by others. Made by `tools/peers` on one machine:
{processor}.

![Relative RMSE against CPU time without start-up, logarithmic axes](performance/caustic_plate.svg)

## What is measured

Each system renders `models/caustic_plate`: a glass ball of radius .3 m above a plane, under a point light, seen by a
pinhole camera between ball and plane, 128 x 128 pixels of a square of .4 m that only the caustic lights. It does so
with the exact ball and with a mesh of 360 x 720 facets that have the ball's own normals, from scenes of ours in
`tools/peer_systems`, with several amounts of work.

- *Error*: root of the mean squared difference to the true irradiance over the pixels whose centre is within .2 m of the
  axis, divided by the mean of the truth there. The truth is a quadrature over all orders of paths
  (`src/reference/ball_caustic.hpp`, written by `vitrum bench photons --truth`); one function scores all pictures. None
  is scaled to fit: *flux*, what arrives within .2 m over the truth's, shows that the units agree.
- *CPU s, whole*: user and system time of the process and all that it starts, on all threads, from its start to a
  written picture; reading files and building trees are in it. The mesh is an OBJ file to vitrum, which is text, a
  binary PLY to Mitsuba and LuxCore, a scene file to POV-Ray.
- *CPU s, compute*: the same less that of a run that does next to nothing. For vitrum, whose runs are shorter than a
  start-up varies, it is what its report tells of the same kind: CPU time of the whole process while photons and camera
  rays are computed, less that of a run with one photon and one sample a pixel.
- Figures are medians of five runs, or of one where it takes more than 5 CPU s. Other work ran on the machine, which
  lengthens wall time, hence not shown, and CPU time somewhat, too: what shares a core and its caches works slower. The
  load average tells how much ran, the system itself included.
- Figures at an error stand between two runs, on logarithmic axes.
"""

REPEAT = """\
## To make this page again

```sh
tools/peers                  # installs the others in build/peers, measures what is not there yet, writes this page
tools/peers --only vitrum    # after work on vitrum: measures it anew, keeps the others' results
tools/peers --quick          # seconds: only to see that it runs
tools/benchmark              # the default scene beside POV-Ray, for the last rows of the table of goals
```

Results stand in `docs/performance/runs.json`. They are kept as long as version, settings and processor are the same;
`--again` measures anew in any case.
"""


def number(value, digits=3):
    if value is None:
        return ""
    if value >= 10 ** digits:
        return f"{float(f'{value:.{digits}g}'):,.0f}"
    return f"{value:.{digits}g}"


def table(head, rows):
    lines = ["| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows)]
    return "\n".join(lines) + "\n"


def load(system):
    """Between what the machine's load average was while the system was measured."""
    loads = [point["load"] for case in system["cases"].values() for points in case.values() for point in points
             if "load" in point]
    return f"{min(loads):g} to {max(loads):g}" if loads else "not kept"


def systems_table(systems):
    rows = []
    for system in systems.values():
        if "left_out" in system:
            rows.append([system["name"], "left out", "", "", system["left_out"]])
        else:
            rows.append([system["name"], system["version"], system["date"], load(system), system["settings"]])
    return "## The systems\n\n" + table(["system", "version", "measured", "load average", "settings"], rows)


def at_error(cases, error):
    """What the error costs each line, and how often vitrum's footprints would fit into it."""
    rows = []
    for case, curves in cases.items():
        ours = next((curve for curve in curves if curve.system == "vitrum"), None)
        for curve in curves:
            compute, whole = curve.at("compute", error), curve.at("whole", error)
            row = [CASES[case], curve.name]
            if compute is None:
                least = min(point.error for point in curve.points)
                row += [f"not reached; best {number(least)}", "", "", "", ""]
            else:
                ratios = ["", ""]
                if ours and curve.system != "vitrum" and ours.at("compute", error):
                    ratios = [number(compute / ours.at("compute", error)), number(whole / ours.at("whole", error))]
                row += [number(curve.at("photons", error)), number(compute), number(whole), *ratios]
            rows.append(row)
    return (f"## What an error of {error:.2f} costs\n\n" +
            table(["case", "system", "photons", "CPU s, compute", "CPU s, whole", "compute, times vitrum's footprints",
                   "whole, times vitrum's footprints"], rows))


def best(curves, x, error):
    """The curve of vitrum's that is cheapest at the error, and what it costs there."""
    reached = [(curve.at(x, error), curve) for curve in curves if curve.system == "vitrum" and curve.at(x, error)]
    return min(reached, key=lambda pair: pair[0], default=(None, None))


def against_mitsuba(curves, x, error):
    """How many times less vitrum takes than Mitsuba, and how that was found."""
    theirs = next((curve for curve in curves if curve.system == "mitsuba"), None)
    errors = [point.error for curve in curves if curve.system == "vitrum" for point in curve.points]
    ours, curve = best(curves, x, error)
    if theirs is None or not errors:
        return None, NOT_MEASURED
    if ours is None:
        return 0, f"vitrum's error does not get there; {number(min(errors))} is the smallest measured"
    cost, how = theirs.at(x, error), ""
    if cost is None and x == "compute":
        cost, how = theirs.beyond(error), f", extrapolated with its slope of {theirs.slope('compute'):.2f}"
    if cost is None:
        return None, NOT_MEASURED
    return cost / ours, (f"{number(cost / ours)} times: {number(ours)} CPU s ({curve.name.removeprefix('vitrum, ')}, "
                         f"{number(curve.at('photons', error))} photons) against {number(cost)}{how}")


def default_scene_figures(folder):
    """The newest figures of tools/benchmark that have POV-Ray in them, with their commit and file."""
    for path in sorted(folder.glob("*-default-scene.json"), reverse=True):
        told = json.loads(path.read_text())
        if told.get("peer"):
            return told, path.name
    return None, None


def default_scene_ratio(told, file, begins):
    if told is None:
        return None, NOT_MEASURED
    name = next((n for n in told["figures"] if n.startswith(begins) and n.endswith("POV-Ray / vitrum")), None)
    if name is None:
        return None, NOT_MEASURED
    ratio = told["figures"][name]["median"]
    return ratio, f"{number(ratio)} times ({name.split(':')[0]}; `docs/benchmarks/{file}`, commit {told['commit']})"


def rows_of(own, benchmark, *kinds):
    """Rows of one of vitrum's own benchmarks that are of these kinds."""
    return [row for row in own.get(benchmark, {}).get("rows", []) if row["what"] in kinds]


def span(values):
    least, most = number(min(values)), number(max(values))
    return least if least == most else f"{least} to {most}"


def beside(own, benchmark, kinds, few, unit):
    """How many times as fast as the library vitrum is, at least; from `few` on."""
    rows = [row for row in rows_of(own, benchmark, *kinds) if row[unit] >= few]
    if not rows:
        return None, NOT_MEASURED
    sizes = sorted({row[unit] for row in rows})
    told = "; ".join(f"{number(size, 4)}: {span([row['times as fast'] for row in rows if row[unit] == size])}" for size in sizes)
    return min(row["times as fast"] for row in rows), f"times as fast with {unit} {told}"


def threads_row(own):
    return next(iter(sorted(rows_of(own, "scaling", "threads"), key=lambda row: -row["threads"])), None)


def photon_rate(own):
    row = threads_row(own)
    if row is None:
        return None, NOT_MEASURED
    rate = 1e-6 * row["photons"] / row["photon CPU s"] * row["threads"]
    return rate, f"{number(rate)} M/s by CPU time"


def thread_cost(own):
    row = threads_row(own)
    if row is None:
        return None, NOT_MEASURED
    ratio = row["times that of one"]
    return 1 / ratio, f"{ratio:.2f} times, {number(row['threads'])} threads"


def photon_cost(own):
    rows = rows_of(own, "scaling", "passes")
    if not rows:
        return None, NOT_MEASURED
    cost = [row["ns a photon"] for row in rows]
    memory = [row["process MB"] for row in rows]
    return (min(cost[0] / max(cost), min(cost) / cost[0]),
            f"{' / '.join(number(c) for c in cost)} ns for 10^6 / 10^7 / 10^8 / 10^9 photons; the process has "
            f"{number(memory[0])} to {number(memory[-1])} MB")


def start(own, what):
    row = next(iter(rows_of(own, "startup", what)), None)
    return (None, NOT_MEASURED) if row is None else (1 / row["first pixel s"], f"{number(row['first pixel s'])} s")


def triangle_memory(own):
    rows = rows_of(own, "traversal", "primary")
    if not rows:
        return None, NOT_MEASURED
    theirs = "Embree's B"
    return (min(row[theirs] / row["B/triangle"] for row in rows),
            f"{span([row['B/triangle'] for row in rows])} bytes, Embree {span([row[theirs] for row in rows])}")


# Why a goal is not met, told where it is not.
WHY = {
    "photons": "More than half of a photon's time is following it, in 228 instructions with bounds of rounding and a balance of "
               "its power, and what a packet keeps is more than the registers hold; the rest is the sort, a third of it copying "
               "([limits.md](limits.md)).",
    "scaling": "It falls: in its first pass a process touches all of its memory for the first time, in pages that the system "
               "clears one by one. From 10^7 photons on it is flat.",
    "traversal": "Where nodes come from memory, rays in turns gain, since each one's next node is fetched while the others go "
                 "on; where a tree fits the caches, they gain less (`kernels/tree.h`).",
    "gather": "A query looks at 2.1 times the photons that it finds, those in the cells about it, and those of random queries "
              "come from memory ([limits.md](limits.md)). The nanoflann of the goal did .44 and .10 M queries/s, this one does "
              "more (below).",
    "start": "PoCL takes .7 s to compile the smallest program of all, and .1 to .5 s for each of five to seven kernels, one after "
             "the other, since its compiler cannot run twice in a process; warm, it still preprocesses the source.",
    "memory": "Boxes are floats, eight at a node, and a leaf has its triangles' corners at hand.",
}


def goals(cases, benchmarks, own):
    ball, mesh = cases.get("ball", []), cases.get("mesh", [])
    told, file = default_scene_figures(benchmarks)
    rows, reasons = [], []

    def goal(what, least, measured, why=None):
        value, how = measured
        met = value is None or value >= least
        rows.append([what, how, "" if value is None else "yes" if met else "no"])
        if why and not met and why not in reasons:
            reasons.append(why)

    goal("Exact ball to error .10, compute: 1,000 times less CPU time than Mitsuba's ptracer", 1000,
         against_mitsuba(ball, "compute", 0.1))
    photons, curve = best(ball, "photons", 0.1)
    goal("that with 16,384 photons", 1, (None, NOT_MEASURED) if photons is None else
         (16384 / photons, f"{number(photons)} photons ({curve.name.removeprefix('vitrum, ')})"))
    goal("Exact ball to error .10, whole process: 20 times less", 20, against_mitsuba(ball, "whole", 0.1))
    goal("Exact ball to error .02, compute: 5,000 times less", 5000, against_mitsuba(ball, "compute", 0.02))
    ours = [curve for curve in ball if curve.system == "vitrum"]
    falling = [(curve, exponent) for curve in ours if (exponent := curve.exponent(0.2, 0.01))]
    goal("From .2 to .01 the error falls as the photons' power of -.55 or steeper", 0.55,
         (None, NOT_MEASURED) if not falling else
         (max((-exponent for curve, exponent in falling if curve.at("photons", 0.01)), default=0),
          "; ".join(f"{curve.name.removeprefix('vitrum, ')}: {exponent:.2f}" +
                    ("" if curve.at("photons", 0.01) else f", down to {number(curve.points[-1].error)} only")
                    for curve, exponent in falling)))
    least = min((point.error for curve in ours for point in curve.points), default=None)
    goal("No floor of the error above .005", 1 / 0.005, (None, NOT_MEASURED) if least is None else
         (1 / least if least <= 0.005 else None, f"{number(least)} is the smallest measured"))
    goal("Mesh of 516,960 triangles to error .10, compute, tree built: 200 times less than Mitsuba's", 200,
         against_mitsuba(mesh, "compute", 0.1))
    goal("Exact ball's photons aimed, followed, stored and sorted: 80 M/s on 2 threads", 80, photon_rate(own), "photons")
    goal("What a photon costs with 10^6 to 10^9 of them: the same within 15 %, memory flat", 1 / 1.15, photon_cost(own), "scaling")
    goal("CPU time with 2 threads: at most 1.05 times that with one", 1 / 1.05, thread_cost(own))
    goal("Default scene, 512 x 512, one sample a pixel: 15 times less CPU time than POV-Ray, one thread", 15,
         default_scene_ratio(told, file, "trace 512 x 512 without photons"))
    goal("Default scene, 1.2 M photons aimed, traced, stored, sorted: 20 times less, one thread", 20,
         default_scene_ratio(told, file, "shoot "), "photons")
    goal("Primary, diffuse, shadow and photon rays through .5, 3 and 10 M triangles: 1.3 times as fast as Embree", 1.3,
         beside(own, "traversal", ("primary", "diffuse", "shadow", "photon"), 400_000, "triangles"), "traversal")
    goal("Memory of a triangle, tree included: no more than Embree's", 1, triangle_memory(own), "memory")
    goal("50 photons within a radius, coherent queries: 30 times as fast as nanoflann", 30,
         beside(own, "gather", ("radius, coherent",), 0, "photons"), "gather")
    goal("the same, random queries: 80 times", 80, beside(own, "gather", ("radius, random",), 0, "photons"), "gather")
    goal("Start to first pixel, warm: .15 s", 1 / 0.15, start(own, "warm"), "start")
    goal("the same, with an empty cache of kernels: 1.2 s", 1 / 1.2, start(own, "cold"), "start")
    page = "## Goals\n\nOn two processors.\n\n" + table(["goal", "measured", "met"], rows)
    if reasons:
        page += "\nWhere one is not met:\n\n" + "".join(f"- *{why}*: {WHY[why]}\n" for why in reasons)
    return page


def all_runs(cases):
    head = ["case", "system", "photons", "CPU s, compute", "CPU s, whole", "error", "flux"]
    rows = [[CASES[case], curve.name, f"{point.photons:,}", number(point.compute), number(point.whole),
             number(point.error), f"{point.flux:.4f}"]
            for case, curves in cases.items() for curve in curves for point in curve.points]
    return "## All runs\n\n" + table(head, rows)


def own_benchmarks(own):
    if not own:
        return ""
    page = ("## By vitrum's own benchmarks\n\n`vitrum bench` has one process for all runs of a kind; [bench.md](bench.md) tells "
            "what each measures. `photons` takes the least of three runs and ends at 256 samples a pixel.\n")
    for name, report in own.items():
        page += f"\n`vitrum bench {name}`, commit {report['commit']}:\n\n" + "".join(f"- {f}\n" for f in report["findings"])
        if name in ("traversal", "gather", "startup", "scaling"):
            # Rows of one kind have the same figures.
            for head in dict.fromkeys(tuple(row) for row in report["rows"]):
                rows = [[row["what"]] + [number(row[key], 4) for key in head[1:]] for row in report["rows"] if tuple(row) == head]
                page += "\n" + table(["", *head[1:]], rows)
    return page


def write_document(output, systems):
    """Raises Failed if systems were measured on different processors: their times say nothing together."""
    processors = {system["processor"] for system in systems.values() if "processor" in system}
    if len(processors) != 1:
        raise Failed(f"results are of different processors ({'; '.join(sorted(processors))}); "
                     "run tools/peers for all systems")
    own = systems.get("vitrum", {}).get("benchmarks", {})
    cases = {case: curves_of(systems, case) for case in CASES}
    cases = {case: curves for case, curves in cases.items() if curves}
    (output / "performance").mkdir(parents=True, exist_ok=True)
    (output / "performance/caustic_plate.svg").write_text(
        figure_svg([(CASES[case], curves) for case, curves in cases.items()]))
    parts = [HEAD.format(processor=processors.pop()), systems_table(systems), at_error(cases, 0.1),
             goals(cases, output / "benchmarks", own), all_runs(cases), own_benchmarks(own), REPEAT]
    (output / "performance.md").write_text("\n".join(part for part in parts if part))
