#include "bench/embree_scene.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <sstream>

#include "bench/side_by_side.hpp"
#include "core/error.hpp"
#include "core/printed.hpp"

namespace vitrum {
namespace {

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE)
    throw Error({}, printed("Embree failed with its error %d", error), "check that Debian's libembree3 fits this machine");
}

bool count_bytes(void* sum, ssize_t bytes, bool) {
  *static_cast<std::atomic<int64_t>*>(sum) += bytes;
  return true;
}

RTCRay ray_of(const RayData& r) {
  const glm::vec3 o = r.origin, d = r.direction;
  return {o.x, o.y, o.z, r.t_min, d.x, d.y, d.z, 0, r.t_max, 0xffffffffu, 0, 0};
}

/// What stands between `from` and `to` in the text, without the blanks around it.
std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const size_t end = text.find(to), start = text.rfind(from, end);
  if (start == std::string::npos || end == std::string::npos) return "?";
  const std::string found = text.substr(start + from.size(), end - start - from.size());
  const size_t first = found.find_first_not_of(' '), last = found.find_last_not_of(' ');
  return first == std::string::npos ? "" : found.substr(first, last + 1 - first);
}

}  // namespace

struct EmbreeScene::State {
  std::atomic<int64_t> bytes = 0;
  unsigned threads;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  explicit State(unsigned n) : threads(n) {}
  ~State() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

EmbreeScene::EmbreeScene(const Mesh& mesh, unsigned threads) : state_(std::make_unique<State>(threads)) {
  RTCDevice device = state_->device = rtcNewDevice(printed("threads=%u", threads).c_str());
  check(device);
  rtcSetDeviceMemoryMonitorFunction(device, count_bytes, &state_->bytes);
  state_->scene = rtcNewScene(device);
  rtcSetSceneFlags(state_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(state_->scene, RTC_BUILD_QUALITY_MEDIUM);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* const corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                                mesh.positions.size());
  void* const indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                                mesh.triangles.size());
  check(device);
  std::ranges::copy(mesh.positions, static_cast<glm::vec3*>(corners));
  std::ranges::copy(mesh.triangles, static_cast<glm::uvec3*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(state_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(state_->scene);
  check(device);
}

EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::closest(const std::vector<RayData>& rays, std::vector<float>& t) const {
  in_threads(state_->threads, rays.size(), [&](size_t first, size_t last) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = first; i < last; ++i) {
      RTCRayHit query{};
      query.ray = ray_of(rays[i]);
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(state_->scene, &context, &query);
      t[i] = query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : query.ray.tfar;
    }
  });
}

void EmbreeScene::occluded(const std::vector<RayData>& rays, std::vector<uint32_t>& met) const {
  in_threads(state_->threads, rays.size(), [&](size_t first, size_t last) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = first; i < last; ++i) {
      RTCRay query = ray_of(rays[i]);
      rtcOccluded1(state_->scene, &context, &query);
      met[i] = query.tfar < 0.0f;  // -inf
    }
  });
}

double EmbreeScene::bytes() const { return static_cast<double>(state_->bytes); }

std::string EmbreeScene::description() {
  // It tells what it was compiled for to std::cout alone.
  std::ostringstream told;
  std::streambuf* const usual = std::cout.rdbuf(told.rdbuf());
  const RTCDevice device = rtcNewDevice("verbose=1");
  std::cout.rdbuf(usual);
  const auto version = static_cast<int>(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION));
  rtcReleaseDevice(device);
  const std::string text = told.str();
  const std::string features = text.substr(std::min(text.size(), text.find("Features:")));
  return printed("Embree %d.%d.%d, built for %s, with %s", version / 10000, version / 100 % 100, version % 100,
                 between(text, "\n", "(compile time enabled)").c_str(), between(features, ":", "\n").c_str());
}

}  // namespace vitrum
