// poise_rig_fits [DATA.csv [NAME]]: processor time of fits, with their intervals and verdicts, beside a bare Ceres
// program for the one mechanism (benchmarks/bare_pendulum.hpp) that only finds the values, as one table; both on one
// thread, in turns, from the same starts. Exit code 1 where a fit is worse than the bare one by more than a hundredth
// of its rms. DATA.csv: the measured double pendulum (datasets/double_pendulum_experiment.toml says where it comes
// from); without it these rows are left out. NAME: only the rows whose names contain it.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "benchmarks/bare_pendulum.hpp"
#include "benchmarks/ratio_table.hpp"
#include "benchmarks/timing.hpp"
#include "identification/fit/first_readings.hpp"
#include "identification/fit/fit.hpp"
#include "model/text_file.hpp"
#include "solvers/random_stream.hpp"

namespace poise::benchmarks {
namespace {

constexpr double driven_limit = 3.0, measured_limit = 2.0;
constexpr double as_good = 1.01;  // rms over that of the bare program
constexpr int turns = 3;

// --- the driven rig -------------------------------------------------------------------------------------------------

// Two arms hang from a motor with a gear of 20 : 1. The torque of the motor is a sum of three sines, other ones in each
// of five runs of 10 s, which begin at rest. Dry friction in both joints. Unknown are both inertias, both centres along
// the arms, and damping and dry friction of both joints; the start of every run is estimated, too.

constexpr int runs = 5;
constexpr double duration = 10.0;
constexpr double noise = 1e-3;  // rad

constexpr PendulumRig driven_rig{
    .mass_1 = 1.4, .mass_2 = 0.8, .gravity = 9.81, .gear = 20.0, .rotor = 2e-5, .width = 0.01};
constexpr PendulumValues truth{0.012, 0.0045, 0.13, 0.11, 0.0, 0.26, 0.06, 0.012, 0.25, 0.05};
const std::vector<PendulumNumber> rig_unknowns = {inertia_1, inertia_2, center_1, center_2_x,
                                                  damping_1, damping_2, dry_1,    dry_2};
/// Of the starts over the truth, in the order of PendulumNumber.
constexpr PendulumValues starts_off{1.3, 0.75, 0.8, 1.2, 1.0, 1.0, 1.5, 0.6, 0.7, 1.4};

double torque_at(int run, double t) {
  constexpr double amplitude[] = {0.05, 0.04, 0.03};
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double frequency = 0.31 + 0.37 * k + 0.083 * run + 0.05 * k * run;
    sum += amplitude[k] * std::sin(2 * std::numbers::pi * frequency * t + 0.7 * run * (k + 1));
  }
  return sum;
}

std::vector<PendulumRecord> driven_records(const PendulumRig& moved, double rate) {
  std::vector<PendulumRecord> out;
  const auto count = static_cast<std::size_t>(std::lround(duration * rate)) + 1;
  for (int r = 0; r < runs; ++r) {
    PendulumRecord record{1 / rate, std::vector<double>(count), std::vector<double>(count), {}};
    for (std::size_t k = 0; k < count; ++k) record.torque.push_back(torque_at(r, static_cast<double>(k) / rate));
    const double down = -std::numbers::pi / 2;
    move_pendulum(moved, truth, {down, down, 0.0, 0.0}, record);
    solvers::RandomStream random(static_cast<std::uint64_t>(r + 1));
    for (std::size_t k = 0; k < count; ++k) {
      record.angle_1[k] += noise * random.normal();
      record.angle_2[k] += noise * random.normal();
    }
    out.push_back(std::move(record));
  }
  return out;
}

constexpr const char* rig_scene = R"(
gravity = [0, -9.81]
[ground]
points = {{ pivot = [0, 0], shaft = [0.1, 0] }}
[body.rotor]
points = {{ shaft = [0, 0] }}
inertia = 2e-5
[body.arm1]
points = {{ pivot = [0, 0], elbow = [0.26, 0] }}
mass = 1.4
center = [0.13, 0]
inertia = 0.012
[body.arm2]
points = {{ elbow = [0, 0] }}
mass = 0.8
center = [0.11, 0]
inertia = 0.0045
[[pin]]
name = "shaft"
points = ["ground.shaft", "rotor.shaft"]
[[pin]]
name = "shoulder"
points = ["ground.pivot", "arm1.pivot"]
[[pin]]
name = "elbow"
points = ["arm1.elbow", "arm2.elbow"]
[[gear]]
bodies = ["rotor", "arm1"]
ratio = 0.05
internal = true
[[torsion_damper]]
name = "shoulder"
bodies = ["ground", "arm1"]
coefficient = 0.06
[[torsion_damper]]
name = "elbow"
bodies = ["arm1", "arm2"]
coefficient = 0.012
[[friction]]
name = "shoulder dry"
bodies = ["ground", "arm1"]
torque = 0.25
width = {0}
[[friction]]
name = "elbow dry"
bodies = ["arm1", "arm2"]
torque = 0.05
width = {0}
[[torque]]
name = "motor"
on = "rotor"
value = 1
[start]
arm1 = -1.5707963267948966
arm2 = -1.5707963267948966
)";

constexpr const char* paths[] = {"body.arm1.inertia",
                                 "body.arm2.inertia",
                                 "body.arm1.center.x",
                                 "body.arm2.center.x",
                                 "body.arm2.center.y",
                                 "point.arm1.elbow.x",
                                 "torsion_damper.shoulder.coefficient",
                                 "torsion_damper.elbow.coefficient",
                                 "friction.shoulder dry.torque",
                                 "friction.elbow dry.torque"};

/// A folder for the files of the rig, which are removed with it.
class RigFiles {
 public:
  RigFiles() : folder_(std::filesystem::temp_directory_path() / "poise_rig_fits") {
    std::filesystem::create_directories(folder_);
  }
  RigFiles(const RigFiles&) = delete;
  RigFiles& operator=(const RigFiles&) = delete;
  ~RigFiles() { std::filesystem::remove_all(folder_); }

  Experiment write(const std::vector<PendulumRecord>& records, const PendulumValues& starts, double width) const {
    std::ofstream(folder_ / "rig.toml") << fmt::format(rig_scene, width);
    std::ofstream data(folder_ / "rig.csv");
    fmt::print(data, "segment,time,tau,phi1,phi2\n");
    for (std::size_t r = 0; r < records.size(); ++r) {
      for (std::size_t k = 0; k < records[r].angle_1.size(); ++k) {
        fmt::print(data, "{},{},{},{},{}\n", r, static_cast<double>(k) * records[r].step, records[r].torque[k],
                   records[r].angle_1[k], records[r].angle_2[k]);
      }
    }
    data.close();
    std::string text = "scene = \"rig.toml\"\n";
    for (const int arm : {1, 2}) {
      text += fmt::format("[[sensor]]\nname = \"phi{0}\"\nangle = \"arm{0}\"\nnoise = {1}\n", arm, noise);
    }
    for (const PendulumNumber i : rig_unknowns) {
      text += fmt::format("[[unknown]]\npath = \"{}\"\nstart = {}\n", paths[i], starts[i]);
    }
    text += "[[run]]\ndata = \"rig.csv\"\nsplit = \"segment\"\n[run.inputs]\n\"load.motor\" = \"tau\"\n";
    return parse_experiment(text, folder_ / "rig_experiment.toml");
  }

 private:
  std::filesystem::path folder_;
};

// --- both programs --------------------------------------------------------------------------------------------------

/// Seconds of the processor that the work takes, of all threads.
double processor_seconds(const std::function<void()>& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

double rms_of(const Fit& fitted) {
  if (!fitted.usable() && fitted.status != FitStatus::ambiguous) return INFINITY;
  return std::sqrt((fitted.rms[0] * fitted.rms[0] + fitted.rms[1] * fitted.rms[1]) / 2);
}

PendulumRecord bare_record(const RunModel& run, const Record& record) {
  const Series& first = record.sensors[0];
  PendulumRecord out{first.time[1] - first.time[0], first.value, record.sensors[1].value, {}};
  for (const RunInput& input : run.run().inputs) {
    for (const double t : first.time) out.torque.push_back(input.motion.curve->at(t));
  }
  return out;
}

class Race {
 public:
  explicit Race(std::string only) : only_(std::move(only)) { table_.head(); }

  bool runs(const std::string& name) const { return name.find(only_) != std::string::npos; }

  /// Both fit `unknowns` of the rig from the values in `numbers` and first guesses of the starts of the runs.
  void run(const std::string& name, double limit, const Experiment& experiment, const PendulumRig& rig,
           const std::vector<PendulumNumber>& unknowns, const PendulumValues& numbers) {
    const FitProblem problem(experiment);
    const std::vector<Record> records = problem.records();
    std::vector<PendulumRecord> bare_records;
    std::vector<PendulumState> starts;
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      const RunModel& model = problem.run(r);
      bare_records.push_back(bare_record(model, records[r]));
      const std::vector<double> guess = first_guess(model, problem.unknowns_of(r, problem.starts()), records[r]);
      std::copy(guess.begin(), guess.end(), starts.emplace_back().begin());
    }
    FitOptions options;
    options.jobs = 1;
    options.use_starts = true;
    std::vector<double> ours, theirs;
    Fit fitted;
    PendulumFit bare;
    for (int turn = 0; turn < turns; ++turn) {
      theirs.push_back(processor_seconds([&] { bare = fit_pendulum(rig, bare_records, unknowns, numbers, starts); }));
      ours.push_back(processor_seconds([&] { fitted = fit(problem, records, options); }));
    }
    const double rms = rms_of(fitted);
    table_.ratio(name, median(ours), median(theirs), limit, rms <= as_good * bare.rms,
                 fmt::format("rms {:.6f} and {:.6f} rad, {} and {} evaluations, {} iterations; {}", rms, bare.rms,
                             fitted.evaluations, fitted.check_evaluations, bare.iterations, to_string(fitted.status)) +
                     (fitted.usable() ? "" : ": " + fitted.why));
  }

  bool all_right() const { return table_.all_right(); }

 private:
  std::string only_;
  RatioTable table_;
};

void race_driven(Race& race, const std::string& name, const PendulumRig& moved, double rate, double width) {
  if (!race.runs(name)) return;
  PendulumValues starts = truth;
  for (const PendulumNumber i : rig_unknowns) starts[i] *= starts_off[i];
  const RigFiles files;
  race.run(name, driven_limit, files.write(driven_records(moved, rate), starts, width), driven_rig, rig_unknowns,
           starts);
}

// --- the measured double pendulum -----------------------------------------------------------------------------------

/// With the length of the first arm as one more unknown.
void race_measured(Race& race, const std::string& name, const std::string& file, const std::filesystem::path& data,
                   std::vector<PendulumNumber> unknowns) {
  if (!race.runs(name)) return;
  if (data.empty()) {
    fmt::print("{:<46}left out: give its CSV file\n", name);
    return;
  }
  const std::filesystem::path path = std::filesystem::path(POISE_SOURCE_DIR) / "datasets" / file;
  const std::string text = read_text_file(path.string()) +
                           fmt::format("\n[[unknown]]\npath = \"{}\"\nmin = 0.1\nmax = 0.3\n", paths[length]);
  const PendulumRig rig{.mass_1 = 0.0938440, .mass_2 = 0.137596, .gravity = 9.80858, .width = 0.1};
  const PendulumValues numbers{4.37529e-4, 1.26883e-3, 0.108565, 0.116779, 0.0, 0.172719, 2.37143e-4, 1e-5, 1e-4, 1e-4};
  PendulumValues own = numbers;
  if (std::find(unknowns.begin(), unknowns.end(), dry_1) == unknowns.end()) own[dry_1] = own[dry_2] = 0.0;
  race.run(name, measured_limit, parse_experiment(text, path, {data, {}}), rig, unknowns, own);
}

bool measure(const std::filesystem::path& data, const std::string& only) {
  Race race(only);
  PendulumRig falling = driven_rig;
  falling.fall = 2.5;
  falling.fall_rate = 0.5;
  PendulumRig sticking = driven_rig;
  sticking.width = 1e-3;
  race_driven(race, "driven, read at 100 Hz", driven_rig, 100.0, driven_rig.width);
  race_driven(race, "driven, read at 100 Hz, sticks", sticking, 100.0, 0.0);
  race_driven(race, "driven, read at 1 kHz", driven_rig, 1000.0, driven_rig.width);
  race_driven(race, "driven, friction falls", falling, 100.0, driven_rig.width);
  sticking.fall = falling.fall;
  sticking.fall_rate = falling.fall_rate;
  race_driven(race, "driven, friction falls, sticks", sticking, 100.0, 0.0);
  std::vector<PendulumNumber> unknowns = {inertia_1, inertia_2, center_2_x, center_2_y, damping_1, damping_2, length};
  race_measured(race, "measured, viscous", "double_pendulum_experiment.toml", data, unknowns);
  unknowns.insert(unknowns.end(), {dry_1, dry_2});
  race_measured(race, "measured, viscous and dry", "double_pendulum_dry_experiment.toml", data, unknowns);
  return race.all_right();
}

}  // namespace
}  // namespace poise::benchmarks

int main(int argc, char** argv) {
  return poise::benchmarks::measure(argc > 1 ? argv[1] : "", argc > 2 ? argv[2] : "") ? 0 : 1;
}
