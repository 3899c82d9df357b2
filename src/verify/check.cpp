#include "verify/check.hpp"

#include <cmath>
#include <limits>

#include "verify/groups.hpp"

namespace vitrum {

const std::vector<CheckGroup>& check_groups() {
  static const std::vector<CheckGroup> groups = {
      {"interface", "Fresnel and Snell, against quadruple precision",
       "checks/fresnel.cl: border", 0.3, check_interface},
      {"absorption", "Bouguer's law",
       "checks/fresnel.cl: medium", 0.02, check_absorption},
      {"geometry", "rays at edges and corners of meshes, photons that go through them, lengths of ways",
       "checks/geometry.cl: edge_rays, chains", 0.1, check_geometry},
      {"photons", "balance of power, and caustics of a ball by quadrature",
       "stages/photons.cl: photons", 0.4, check_photons},
      {"density", "irradiance from photons: mean, bias, noise, and a radius that shrinks, against theory",
       "stages/photons.cl: photons, checks/gather.cl: gather_at", 0.1, check_density},
      {"slab-and-ball", "pictures of slabs, balls, nested and touching bodies, exact and as meshes, against closed forms",
       "stages/camera.cl: camera", 0.05, check_slab_and_ball},
      {"lights", "irradiance under each kind of light",
       "stages/camera.cl: camera", 0.04, check_lights},
      {"determinism", "the same bits again, in other groups, threads and launches",
       "stages/photons.cl: photons, stages/camera.cl: camera", 0.02, check_determinism},
      {"devices", "another device's answers to the same questions, with --against",
       "checks/fresnel.cl, stages/photons.cl, stages/camera.cl", 0.02, check_devices},
  };
  return groups;
}

void Worst::add(double found, uint64_t index) {
  ++cases;
  if (found <= error) return;   // lets NaN through
  if (std::isnan(found)) found = std::numeric_limits<double>::infinity();
  if (found > error) {
    error = found;
    at = index;
  }
}

void Worst::merge(const Worst& later) {
  cases += later.cases;
  if (later.error > error) {
    error = later.error;
    at = later.at;
  }
}

}  // namespace vitrum
