// MuJoCo as a judge of MJCF: what it makes of files that Poise has written, and what Poise makes of files that MuJoCo
// reads, released at rest or in motion.

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "comparison/random.hpp"
#include "exchange/mjcf.hpp"
#include "model/scene.hpp"
#include "tests/exchange/robots.hpp"
#include "tests/support/seed.hpp"

namespace poise::mujoco_test {
namespace {

using comparison::Random;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class Mujoco {
 public:
  explicit Mujoco(const std::string& text) {
    mju_user_warning = [](const char*) {};  // else they go to a file in the directory at hand
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
    std::array<char, 500> error{};
    model_ = mj_loadXML("scene.xml", files.get(), error.data(), static_cast<int>(error.size()));
    mj_deleteVFS(files.get());
    if (model_ == nullptr) throw std::runtime_error(error.data());
    model_->opt.jacobian = mjJAC_DENSE;
    data_ = mj_makeData(model_);
  }
  ~Mujoco() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;

  int freedoms() const { return model_->nv; }
  void set_rates(const VectorXd& rates) { Eigen::Map<VectorXd>(data_->qvel, model_->nv) = rates; }

  /// Angular velocity of a body in the world by the rates of the joints.
  MatrixXd turning_by(const std::string& body) {
    mj_forward(model_, data_);
    RowMajor moving = RowMajor::Zero(3, model_->nv), turning = RowMajor::Zero(3, model_->nv);
    const int id = mj_name2id(model_, mjOBJ_BODY, body.c_str());
    if (id < 0) throw std::runtime_error("no body " + body);
    mj_jacBody(model_, data_, moving.data(), turning.data(), id);
    return turning;
  }
  MatrixXd moving_by(const std::string& body) {
    mj_forward(model_, data_);
    RowMajor moving = RowMajor::Zero(3, model_->nv);
    mj_jacBody(model_, data_, moving.data(), nullptr, mj_name2id(model_, mjOBJ_BODY, body.c_str()));
    return moving;
  }

  /// Accelerations of the joints with rigid equalities: M a + J^T l = f, J a = 0. At rest, or with equalities of joints
  /// only, whose J is constant.
  VectorXd accelerations() {
    mj_forward(model_, data_);
    const int n = model_->nv;
    RowMajor mass(n, n);
    mj_fullM(model_, mass.data(), data_->qM);
    std::vector<int> rows;
    for (int k = 0; k < data_->nefc; ++k) {
      if (data_->efc_type[k] == mjCNSTR_EQUALITY) rows.push_back(k);
    }
    const int m = static_cast<int>(rows.size());
    MatrixXd system = MatrixXd::Zero(n + m, n + m);
    system.topLeftCorner(n, n) = mass;
    for (int k = 0; k < m; ++k) {
      const Eigen::Map<const VectorXd> row(
          data_->efc_J + static_cast<std::ptrdiff_t>(rows[static_cast<std::size_t>(k)]) * n, n);
      system.row(n + k).head(n) = row.transpose();
      system.col(n + k).head(n) = row;
    }
    VectorXd right = VectorXd::Zero(n + m);
    right.head(n) = Eigen::Map<const VectorXd>(data_->qfrc_smooth, n);
    // Rows across the plane, and those that repeat others to the rounding of the pose, count as repeating.
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> factors;
    factors.setThreshold(1e-9);
    factors.compute(system);
    return factors.solve(right).head(n);
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

const Vector3d normal(0.0, -1.0, 0.0);  // counter-clockwise of a scene in its file

TEST(MujocoAsJudge, ScenesMoveAsInPoise) {
  for (int k = 0; k < test::cases(60, 600); ++k) {
    const Scene scene =
        test::random_robot(test::seed(700 + static_cast<std::uint64_t>(k)),
                           {.loops = k % 3, .lines = k % 2 == 0, .free_body = k % 5 == 0, .friction = false});
    const std::string text = export_mjcf(scene, test::poses_at_start(scene)).text;
    Mujoco mujoco(text);
    const std::vector<BodyMotion> expected = test::released(scene);
    const VectorXd a = mujoco.accelerations();
    double size = 1.0;
    for (const BodyMotion& one : expected) size = std::max(size, std::abs(one.angular_acceleration));
    for (std::size_t body = 1; body < scene.bodies.size(); ++body) {
      const std::string& name = scene.bodies[body].name;
      EXPECT_NEAR(normal.dot(mujoco.turning_by(name) * a), expected[body].angular_acceleration, 1e-8 * size)
          << scene.title << ' ' << name << '\n'
          << text;
      const Vector3d linear = mujoco.moving_by(name) * a;
      EXPECT_NEAR(linear.x(), expected[body].acceleration.x, 1e-8 * size * 10) << name << text;
      EXPECT_NEAR(linear.z(), expected[body].acceleration.y, 1e-8 * size * 10) << name << text;
      EXPECT_NEAR(linear.y(), 0.0, 1e-8 * size);
    }
    if (HasFailure()) return;
  }
}

// A random turn, as MuJoCo's words for it and as a matrix.
Eigen::Quaterniond random_turn(Random& random) {
  Eigen::Vector4d q;
  for (int k = 0; k < 4; ++k) q[k] = random.uniform(-1.0, 1.0);
  q.normalize();
  return {q[0], q[1], q[2], q[3]};
}

std::string numbers(const Vector3d& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); }

// A chain of bodies that turn about one normal and slide across it, in a plane that stands anywhere, of solids of all
// kinds in any places.
class ChainMaker {
 public:
  explicit ChainMaker(std::uint64_t seed) : random_(seed) {}

  std::string make() {
    const std::array<std::string, 5> orders = {"xyz", "XYZ", "zyx", "xYz", "ZXz"};
    const std::string order = orders[static_cast<std::size_t>(random_.index(orders.size()))];
    const Eigen::Quaterniond base = random_turn(random_);
    normal_ = base * Vector3d::UnitZ();
    count_ = 2 + random_.index(3);
    const std::string inside = body(0, base);
    std::string out = fmt::format(
        "<mujoco><compiler angle=\"degree\" eulerseq=\"{}\"/><option gravity=\"{}\"/><default><geom density=\"700\"/>"
        "<default class=\"soft\"><joint damping=\"0.4\" stiffness=\"3\"/></default></default><worldbody>"
        "<body name=\"base\" quat=\"{} {} {} {}\">{}</body></worldbody>",
        order, numbers(vector(8.0)), base.w(), base.x(), base.y(), base.z(), inside);
    if (count_ > 2 && random_.chance(0.6)) {
      out +=
          fmt::format("<equality><connect body1=\"b{}\" anchor=\"{}\"/></equality>", count_ - 1, numbers(vector(0.4)));
    }
    if (is_like_the_first_ && random_.chance(0.7)) {
      out += fmt::format(
          "<tendon><fixed name=\"t\" stiffness=\"5\" springlength=\"0.3\" damping=\"0.1\"><joint joint=\"j0\" "
          "coef=\"1.5\"/><joint joint=\"j1\" coef=\"-0.7\"/></fixed></tendon>");
    }
    return out + "</mujoco>";
  }

 private:
  Vector3d vector(double size) {
    return {random_.uniform(-size, size), random_.uniform(-size, size), random_.uniform(-size, size)};
  }

  // The first of two texts is drawn first, whatever the compiler does with arguments.
  template <class First, class Second>
  static std::string in_order(First first, Second second) {
    const std::string begin = first();
    return begin + " " + second();
  }
  std::string two_vectors(double size) {
    return in_order([&] { return numbers(vector(size)); }, [&] { return numbers(vector(size)); });
  }

  std::string turn() {
    switch (random_.index(5)) {
      case 0:
        return fmt::format("euler=\"{}\"", numbers(vector(180.0)));
      case 1:
        return fmt::format("axisangle=\"{}\"",
                           in_order([&] { return numbers(vector(1.0)); },
                                    [&] { return fmt::format("{}", random_.uniform(-180.0, 180.0)); }));
      case 2:
        return fmt::format("xyaxes=\"{}\"", two_vectors(1.0));
      case 3:
        return fmt::format("zaxis=\"{}\"", numbers(vector(1.0)));
      default: {
        const Eigen::Quaterniond q = random_turn(random_);
        return fmt::format("quat=\"{} {} {} {}\"", 2 * q.w(), 2 * q.x(), 2 * q.y(), 2 * q.z());
      }
    }
  }

  std::string geom() {
    const double r = random_.uniform(0.05, 0.2), h = random_.uniform(0.1, 0.4);
    const std::string at = numbers(vector(0.4));
    const std::string place = fmt::format(" pos=\"{}\" {}/>", at, turn());
    const std::string ends = fmt::format(" fromto=\"{}\"/>", two_vectors(0.4));
    switch (random_.index(8)) {
      case 0:
        return fmt::format("<geom size=\"{}\"", r) + place;
      case 1:
        return fmt::format("<geom type=\"capsule\" size=\"{} {}\"", r, h) + place;
      case 2:
        return fmt::format("<geom type=\"capsule\" size=\"{}\" mass=\"1.5\"", r) + ends;
      case 3:
        return fmt::format("<geom type=\"cylinder\" size=\"{} {}\"", r, h) + place;
      case 4:
        return fmt::format("<geom type=\"box\" size=\"{} {} {}\"", r, h, 0.7 * r) + place;
      case 5:
        return fmt::format("<geom type=\"ellipsoid\" size=\"{} {} {}\"", r, h, 0.7 * r) + place;
      case 6:
        return fmt::format("<geom type=\"box\" size=\"{}\"", r) + ends;
      default:
        return fmt::format("<geom type=\"ellipsoid\" size=\"{}\"", r) + ends;
    }
  }

  // `world` is the turn of its parent.
  std::string body(int k, const Eigen::Quaterniond& world) {
    if (k == count_) return "";
    const Eigen::Quaterniond own = random_turn(random_), turned = world * own;
    std::string out = fmt::format("<body name=\"b{}\" pos=\"{}\" quat=\"{} {} {} {}\">", k, numbers(vector(0.6)),
                                  own.w(), own.x(), own.y(), own.z());
    const Vector3d axis = turned.conjugate() * normal_;
    const auto slide = [&](const std::string& name) {
      const Vector3d along = turned.conjugate() * normal_.cross(vector(1.0));
      return fmt::format("<joint name=\"{}\" type=\"slide\" axis=\"{}\" ref=\"{}\" stiffness=\"9\" springref=\"0.2\"/>",
                         name, numbers(along), random_.uniform(-0.4, 0.4));
    };
    const auto hinge = [&](const std::string& name) {
      const char* const soft = random_.chance(0.5) ? " class=\"soft\"" : "";
      const double along = random_.chance(0.5) ? 2.0 : -1.0;
      const std::string at = numbers(vector(0.3));
      return fmt::format("<joint name=\"{}\"{} axis=\"{}\" pos=\"{}\" ref=\"{}\" springref=\"-20\"/>", name, soft,
                         numbers(along * axis), at, random_.uniform(-40.0, 40.0));
    };
    const std::string name = fmt::format("j{}", k);
    const double kind = random_.uniform(0.0, 1.0);
    const bool turns = kind < 0.6 || (kind > 0.85 && kind < 0.95);
    if (k == 0) first_turns_ = turns;
    if (k == 1) is_like_the_first_ = turns == first_turns_;
    if (kind < 0.6)
      out += hinge(name);
    else if (kind < 0.75)
      out += slide(name);
    else if (kind < 0.85)
      out += in_order([&] { return slide(name); }, [&] { return hinge(name + "h"); });
    else if (kind < 0.95)
      out += in_order([&] { return hinge(name); }, [&] { return slide(name + "s"); });
    else
      out += in_order([&] { return in_order([&] { return slide(name); }, [&] { return slide(name + "s"); }); },
                      [&] { return hinge(name + "h"); });
    if (random_.chance(0.3)) {
      const std::string at = numbers(vector(0.3));
      out += fmt::format("<inertial pos=\"{}\" {} mass=\"2\" diaginertia=\"0.2 0.3 0.4\"/>", at, turn());
    } else {
      out += in_order([&] { return geom(); }, [&] { return random_.chance(0.5) ? geom() : ""; });
    }
    return out + body(k + 1, turned) + "</body>";
  }

  Random random_;
  Vector3d normal_ = Vector3d::UnitZ();
  int count_ = 0;
  bool first_turns_ = false, is_like_the_first_ = false;
};

// MuJoCo turns the inertia of each body to its principal axes, which it finds to some 1e-8.
TEST(MujocoAsJudge, FilesMoveAsInMujoco) {
  for (int k = 0; k < test::cases(80, 800); ++k) {
    const std::string text = ChainMaker(test::seed(900 + static_cast<std::uint64_t>(k))).make();
    Mujoco mujoco(text);
    const VectorXd a = mujoco.accelerations();
    const Scene scene = parse_scene(import_mjcf(text, "m.xml", {}).text, "m");
    const std::vector<BodyMotion> found = test::released(scene);
    // The scene may look at the plane from either side.
    double size = 1.0;
    Vector3d axis = Vector3d::Zero();
    for (std::size_t body = 1; body < scene.bodies.size(); ++body) {
      if (scene.bodies[body].name.ends_with("carrier")) continue;
      const Vector3d turning = mujoco.turning_by(scene.bodies[body].name) * a;
      const double angular = found[body].angular_acceleration;
      size = std::max(size, std::abs(angular));
      if (axis.isZero() && turning.norm() > 1e-3) {
        const Vector3d seen = turning / angular;  // the normal of the scene
        EXPECT_NEAR(turning.norm(), std::abs(angular), 1e-6 * size) << text;
        axis = seen.normalized();
      }
      EXPECT_NEAR(axis.dot(turning), angular, 1e-6 * size) << scene.bodies[body].name << '\n' << text;
      const Vector3d linear = mujoco.moving_by(scene.bodies[body].name) * a;
      EXPECT_NEAR(linear.norm(), norm(found[body].acceleration), 1e-6 * size) << text;
    }
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace poise::mujoco_test
