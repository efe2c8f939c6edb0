#include "statics/many/scene_in_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "model/mechanism_impl.hpp"
#include "model/number_list.hpp"
#include "model/numbers.hpp"
#include "statics/many/private/lane_code.hpp"
#include "statics/many/private/lane_values.hpp"
#include "statics/many/private/step_equations.hpp"
#include "statics/quantities/linear_response.hpp"

namespace poise {
namespace {

constexpr double lane_step_tolerance = 1e-9;  // those of NewtonOptions
constexpr double longest_lane_step = 0.5;
constexpr double lane_contraction = 0.25;
constexpr int most_lane_steps = 12;
constexpr std::size_t most_instructions = 200'000;
constexpr double same_answer = 1e-9;  // rad or sizes

const LaneKernel& kernel_of(Simd simd) {
#ifdef POISE_VECTOR_KERNELS
  if (simd == Simd::avx512) return *poise_lanes_avx512();
  if (simd == Simd::avx2) return *poise_lanes_avx2();
#endif
  (void)simd;
  return *poise_lanes_plain();
}

bool has_held_factor(const Scene& scene) {
  return scene.dependents && std::any_of(scene.dependents->begin(), scene.dependents->end(),
                                         [](const DependentNumber& one) { return one.factor != nullptr; });
}

/// In range as far as its sign says; `value` is not known to be.
RecordedMask is_possible(const Recorded& value, Range range) {
  const Recorded most(largest_value);
  RecordedMask out = value >= -most && value <= most;
  if (range == Range::positive) out = out && value > Recorded(0.0);
  if (range == Range::not_negative) out = out && value >= Recorded(0.0);
  return out;
}

}  // namespace

struct SceneInLanes::Compiled {
  std::string why_not;
  std::unique_ptr<LaneCode> code;
  std::vector<char> has_value;
  std::size_t values = 0;
};

namespace {

class LaneWork : public SceneInLanes::Work {
 public:
  LaneWork(const LaneNewton& newton, Simd simd) : kernel_(kernel_of(simd)) {
    constexpr std::size_t line = 64;
    memory_.resize(newton.places * kernel_.lanes + line / sizeof(double));
    const auto address = reinterpret_cast<std::uintptr_t>(memory_.data());
    at_ = memory_.data() + (line - address % line) % line / sizeof(double);
    kernel_.prepare(&newton, at_);
  }
  const LaneKernel& kernel() const { return kernel_; }
  double* memory() { return at_; }

 private:
  const LaneKernel& kernel_;
  std::vector<double> memory_;
  double* at_ = nullptr;
};

/// What of a scene is recorded, and how.
class LaneRecorder {
 public:
  LaneRecorder(const StaticModel& model, const Equilibrium& answer, const std::vector<ParameterRow>& rows,
               const std::vector<double>& factors, const LaneOptions& options)
      : model_(model), answer_(answer), rows_(rows), factors_(factors), options_(options) {}

  std::string record(Recording& recording, RecordedNewton& out, std::vector<char>& has_value) {
    if (std::string why = why_unsuited(); !why.empty()) return why;
    const auto list = std::make_shared<const NumberList>(model_.scaled_scene(), vectors_that_follow());
    const Recorder recorder(recording);
    std::vector<Recorded> p = numbers(*list, out);
    Mechanism<Recorded> mechanism(list->scene(), model_.layout(), Purpose::statics);
    mechanism.set_numbers(Numbers<Recorded>(*list, p.data()));
    const RecordedMask of_numbers = numbers_are_possible_ && guards_of(recording);

    std::vector<ActingStop> acting = acting_at(list->scene(), poses_of(model_, answer_.x), stops_held(list->scene()));
    std::vector<HeldStop> held;
    for (const ActingStop& one : acting) held.push_back({one.stop, one.upper});
    StepEquations equations(mechanism, held);
    for (const double x : answer_.x) out.x.push_back(Recorded::input(x));
    recording.comparisons.clear();
    const RecordedStep next = equations.at(out.x);
    if (!equations.why_not().empty()) return equations.why_not();
    out.next_step = next.step;
    out.last_mask = next.is_good && guards_of(recording);
    if (options_.keeps_sides) out.last_mask = out.last_mask && sides_of(recording);

    const bool is_from_start = options_.start == LaneStart::scene;
    out.start = is_from_start ? model_.start() : answer_.x;
    const RecordedStep first = equations.at({out.start.begin(), out.start.end()});
    out.first_step = first.step;
    out.first_mask = of_numbers && guards_of(recording);
    if (is_from_start) out.first_mask = out.first_mask && first.is_good && first.is_touched;

    LaneValues values(model_, list, p, std::move(acting));
    values.place(mechanism, out.x);
    if (options_.poses) values.add_poses(out.values);
    has_value = values.add(options_.quantities, out.values);
    out.values_mask = values.is_good() && guards_of(recording);
    return "";
  }

 private:
  std::string why_unsuited() const {
    const Certificate& certificate = answer_.certificate;
    if (!answer_.found()) return "no equilibrium of the scene as it is was found";
    if (certificate.stability != Stability::stable || !certificate.strict || certificate.outcome != Outcome::proved) {
      return "the equilibrium of the scene as it is is not proved to be stable with stops that press";
    }
    if (!certificate.sharing_stops.empty()) return "stops share loads in the scene as it is";
    if (model_.mechanism().coordinates() > SceneInLanes::most_coordinates) {
      return "it has more coordinates than are solved in lanes, " + std::to_string(SceneInLanes::most_coordinates);
    }
    for (const ParameterRow& row : rows_) {
      if (dependent_number(model_.scene(), row.place) != nullptr) return "a number that follows from others is varied";
      if (moves_springs(row.place)) return "the section of a flexible link is varied";
      if (row.place.owner == Owner::start || row.place.owner == Owner::time) return "a guess of the start is varied";
      if (row.place.owner == Owner::number && has_held_factor(model_.scene())) {
        return "loads that follow a function of time follow from a number that is varied";
      }
    }
    return "";
  }

  // Forces that follow from named numbers have components, in place of a magnitude.
  std::vector<int> vectors_that_follow() const {
    std::vector<int> out;
    if (!model_.scene().dependents) return out;
    for (const DependentNumber& one : *model_.scene().dependents) {
      const int force = one.at.place.item;
      if (one.at.of != DependentPlace::Of::force || std::find(out.begin(), out.end(), force) != out.end()) continue;
      out.push_back(force);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  // p with inputs in the place of what varies, and what follows from these.
  std::vector<Recorded> numbers(const NumberList& list, RecordedNewton& out) {
    std::vector<Recorded> p(list.values().begin(), list.values().end());
    bool leads = false;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const auto at = static_cast<std::size_t>(list.row(rows_[k].place));
      out.numbers.push_back(Recorded::input(list.values()[at] / factors_[k]));
      p[at] = out.numbers.back() * Recorded(factors_[k]);
      leads = leads || rows_[k].place.owner == Owner::number;
    }
    const Scene& scene = list.scene();
    if (!leads || !scene.dependents) return p;
    const auto names = static_cast<std::ptrdiff_t>(scene.named_values.size());
    list.follow_in<Recorded>({p.begin(), p.begin() + names}, p.data());
    // What follows is possible. A number that is varied too is as it is given.
    for (const DependentNumber& one : *scene.dependents) {
      if (one.at.of != DependentPlace::Of::row) continue;
      const Recorded& value = p[static_cast<std::size_t>(list.row(one.at.place))];
      if (!value.is_known()) numbers_are_possible_ = numbers_are_possible_ && is_possible(value, one.range);
    }
    return p;
  }

  std::vector<int> stops_held(const Scene& scene) const {
    std::vector<int> out = answer_.certificate.active_stops;
    for (int s = 0; s < static_cast<int>(scene.stops.size()); ++s) {
      const Stop& stop = scene.stops[static_cast<std::size_t>(s)];
      if (stop.min == stop.max && std::find(out.begin(), out.end(), s) == out.end()) out.push_back(s);
    }
    return out;
  }

  static RecordedMask all_of(const std::vector<Recording::Guard>& guards) {
    RecordedMask out(true);
    for (const Recording::Guard& one : guards) {
      const RecordedMask mask(one.holds, one.mask);
      out = out && (one.holds ? mask : !mask);
    }
    return out;
  }
  static RecordedMask guards_of(Recording& recording) { return all_of(std::exchange(recording.guards, {})); }
  static RecordedMask sides_of(Recording& recording) { return all_of(std::exchange(recording.comparisons, {})); }

  const StaticModel& model_;
  const Equilibrium& answer_;
  const std::vector<ParameterRow>& rows_;
  const std::vector<double>& factors_;
  const LaneOptions& options_;
  RecordedMask numbers_are_possible_{true};
};

}  // namespace

SceneInLanes::SceneInLanes(const StaticModel& model, const Equilibrium& answer, const std::vector<ParameterRow>& rows,
                           const std::vector<double>& factors, const LaneOptions& options)
    : compiled_(std::make_unique<Compiled>()) {
  Recording recording;
  RecordedNewton newton;
  compiled_->why_not =
      LaneRecorder(model, answer, rows, factors, options).record(recording, newton, compiled_->has_value);
  if (!compiled_->why_not.empty()) return;
  compiled_->values = newton.values.size();
  const std::vector<double> units = model.to_si(std::vector<double>(answer.x.size(), 1.0));
  compiled_->code = std::make_unique<LaneCode>(recording, newton, units);
  LaneNewton& of = compiled_->code->newton();
  of.tolerance = lane_step_tolerance;
  of.longest = longest_lane_step;
  of.contraction = lane_contraction;
  of.most_steps = most_lane_steps;
  if (!compiled_->code->fits() || compiled_->code->instructions() > most_instructions) {
    compiled_->why_not = "its equations are too large to be solved in lanes";
    return;
  }
  // The scene as it is has to be solved so.
  std::vector<double> own;
  for (const Recorded& one : newton.numbers) own.push_back(one.value());
  std::vector<const double*> numbers;
  for (const double& one : own) numbers.push_back(&one);
  const std::vector<std::size_t> strides(own.size(), 0);
  std::vector<double> q(answer.x.size()), values(compiled_->values);
  Lane lane{};
  const std::unique_ptr<Work> memory = work(Simd::plain);
  solve(numbers, strides, 0, 1, *memory, q.data(), values.data(), &lane);
  const std::vector<double> x = model.from_si(q);
  double far = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) far = std::max(far, std::abs(x[i] - answer.x[i]));
  if (lane == Lane::not_solved) {
    compiled_->why_not = "plain steps of Newton's method from the start do not reach where the scene as it is settles";
  } else if (!(far <= same_answer)) {
    compiled_->why_not = "plain steps of Newton's method lead elsewhere than the scene as it is settles";
  }
}

SceneInLanes::~SceneInLanes() = default;
SceneInLanes::SceneInLanes(SceneInLanes&&) noexcept = default;
SceneInLanes& SceneInLanes::operator=(SceneInLanes&&) noexcept = default;

const std::string& SceneInLanes::why_not() const { return compiled_->why_not; }
bool SceneInLanes::has_value(std::size_t k) const { return compiled_->has_value[k] != 0; }
std::size_t SceneInLanes::values() const { return compiled_->values; }
std::size_t SceneInLanes::instructions() const { return compiled_->code ? compiled_->code->instructions() : 0; }

std::unique_ptr<SceneInLanes::Work> SceneInLanes::work(Simd simd) const {
  return std::make_unique<LaneWork>(compiled_->code->newton(), simd);
}

std::size_t SceneInLanes::block(Simd simd) { return kernel_of(simd).lanes; }

void SceneInLanes::solve(std::span<const double* const> numbers, std::span<const std::size_t> strides,
                         std::size_t first, std::size_t count, Work& work, double* q, double* values,
                         Lane* lanes) const {
  const LaneBlock block{
      numbers.data(), strides.data(), first, count, q, values, reinterpret_cast<std::uint8_t*>(lanes)};
  auto& memory = static_cast<LaneWork&>(work);
  memory.kernel().solve(&compiled_->code->newton(), memory.memory(), &block);
}

}  // namespace poise
