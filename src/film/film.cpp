#include "film/film.hpp"

#include <cassert>
#include <set>

#include "core/error.hpp"

namespace vitrum {

Film::Film(int width, int height, int replicates) : width_(width), height_(height), planes_(std::size_t(replicates)) {
  assert(width >= 1 && height >= 1 && replicates >= 1 && replicates <= max_replicates);
}

std::size_t Film::values_of(int channels) const {
  return std::size_t(width_) * std::size_t(height_) * std::size_t(channels);
}

void Film::add(uint64_t pass, const std::string& name, int channels, std::span<const float> values, double samples) {
  assert(channels >= 1 && values.size() == values_of(channels) && samples > 0);
  const auto [place, is_new] =
      planes_[pass % planes_.size()].try_emplace(name, FilmPlane{name, channels, 0, std::vector<double>()});
  FilmPlane& plane = place->second;
  assert(plane.channels == channels);
  if (is_new) plane.sums.resize(values_of(channels), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) plane.sums[i] += values[i];
  plane.samples += samples;
}

std::vector<std::string> Film::names() const {
  std::set<std::string> all;
  for (const auto& planes : planes_) {
    for (const auto& [name, plane] : planes) all.insert(name);
  }
  return {all.begin(), all.end()};
}

const FilmPlane* Film::plane(const std::string& name, int replicate) const {
  const auto& planes = planes_.at(std::size_t(replicate));
  const auto found = planes.find(name);
  return found == planes.end() ? nullptr : &found->second;
}

std::vector<double> Film::mean(const std::string& name) const {
  std::vector<double> sums;
  double samples = 0;
  for (int r = 0; r < replicates(); ++r) {
    const FilmPlane* part = plane(name, r);
    if (!part) continue;
    sums.resize(part->sums.size(), 0.0);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += part->sums[i];
    samples += part->samples;
  }
  for (double& sum : sums) sum /= samples;
  return sums;
}

std::vector<double> Film::variance_of_mean(const std::string& name) const {
  const std::vector<double> centre = mean(name);
  std::vector<double> variance(centre.size(), 0.0);
  double samples = 0;
  int filled = 0;
  for (int r = 0; r < replicates(); ++r) {
    const FilmPlane* part = plane(name, r);
    if (!part) continue;
    for (std::size_t i = 0; i < variance.size(); ++i) {
      const double deviation = part->sums[i] / part->samples - centre[i];
      variance[i] += part->samples * deviation * deviation;
    }
    samples += part->samples;
    ++filled;
  }
  if (filled < 2) return {};
  for (double& value : variance) value /= (filled - 1) * samples;
  return variance;
}

void Film::merge(const Film& other) {
  const char* mend = "merge films of the same scene and settings";
  if (other.width_ != width_ || other.height_ != height_) throw Error({}, "the films differ in size", mend);
  if (other.replicates() != replicates()) throw Error({}, "the films differ in their number of replicates", mend);
  for (int r = 0; r < replicates(); ++r) {
    for (const auto& [name, theirs] : other.planes_[std::size_t(r)]) {
      const FilmPlane* ours = plane(name, r);
      if (ours && ours->channels != theirs.channels) {
        throw Error({}, "the films differ in the channels of their plane '" + name + "'", mend);
      }
    }
  }
  for (int r = 0; r < replicates(); ++r) {
    for (const auto& [name, theirs] : other.planes_[std::size_t(r)]) {
      const auto [place, is_new] = planes_[std::size_t(r)].try_emplace(name, theirs);
      if (is_new) continue;
      FilmPlane& ours = place->second;
      for (std::size_t i = 0; i < ours.sums.size(); ++i) ours.sums[i] += theirs.sums[i];
      ours.samples += theirs.samples;
    }
  }
}

}  // namespace vitrum
