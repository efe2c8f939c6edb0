#include "motion/motion_record.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/nearest_name.hpp"
#include "motion/body_motion.hpp"
#include "motion/states_along.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

/// Kinetic and potential energy of states of a model.
class Energies {
 public:
  explicit Energies(const MotionModel& model)
      : model_(model),
        n_(static_cast<std::size_t>(model.mechanism().coordinates())),
        pose_(static_cast<std::size_t>(model.mechanism().pose_size())),
        mass_(n_ * n_) {}

  void add(const std::vector<double>& q, const std::vector<double>& v, MotionRecord& record) {
    const std::vector<double> x = model_.from_si(q);
    const std::vector<double> w = model_.from_si(v);
    model_.mechanism().place(x.data(), pose_.data());
    model_.inertia().mass_matrix(pose_.data(), mass_.data());
    double twice = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      twice += w[i] * std::inner_product(w.begin(), w.end(), &mass_[i * n_], 0.0);
    }
    record.kinetic.push_back(model_.scales().energy() * twice / 2);
    record.potential.push_back(model_.scales().energy() * model_.mechanism().energy(x.data(), pose_.data()));
  }

 private:
  const MotionModel& model_;
  std::size_t n_;
  std::vector<Planar<double>> pose_;
  std::vector<double> mass_;
};

}  // namespace

std::vector<Channel> channels_of(const MotionModel& model) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  const std::set<int> states = bodies_of_states(scene);
  std::vector<Channel> channels;
  std::vector<bool> named(layout.coordinates.size(), false);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Link& link = layout.links[i];
    if (link.frame < 0 || link.frame >= layout.kept || states.contains(static_cast<int>(i))) continue;
    channels.push_back({scene.bodies[i].name, Quantity::angle, link.frame, layout.turns[link.turn].to<double>()});
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const int travel = layout.travel[j];
    if (travel < 0 || travel >= layout.kept) continue;
    named[static_cast<std::size_t>(travel)] = true;
    channels.push_back({scene.joints[j].name, Quantity::length, travel, 0.0});
  }
  for (int t = layout.angles; t < layout.kept; ++t) {
    const auto i = static_cast<std::size_t>(t);
    if (!named[i] && !layout.coordinates[i].name.empty())
      channels.push_back(
          {layout.coordinates[i].name, Quantity::length, t, model.scales().length * layout.coordinates[i].origin});
  }
  return channels;
}

const Channel& channel_named(const std::string& where, const std::string& name, const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (const Channel& channel : channels) {
    if (channel.name == name) return channel;
    names.push_back(channel.name);
  }
  throw InputError(
      fmt::format("{}: nothing that moves is called \"{}\"; expected a body that turns or a joint that slides{}", where,
                  name, did_you_mean_or_list(name, names)));
}

std::vector<PointRecord> points_of(const Scene& scene) {
  constexpr const char* center = "center";
  std::vector<PointRecord> out;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    bool has_name = false;
    const auto add = [&](const std::string& name, const Vec2& at) {
      out.push_back({.name = body.name + "." + name, .body = static_cast<int>(i), .at = at});
    };
    for (const NamedPoint& p : body.points) {
      add(p.name, p.at);
      has_name = has_name || p.name == center;
    }
    if (body.mass > 0.0 && !has_name) add(center, body.center);
  }
  return out;
}

MotionRecord record(const MotionModel& model, const Motion& motion, double rate, bool whole) {
  MotionRecord out;
  out.channels = channels_of(model);
  const std::size_t channels = out.channels.size();
  out.value.resize(channels);
  out.rate.resize(channels);
  if (whole) {
    out.acceleration.resize(channels);
    out.points = points_of(model.scene());
  }
  if (motion.trajectory.nodes() < 2) return out;
  StatesAlong states(model, motion);
  Energies energies(model);
  // A sample that rounding puts behind the end belongs to it.
  const auto samples = static_cast<std::size_t>(std::floor(motion.trajectory.t.back() * rate * (1 + 1e-12))) + 1;
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = std::min(static_cast<double>(k) / rate, motion.trajectory.t.back());
    const StatesAlong::Reading& read = states.read(t);
    out.time.push_back(t);
    for (std::size_t c = 0; c < channels; ++c) {
      const auto i = static_cast<std::size_t>(out.channels[c].coordinate);
      out.value[c].push_back(read.q[i] + out.channels[c].offset);
      out.rate[c].push_back(read.v[i]);
    }
    energies.add(read.q, read.v, out);
    if (!whole) continue;
    const MovingState& state = states.at(t);
    const std::vector<double> accelerations = model.to_si(state.a);
    for (std::size_t c = 0; c < channels; ++c) {
      out.acceleration[c].push_back(accelerations[static_cast<std::size_t>(out.channels[c].coordinate)]);
    }
    const std::vector<BodyMotion> bodies = body_motions(model, state.x, state.v, state.a);
    for (PointRecord& point : out.points) {
      const BodyMotion& body = bodies[static_cast<std::size_t>(point.body)];
      point.place.push_back(body.pose.world(point.at));
      point.velocity.push_back(body.velocity_of(point.at));
      point.acceleration.push_back(body.acceleration_of(point.at));
    }
  }
  return out;
}

void add_noise(MotionRecord& record, const Units& units, double sigma, std::uint64_t seed) {
  solvers::RandomStream random(seed);
  for (std::size_t k = 0; k < record.time.size(); ++k) {
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
      record.value[c][k] += sigma * unit_value(record.channels[c].quantity, units) * random.normal();
    }
  }
}

}  // namespace poise
