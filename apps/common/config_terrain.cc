#include "apps/common/config_terrain.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "apps/common/config_include.h"

namespace surefoot::apps {

void load_terrain(ConfigNode& tree, ConfigIssues& issues) {
  ConfigNode* terrain = tree.find("terrain");
  ConfigNode* model = terrain == nullptr ? nullptr : terrain->find("model");
  // A group is what the record holds.
  if (model == nullptr || model->kind == ConfigNode::Kind::kMap) return;
  const std::optional<std::filesystem::path> file =
      named_file(*model, terrain->place.source, "terrain.model", "terrain model", issues);
  if (!file) {
    model->kind = ConfigNode::Kind::kMap;
    return;
  }
  ConfigNode content = read_yaml_file(file->string(), issues);
  *model = std::move(content);
}

}  // namespace surefoot::apps
