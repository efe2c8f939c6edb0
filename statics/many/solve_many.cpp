#include "statics/many/solve_many.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "solvers/parallel.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/many/scene_in_lanes.hpp"
#include "statics/model/static_numbers.hpp"
#include "statics/proof/certificate.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t variants_at_a_time = 2048;  // of a thread in lanes; a multiple of every block

/// Numbers whose values may contradict others of their item, which their range does not say.
bool may_contradict(const Scene& scene, const ParameterPlace& place) {
  if (place.owner == Owner::coupling || place.owner == Owner::joint) return true;
  return place.owner == Owner::element &&
         std::holds_alternative<GasStrut>(scene.elements[static_cast<std::size_t>(place.item)].law);
}

class Batch {
 public:
  Batch(const Scene& scene, const std::vector<ManyValues>& numbers, const ManyOptions& options)
      : scene_(scene), numbers_(numbers), options_(options), simd_(options.simd ? *options.simd : simd_to_use()) {
    if (!has_simd(simd_)) throw InputError(fmt::format("this processor has no {}; expected plain", to_string(simd_)));
    count_variants();
    find_rows();
    for (const std::string& name : options.quantities) add_quantity(name);
    check_values();
    apply_those_for_all();
  }

  ManySolutions run() {
    compile();
    make_room();
    if (lanes_) run_lanes();
    search_others();
    if (lanes_) complete_values();
    explain_lanes();
    prove();
    conclude();
    return std::move(out_);
  }

 private:
  void count_variants() {
    std::size_t count = 1;
    const std::string* longest = nullptr;
    for (const ManyValues& one : numbers_) {
      if (one.values.empty()) throw InputError(fmt::format("{}: expected at least one value, found none", one.name));
      if (one.values.size() == 1) continue;
      if (longest != nullptr && one.values.size() != count) {
        throw InputError(fmt::format("{}: expected {} values, as {} has, or one for all; found {}", one.name, count,
                                     *longest, one.values.size()));
      }
      count = one.values.size();
      longest = &one.name;
    }
    out_.variants = count;
  }

  // Named numbers come first: what follows from them may be varied too.
  void find_rows() {
    std::vector<ParameterRow> rows;
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const std::string& name = numbers_[k].name;
      rows.push_back(parameter(scene_, name));
      check_is_free(scene_, rows.back());
      for (std::size_t before = 0; before < k; ++before) {
        if (rows[before].place == rows[k].place)
          throw InputError(fmt::format("{}: expected it once, found twice", name));
      }
    }
    for (const bool named : {true, false}) {
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if ((rows[k].place.owner == Owner::number) == named) order_.push_back(k);
      }
    }
    rows_ = std::move(rows);
  }

  void add_quantity(const std::string& name) {
    SoughtQuantity of = find_quantity(scene_, name);
    if (of.is_over_path() || of.has(SoughtQuantity::Kind::load_at_fold)) {
      throw InputError(fmt::format("{}: expected a quantity of a position, this one belongs to a path", name));
    }
    if (is_found_by_others(of)) {
      throw InputError(
          fmt::format("{}: expected a quantity of statics; stresses and modes are found one by one", name));
    }
    out_.quantities.push_back(std::move(of));
  }

  double value_of(std::size_t number, std::size_t variant) const {
    const std::span<const double>& values = numbers_[number].values;
    return values.size() == 1 ? values[0] : values[variant];
  }
  bool is_for_all(std::size_t number) const { return numbers_[number].values.size() == 1 && out_.variants > 1; }

  void check_values() const {
    std::vector<std::size_t> contradicting;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const ParameterRow& row = rows_[k];
      const double unit = row.dimension.unit(scene_.units);
      const std::span<const double>& values = numbers_[k].values;
      const std::size_t chunks = (values.size() + variants_at_a_time - 1) / variants_at_a_time;
      solvers::parallel_for(chunks, {.jobs = options_.jobs}, [&](std::size_t chunk) {
        const std::size_t end = std::min(values.size(), (chunk + 1) * variants_at_a_time);
        for (std::size_t v = chunk * variants_at_a_time; v < end; ++v) {
          if (contains(row.range, values[v] * unit)) continue;
          throw InputError(fmt::format("{}: variant {}: {}", numbers_[k].name, v, out_of_range(row.range, values[v])));
        }
      });
      if (may_contradict(scene_, row.place)) contradicting.push_back(k);
    }
    if (contradicting.empty()) return;
    Scene scene = scene_;
    for (std::size_t v = 0; v < out_.variants; ++v) {
      for (const std::size_t k : contradicting) set(scene, k, v);
    }
  }

  void set(Scene& scene, std::size_t number, std::size_t variant) const {
    try {
      set_value(scene, numbers_[number].name, value_of(number, variant));
    } catch (const InputError& error) {
      throw InputError(fmt::format("variant {}: {}", variant, error.what()));
    }
  }

  Scene scene_of(std::size_t variant) const {
    Scene out = base_;
    for (const std::size_t k : order_) {
      if (!is_for_all(k)) set(out, k, variant);
    }
    return out;
  }

  void apply_those_for_all() {
    base_ = scene_;
    for (const std::size_t k : order_) {
      if (is_for_all(k)) set(base_, k, 0);
    }
  }

  // The scene as it is, with the numbers that are the same in all variants, and its program for lanes.
  void compile() {
    for (const std::size_t k : order_) {
      if (is_for_all(k)) continue;
      const ParameterPlace& place = rows_[k].place;
      if (place.owner == Owner::start) out_.why_no_lanes = "guesses of the start are varied";
      if (!acts_in_statics(scene_, place)) continue;
      varied_.push_back(rows_[k]);
      numbers_in_lanes_.push_back(numbers_[k].values.data());
    }
    std::vector<ParameterPlace> places;
    for (const ParameterRow& row : varied_) places.push_back(row.place);
    varying_ = VaryingNumbers(base_, places);
    const ScaledModel own(base_, Purpose::statics);
    scales_ = own.scales();
    model_ = std::make_unique<StaticModel>(base_, scales_, varying_);
    for (int t = 0; t < model_->mechanism().coordinates(); ++t) {
      out_.coordinates.push_back(model_->layout().coordinates[static_cast<std::size_t>(t)].name);
      out_.is_angle.push_back(model_->layout().is_length(t) ? 0 : 1);
    }
    out_.simd = simd_;
    origins_ = origins_of(*model_);
    has_origins_ = std::any_of(origins_.begin(), origins_.end(), [](double origin) { return origin != 0.0; });
    if (!out_.why_no_lanes.empty()) return;
    try {
      const Equilibrium answer = solve(*model_, options_.solve);
      active_stops_ = answer.certificate.active_stops;
      std::vector<double> factors;
      for (const ParameterRow& row : varied_) {
        factors.push_back(row.dimension.unit(scene_.units) * row.dimension.per_scale(scales_));
      }
      lanes_ = std::make_unique<SceneInLanes>(*model_, answer, varied_, std::move(factors),
                                              LaneOptions{.poses = options_.poses, .quantities = out_.quantities});
      out_.why_no_lanes = lanes_->why_not();
    } catch (const InputError& error) {
      out_.why_no_lanes = error.what();  // the scene as it is cannot be assembled
    }
    if (!out_.why_no_lanes.empty()) lanes_.reset();
  }

  // Where coordinates are counted from in the world, SI: a place that follows from numbers of the scene.
  static std::vector<double> origins_of(const StaticModel& model) {
    std::vector<double> out;
    for (int t = 0; t < model.mechanism().coordinates(); ++t) {
      const double origin = model.layout().coordinates[static_cast<std::size_t>(t)].origin;
      out.push_back(model.layout().is_length(t) ? origin * model.scales().length : 0.0);
    }
    return out;
  }

  std::size_t coordinates() const { return out_.coordinates.size(); }
  std::size_t quantities() const { return out_.quantities.size(); }
  std::size_t pose_numbers() const { return options_.poses ? 3 * (scene_.bodies.size() - 1) : 0; }

  void make_room() {
    const std::size_t n = out_.variants;
    out_.solved_by.assign(n, SolvedBy::nothing);
    out_.q.resize(n * coordinates());
    out_.values.resize(n * quantities());
    out_.poses.resize(n * pose_numbers());
    out_.proofs.assign(n, ProofOf::not_asked);
    out_.radius.assign(n, unknown);
    if (options_.poses) {
      for (std::size_t i = 1; i < scene_.bodies.size(); ++i) out_.bodies.push_back(scene_.bodies[i].name);
    }
    if (lanes_ && lanes_->values() > 0) has_values_.assign(n, 0);
  }

  bool is_interrupted() const { return options_.solve.interrupt != nullptr && *options_.solve.interrupt; }

  void run_lanes() {
    const std::size_t n = out_.variants, chunks = (n + variants_at_a_time - 1) / variants_at_a_time;
    const std::vector<std::size_t> strides(numbers_in_lanes_.size(), out_.variants > 1 ? 1 : 0);
    solvers::ParallelOptions parallel{.jobs = options_.jobs, .interrupt = options_.solve.interrupt};
    if (options_.progress) {
      parallel.progress = [&](std::size_t done) { options_.progress(std::min(n, done * variants_at_a_time)); };
    }
    // Memory of a thread serves many chunks.
    std::mutex mutex;
    std::vector<std::unique_ptr<SceneInLanes::Work>> idle;
    solvers::parallel_for(chunks, parallel, [&](std::size_t chunk) {
      std::unique_ptr<SceneInLanes::Work> work;
      {
        const std::lock_guard lock(mutex);
        if (!idle.empty()) {
          work = std::move(idle.back());
          idle.pop_back();
        }
      }
      if (!work) work = lanes_->work(simd_);
      const std::size_t block = SceneInLanes::block(simd_), end = std::min(n, (chunk + 1) * variants_at_a_time);
      std::vector<SceneInLanes::Lane> lanes(block);
      std::vector<double> values(block * lanes_->values());
      for (std::size_t first = chunk * variants_at_a_time; first < end; first += block) {
        const std::size_t count = std::min(block, end - first);
        lanes_->solve(numbers_in_lanes_, strides, first, count, *work, &out_.q[first * coordinates()], values.data(),
                      lanes.data());
        for (std::size_t l = 0; l < count; ++l) keep_lane(first + l, lanes[l], &values[l * lanes_->values()]);
      }
      const std::lock_guard lock(mutex);
      idle.push_back(std::move(work));
    });
  }

  void keep_lane(std::size_t variant, SceneInLanes::Lane lane, const double* values) {
    if (lane == SceneInLanes::Lane::not_solved) return;
    out_.solved_by[variant] = SolvedBy::lanes;
    if (has_origins_) {
      for (std::size_t i = 0; i < origins_.size(); ++i) out_.q[variant * origins_.size() + i] += origins_[i];
    }
    if (lanes_->values() == 0) return;
    has_values_[variant] = lane == SceneInLanes::Lane::with_values ? 1 : 0;
    for (std::size_t k = 0; k < pose_numbers(); ++k) out_.poses[variant * pose_numbers() + k] = *values++;
    for (std::size_t k = 0; k < quantities(); ++k) {
      out_.values[variant * quantities() + k] = lanes_->has_value(k) ? defined(*values++) : unknown;
    }
  }
  static double defined(double value) { return std::isfinite(value) ? value : unknown; }

  template <class Work>
  void for_each(const std::vector<std::size_t>& variants, std::size_t done_before, Work work) {
    solvers::ParallelOptions parallel{.jobs = options_.jobs, .interrupt = options_.solve.interrupt};
    if (options_.progress) parallel.progress = [&](std::size_t done) { options_.progress(done_before + done); };
    solvers::parallel_for(variants.size(), parallel, [&](std::size_t k) { work(variants[k]); });
  }

  void search_others() {
    std::vector<std::size_t> others;
    for (std::size_t v = 0; v < out_.variants; ++v) {
      if (out_.solved_by[v] == SolvedBy::nothing) others.push_back(v);
    }
    if (others.empty() || is_interrupted()) return;
    for_each(others, out_.variants - others.size(), [&](std::size_t v) { search(v); });
  }

  void search(std::size_t v) {
    Scene scene = scene_of(v);
    try {
      const StaticModel model(std::move(scene), scales_, varying_);
      const Equilibrium found = solve(model, options_.solve);
      if (found.status == Status::interrupted || (is_interrupted() && !found.found())) return;
      if (!found.found() && found.status != Status::checked) return lose(v, found.why);
      out_.solved_by[v] = SolvedBy::search;
      keep_place(v, model, found.x);
      keep_values(v, model, found.x, found.certificate.active_stops);
      if (has_undefined(v)) explain(v, model, found.x, found.certificate.active_stops);
      if (is_to_prove(v)) keep_proof(v, found.certificate);
    } catch (const InputError& error) {  // its loops cannot be closed
      lose(v, error.what());
    }
  }

  void lose(std::size_t v, std::string why) {
    out_.solved_by[v] = SolvedBy::none;
    note(v, std::move(why));
  }

  void note(std::size_t v, std::string why) {
    const std::lock_guard lock(notes_mutex_);
    out_.notes.push_back({v, std::move(why)});
  }

  bool has_undefined(std::size_t v) const {
    const auto first = out_.values.begin() + static_cast<std::ptrdiff_t>(v * quantities());
    return std::any_of(first, first + static_cast<std::ptrdiff_t>(quantities()),
                       [](double value) { return std::isnan(value); });
  }

  // Notes why quantities of a variant that was solved have no value.
  void explain(std::size_t v, const StaticModel& model, const std::vector<double>& x, const std::vector<int>& active) {
    const std::vector<QuantityValue> found = quantity_values(resting_place(model, x, active), out_.quantities);
    std::string why;
    for (std::size_t k = 0; k < quantities(); ++k) {
      if (!std::isnan(out_.values[v * quantities() + k]) || found[k].why.empty()) continue;
      why += fmt::format("{}{}: {}", why.empty() ? "" : "; ", out_.quantities[k].name, found[k].why);
    }
    if (!why.empty()) note(v, std::move(why));
  }

  // In lanes only the values are found. Reasons are found for as many variants as there may be notes.
  void explain_lanes() {
    std::vector<std::size_t> undefined;
    for (std::size_t v = 0; v < out_.variants && undefined.size() < ManySolutions::most_notes; ++v) {
      if (out_.solved_by[v] == SolvedBy::lanes && has_undefined(v)) undefined.push_back(v);
    }
    if (undefined.empty() || is_interrupted()) return;
    for_each(undefined, out_.variants - undefined.size(), [&](std::size_t v) {
      const StaticModel model(scene_of(v), scales_, varying_);
      explain(v, model, place_of(v, model), active_stops_);
    });
  }

  void keep_place(std::size_t v, const StaticModel& model, const std::vector<double>& x) {
    const std::vector<double> q = model.to_si(x), origins = origins_of(model);
    for (std::size_t i = 0; i < q.size(); ++i) out_.q[v * coordinates() + i] = q[i] + origins[i];
    if (!options_.poses) return;
    const std::vector<BodyPose<double>> poses = model.poses(x);
    double* to = &out_.poses[v * pose_numbers()];
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      *to++ = poses[i].origin.x;
      *to++ = poses[i].origin.y;
      *to++ = poses[i].angle;
    }
  }

  void keep_values(std::size_t v, const StaticModel& model, const std::vector<double>& x,
                   const std::vector<int>& active) {
    if (quantities() == 0) return;
    const std::vector<double> values = quantities_at(model, x, active, out_.quantities);
    for (std::size_t k = 0; k < quantities(); ++k) {
      double& to = out_.values[v * quantities() + k];
      const bool is_there = out_.solved_by[v] == SolvedBy::lanes && has_values_in_lanes(v) && lanes_->has_value(k);
      if (!is_there) to = defined(values[k]);
    }
  }

  bool has_values_in_lanes(std::size_t v) const { return lanes_->values() > 0 && has_values_[v] != 0; }

  // What was not computed in lanes of what was solved there.
  void complete_values() {
    bool some_are_left = false;
    for (std::size_t k = 0; k < quantities(); ++k) some_are_left = some_are_left || !lanes_->has_value(k);
    if (!some_are_left && lanes_->values() == 0) return;
    std::vector<std::size_t> left;
    for (std::size_t v = 0; v < out_.variants; ++v) {
      if (out_.solved_by[v] != SolvedBy::lanes) continue;
      if (some_are_left || (lanes_->values() > 0 && !has_values_in_lanes(v))) left.push_back(v);
    }
    if (is_interrupted()) return forget_values(left);
    std::vector<char> done(out_.variants, 0);
    for_each(left, out_.variants - left.size(), [&](std::size_t v) {
      const StaticModel model(scene_of(v), scales_, varying_);
      keep_values(v, model, place_of(v, model), active_stops_);
      done[v] = 1;
    });
    std::erase_if(left, [&](std::size_t v) { return done[v] != 0; });
    forget_values(left);
  }

  void forget_values(const std::vector<std::size_t>& variants) {
    for (const std::size_t v : variants) {
      for (std::size_t k = 0; k < quantities(); ++k) {
        if (!has_values_in_lanes(v) || !lanes_->has_value(k)) out_.values[v * quantities() + k] = unknown;
      }
    }
  }

  std::vector<double> place_of(std::size_t v, const StaticModel& model) const {
    std::vector<double> q = origins_of(model);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = out_.q[v * coordinates() + i] - q[i];
    return model.from_si(std::move(q));
  }

  bool is_to_prove(std::size_t v) const {
    if (options_.prove == ManyOptions::Prove::none) return false;
    if (options_.prove == ManyOptions::Prove::all || options_.sample >= out_.variants) return true;
    // The sample is the middles of as many equal parts of the indices.
    const std::size_t n = out_.variants, k = options_.sample;
    if (k == 0) return false;
    const std::size_t part = v * k / n;
    return v == (part * n + n / 2) / k;
  }

  void keep_proof(std::size_t v, const Certificate& certificate) {
    out_.proofs[v] = certificate.confirmed() ? ProofOf::proved : ProofOf::not_proved;
    if (certificate.confirmed()) out_.radius[v] = certificate.radius;
  }

  void prove() {
    if (options_.prove == ManyOptions::Prove::none) return;
    std::vector<std::size_t> asked;
    for (std::size_t v = 0; v < out_.variants; ++v) {
      if (!is_to_prove(v)) continue;
      if (out_.solved_by[v] == SolvedBy::lanes) asked.push_back(v);
      if (out_.solved_by[v] == SolvedBy::none) out_.proofs[v] = ProofOf::not_proved;
    }
    if (is_interrupted()) return;
    for_each(asked, out_.variants - asked.size(), [&](std::size_t v) {
      const StaticModel model(scene_of(v), scales_, varying_);
      keep_proof(v, certify(model, place_of(v, model), options_.solve.certificate));
    });
  }

  std::size_t count(SolvedBy by) const {
    return static_cast<std::size_t>(std::count(out_.solved_by.begin(), out_.solved_by.end(), by));
  }

  void conclude() {
    out_.in_lanes = count(SolvedBy::lanes);
    out_.by_search = count(SolvedBy::search);
    out_.not_found = count(SolvedBy::none);
    if (options_.prove != ManyOptions::Prove::none) {
      for (const ProofOf proof : out_.proofs) {
        out_.proved += proof == ProofOf::proved ? 1 : 0;
        out_.not_proved += proof == ProofOf::not_proved ? 1 : 0;
      }
    }
    if (out_.in_lanes + out_.by_search < out_.variants) forget_unsolved();
    out_.interrupted = is_interrupted();
    std::sort(out_.notes.begin(), out_.notes.end(),
              [](const VariantNote& a, const VariantNote& b) { return a.variant < b.variant; });
    if (out_.notes.size() > ManySolutions::most_notes) out_.notes.resize(ManySolutions::most_notes);
  }

  void forget_unsolved() {
    const auto forget = [](std::vector<double>& of, std::size_t v, std::size_t width) {
      std::fill_n(of.begin() + static_cast<std::ptrdiff_t>(v * width), width, unknown);
    };
    for (std::size_t v = 0; v < out_.variants; ++v) {
      if (out_.solved_by[v] == SolvedBy::lanes || out_.solved_by[v] == SolvedBy::search) continue;
      forget(out_.q, v, coordinates());
      forget(out_.values, v, quantities());
      forget(out_.poses, v, pose_numbers());
    }
  }

  const Scene& scene_;
  const std::vector<ManyValues>& numbers_;
  const ManyOptions& options_;
  Simd simd_;
  ManySolutions out_;
  std::vector<ParameterRow> rows_;  // of numbers_
  std::vector<std::size_t> order_;  // of numbers_: named numbers first
  Scene base_;                      // with what is the same in all variants
  std::vector<ParameterRow> varied_;
  std::vector<const double*> numbers_in_lanes_;
  VaryingNumbers varying_;
  Scales scales_;
  std::unique_ptr<StaticModel> model_;
  std::vector<double> origins_;  // of its coordinates
  bool has_origins_ = false;
  std::vector<int> active_stops_;  // of the scene as it is
  std::unique_ptr<SceneInLanes> lanes_;
  std::vector<char> has_values_;  // per variant: in lanes
  std::mutex notes_mutex_;
};

}  // namespace

std::string to_string(SolvedBy by) {
  switch (by) {
    case SolvedBy::nothing:
      return "not solved";
    case SolvedBy::lanes:
      return "in lanes";
    case SolvedBy::search:
      return "by search";
    case SolvedBy::none:
      return "not found";
  }
  return "unknown";
}

ManySolutions solve_many(const Scene& scene, const std::vector<ManyValues>& numbers, const ManyOptions& options) {
  refuse_blades(scene, "batches of equilibria");
  return Batch(scene, numbers, options).run();
}

}  // namespace poise
