#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/support/seed.hpp"

// Boxes in the plane on inextensible ropes and one-sided stops that share their weights and loads.
namespace poise::app_tests::shared_loads_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using nlohmann::json;

/// A rope between two points, or a stop that keeps the x or y of `a` on one side.
struct Contact {
  std::string name;
  std::string a, b;                  ///< points "body.P"; of a stop a alone
  Vector2d push = Vector2d::Zero();  ///< direction in which a stop pushes; zero of a rope
  bool is_rope() const { return push.isZero(); }
};

struct Boxes {
  std::string text;
  int bodies = 0;
  std::vector<Contact> contacts;
  bool all_share = false;
  bool balances_at_start = false;  ///< its loads are those of a set of contacts that pull and push
};

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : random_(seed) {}

  Boxes make() {
    const int boxes = pick(4) == 0 ? 2 : 1;
    out_.bodies = boxes;
    std::vector<Vector2d> centre;
    std::vector<double> angle;
    std::string bodies, start;
    for (int b = 0; b < boxes; ++b) {
      centre.push_back(b == 0 ? Vector2d(0, 0) : Vector2d(uniform(-0.3, 0.3), -2.5));
      angle.push_back(pick(2) == 0 ? 0.0 : uniform(-0.4, 0.4));
      const double w = round(uniform(0.3, 1.0)), h = round(uniform(0.3, 0.8));
      const std::array<Vector2d, 4> corners = {Vector2d(-w, h), {w, h}, {-w, -h}, {w, -h}};
      bodies += fmt::format("[body.box{}]\npoints = {{ O = [0, 0]", b);
      for (int c = 0; c < 4; ++c) {
        const std::string name = fmt::format("box{}.P{}", b, c);
        place_[name] = centre.back() + turned(corners[c], angle.back());
        bodies += fmt::format(", P{} = [{}, {}]", c, corners[c].x(), corners[c].y());
      }
      place_[fmt::format("box{}.O", b)] = centre.back();
      bodies += " }\n";
      start += fmt::format("box{} = {}\n", b, angle.back());
      if (b > 0) start += fmt::format("position = {{ box{} = [{}, {}] }}\n", b, centre.back().x(), centre.back().y());
    }
    for (int b = 0; b < boxes; ++b) add_contacts(b);
    if (boxes == 2) {
      const int links = 1 + pick(3);
      for (int k = 0; k < links; ++k) {
        const std::string other = corner(1);
        add_rope(corner(0), other);
      }
    }
    std::string loads = add_loads(boxes);
    std::string ground = "[ground]\npoints = { O = [0, 0]";
    for (const auto& [name, at] : place_) {
      if (name.starts_with("ground.")) ground += fmt::format(", {} = [{}, {}]", name.substr(7), at.x(), at.y());
    }
    out_.text = loads.substr(0, loads.find('|')) + ground + " }\n" + bodies + contacts_ +
                loads.substr(loads.find('|') + 1) + "[start]\n" + start;
    return std::move(out_);
  }

 private:
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  static double round(double v) { return std::round(v * 100) / 100; }
  static Vector2d turned(Vector2d v, double by) {
    return {std::cos(by) * v.x() - std::sin(by) * v.y(), std::sin(by) * v.x() + std::cos(by) * v.y()};
  }
  std::string corner(int box) { return fmt::format("box{}.P{}", box, pick(4)); }

  void add_rope(const std::string& a, const std::string& b) {
    const std::string name = fmt::format("r{}", out_.contacts.size());
    contacts_ += fmt::format("[[rope]]\nname = \"{}\"\nover = [\"{}\", \"{}\"]\nlength = {}\n", name, a, b,
                             (place_[a] - place_[b]).norm());
    out_.contacts.push_back({name, a, b});
  }

  void add_rope_to_ground(const std::string& from, double direction) {
    const double length = uniform(0.5, 2.0);
    const std::string to = fmt::format("ground.G{}", out_.contacts.size());
    const bool is_vertical = direction == M_PI / 2;
    place_[to] =
        place_[from] + length * (is_vertical ? Vector2d(0, 1) : Vector2d(std::cos(direction), std::sin(direction)));
    add_rope(to, from);
  }

  // From a random corner.
  void add_rope_to_ground(int box, double direction) { add_rope_to_ground(corner(box), direction); }

  void add_stop(const std::string& at, bool is_x, bool is_max) {
    const std::string name = fmt::format("s{}", out_.contacts.size());
    const double value = is_x ? place_[at].x() : place_[at].y();
    contacts_ += fmt::format("[[stop]]\nname = \"{}\"\n{} = \"{}\"\n{} = {}\n", name, is_x ? "x" : "y", at,
                             is_max ? "max" : "min", value);
    const double sign = is_max ? -1.0 : 1.0;
    out_.contacts.push_back({name, at, "", is_x ? Vector2d(sign, 0) : Vector2d(0, sign)});
  }

  void add_stop(int box, bool is_x, bool is_max) { add_stop(corner(box), is_x, is_max); }

  void add_contacts(int box) {
    switch (pick(5)) {
      case 0: {  // a rope from each corner
        const double spread = uniform(0.2, 1.3);
        const bool even = pick(2) == 0;
        const std::array<double, 4> directions = {M_PI / 2 + spread, M_PI / 2 - spread, -M_PI / 2 - spread,
                                                  -M_PI / 2 + spread};
        for (int c = 0; c < 4; ++c) {
          add_rope_to_ground(fmt::format("box{}.P{}", box, c), directions[c] + (even ? 0.0 : uniform(-0.3, 0.3)));
        }
        break;
      }
      case 1: {  // ropes anywhere
        const int count = 2 + pick(5);
        for (int k = 0; k < count; ++k) add_rope_to_ground(box, uniform(-M_PI, M_PI));
        break;
      }
      case 2: {  // vertical ropes and a floor
        const int ropes = 1 + pick(4), stops = pick(3);
        for (int k = 0; k < ropes; ++k) add_rope_to_ground(box, M_PI / 2);
        for (int k = 0; k < stops; ++k) add_stop(box, false, false);
        if (pick(2) == 0) add_rope_to_ground(box, uniform(-M_PI, 0));
        break;
      }
      case 3: {  // in a pit
        add_stop(fmt::format("box{}.P2", box), false, false);
        add_stop(fmt::format("box{}.P3", box), false, false);
        add_stop(box, true, pick(2) == 0);
        if (pick(2) == 0) add_stop(box, true, pick(2) == 0);
        const int ropes = pick(3);
        for (int k = 0; k < ropes; ++k) add_rope_to_ground(box, uniform(-M_PI, M_PI));
        break;
      }
      default: {  // hung from above, with ropes on both sides
        const int above = 1 + pick(3), others = pick(3);
        for (int k = 0; k < above; ++k) add_rope_to_ground(box, M_PI / 2 + uniform(-0.8, 0.8));
        for (int k = 0; k < others; ++k) add_rope_to_ground(box, pick(2) == 0 ? 0.0 : M_PI);
        break;
      }
    }
  }

  // Weights, or loads that a set of contacts carries; the keys before the tables and after them, parted by a bar.
  std::string add_loads(int boxes);

  std::mt19937_64 random_;
  Boxes out_;
  std::map<std::string, Vector2d> place_;
  std::string contacts_;
};

/// Columns: force and moment about the origin on each box of a unit push of each contact.
MatrixXd pushes(const Boxes& boxes, const std::map<std::string, Vector2d>& place) {
  MatrixXd out = MatrixXd::Zero(3 * boxes.bodies, static_cast<Index>(boxes.contacts.size()));
  const auto add = [&](Index column, const std::string& point, const Vector2d& force) {
    if (point.starts_with("ground")) return;
    const Index row = 3 * (point[3] - '0');
    const Vector2d at = place.at(point);
    out.col(column).segment(row, 2) += force;
    out(row + 2, column) += at.x() * force.y() - at.y() * force.x();
  };
  for (std::size_t k = 0; k < boxes.contacts.size(); ++k) {
    const Contact& c = boxes.contacts[k];
    const auto column = static_cast<Index>(k);
    if (!c.is_rope()) {
      add(column, c.a, c.push);
      continue;
    }
    const Vector2d d = (place.at(c.b) - place.at(c.a)).normalized();
    add(column, c.a, d);
    add(column, c.b, -d);
  }
  return out;
}

std::string Generator::add_loads(int boxes) {
  VectorXd load = VectorXd::Zero(3 * boxes);
  const int kind = pick(3);
  std::string before, after;
  if (kind == 0) {
    before = "gravity = [0, -9.81]\n";
    for (int b = 0; b < boxes; ++b) {
      after += fmt::format("[[force]]\nname = \"w{0}\"\nat = \"box{0}.C\"\nvector = [0, {1}]\n", b, -uniform(5, 50));
    }
    before.clear();
    for (int b = 0; b < boxes; ++b) {
      // Loads at the centre.
      const std::size_t at = after.find(fmt::format("box{}.C", b));
      after.replace(at, 6, fmt::format("box{}.O", b));
    }
    return before + "|" + after;
  }
  out_.balances_at_start = true;
  out_.all_share = kind == 1;
  const MatrixXd a = pushes(out_, place_);
  for (Index k = 0; k < a.cols(); ++k) {
    if (pick(kind == 1 ? 1 : 3) == 0) load -= uniform(1, 20) * a.col(k);
  }
  for (int b = 0; b < boxes; ++b) {
    const Vector2d at = place_[fmt::format("box{}.O", b)], force = load.segment(3 * b, 2);
    const double moment = load[3 * b + 2] - (at.x() * force.y() - at.y() * force.x());
    after +=
        fmt::format("[[force]]\nname = \"f{0}\"\nat = \"box{0}.O\"\nvector = [{1}, {2}]\n", b, force.x(), force.y());
    after += fmt::format("[[torque]]\nname = \"t{0}\"\non = \"box{0}\"\nvalue = {1}\n", b, moment);
  }
  return before + "|" + after;
}

/// x >= 0 of A x = b, of at most as many positive entries as there are rows, by trying all sets; within `within` of
/// the size of b and x, and x at most 1e4 times b: larger ones hide a b that they do not balance.
std::optional<VectorXd> sign_feasible(const MatrixXd& a, const VectorXd& b, double within) {
  const Index n = a.cols();
  std::optional<VectorXd> out;
  for (unsigned set = 0; set < 1U << n; ++set) {
    if (__builtin_popcount(set) > a.rows()) continue;
    std::vector<Index> columns;
    for (Index k = 0; k < n; ++k) {
      if ((set >> k & 1U) != 0 && !a.col(k).isZero(0.0)) columns.push_back(k);
    }
    MatrixXd part(a.rows(), static_cast<Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) part.col(static_cast<Index>(k)) = a.col(columns[k]);
    const VectorXd x = columns.empty() ? VectorXd() : VectorXd(part.colPivHouseholderQr().solve(b));
    if (!x.allFinite()) continue;
    const double size = std::max(b.norm(), x.size() > 0 ? x.norm() : 0.0);
    if (x.size() > 0 && (x.minCoeff() < -within * size || x.norm() > 1e4 * b.norm())) continue;
    const VectorXd left = columns.empty() ? b : VectorXd(part * x - b);
    if (left.norm() > within * size) continue;
    out = VectorXd::Zero(n);
    for (std::size_t k = 0; k < columns.size(); ++k) (*out)[columns[k]] = x[static_cast<Index>(k)];
    return out;
  }
  return out;
}

/// What the printed result says: places of points, and forces from its list `forces_on_bodies`.
struct Printed {
  std::map<std::string, Vector2d> place;
  VectorXd load;   ///< force and moment about the origin of the loads on each box
  VectorXd force;  ///< with which each contact pushes or pulls; negative where it does what it cannot
};

Printed printed(const Boxes& boxes, const json& found) {
  Printed out;
  for (const auto& [name, at] : found["points"].items()) out.place[name] = Vector2d(at[0], at[1]);
  out.load = VectorXd::Zero(3 * boxes.bodies);
  out.force = VectorXd::Zero(static_cast<Index>(boxes.contacts.size()));
  for (const json& row : found["forces_on_bodies"]) {
    const std::string kind = row["kind"], body = row["body"];
    if (body == "ground") continue;
    const Vector2d force(row["force"][0], row["force"][1]), at(row["at"][0], row["at"][1]);
    if (kind == "force" || kind == "torque") {
      const Index first = 3 * (body[3] - '0');
      out.load.segment(first, 2) += force;
      out.load[first + 2] += row["moment"].get<double>() + at.x() * force.y() - at.y() * force.x();
    }
    for (std::size_t k = 0; k < boxes.contacts.size(); ++k) {
      const Contact& c = boxes.contacts[k];
      if (row["name"] != c.name) continue;
      Vector2d direction = c.push;
      if (c.is_rope()) {
        direction = (out.place[c.b] - out.place[c.a]).normalized();
        if (!c.a.starts_with(body + ".")) direction = -direction;
      }
      out.force[static_cast<Index>(k)] = force.dot(direction);
    }
  }
  return out;
}

/// Whether forces >= 0 of A f = b are those of least norm: with l of f_k = a_k.l where f_k > 0, no other would grow.
bool is_least(const MatrixXd& a, const VectorXd& f) {
  const double size = f.norm();
  std::vector<Index> carrying;
  for (Index k = 0; k < f.size(); ++k) {
    if (f[k] > 1e-9 * size) carrying.push_back(k);
  }
  if (carrying.empty()) return true;
  MatrixXd part(a.rows(), static_cast<Index>(carrying.size()));
  VectorXd of(part.cols());
  for (std::size_t k = 0; k < carrying.size(); ++k) {
    part.col(static_cast<Index>(k)) = a.col(carrying[k]);
    of[static_cast<Index>(k)] = f[carrying[k]];
  }
  const VectorXd l = part.transpose().completeOrthogonalDecomposition().solve(of);
  return (part.transpose() * l - of).norm() <= 1e-6 * size;
}

json result_of(const TempFolder& folder, const std::string& text, const std::string& seek) {
  const std::string file = folder.path("result.json").string();
  std::filesystem::remove(file);
  run_poise({"solve", folder.write("scene.toml", text), "--seek", seek, "--json", file});
  return std::filesystem::exists(file) ? json::parse(contents(file)) : json();
}

/// How many undetermined stops are said to be possibly idle, to be needed, and neither.
struct Told {
  int idle = 0, needed = 0, open = 0;
  int without_radius = 0;
};

/// Expects that what is printed of a confirmed equilibrium is true: contacts push or pull as they can, all boxes
/// balance, and of undetermined forces the set is that of least norm.
void expect_true(const Boxes& boxes, const json& found, Told& told) {
  const Printed p = printed(boxes, found);
  const MatrixXd a = pushes(boxes, p.place);
  const double size = std::max(p.load.norm(), p.force.norm());
  EXPECT_GE(p.force.minCoeff(), -1e-9 * size);
  EXPECT_LE((a * p.force + p.load).norm(), 1e-7 * size);
  EXPECT_TRUE(sign_feasible(a, -p.load, 1e-7).has_value());
  std::vector<Index> acting;
  for (const json& row : found["reactions"]) {
    const auto of = std::find_if(boxes.contacts.begin(), boxes.contacts.end(),
                                 [&](const Contact& c) { return row["name"] == c.name; });
    ASSERT_NE(of, boxes.contacts.end());
    acting.push_back(of - boxes.contacts.begin());
    // One that carries nothing has its place too.
    const Vector2d at(row["at"][0], row["at"][1]);
    const double from_b = of->is_rope() ? (at - p.place.at(of->b)).norm() : 1.0;
    EXPECT_LE(std::min((at - p.place.at(of->a)).norm(), from_b), 1e-9) << of->name;
  }
  bool any_undetermined = false;
  for (std::size_t r = 0; r < acting.size(); ++r) {
    const json& row = found["reactions"][r];
    if (row["determined"]) continue;
    any_undetermined = true;
    told.without_radius += row["radius"].is_null();
    // It may be slack only if the others that act can carry everything.
    MatrixXd others = MatrixXd::Zero(a.rows(), a.cols());
    for (const Index k : acting) {
      if (k != acting[r]) others.col(k) = a.col(k);
    }
    const json& idle = row["may_be_idle"];
    EXPECT_TRUE(idle != true || sign_feasible(others, -p.load, 1e-6).has_value()) << row["name"];
    EXPECT_TRUE(idle != false || !sign_feasible(others, -p.load, 1e-9).has_value()) << row["name"];
    told.idle += idle == true;
    told.needed += idle == false;
    told.open += idle.is_null();
  }
  EXPECT_TRUE(!any_undetermined || is_least(a, p.force));
}

TEST(SharedLoads, RandomBoxesOnRopesAndStops) {
  const TempFolder folder;
  const int wanted = test::cases(40, 500);
  int confirmed = 0, shared = 0, found_shared = 0, asked = 0;
  Told told;
  for (int k = 0; k < wanted; ++k) {
    const std::uint64_t seed = test::seed(1) + static_cast<std::uint64_t>(k);
    const Boxes boxes = Generator(seed).make();
    for (const char* seek : {"any", "settle"}) {
      SCOPED_TRACE(fmt::format("seed {}, --seek {}", seed, seek));
      const json found = result_of(folder, boxes.text, seek);
      ASSERT_FALSE(found.is_null());
      const bool is_confirmed = found["status"] == "confirmed";
      if (is_confirmed) expect_true(boxes, found, told);
      ++asked;
      confirmed += is_confirmed;
      shared += boxes.all_share;
      found_shared += boxes.all_share && is_confirmed;
    }
  }
  // Where every contact carries a part of the load at the start.
  EXPECT_GE(found_shared, shared * 98 / 100);
  EXPECT_GE(confirmed, asked * 92 / 100);
  const int undetermined = told.idle + told.needed + told.open;
  EXPECT_LE(told.open, undetermined / 10);
  // Some of the sets in which some carry exactly nothing, as the loads are made, have none.
  EXPECT_LE(told.without_radius, undetermined / 5);
  std::cout << fmt::format("{} of {} confirmed, {} of {} whose contacts all carry at the start\n", confirmed, asked,
                           found_shared, shared)
            << fmt::format("{} stops possibly idle, {} needed, {} open, {} without radius\n", told.idle, told.needed,
                           told.open, told.without_radius);
}

constexpr const char* box_on_four_ropes = R"(
gravity = [0, -9.81]
[ground]
points = { A = [-1.5, 2], B = [1.5, 2], C = [-1.5, -2], D = [1.5, -2] }
[body.box]
points = { P = [-0.5, 0.5], Q = [0.5, 0.5], R = [-0.5, -0.5], S = [0.5, -0.5] }
mass = 10
center = [0.1, 0]
[[rope]]
name = "a"
over = ["ground.A", "box.P"]
length = 1.8027756377319946
[[rope]]
name = "b"
over = ["ground.B", "box.Q"]
length = 1.8027756377319946
[[rope]]
name = "c"
over = ["ground.C", "box.R"]
length = 1.8027756377319946
[[rope]]
name = "d"
over = ["ground.D", "box.S"]
length = 1.8027756377319946
)";

// Of the sets t of self-stress, tensions (-32.7, 52.32, -19.62, 0) and so on along x, the least has d slack: with the
// tensions of a, b and c in the directions (-1, 1.5), (1, 1.5) and (-1, -1.5) of the ropes, forces and moments give
// those along x.
TEST(SharedLoads, RopesOfABoxPullOnly) {
  const TempFolder folder;
  const std::string file = folder.path("result.json").string();
  const app_tests::ProgramRun ran = run_poise({"solve", folder.write("scene.toml", box_on_four_ropes), "--json", file});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_NE(ran.out.find("undetermined, slack possible"), std::string::npos) << ran.out;
  const json found = json::parse(contents(file));
  const std::map<std::string, double> along_x = {{"a", -32.7}, {"b", 52.32}, {"c", -19.62}, {"d", 0.0}};
  ASSERT_EQ(found["reactions"].size(), 4U);
  for (const json& row : found["reactions"]) {
    EXPECT_GE(row["axial"].get<double>(), 0.0);
    EXPECT_NEAR(row["force"][0].get<double>(), along_x.at(row["name"]), 1e-9);
    // Without a, b or c the others cannot hold it.
    EXPECT_EQ(row["may_be_idle"].get<bool>(), row["name"] == "d");
  }
}

// Its start above the ropes is no equilibrium, for both would have to push: it comes to hang on them.
TEST(SharedLoads, BoxAboveItsRopesComesToHangOnThem) {
  const TempFolder folder;
  const std::string scene = folder.write("scene.toml", R"(
gravity = [0, -10]
[ground]
points = { A = [-1, -2], B = [1, -2] }
[body.box]
points = { P = [-0.6, -1], Q = [1.4, -1] }
mass = 1
[[rope]]
name = "left"
over = ["ground.A", "box.P"]
length = 1.1
[[rope]]
name = "right"
over = ["ground.B", "box.Q"]
length = 1.1
)");
  for (const char* seek : {"any", "settle", "stable"}) {
    SCOPED_TRACE(seek);
    const std::string file = folder.path("result.json").string();
    run_poise({"solve", scene, "--seek", seek, "--json", file});
    const json found = json::parse(contents(file));
    EXPECT_EQ(found["status"], "confirmed") << found["why"];
    for (const json& row : found["reactions"]) EXPECT_GT(row["axial"].get<double>(), 0.0);
    EXPECT_LT(found["points"]["box.P"][1].get<double>(), -2.0);
  }
}

// Two ropes that are vertical one above the other allow the same motions at the start. When the box turns, only one of
// them can hold it, and hangs vertical over the box's middle in the end.
TEST(SharedLoads, RopesThatPartOnTheWayLeaveOneTaut) {
  const TempFolder folder;
  const auto scene = [](const char* first, const char* second) {
    return fmt::format(R"(
[ground]
points = {{ U = [-0.75, 2], V = [-0.75, 1] }}
[body.box]
points = {{ O = [0, 0], P = [-0.75, 0.75], R = [-0.75, -0.75] }}
[[rope]]
name = "{0}"
over = ["ground.{0}", "box.{1}"]
length = {2}
[[rope]]
name = "{3}"
over = ["ground.{3}", "box.{4}"]
length = {5}
[[force]]
at = "box.O"
vector = [0, -10]
)",
                       first, *first == 'U' ? "P" : "R", *first == 'U' ? 1.25 : 1.75, second,
                       *second == 'U' ? "P" : "R", *second == 'U' ? 1.25 : 1.75);
  };
  for (const std::string& text : {scene("U", "V"), scene("V", "U")}) {
    const json found = result_of(folder, text, "settle");
    ASSERT_FALSE(found.is_null());
    EXPECT_EQ(found["status"], "confirmed") << found["why"];
    EXPECT_NEAR(found["points"]["box.O"][0].get<double>(), -0.75, 1e-9);
  }
}

// Two collinear ropes that pull against each other leave no direction to the first order in which the box could move,
// and yet it moves: beside the start it comes to hang.
TEST(SharedLoads, RopesThatPullAgainstEachOtherLetGo) {
  const TempFolder folder;
  const std::string text = Generator(187).make().text;
  for (const char* seek : {"any", "settle", "stable"}) {
    SCOPED_TRACE(seek);
    const json found = result_of(folder, text, seek);
    ASSERT_FALSE(found.is_null());
    EXPECT_EQ(found["status"], "confirmed") << found["why"];
  }
}

// The load passes through the lower left corner of a box that touches two floors, a wall and two ropes: all but the
// first floor carry nothing but what rounding makes, and yet only some of them can hold the box.
TEST(SharedLoads, BoxOnOneOfManyContactsIsProved) {
  const TempFolder folder;
  const json found = result_of(folder, R"(
[ground]
points = { G3 = [0.04895867173314494, -1.4055452476154735], G4 = [-1.153016760837207, 0.5274181863569066] }
[body.box]
points = { O = [0, 0], P0 = [-0.58, 0.73], P1 = [0.58, 0.73], P2 = [-0.58, -0.73], P3 = [0.58, -0.73] }
[[stop]]
name = "left floor"
y = "box.P2"
min = -0.73
[[stop]]
name = "right floor"
y = "box.P3"
min = -0.73
[[stop]]
name = "wall"
x = "box.P1"
min = 0.58
[[rope]]
name = "lower rope"
over = ["ground.G3", "box.P2"]
length = 0.9230115884018864
[[rope]]
name = "upper rope"
over = ["ground.G4", "box.P1"]
length = 1.7448170346949305
[[force]]
at = "box.O"
vector = [0, -7.267445114627181]
[[torque]]
on = "box"
value = 4.215118166483765
)",
                               "any");
  ASSERT_FALSE(found.is_null());
  EXPECT_EQ(found["status"], "confirmed") << found["why"];
  for (const json& row : found["reactions"]) {
    EXPECT_NEAR(row["force"][1].get<double>(), row["name"] == "left floor" ? 7.267445114627181 : 0.0, 1e-12);
    EXPECT_NEAR(row["force"][0].get<double>(), 0.0, 1e-12);
  }
}

// A stop that shares a load and carries nothing is shown where it touches.
TEST(SharedLoads, RopeWithoutForceHasItsPlace) {
  const TempFolder folder;
  const std::string file = folder.path("result.json").string();
  const std::string scene = folder.write("scene.toml", box_on_four_ropes);
  const app_tests::ProgramRun ran =
      run_poise({"solve", scene, "--method", "energy", "--seek", "stable", "--json", file});
  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  int shown = 0;
  const json found = json::parse(contents(file));
  for (const json& row : found["reactions"]) {
    if (row["name"] != "d") continue;
    ++shown;
    EXPECT_NEAR(row["at"][0].get<double>(), 0.5, 1e-9);
    EXPECT_NEAR(row["at"][1].get<double>(), -0.5, 1e-9);
    EXPECT_EQ(row["force"], json({0.0, 0.0}));
  }
  EXPECT_EQ(shown, 1);
}

}  // namespace
}  // namespace poise::app_tests::shared_loads_test
