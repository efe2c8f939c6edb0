#pragma once

// Parts of a scene: the tables [[part]] of its document, each of which names a scene file whose items it brings into
// the scene, placed, turned, mirrored and under names of their own. What is read after that is one document as if it
// had been written by hand, whose nodes know the files that they come from. Private to model/.
//
// The ground of a part is a massless body PART.ground that a weld, PART, holds at the point ground.PART: all that
// counts from the part's ground stays as its file has it. A mirrored part has y to -y in the frames of all of its
// bodies, so that their angles are the opposite ones. A measure of angles keeps its value there by an exchange of its
// two bodies.

#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <toml++/toml.h>

#include "model/toml_reader.hpp"

namespace poise {

namespace parts {
class Expander;
class Placing;
}  // namespace parts

/// A use of a part's file.
struct PartUse : TomlPart {
  /// In front of the names of the numbers that all uses of the file share: "stage". Empty of what no such file has.
  std::string file_stem{};
  /// A number of the file whose place another one has: its path in the file, as a name in expressions, and that one's
  /// name in [numbers].
  std::map<std::string, std::string> replaced{};
  /// What `scale` follows from, an expression of numbers of the scene; empty where it is a number.
  std::string scale_text{};
  TomlPlace scale_place{};
};

/// A number of [numbers] that a table [[part]] gives: "lift.k", or in the place of another one "lift.body.left.mass".
struct PartNumber {
  const PartUse* use;  ///< the first of that table
  std::string key;     ///< as the table has it: "k", "body.left.mass"
  TomlPlace place;
};

/// The document of a scene with its parts in their places.
class PartedDocument {
 public:
  /// Throws InputError: of a part's file with its line there. Without a table [[part]] the document is left as it is.
  PartedDocument(toml::table document, const TomlPlace& place);
  PartedDocument(const PartedDocument&) = delete;
  PartedDocument& operator=(const PartedDocument&) = delete;

  const toml::table& document() const { return document_; }
  const TomlParts& files() const { return files_; }
  bool has_parts() const { return !uses_.empty(); }
  const std::deque<PartUse>& uses() const { return uses_; }
  /// The use that a node comes from; null of the scene's own file and of what no file has.
  const PartUse* use_of(const toml::node& node) const;
  /// Whether mirroring has changed the sign of a number.
  bool is_negated(const toml::node& number) const { return negated_.contains(spot_of(number)); }
  /// The key under which the file has a number that mirroring has moved; else `key`.
  std::string_view key_in_file(const toml::node& number, std::string_view key) const;
  /// Numbers that tables [[part]] give in the place of others than those of [numbers].
  const std::vector<PartNumber>& replacements() const { return replacements_; }
  /// What the scene's own [numbers] gives for others than those of [numbers] of parts' files: "stage.body.left.mass".
  struct Given {
    TomlPlace place;
    double value = 0.0;
  };
  const std::map<std::string, Given>& given() const { return given_; }
  /// Gives parts whose scale is an expression the scale that it has: value(expression), which may throw InputError.
  template <class Value>
  void find_scales(Value value) {
    for (PartUse& use : uses_) {
      if (use.scale_text.empty()) continue;
      use.scale = located(use.scale_place, [&] { return value(use.scale_text); });
    }
  }
  /// Those of the scene's own file, once its table [units] has been read.
  Units& units() { return own_.units; }

 private:
  friend class parts::Expander;
  friend class parts::Placing;

  /// Where a use of a file has a node. It stays with the node where that is moved, and what is placed makes new nodes
  /// at addresses of old ones.
  struct Spot {
    const std::string* use;
    toml::source_position begin;
    bool operator<(const Spot& other) const {
      return use != other.use ? std::less<>{}(use, other.use) : begin < other.begin;
    }
  };
  static Spot spot_of(const toml::node& node) { return {node.source().path.get(), node.source().begin}; }

  toml::table document_;
  PartUse own_;  // the scene's own file
  TomlParts files_;
  std::deque<PartUse> uses_;
  std::vector<toml::source_path_ptr> paths_;  // kept, so that each use has an address of its own
  std::set<Spot> negated_;
  std::map<Spot, std::string> moved_;
  std::vector<PartNumber> replacements_;
  std::map<std::string, Given> given_;
};

/// Fails unless it may be the name of a number in this table [numbers] of a file.
void check_number_name(const std::string& name, const TomlTable& numbers);
/// A path of a number as a name in expressions: other characters than letters, digits, underscores and dots are
/// underscores.
std::string name_in_expressions(std::string_view path);

}  // namespace poise
