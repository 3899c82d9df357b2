"""Error against CPU time, from the figures of tools/peers."""
import math
from dataclasses import dataclass
from statistics import median


@dataclass
class Point:
    photons: int
    error: float
    flux: float                 # within .2 m, relative to the truth's
    whole: float                # CPU seconds of the process
    compute: float              # without start-up


@dataclass
class Curve:
    system: str                 # its key
    name: str                   # of the line, with the system's
    points: list

    def slope(self, x):
        """Exponent fitted to the error over all points, `x` being "compute" or "photons"."""
        pairs = [(math.log(getattr(p, x)), math.log(p.error)) for p in self.points]
        mean_x, mean_y = (sum(values) / len(pairs) for values in zip(*pairs))
        return (sum((a - mean_x) * (b - mean_y) for a, b in pairs) / sum((a - mean_x) ** 2 for a, _ in pairs))

    def at(self, x, error):
        """Where the error first falls to `error`, between two points on logarithmic axes; None: nowhere."""
        for before, after in zip(self.points, self.points[1:]):
            if before.error > error >= after.error:
                share = math.log(before.error / error) / math.log(before.error / after.error)
                return getattr(before, x) * (getattr(after, x) / getattr(before, x)) ** share
        return None

    def exponent(self, above, below):
        """Exponent of the photons by which the error falls from `above` to `below`, or to its last point if that comes
        first; None if it does not come to `above`."""
        first = self.at("photons", above)
        if first is None:
            return None
        last = self.at("photons", below)
        end = (last, below) if last else (self.points[-1].photons, self.points[-1].error)
        return math.log(end[1] / above) / math.log(end[0] / first)

    def beyond(self, error):
        """Where it would fall to `error` if it went on from its last point as the fit says."""
        last = self.points[-1]
        return last.compute * (error / last.error) ** (1 / self.slope("compute"))


def curves_of(systems, case):
    """The curves of a case, in the order of systems and lines."""
    curves = []
    for key, system in systems.items():
        for name, figures in system.get("cases", {}).get(case, {}).items():
            little, *rest = figures
            points = []
            for f in rest:
                whole, seconds = median(f["whole"]), "passes" if "passes" in f else "whole"
                compute = median(f[seconds]) - median(little[seconds])
                if compute > 0:
                    points.append(Point(f["photons"], f["error"], f["flux"], whole, compute))
            if len(points) > 1:
                curves.append(Curve(key, f"{system['name']}, {name}", points))
    return curves
