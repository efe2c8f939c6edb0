#pragma once

// Expressions of a scene file: the table [numbers], and strings where numbers are expected. Private to model/.

#include <string>
#include <unordered_map>
#include <vector>

#include "model/dependent_number.hpp"
#include "model/toml_reader.hpp"

namespace poise {

class SceneExpressions final : public ExpressionReader {
 public:
  /// Reads [numbers] into the scene. Fails with the nearest name for one that is not there, and names a cycle.
  void read_named(const TomlTable& root, Scene& scene);
  double value(const toml::value<std::string>& node, const TomlPlace& place) override;
  /// Finds for each expression that was read the number of the scene that follows from it. Fails where there is none.
  void find_dependents(const toml::table& document, Scene& scene);

 private:
  struct Written {
    Expression expression;
    TomlPlace place;
    bool is_found = false;
  };
  Expression parsed(const std::string& text, const TomlPlace& place) const;
  const Written* find(const toml::node* node);

  std::vector<std::string> names_;
  std::vector<double> values_;
  std::vector<DependentNumber> dependents_;
  std::unordered_map<const toml::node*, Written> written_;
};

}  // namespace poise
