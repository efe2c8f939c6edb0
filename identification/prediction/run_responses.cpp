#include <algorithm>
#include <cmath>

#include "identification/prediction/private/quantity_reader.hpp"
#include "identification/prediction/private/sensor_reader.hpp"
#include "identification/prediction/run_model.hpp"

namespace poise {

std::vector<RunModel::State> RunModel::states(const double* unknowns, const double* nuisances, std::size_t most) const {
  std::vector<State> out;
  if (is_at_rest()) return out;
  const Built built = build(unknowns, equilibrium_unknown_ ? nuisances[0] : equilibrium_at(), false);
  if (!built.model) return out;
  const Trajectory path = move(built, nuisances, std::max(span(), 1e-9), 1e-6, false, nullptr).trajectory;
  const std::size_t n = built.q.size();
  const std::size_t every = std::max<std::size_t>(1, path.nodes() / std::max<std::size_t>(most, 1));
  for (std::size_t node = 0; node < path.nodes() && out.size() < most; node += every) {
    const auto values = [&](const std::vector<double>& of) {
      const auto begin = of.begin() + static_cast<std::ptrdiff_t>(node * n);
      return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(n));
    };
    out.push_back({path.t[node], values(path.q), values(path.v)});
  }
  return out;
}

Eigen::MatrixXd RunModel::responses(const double* unknowns, double equilibrium,
                                    const std::vector<State>& states) const {
  if (is_at_rest()) return {};
  const Built built = build(unknowns, equilibrium, false);
  if (!built.model) return {};
  const MotionModel& model = *built.model;
  ReducedMotion<double> reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  reduced.set_inputs(model.scaled_scene(), scaled(inputs_in(model.scene()), model.scene(), model.scales()));
  const std::vector<double> x = model.from_si(built.q);
  reduced.begin(0.0, x.data(), &independent_);
  const std::vector<Scaling> scaling = scalings(unknowns);
  struct Reader {
    std::size_t sensor;
    std::optional<SensorReader> of_measure{};
    std::optional<VariedQuantity> of_quantity{};
  };
  std::vector<Reader> readers;
  for (std::size_t k = 0; k < times_.size(); ++k) {
    if (times_[k].empty()) continue;
    Reader& reader = readers.emplace_back(Reader{k});
    if (experiment_.sensors[k].quantity)
      reader.of_quantity.emplace(quantity_of(k, built.model, false));
    else
      reader.of_measure.emplace(model, experiment_.sensors[k]);
  }
  Eigen::MatrixXd out(static_cast<Eigen::Index>(states.size()), freedoms_ + static_cast<Eigen::Index>(readers.size()));
  std::vector<double> z(static_cast<std::size_t>(freedoms_)), w(z);
  for (std::size_t s = 0; s < states.size(); ++s) {
    const auto row = static_cast<Eigen::Index>(s);
    const std::vector<double> near = model.from_si(states[s].q);
    const std::vector<double> rates = model.from_si(states[s].v);
    for (std::size_t k = 0; k < z.size(); ++k) {
      z[k] = near[static_cast<std::size_t>(independent_[k])];
      w[k] = rates[static_cast<std::size_t>(independent_[k])];
    }
    reduced.expect(near.data());
    if (reduced.evaluate(states[s].t, z.data(), w.data()) != ReducedMotion<double>::Status::ok) return {};
    for (int k = 0; k < freedoms_; ++k) out(row, k) = reduced.alpha()[k];
    const std::vector<double> q = model.to_si({reduced.q(), reduced.q() + near.size()});
    const std::vector<double> v = model.to_si({reduced.v(), reduced.v() + near.size()});
    const std::vector<double> a = model.to_si({reduced.a(), reduced.a() + near.size()});
    for (std::size_t i = 0; i < readers.size(); ++i) {
      auto& [k, of_measure, of_quantity] = readers[i];
      double quantity = 0.0;
      if (of_quantity) {
        quantity = of_quantity->read(states[s].t, {model.from_si(q), model.from_si(v), model.from_si(a)});
      } else {
        std::vector<double> own_q, own_v, own_a;
        for (const int c : of_measure->coordinates()) {
          own_q.push_back(q[static_cast<std::size_t>(c)]);
          own_v.push_back(v[static_cast<std::size_t>(c)]);
          own_a.push_back(a[static_cast<std::size_t>(c)]);
        }
        quantity = of_measure->read(own_q.data(), own_v.data(), own_a.data());
      }
      const double gain = experiment_.sensors[k].unit / scaling[k].factor;
      out(row, freedoms_ + static_cast<Eigen::Index>(i)) = gain * (quantity - scaling[k].zero);
    }
  }
  return out;
}

Eigen::MatrixXd RunModel::accelerations(const double* unknowns, const std::vector<ReadState>& states) const {
  const Built built = build(unknowns, equilibrium_at(), false);
  if (!built.model) return {};
  const MotionModel& model = *built.model;
  ReducedMotion<double> reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  reduced.set_inputs(model.scaled_scene(), scaled(inputs_in(model.scene()), model.scene(), model.scales()));
  reduced.begin(0.0, model.from_si(built.q).data(), &independent_);
  const std::size_t f = independent_.size();
  std::vector<double> units, z(f), w(f);
  for (const int i : independent_) units.push_back(i < model.layout().angles ? 1.0 : model.scales().length);
  Eigen::MatrixXd out(static_cast<Eigen::Index>(states.size()), freedoms_);
  for (std::size_t s = 0; s < states.size(); ++s) {
    for (std::size_t k = 0; k < f; ++k) {
      z[k] = states[s].z[k] / units[k];
      w[k] = states[s].w[k] / units[k];
    }
    if (reduced.evaluate(states[s].t, z.data(), w.data()) != ReducedMotion<double>::Status::ok) return {};
    for (int k = 0; k < freedoms_; ++k) {
      out(static_cast<Eigen::Index>(s), k) = units[static_cast<std::size_t>(k)] * reduced.alpha()[k];
    }
  }
  return out;
}

}  // namespace poise
