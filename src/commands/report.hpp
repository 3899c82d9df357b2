#pragma once
// What a render reports of itself, as JSON.

#include <string>

#include "render/render.hpp"

namespace vitrum {

/// Settings, device, features, times by stage, counts, memory, what the limits cut away, and errors as far as known
/// (docs/errors.md).
std::string render_report(const Scene& scene, const Device& device, const RenderResult& result);

}  // namespace vitrum
