#include "film/picture_layers.hpp"

#include <algorithm>
#include <utility>

namespace vitrum {
namespace {

/// A layer yet without values, and the channels that it takes them from.
struct LayerPlan {
  PictureLayer layer;
  std::vector<size_t> channels;
};

class Planner {
 public:
  explicit Planner(const std::vector<std::string>& names) : names_(names), is_taken_(names.size(), false) {
    for (size_t i = 0; i < names.size(); ++i) {
      if (!is_taken_[i]) plan_layer_of(i);
    }
  }
  std::vector<LayerPlan>& plans() { return plans_; }

 private:
  void plan_layer_of(size_t channel) {
    const std::string& full_name = names_[channel];
    const size_t dot = full_name.rfind('.');
    const bool is_plain = dot == std::string::npos;
    const std::string prefix = is_plain ? "" : full_name.substr(0, dot + 1), last = full_name.substr(prefix.size());
    const std::string group = is_plain ? "" : full_name.substr(0, dot);
    for (const std::string letters : {"RGB", "XYZ"}) {
      if (last.size() != 1 || letters.find(last) == std::string::npos) continue;
      const bool is_colour = letters == "RGB";
      const std::string name = !is_plain ? group : is_colour ? "beauty" : letters;
      std::vector<size_t> channels;
      for (const char letter : letters) {
        const auto found = std::find(names_.begin(), names_.end(), prefix + letter);
        if (found != names_.end()) channels.push_back(size_t(found - names_.begin()));
      }
      if (channels.size() == 3 && !is_name_taken(name)) return add(name, std::move(channels), is_colour);
    }
    const bool is_grey = last == "Y" || last == "I";  // luminance in EXR and PNG, intensity in older files
    const std::string name = is_plain ? (is_grey ? "beauty" : full_name) : group;
    if (is_name_taken(name)) return add(full_name, {channel}, is_grey);
    add(name, std::vector<size_t>(name == "beauty" ? 3 : 1, channel), is_grey);
  }
  bool is_name_taken(const std::string& name) const {
    return std::any_of(plans_.begin(), plans_.end(), [&](const LayerPlan& plan) { return plan.layer.name == name; });
  }
  void add(const std::string& name, std::vector<size_t> channels, bool is_colour) {
    for (const size_t channel : channels) is_taken_[channel] = true;
    plans_.push_back({{name, int(channels.size()), {}, is_colour}, std::move(channels)});
  }

  const std::vector<std::string>& names_;
  std::vector<bool> is_taken_;
  std::vector<LayerPlan> plans_;
};

}  // namespace

LayeredPicture in_layers(const PictureChannels& picture) {
  LayeredPicture layered{picture.width, picture.height, picture.is_float, {}};
  const size_t stride = picture.names.size();
  Planner planner(picture.names);
  for (LayerPlan& plan : planner.plans()) {
    plan.layer.values.reserve(picture.values.size() / stride * plan.channels.size());
    for (size_t pixel = 0; pixel < picture.values.size(); pixel += stride) {
      for (const size_t channel : plan.channels) plan.layer.values.push_back(picture.values[pixel + channel]);
    }
    layered.layers.push_back(std::move(plan.layer));
  }
  return layered;
}

}  // namespace vitrum
