#pragma once
// The photon map's grid: how large its cells are, how wide the estimate's radius, and the sort into it.

#include <span>

#include "render/photon_pass.hpp"

namespace vitrum {

/// The radius within which about `wanted` of `count` photons lie around the median photon, judged from `places`, those
/// of some photons [m]. The density is that on a surface.
float automatic_radius(std::span<const glm::vec3> places, uint64_t count, double wanted);

/// What a progressive radius has become by pass number `pass`, from 0, as a multiple of its square in pass 0: r_(i+1)^2
/// / r_i^2 = (i + alpha) / (i + 1) for passes i = 1, 2, ... with alpha = 2/3, for which the mean squared error of the
/// mean over N passes falls fastest, as N^(-2/3). Knaus and Zwicker, "Progressive photon mapping: a probabilistic
/// approach", ACM Transactions on Graphics 30 (2011).
double progressive_area(uint64_t pass);

/// A grid of cells a little larger than `radius` [m], 1 / `along_x` of that along x (a power of two): about
/// `cells_at_most`, but 2^22 at most, and fewer where the photons in `sample` lie close together along all axes.
kernel::GridData choose_grid(std::span<const glm::vec3> sample, uint64_t cells_at_most, float radius, uint32_t along_x);

/// Photons to look at, of a pass of `count`, before its grid is started: enough for each bucket to tell its room, so
/// that this stays within `largest_row_share` rows a photon.
uint32_t pilot_size(uint64_t count);
inline constexpr double largest_row_share = 1.5;

/// The cell of a place [m], as kernels/photon_map.h numbers them.
uint32_t cell_of(const kernel::GridData& grid, const glm::vec3& p);

/// Sorts the photons of a pass into a grid, launch by launch; keeps its buffers.
class PhotonGrid {
 public:
  explicit PhotonGrid(const KernelContext& context);

  /// Chooses radius and grid from `sample`, places of some photons [m], for a pass that stores about `expected`. An
  /// automatic radius takes in the pass's share of photons.nearest; a progressive one is that of pass 0, where an
  /// automatic one takes in as many of that pass, shrunk.
  void start(std::span<const glm::vec3> sample, uint64_t expected, const PhotonPassPlan& plan);
  const kernel::GridData& grid() const { return map_.grid; }
  /// Buckets of cells, by which the photons of a launch are to be counted.
  uint32_t buckets() const { return static_cast<uint32_t>(room_.size()); }

  /// How large footprints may be in the pass.
  kernel::FootprintLimits footprint_limits() const;
  /// Takes in the photons of a launch; with footprints, all of a lattice.
  void add(const PhotonRuns& runs);
  /// Sorts what was taken in.
  void finish();
  /// Valid from finish until the next start; from start until finish without photons.
  const PhotonMap& map() const { return map_; }

 private:
  /// Where the rows of a bucket are, in rows of the map's buffer.
  struct Room {
    uint32_t start = 0, size = 0;
  };
  /// Makes the map's buffer at least so large; what is used of it stays.
  void reserve_rows(uint64_t rows);
  Room new_room(uint32_t rows);

  /// Room for what `runs` adds to each bucket, by their counts; leaves in places_ where each of them goes on.
  void make_room(const PhotonRuns& runs);

  KernelContext context_;
  const uint32_t row_;          ///< floats of an entry before it is sorted
  PhotonMap map_;
  double first_radius_ = 0.0;   ///< [m], before it shrinks
  int samples_ = 1;             ///< of a pixel
  std::vector<Room> room_;      ///< by bucket
  uint32_t used_rows_ = 0;
  Buffer<uint32_t> places_, next_of_cell_, tasks_, first_task_, first_scratch_, counts_;
  Buffer<float> scratch_;
};

}  // namespace vitrum
