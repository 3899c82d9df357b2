#pragma once
// One pass of photons: emitted towards what refracts or mirrors, traced, stored, sorted into a grid or a tree.

#include <array>
#include <functional>
#include <memory>

#include "render/kernel_context.hpp"

namespace vitrum {

/// Power by what became of it [W], red, green and blue. Each is summed by itself, so that the balance
/// shot + split = stored + absorbed + direct + lost + cut is a check and not a definition.
struct PhotonBalance {
  Spectrum shot{0.0};           ///< aimed at casters and emitted
  Spectrum stored{0.0};         ///< in the photon map
  Spectrum absorbed{0.0};       ///< by media, and by surfaces that do not scatter
  Spectrum direct{0.0};         ///< met a diffuse surface first: direct light's business
  Spectrum lost{0.0};           ///< left the scene
  Spectrum cut{0.0};            ///< by the depth limit
  Spectrum split{0.0};          ///< what photons that branched off took along, less their chance to: 0 on average
  Spectrum not_aimed{0.0};      ///< sent by the lights elsewhere; infinite where a light has no finite power
  uint64_t photons_shot = 0, photons_stored = 0, photons_absorbed = 0, photons_direct = 0, photons_lost = 0;
  uint64_t photons_cut = 0, photons_branched = 0;
  uint64_t photons_rejected = 0;  ///< not stored since their place, direction or power is not finite; none expected
  uint64_t surfaces_met = 0;    ///< rays traced
};

/// What a launch of photons leaves, run by run (kernels/photon_map.h).
struct PhotonRuns {
  uint32_t length = 0;                      ///< of a run
  uint32_t row = PHOTON_ROW;                ///< floats of a photon; ARRIVED_ROW where patches are drawn, and then:
  kernel::LatticeData lattice{};
  Buffer<float> landings;                   ///< of the lattice's points
  Buffer<float> photons;
  Buffer<uint32_t> counts;                  ///< photons of each run in each bucket of the grid
  Buffer<kernel::PhotonRunData> on_device;
  std::vector<kernel::PhotonRunData> reports;
};

/// The photons of a pass, sorted into a grid or, for the k nearest, into a tree (kernels/photon_map.h).
struct PhotonMap {
  uint32_t count = 0;
  float radius = 0.0f;                      ///< of the estimate [m]; for the k nearest, the greatest; how far footprints reach
  std::array<float, 4> low{}, high{};       ///< box around all photons [m]
  // The grid.
  uint32_t fields = PHOTON_FIELDS;          ///< of an entry; FOOTPRINT_FIELDS with footprints
  kernel::GridData grid{};
  Buffer<float> photons;
  Buffer<kernel::BucketData> buckets;
  std::vector<uint32_t> bucket_counts;
  Buffer<uint32_t> first_of_cell;
  // The tree.
  kernel::PhotonTreeData tree{};
  Buffer<float> leaves, nodes;
};

/// The photons of the map {x, y, z, packed direction, power r, g, b, -}, in no order that means anything; where a footprint was
/// cut, its parts.
std::vector<cl_float8> read_photons(Device& device, const PhotonMap& map);

/// Sets a kernel's PHOTON_MAP_PARAMETERS (kernels/gather.h) from argument `first` on; returns the next argument's index.
unsigned set_map_arguments(cl::Kernel& kernel, unsigned first, const PhotonMap& map, const Scene& scene);

/// Photons of the largest lattice; they all wait in memory until their neighbours are known.
inline constexpr uint64_t largest_lattice = 1u << 20;

/// What a pass is to do.
struct PhotonPassPlan {
  uint64_t pass = 0;            ///< its number in the picture, from 0: a progressive radius goes by it
  uint32_t replicate = 0;
  uint64_t before = 0;          ///< photons that this replicate has emitted already
  uint64_t count = 0;           ///< to emit
  double share = 1.0;           ///< of the photons of the picture, so that an automatic radius is no wider for many passes
  int samples = 1;              ///< of a pixel in the picture: footprints are no smaller than what lies between them
};

class PatchView;

/// Traces photons pass by pass; keeps its buffers between passes, and has room for the largest so far.
class PhotonPass {
 public:
  explicit PhotonPass(const KernelContext& context);
  ~PhotonPass();

  /// Photons that a single pass can hold on this device.
  static uint64_t capacity(const Device& device, const Features& features);

  /// Emits the photons of a pass; passes come one after the other. `view`: takes them in too, where patches are drawn and
  /// a picture is made. `wants_map`: if not, and the view shows all that is lit, no map is made. Reports the fraction done.
  void run(const PhotonPassPlan& plan, PatchView* view, bool wants_map, const std::function<void(double)>& progress);

  /// What the last run left. Valid until the next.
  const PhotonMap& map() const;
  /// Sum over all runs.
  const PhotonBalance& balance() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vitrum
