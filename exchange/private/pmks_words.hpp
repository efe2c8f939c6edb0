#pragma once

// How PMKS+ writes numbers into an address: whole numbers with 64 digits, of which a leading zero says that it is
// negative; a number with decimals is 1000 times as large, rounded; flags are the bits of a whole number, six of them
// in each digit.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace poise {

struct PmksJoint {
  bool slides = false, is_input = false, is_grounded = false, is_welded = false;
  std::string id, name;
  double x = 0.0, y = 0.0, angle = 0.0;  ///< rad
  std::string carrier{}, from{}, to{};   ///< of a slot in a link that moves: that link and two joints along it
};

struct PmksLink {
  bool is_root = true;    ///< others are parts that are welded into one
  bool is_block = false;  ///< of a slider
  std::string id, name;
  double mass = 0.0, inertia = 0.0, x = 0.0, y = 0.0;  ///< of and at the centre of mass
  std::vector<std::string> joints, parts;
};

struct PmksForce {
  bool is_local = false, is_outward = true;
  std::string id, link, name;
  double x = 0.0, y = 0.0, to_x = 0.0, to_y = 0.0, size = 0.0;
};

/// What an address has, as numbers of its own units.
struct PmksMechanism {
  enum class Length { inch, cm, m };
  Length length = Length::cm;
  bool is_clockwise = false, has_gravity = false;
  std::int64_t speed = 0;  ///< of inputs, turns a minute
  std::vector<PmksJoint> joints;
  std::vector<PmksLink> links;
  std::vector<PmksForce> forces;
};

/// What stands behind the question mark of an address. Throws InputError naming `file`.
PmksMechanism read_pmks_query(std::string_view query, const std::string& file);
std::string pmks_query(const PmksMechanism& mechanism);

}  // namespace poise
