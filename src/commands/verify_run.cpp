#include "commands/verify_run.hpp"

#include <algorithm>

#include "core/version.hpp"

namespace vitrum {

size_t VerifyRun::failed() const {
  return static_cast<size_t>(std::count_if(results.begin(), results.end(), [](const CheckResult& r) { return !r.passed(); }));
}

std::string VerifyRun::made_by() const {
  const auto named = [](const DeviceInfo& d) { return d.name + ", " + d.platform + ", " + d.version + ", driver " + d.driver; };
  const std::string built = commit();
  return std::string("vitrum ") + version() + (built.empty() ? "" : ", commit " + built) + ", " + named(device) +
         (other ? ", against " + named(*other) : "");
}

std::string png_of(const CheckPicture& picture) {
  PictureLayer layer;
  for (const glm::vec3& pixel : picture.picture.pixels) layer.values.insert(layer.values.end(), {pixel.x, pixel.y, pixel.z});
  return picture_file("report.png", picture.picture.width, picture.picture.height, {layer}, DisplaySettings{}, {});
}

}  // namespace vitrum
