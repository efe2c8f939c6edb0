#pragma once

// Expressions of a scene file: the table [numbers], and strings where numbers are expected. Private to model/.

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "model/dependent_number.hpp"
#include "model/number_spots.hpp"
#include "model/parts.hpp"

namespace poise {

class SceneExpressions final : public ExpressionReader {
 public:
  /// The document outlives it.
  explicit SceneExpressions(const PartedDocument& parts) : parts_(parts) {}

  /// Reads [numbers] into the scene. Fails with the nearest name for one that is not there, and names a cycle.
  void read_named(const TomlTable& root, Scene& scene);
  /// Computes the scale of a part from its expression.
  double scale(const std::string& text) const;
  double value(const toml::value<std::string>& node, const TomlPlace& place) override;
  const std::vector<std::string>& names() const override { return names_; }
  const std::vector<double>& values() const override { return values_; }
  /// Finds for each expression that was read the number of the scene that follows from it. Fails where there is none.
  /// Numbers of a part's file become numbers of [numbers] too, each one for all uses of the file.
  void find_dependents(Scene& scene);

 private:
  struct Written {
    Expression expression;
    TomlPlace place;
    bool is_found = false;
  };
  Expression parsed(const std::string& text, const TomlPlace& place) const;
  const Written* find(const toml::node* node);
  /// The expression of a number of this dimension that was written in the file of a part, in the units of the scene.
  Expression in_scene(const Written& written, const Dimension& dimension, const Scene& scene) const;
  /// Of a number of a part's file that has this path there: how its row follows from the number that all uses share.
  Expression shared(const PartUse& use, const std::string& path, double value, const std::string& factor, Scene& scene);
  void share_number(const ParameterRow& row, const NumberSpot& spot, Scene& scene);
  void share_force(const ParameterRow& row, const NumberSpot& spot, std::vector<DependentNumber>& components,
                   Scene& scene);
  /// Keeps scales of parts that follow from numbers positive.
  void bound_scales(std::vector<DependentNumber>& components) const;
  void check_replacements() const;

  const PartedDocument& parts_;
  std::unordered_map<std::string, std::vector<std::string>> paths_;  // of numbers, by the file of a part
  std::map<std::string, std::string> shared_;                        // names of numbers that uses share
  std::vector<std::string> names_;
  std::vector<double> values_;
  std::vector<DependentNumber> dependents_;
  std::unordered_map<const toml::node*, Written> written_;
};

}  // namespace poise
