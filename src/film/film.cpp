#include "film/film.hpp"

#include <cassert>
#include <cmath>
#include <set>

#include "core/error.hpp"

namespace vitrum {

Film::Film(int width, int height, int replicates) : width_(width), height_(height), planes_(std::size_t(replicates)) {
  assert(width >= 1 && height >= 1 && replicates >= 1 && replicates <= max_replicates);
}

std::size_t Film::values_of(int channels) const {
  return std::size_t(width_) * std::size_t(height_) * std::size_t(channels);
}

uint64_t Film::add(uint64_t pass, const std::string& name, int channels, std::span<const float> values, double samples) {
  assert(channels >= 1 && values.size() == values_of(channels) && samples > 0);
  const auto [place, is_new] =
      planes_[pass % planes_.size()].try_emplace(name, FilmPlane{name, channels, 0, {}, {}});
  FilmPlane& plane = place->second;
  assert(plane.channels == channels);
  if (is_new) plane.sums.resize(values_of(channels), 0.0);
  uint64_t rejected = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) {
      plane.sums[i] += values[i];
    } else {
      plane.rejected[i] += samples;
      ++rejected;
    }
  }
  plane.samples += samples;
  return rejected;
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

std::vector<const FilmPlane*> Film::parts(const std::string& name) const {
  std::vector<const FilmPlane*> found;
  for (int r = 0; r < replicates(); ++r)
    if (const FilmPlane* part = plane(name, r)) found.push_back(part);
  return found;
}

std::vector<double> Film::mean(const std::string& name) const {
  const std::vector<const FilmPlane*> all = parts(name);
  std::vector<double> means(all.empty() ? 0 : all.front()->sums.size());
  for (std::size_t i = 0; i < means.size(); ++i) {
    double sum = 0, samples = 0;
    for (const FilmPlane* part : all) {
      sum += part->sums[i];
      samples += part->samples_of(i);
    }
    means[i] = sum / samples;
  }
  return means;
}

std::vector<double> Film::variance_of_mean(const std::string& name) const {
  const std::vector<const FilmPlane*> all = parts(name);
  if (all.size() < 2) return {};
  std::vector<double> variance = mean(name);
  for (std::size_t i = 0; i < variance.size(); ++i) {
    double samples = 0, sum = 0;
    for (const FilmPlane* part : all) samples += part->samples_of(i);
    for (const FilmPlane* part : all) {
      const double share = part->samples_of(i) / samples;
      if (share == 0) continue;
      const double deviation = share * (part->sums[i] / part->samples_of(i) - variance[i]);
      // Of a single replicate 0 / 0, which is no number.
      sum += deviation * deviation / (1 - share);
    }
    variance[i] = sum;
  }
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
      for (const auto& [i, samples] : theirs.rejected) ours.rejected[i] += samples;
      ours.samples += theirs.samples;
    }
  }
}

}  // namespace vitrum
