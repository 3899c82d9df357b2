#pragma once
// What a scene needs of the renderer: a pure function of the scene, so that what it does not use costs it nothing.

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

/// One switch for each thing that a kernel can be compiled without (kernels/switches.h).
struct Features {
  bool mesh = false;            ///< triangle meshes, and so a tree
  bool dielectric = false;      ///< light is refracted somewhere
  bool media_stack = false;     ///< there are several bodies of media, which may touch or overlap
  bool contacts = false;        ///< a transparent mesh may touch another shape
  bool absorption = false;      ///< some medium absorbs
  bool textures = false;
  bool highlights = false;      ///< some surface has a Phong term
  bool lights = false;          ///< direct light is computed
  bool caustics = false;        ///< photons are traced and gathered
  bool footprints = false;      ///< photons in the map have footprints
  bool patches = false;         ///< caustics that are seen directly are drawn by area, from photons on lattices
  bool nearest_photons = false; ///< the k nearest are gathered, not those within a fixed radius
  unsigned max_depth = 1;       ///< of camera rays
  unsigned light_kinds = 0;     ///< bit set, 1 << LIGHT_... of kernels/types.h
  std::optional<double> constant_reflectance;

  /// The switches as options for the OpenCL compiler.
  std::string build_options() const;
  /// "mesh, dielectric, ..." for the log.
  std::string names() const;
};

Features scene_features(const Scene& scene);

/// Names of the kernel stages (kernels/stages/NAME.cl) that will be built for these features.
std::vector<std::string> stages_for(const Features& features);
/// Those of them that photons need.
std::vector<std::string> photon_stages_for(const Features& features);

}  // namespace vitrum
