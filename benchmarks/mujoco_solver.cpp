#include "benchmarks/mujoco_solver.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/LU>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "benchmarks/mujoco_model.hpp"

namespace poise::benchmarks {
namespace {

using Plain = PlainMechanism;

// Units are those of the scaled scene, in which sizes and loads are about 1.
constexpr double massless = 1e-14;        // MuJoCo wants more than 1e-15
constexpr double armature = 0.1;          // of every joint
constexpr double damping = 0.1;           // of every joint
constexpr double far_away = 1e6;          // an end without a stop
constexpr double newton_stiffness = 1e7;  // over the armature's mass
constexpr double newton_damping = 1e3;    // without effect at rest
constexpr double difference = 1e-6;       // rad or sizes, central
constexpr double longest_step = 0.5;      // of Newton, rad or sizes
constexpr int newton_steps = 50;
constexpr double longest_time_step = 0.02;  // of mj_step
constexpr double longest_settling = 5.0;    // s, of the clock
constexpr int steps_between_looks = 1000;   // at the clock

// What closures give per h^2 where a load of 1 acts on that armature.
constexpr double give = (1.0 - stiffest_impedance) / armature;

class MujocoSolver : public PlainSolver {
 public:
  explicit MujocoSolver(const Plain& mechanism) : mechanism_(mechanism), branches_(mechanism.bodies.size()) {
    grow_tree();
    model_ = mujoco_model(text());
    data_ = mj_makeData(model_);
    for (std::size_t body = 1; body < branches_.size(); ++body) {
      branches_[body].index = mj_name2id(model_, mjOBJ_BODY, name(body).c_str());
      branches_[body].q = model_->jnt_qposadr[mj_name2id(model_, mjOBJ_JOINT, joint_name(body).c_str())];
    }
    place_anchors();
    start_.assign(model_->nq, 0.0);
  }
  ~MujocoSolver() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void start_from(const PlainPose& pose) override {
    for (std::size_t body = 1; body < branches_.size(); ++body) {
      const Branch& branch = branches_[body];
      start_[branch.q] = mechanism_.joints[branch.joint].is_slide ? pose.travel[branch.joint]
                                                                  : pose.angle[body] - pose.angle[branch.parent];
    }
  }

  Result solve(int method, double accuracy, int times) override {
    current_ = this;
    mjcb_passive = [](const mjModel*, mjData*) { current_->add_loads(); };
    evaluations_ = 0;
    Result result;
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < times; ++k) result.claimed = method == 0 ? settle(accuracy) : find_by_newton(accuracy);
    result.seconds = seconds_since(begin) / times;
    result.evaluations = evaluations_ / times;
    result.pose = pose();
    return result;
  }

 private:
  using Clock = std::chrono::steady_clock;

  // How a body hangs on the tree. A pin's q is the angle of the body less that of its parent, a slide's its travel.
  struct Branch {
    int parent = -1, joint = -1;
    int q = -1, index = 0;  // places in MuJoCo's coordinates and bodies
  };

  static double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }
  static std::string name(std::size_t body) { return body == 0 ? "world" : fmt::format("b{}", body); }
  static std::string joint_name(std::size_t body) { return fmt::format("q{}", body); }

  // Breadth first from the ground.
  void grow_tree() {
    std::vector<int> reached = {0};
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const int parent = reached[next];
      for (std::size_t j = 0; j < mechanism_.joints.size(); ++j) {
        const Plain::Joint& joint = mechanism_.joints[j];
        if (joint.a.body != parent && joint.b.body != parent) continue;
        const int child = joint.a.body == parent ? joint.b.body : joint.a.body;
        if (child == 0 || branches_[child].parent >= 0) continue;
        if (joint.is_slide && joint.a.body != parent) throw std::invalid_argument("a slide that leads to the ground");
        branches_[child].parent = parent;
        branches_[child].joint = static_cast<int>(j);
        reached.push_back(child);
      }
    }
    if (reached.size() != branches_.size()) throw std::invalid_argument("a body that no joints tie to the ground");
  }

  bool in_tree(std::size_t joint) const {
    return std::any_of(branches_.begin(), branches_.end(),
                       [&](const Branch& branch) { return branch.joint == static_cast<int>(joint); });
  }

  std::string text() const {
    return fmt::format(
        "<mujoco><compiler angle=\"radian\"/>"
        "<option gravity=\"{} {} 0\" tolerance=\"1e-14\"><flag contact=\"disable\"/></option>"
        "<default><joint armature=\"{}\" damping=\"{}\"/></default>"
        "<worldbody>{}</worldbody><equality>{}</equality><tendon>{}{}</tendon></mujoco>",
        mechanism_.gravity.x, mechanism_.gravity.y, armature, damping, inside(0), closures(), springs(), stops());
  }

  // What hangs on a body, and the sites on it.
  std::string inside(int parent) const {
    std::string out;
    for (std::size_t s = 0; s < mechanism_.springs.size(); ++s) {
      for (const auto& [end, place] :
           {std::pair('a', mechanism_.springs[s].a), std::pair('b', mechanism_.springs[s].b)}) {
        if (place.body == parent)
          out += fmt::format("<site name=\"{}{}\" pos=\"{} {} 0\"/>", end, s, place.at.x, place.at.y);
      }
    }
    for (std::size_t child = 1; child < branches_.size(); ++child) {
      if (branches_[child].parent == parent) out += body(static_cast<int>(child));
    }
    return out;
  }

  std::string body(int child) const {
    const Plain::Joint& joint = mechanism_.joints[branches_[child].joint];
    const Plain::Body& mass = mechanism_.bodies[child];
    const bool forwards = joint.b.body == child;
    const Plain::Vector from = forwards ? joint.a.at : joint.b.at, to = forwards ? joint.b.at : joint.a.at;
    const double turn = joint.is_slide ? joint.angle : 0.0, c = std::cos(turn), s = std::sin(turn);
    std::string out = fmt::format("<body name=\"{}\" pos=\"{} {} 0\" euler=\"0 0 {}\">", name(child),
                                  from.x - (c * to.x - s * to.y), from.y - (s * to.x + c * to.y), turn);
    const double inertia = std::max(mass.inertia, massless);
    out += fmt::format("<inertial pos=\"{} {} 0\" mass=\"{}\" diaginertia=\"{} {} {}\"/>", mass.center.x, mass.center.y,
                       std::max(mass.mass, massless), inertia, inertia, inertia);
    if (joint.is_slide) {
      out += fmt::format("<joint name=\"{}\" type=\"slide\" axis=\"{} {} 0\"/>", joint_name(child),
                         std::cos(joint.axis - turn), std::sin(joint.axis - turn));
    } else {
      out += fmt::format("<joint name=\"{}\" type=\"hinge\" axis=\"0 0 1\" pos=\"{} {} 0\"/>", joint_name(child), to.x,
                         to.y);
    }
    return out + inside(child) + "</body>";
  }

  // Their anchors are set later: MuJoCo would take the second one from the pose in which all coordinates are zero.
  std::string closures() const {
    std::string out;
    for (std::size_t j = 0; j < mechanism_.joints.size(); ++j) {
      if (in_tree(j)) continue;
      const Plain::Joint& joint = mechanism_.joints[j];
      if (joint.is_slide) throw std::invalid_argument("a slide that closes a loop");
      out += fmt::format("<connect name=\"{}\" body1=\"{}\" body2=\"{}\" anchor=\"0 0 0\"/>", j, name(joint.a.body),
                         name(joint.b.body));
    }
    return out;
  }

  void place_anchors() {
    for (std::size_t j = 0; j < mechanism_.joints.size(); ++j) {
      const int closure = mj_name2id(model_, mjOBJ_EQUALITY, fmt::format("{}", j).c_str());
      if (closure < 0) continue;
      const Plain::Joint& joint = mechanism_.joints[j];
      mjtNum* anchors = model_->eq_data + static_cast<std::ptrdiff_t>(mjNEQDATA) * closure;
      const std::array<double, 6> both = {joint.a.at.x, joint.a.at.y, 0.0, joint.b.at.x, joint.b.at.y, 0.0};
      std::copy(both.begin(), both.end(), anchors);
    }
  }

  std::string springs() const {
    std::string out;
    for (std::size_t s = 0; s < mechanism_.springs.size(); ++s) {
      const Plain::Spring& spring = mechanism_.springs[s];
      if (!spring.pulls || !spring.pushes) continue;
      out += fmt::format(
          "<spatial stiffness=\"{}\" springlength=\"{}\"><site site=\"a{}\"/><site site=\"b{}\"/></spatial>",
          spring.stiffness, spring.free_length, s, s);
    }
    return out;
  }

  // The angle between two bodies is a sum over the pins between them in the tree.
  std::string stops() const {
    std::string out;
    for (const Plain::Stop& stop : mechanism_.stops) {
      std::vector<double> share(branches_.size(), 0.0);
      double fixed = 0.0;
      for (const auto& [end, sign] : {std::pair(stop.a, -1.0), std::pair(stop.b, 1.0)}) {
        for (int at = end; at != 0; at = branches_[at].parent) {
          const Plain::Joint& joint = mechanism_.joints[branches_[at].joint];
          if (joint.is_slide)
            fixed += sign * joint.angle;
          else
            share[at] += sign;
        }
      }
      out += fmt::format("<fixed limited=\"true\" range=\"{} {}\">", std::max(stop.min - fixed, -far_away),
                         std::min(stop.max - fixed, far_away));
      for (std::size_t at = 1; at < share.size(); ++at) {
        if (share[at] != 0.0) out += fmt::format("<joint joint=\"{}\" coef=\"{}\"/>", joint_name(at), share[at]);
      }
      out += "</fixed>";
    }
    return out;
  }

  // MuJoCo's "solref" of a constraint: stiffness and damping where negative, else time constant and damping ratio.
  struct Spring {
    double first = 0.0, second = 0.0;
  };

  void make_constraints(const Spring& closure, const Spring& stop) {
    const std::array<double, mjNIMP> impedance = {stiffest_impedance, stiffest_impedance, 1e-3, 0.5, 2.0};
    const auto set = [&](const Spring& spring, mjtNum* reference, mjtNum* impedances, int count) {
      for (int k = 0; k < count; ++k) {
        reference[mjNREF * k] = spring.first;
        reference[mjNREF * k + 1] = spring.second;
        std::copy(impedance.begin(), impedance.end(), impedances + static_cast<std::ptrdiff_t>(mjNIMP) * k);
      }
    };
    set(closure, model_->eq_solref, model_->eq_solimp, model_->neq);
    set(stop, model_->tendon_solref_lim, model_->tendon_solimp_lim, model_->ntendon);
  }

  void begin() {
    mj_resetData(model_, data_);
    std::copy(start_.begin(), start_.end(), data_->qpos);
  }

  bool settle(double accuracy) {
    const double step =
        model_->neq == 0 ? longest_time_step : std::clamp(std::sqrt(accuracy / give), 1e-5, longest_time_step);
    model_->opt.timestep = step;
    // An error of closure is gone in one step; a stop that did the same would throw off what is past it.
    make_constraints({-1.0 / (step * step), -1.0 / step}, {2.0 * step, 1.0});
    begin();
    const auto since = Clock::now();
    for (;;) {
      for (int k = 0; k < steps_between_looks; ++k) {
        mj_step(model_, data_);
        if (largest(data_->qvel) < accuracy && largest(data_->qacc) < accuracy) return true;
      }
      if (seconds_since(since) > longest_settling) return false;
    }
  }

  bool find_by_newton(double accuracy) {
    make_constraints({-newton_stiffness, -newton_damping}, {-newton_stiffness, -newton_damping});
    begin();
    const int n = model_->nv;
    Eigen::MatrixXd slope(n, n);
    Eigen::VectorXd acceleration(n);
    const auto accelerate = [&] {
      mj_forward(model_, data_);
      return Eigen::Map<const Eigen::VectorXd>(data_->qacc, n);
    };
    for (int k = 0; k < newton_steps; ++k) {
      acceleration = accelerate();
      for (int i = 0; i < n; ++i) {
        const double at = data_->qpos[i];
        data_->qpos[i] = at + difference;
        slope.col(i) = accelerate();
        data_->qpos[i] = at - difference;
        slope.col(i) -= accelerate();
        data_->qpos[i] = at;
      }
      const Eigen::VectorXd by = (-2.0 * difference) * slope.partialPivLu().solve(acceleration);
      const double longest = by.cwiseAbs().maxCoeff();
      if (!std::isfinite(longest)) return false;
      const double share = std::min(1.0, longest_step / longest);
      for (int i = 0; i < n; ++i) data_->qpos[i] += share * by[i];
      if (longest <= accuracy) return true;
    }
    return false;
  }

  double largest(const mjtNum* values) const {
    double worst = 0.0;
    for (int k = 0; k < model_->nv; ++k) worst = std::max(worst, std::abs(values[k]));
    return worst;
  }

  Plain::Vector at(const Plain::Place& place) const {
    const mjtNum* origin = data_->xpos + std::ptrdiff_t{3} * branches_[place.body].index;
    const mjtNum* axes = data_->xmat + std::ptrdiff_t{9} * branches_[place.body].index;
    return {origin[0] + axes[0] * place.at.x + axes[1] * place.at.y,
            origin[1] + axes[3] * place.at.x + axes[4] * place.at.y};
  }

  void push(int body, const Plain::Vector& force, double torque, const Plain::Vector& point) {
    const std::array<mjtNum, 3> f = {force.x, force.y, 0.0}, t = {0.0, 0.0, torque}, p = {point.x, point.y, 0.0};
    mj_applyFT(model_, data_, f.data(), t.data(), p.data(), branches_[body].index, data_->qfrc_passive);
  }

  void add_loads() {
    ++evaluations_;
    for (const Plain::Force& f : mechanism_.forces) push(f.at.body, f.force, 0.0, at(f.at));
    for (const Plain::Torque& t : mechanism_.torques) push(t.body, {}, t.torque, {});
    for (const Plain::Spring& s : mechanism_.springs) {
      if (s.pulls && s.pushes) continue;
      const Plain::Vector a = at(s.a), b = at(s.b);
      const double length = std::hypot(b.x - a.x, b.y - a.y), by = length - s.free_length;
      if (!(by > 0.0 ? s.pulls : s.pushes)) continue;
      const double pull = s.stiffness * by / length;
      const Plain::Vector force = {pull * (b.x - a.x), pull * (b.y - a.y)};
      push(s.a.body, force, 0.0, a);
      push(s.b.body, {-force.x, -force.y}, 0.0, b);
    }
  }

  PlainPose pose() const {
    PlainPose pose{std::vector<double>(branches_.size()), std::vector<double>(mechanism_.joints.size())};
    for (std::size_t body = 1; body < branches_.size(); ++body) {
      for (int at = static_cast<int>(body); at != 0; at = branches_[at].parent) {
        const Plain::Joint& joint = mechanism_.joints[branches_[at].joint];
        pose.angle[body] += joint.is_slide ? joint.angle : data_->qpos[branches_[at].q];
      }
      const Branch& branch = branches_[body];
      if (mechanism_.joints[branch.joint].is_slide) pose.travel[branch.joint] = data_->qpos[branch.q];
    }
    return pose;
  }

  inline static MujocoSolver* current_ = nullptr;  // whose loads MuJoCo's callback adds

  const Plain mechanism_;
  std::vector<Branch> branches_;
  std::vector<double> start_;
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  long evaluations_ = 0;
};

}  // namespace

std::unique_ptr<PlainSolver> mujoco_solver(const PlainMechanism& mechanism) {
  return std::make_unique<MujocoSolver>(mechanism);
}

}  // namespace poise::benchmarks
