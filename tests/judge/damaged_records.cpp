#include "tests/judge/damaged_records.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "identification/assessment/identify.hpp"
#include "model/input_error.hpp"
#include "solvers/random_stream.hpp"

namespace poise::judge {
namespace {
namespace fs = std::filesystem;
using std::numbers::pi;

// --- benches --------------------------------------------------------------------------------------------------------

constexpr const char* arm_scene = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
mass = 1.2
center = [0.3, 0]
inertia = 0.02
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_damper]]
name = "bearing"
bodies = ["ground", "arm"]
coefficient = 0.05
MOTOR
[start]
arm = -1.5707963267948966
)";
constexpr const char* motor = R"([[torque]]
name = "motor"
on = "arm"
value = 0
)";
constexpr const char* arm_unknowns = R"([[unknown]]
path = "body.arm.inertia"
name = "J"
start = 0.03
[[unknown]]
path = "torsion_damper.bearing.coefficient"
name = "c"
start = 0.03
)";

/// A column of the data file.
struct Column {
  std::string name;
  std::vector<double> values;
};

/// A data file of a run: the time first.
struct File {
  std::vector<Column> columns;

  std::vector<double>& operator[](const std::string& name) {
    for (Column& column : columns) {
      if (column.name == name) return column.values;
    }
    throw std::out_of_range(name);
  }
  std::vector<double>& time() { return columns.front().values; }
  std::size_t rows() const { return columns.front().values.size(); }
  void erase(std::size_t first, std::size_t last) {
    for (Column& column : columns) {
      column.values.erase(column.values.begin() + static_cast<std::ptrdiff_t>(first),
                          column.values.begin() + static_cast<std::ptrdiff_t>(last));
    }
  }
};

struct Bench {
  std::string scene, head;        // head: sensors and unknowns
  std::vector<std::string> runs;  // what a run states besides its data
  std::vector<std::string> releases;
  double duration, rate;
  std::vector<double> noise;  // per sensor
  std::vector<std::string> sensors;
  std::string input;  // column; empty without
};

Bench swing() {
  Bench out;
  out.scene = arm_scene;
  out.scene.replace(out.scene.find("MOTOR"), 5, "");
  out.head = "[[sensor]]\nname = \"phi\"\nangle = \"arm\"\n" + std::string(arm_unknowns);
  out.runs = {"", ""};
  out.releases = {"release = { arm = -0.77 }", "release = { arm = -2.1 }"};
  out.duration = 6;
  out.rate = 200;
  out.noise = {1e-3};
  out.sensors = {"phi"};
  return out;
}

Bench driven() {
  Bench out;
  out.scene = arm_scene;
  out.scene.replace(out.scene.find("MOTOR"), 5, motor);
  out.head =
      "[[sensor]]\nname = \"phi\"\nangle = \"arm\"\nnoise = 1e-3\n[[sensor]]\nname = \"gyro\"\nangle = "
      "\"arm\"\nrate = true\nnoise = 5e-3\n" +
      std::string(arm_unknowns) + "[[unknown]]\npath = \"body.arm.center.x\"\nname = \"a\"\nstart = 0.28\n";
  out.runs = {"inputs = { \"load.motor\" = \"tau\" }", "inputs = { \"load.motor\" = \"tau\" }"};
  out.releases = {"release = { arm = -1.2 }", "release = { arm = -1.9 }"};
  out.duration = 6;
  out.rate = 200;
  out.noise = {1e-3, 5e-3};
  out.sensors = {"phi", "gyro"};
  out.input = "tau";
  return out;
}

Bench double_swing() {
  Bench out;
  std::ifstream scene(fs::path(POISE_SOURCE_DIR) / "datasets" / "double_pendulum.toml");
  out.scene = {std::istreambuf_iterator<char>(scene), {}};
  out.head = R"([[sensor]]
name = "phi1"
angle = "arm1"
noise = 1.5e-3
[[sensor]]
name = "phi2"
angle = "arm2"
noise = 1.5e-3
[[unknown]]
path = "body.arm1.inertia"
name = "J1"
start = 6e-4
[[unknown]]
path = "body.arm2.inertia"
name = "J2"
start = 1e-3
[[unknown]]
path = "torsion_damper.shoulder.coefficient"
name = "c1"
start = 1e-4
)";
  out.runs = {"", ""};
  out.releases = {"release = { arm1 = -0.7, arm2 = -1.1 }", "release = { arm1 = -2.0, arm2 = -0.9 }"};
  out.duration = 4;
  out.rate = 250;
  out.noise = {1.5e-3, 1.5e-3};
  out.sensors = {"phi1", "phi2"};
  return out;
}

Bench lift() {
  Bench out;
  std::ifstream scene(fs::path(POISE_SOURCE_DIR) / "datasets" / "lift.toml");
  out.scene = {std::istreambuf_iterator<char>(scene), {}};
  out.head = R"([[sensor]]
name = "angle"
angle = "obd"
noise = 1e-4
[[unknown]]
path = "body.lump.mass"
name = "mP"
includes = 64.6823847579
start = 40
[[unknown]]
path = "body.obd.inertia"
name = "J_O"
includes = 2.8090062222
start = 5
[[unknown]]
path = "spring.oil.stiffness"
name = "k"
start = 3e6
[[unknown]]
path = "damper.oil film.coefficient"
name = "c"
start = 2500
)";
  const auto run = [](const char* payload, const char* at) {
    return fmt::format(
        "set = {{ \"body.payload.mass\" = {} }}\nrest = {{ angle = \"obd\", at = {}, by = \"spring.oil.free_length\" "
        "}}",
        payload, at);
  };
  out.runs = {run("0", "-0.0704"), run("0", "0.3769"), run("200", "0.3769"), run("0", "0.8242")};
  out.releases.assign(4, "release = { obd = 0.005 }");
  out.duration = 1;
  out.rate = 500;
  out.noise = {1e-4};
  out.sensors = {"angle"};
  return out;
}

Bench bench_of(const std::string& name) {
  return name == "swing" ? swing() : name == "driven" ? driven() : name == "double" ? double_swing() : lift();
}

// --- damage ---------------------------------------------------------------------------------------------------------

/// What a damage works on.
struct Records {
  Bench bench;
  std::vector<File> files;          // of the true motion, with noise
  std::string in_runs, in_sensors;  // further lines of every run, and of the first sensor
  solvers::RandomStream random;
};

using Hurt = std::function<void(Records&)>;

Hurt on_column(const std::string& name, const std::function<double(double)>& change) {
  return [=](Records& all) {
    for (File& file : all.files) {
      for (double& value : file[name]) value = change(value);
    }
  };
}
Hurt times(const std::string& name, double factor) {
  return on_column(name, [factor](double v) { return factor * v; });
}
Hurt plus(const std::string& name, double by) {
  return on_column(name, [by](double v) { return v + by; });
}
Hurt both(Hurt a, Hurt b) {
  return [a = std::move(a), b = std::move(b)](Records& all) {
    a(all);
    b(all);
  };
}
Hurt on_time(const std::function<double(double)>& change) {
  return [=](Records& all) {
    for (File& file : all.files) {
      for (double& t : file.time()) t = change(t);
    }
  };
}
/// The column has what the quantity was so many readings before.
Hurt late(const std::string& name, std::size_t rows) {
  return [=](Records& all) {
    for (File& file : all.files) {
      std::vector<double>& values = file[name];
      for (std::size_t i = values.size(); i-- > rows;) values[i] = values[i - rows];
      file.erase(0, rows);
    }
  };
}
/// Of about one in `per` readings of a column.
Hurt now_and_then(const std::string& name, double per, const std::function<double(double)>& change) {
  return [=](Records& all) {
    for (File& file : all.files) {
      for (double& value : file[name]) {
        if (all.random.uniform() * per < 1) value = change(value);
      }
    }
  };
}
/// Rows [part, part + of) of the first run's column.
Hurt stretch(const std::string& name, double part, double of, const std::function<double(double, double)>& change) {
  return [=](Records& all) {
    std::vector<double>& values = all.files.front()[name];
    const auto first = static_cast<std::size_t>(part * static_cast<double>(values.size()));
    const auto last =
        std::min(values.size(), first + static_cast<std::size_t>(of * static_cast<double>(values.size())));
    const double held = values[first];
    for (std::size_t i = first; i < last; ++i) values[i] = change(values[i], held);
  };
}
Hurt clipped(const std::string& name, double part) {
  return [=](Records& all) {
    for (File& file : all.files) {
      const auto [low, high] = std::minmax_element(file[name].begin(), file[name].end());
      const double most = *high - part * (*high - *low);
      for (double& v : file[name]) v = std::min(v, most);
    }
  };
}
/// Stands still with its noise for so many s before the first run begins.
Hurt idle(double seconds) {
  return [=](Records& all) {
    File& file = all.files.front();
    const auto rows = static_cast<std::size_t>(seconds * all.bench.rate);
    for (std::size_t c = 0; c < file.columns.size(); ++c) {
      std::vector<double>& values = file.columns[c].values;
      if (c == 0) {
        for (std::size_t i = 0; i < rows; ++i) values.push_back(values.back() + 1 / all.bench.rate);
        continue;
      }
      const double first = values.front();
      for (std::size_t i = 0; i < rows; ++i) {
        values.insert(values.begin(), first + all.bench.noise[c - 1] * all.random.normal());
      }
    }
  };
}
/// From `part` on it is held where it is.
Hurt held(double part) {
  return [=](Records& all) {
    File& file = all.files.front();
    const auto from = static_cast<std::size_t>(part * static_cast<double>(file.rows()));
    for (std::size_t c = 1; c < file.columns.size(); ++c) {
      std::vector<double>& values = file.columns[c].values;
      const double place = values[from];
      for (std::size_t i = from; i < values.size(); ++i)
        values[i] = place + all.bench.noise[c - 1] * all.random.normal();
    }
  };
}
/// Rows in the middle of the first run are lost; the times go on without a gap where `seamless`.
Hurt lost_rows(std::size_t rows, bool seamless) {
  return [=](Records& all) {
    File& file = all.files.front();
    const std::size_t at = file.rows() * 45 / 100;
    const std::vector<double> time = file.time();
    file.erase(at, at + rows);
    if (seamless) file.time().assign(time.begin(), time.begin() + static_cast<std::ptrdiff_t>(file.rows()));
  };
}
Hurt clock_jump(double by) {
  return [=](Records& all) {
    std::vector<double>& time = all.files.front().time();
    for (std::size_t i = time.size() * 45 / 100; i < time.size(); ++i) time[i] += by;
  };
}
Hurt in_runs(const std::string& line) {
  return [=](Records& all) { all.in_runs += line + "\n"; };
}
Hurt in_sensors(const std::string& line) {
  return [=](Records& all) { all.in_sensors += line + "\n"; };
}
Hurt exchanged(const std::string& a, const std::string& b) {
  return [=](Records& all) {
    for (File& file : all.files) std::swap(file[a], file[b]);
  };
}
Hurt numbered(double first) {
  return [=](Records& all) {
    for (File& file : all.files) {
      for (std::size_t i = 0; i < file.rows(); ++i) file.time()[i] = first + static_cast<double>(i);
    }
  };
}
/// The last run's record goes backwards.
Hurt other_motion(const std::string& name) {
  return [=](Records& all) {
    std::vector<double>& values = all.files.back()[name];
    std::reverse(values.begin(), values.end());
  };
}
Hurt correlated(const std::string& name, double noise) {
  return [=](Records& all) {
    for (File& file : all.files) {
      double x = 0.0;
      for (double& v : file[name]) {
        x = 0.9 * x + std::sqrt(1 - 0.81) * all.random.normal();
        v += noise * x;
      }
    }
  };
}
Hurt averaged(const std::string& name, std::size_t over) {
  return [=](Records& all) {
    for (File& file : all.files) {
      const std::vector<double> values = file[name];
      for (std::size_t i = over; i < values.size(); ++i) {
        double sum = 0.0;
        for (std::size_t j = 0; j < over; ++j) sum += values[i - j];
        file[name][i] = sum / static_cast<double>(over);
      }
    }
  };
}
/// The true torque is cut off, which the column does not show: done by the simulation.
constexpr double motor_most = 0.9;

double wrapped(double v, double period) { return v - period * std::floor(v / period); }

const std::map<std::string, std::function<Hurt(const Bench&)>>& hurts() {
  using B = const Bench&;
  static const auto deg = [](double v) { return v * 180 / pi; };
  static const std::map<std::string, std::function<Hurt(B)>> all = {
      {"none", [](B) { return in_runs(""); }},
      {"sign", [](B b) { return times(b.sensors.front(), -1); }},
      {"sign of the second", [](B b) { return times(b.sensors.back(), -1); }},
      {"all signs", [](B b) { return both(times(b.sensors.front(), -1), times(b.sensors.back(), -1)); }},
      {"sign of the input", [](B b) { return times(b.input, -1); }},
      {"degrees", [](B b) { return times(b.sensors.front(), 180 / pi); }},
      {"degrees, second", [](B b) { return times(b.sensors.back(), 180 / pi); }},
      {"degrees, all", [](B b) { return both(times(b.sensors.front(), 180 / pi), times(b.sensors.back(), 180 / pi)); }},
      {"turns", [](B b) { return times(b.sensors.front(), 1 / (2 * pi)); }},
      {"turns per minute", [](B b) { return times(b.sensors.back(), 60 / (2 * pi)); }},
      {"thousandths", [](B b) { return times(b.sensors.front(), 1e3); }},
      {"thousandths, second", [](B b) { return times(b.sensors.back(), 1e3); }},
      {"thousandths, input", [](B b) { return times(b.input, 1e3); }},
      {"thousands, input", [](B b) { return times(b.input, 1e-3); }},
      {"gain", [](B b) { return times(b.sensors.front(), 1.3); }},
      {"gain of the input", [](B b) { return times(b.input, 1.3); }},
      {"exchanged", [](B b) { return exchanged(b.sensors.front(), b.sensors.back()); }},
      {"zero", [](B b) { return plus(b.sensors.front(), 0.2); }},
      {"zero, second", [](B b) { return plus(b.sensors.back(), 0.2); }},
      {"zero, input", [](B b) { return plus(b.input, 0.3); }},
      {"late", [](B b) { return late(b.sensors.front(), 4); }},
      {"late, second", [](B b) { return late(b.sensors.back(), 4); }},
      {"late, input", [](B b) { return late(b.input, 5); }},
      {"clock 2 % fast", [](B) { return on_time([](double t) { return 1.02 * t; }); }},
      {"clock jump", [](B) { return clock_jump(0.15); }},
      {"clock stands", [](B) { return lost_rows(30, true); }},
      {"milliseconds", [](B) { return on_time([](double t) { return 1e3 * t; }); }},
      {"minutes", [](B) { return on_time([](double t) { return t / 60; }); }},
      {"tenths", [](B) { return on_time([](double t) { return 10 * t; }); }},
      {"row numbers", [](B) { return numbered(0); }},
      {"row numbers from 1", [](B) { return numbered(1); }},
      {"wrapped", [](B b) { return on_column(b.sensors.front(), [](double v) { return wrapped(v + 1.5, 2 * pi); }); }},
      {"wrapped degrees",
       [](B b) { return on_column(b.sensors.front(), [](double v) { return wrapped(deg(v + 1.5), 360); }); }},
      {"clipped", [](B b) { return clipped(b.sensors.front(), 0.15); }},
      {"clipped, second", [](B b) { return clipped(b.sensors.back(), 0.15); }},
      {"stuck", [](B b) { return stretch(b.sensors.front(), 0.4, 0.1, [](double, double held) { return held; }); }},
      {"stuck, second",
       [](B b) { return stretch(b.sensors.back(), 0.3, 0.05, [](double, double held) { return held; }); }},
      {"constant", [](B b) { return stretch(b.sensors.back(), 0, 1.1, [](double, double held) { return held; }); }},
      {"rows lost", [](B) { return lost_rows(40, false); }},
      {"marker -9999", [](B b) { return now_and_then(b.sensors.front(), 100, [](double) { return -9999; }); }},
      {"marker 0", [](B b) { return now_and_then(b.sensors.front(), 100, [](double) { return 0; }); }},
      {"marker 65535", [](B b) { return now_and_then(b.sensors.back(), 100, [](double) { return 65535; }); }},
      {"idle", [](B) { return idle(0.7); }},
      {"held at the end", [](B) { return held(0.6); }},
      {"saturation", [](B) { return in_runs(""); }},
      {"other motion", [](B b) { return other_motion(b.sensors.front()); }},
      {"spikes", [](B b) { return now_and_then(b.sensors.front(), 150, [](double v) { return v + 3.7; }); }},
      {"quantized",
       [](B b) { return on_column(b.sensors.front(), [](double v) { return 2e-3 * std::round(v / 2e-3); }); }},
      {"correlated noise", [](B b) { return correlated(b.sensors.front(), 2 * b.noise.front()); }},
      {"averaged", [](B b) { return averaged(b.sensors.front(), 15); }},
      {"relative",
       [](B b) -> Hurt {
         return [a = b.sensors.front(), c = b.sensors.back()](Records& all) {
           for (File& file : all.files) {
             for (std::size_t i = 0; i < file.rows(); ++i) file[c][i] -= file[a][i];
           }
         };
       }},
      {"gap", [](B b) { return now_and_then(b.sensors.front(), 100, [](double) { return NAN; }); }},
      {"rows twice",
       [](B) -> Hurt {
         return [](Records& all) {
           for (Column& column : all.files.front().columns)
             column.values.insert(column.values.begin() + 99, column.values[99]);
         };
       }},
      {"rows exchanged",
       [](B) -> Hurt {
         return [](Records& all) {
           for (Column& column : all.files.front().columns) std::swap(column.values[99], column.values[100]);
         };
       }},
      {"uneven clock",
       [](B b) -> Hurt {
         return [rate = b.rate](Records& all) {
           for (File& file : all.files) {
             for (double& t : file.time()) t += 0.01 / rate * all.random.normal();
           }
         };
       }},
      {"late clock", [](B) { return on_time([](double t) { return t + 86400; }); }},
      {"records exchanged",
       [](B) -> Hurt { return [](Records& all) { std::swap(all.files.front(), all.files.back()); }; }},
      {"drift",
       [](B b) -> Hurt {
         return [name = b.sensors.front()](Records& all) {
           for (File& file : all.files) {
             for (std::size_t i = 0; i < file.rows(); ++i) file[name][i] += 0.05 * file.time()[i];
           }
         };
       }},
      {"more noise",
       [](B b) -> Hurt {
         return [name = b.sensors.front(), noise = b.noise.front()](Records& all) {
           for (File& file : all.files) {
             for (double& v : file[name]) v += 2 * noise * all.random.normal();
           }
         };
       }},
  };
  return all;
}

// --- one experiment -------------------------------------------------------------------------------------------------

class Folder {
 public:
  Folder() {
    static int count = 0;
    path_ = fs::temp_directory_path() / fmt::format("poise_damage_{}_{}", static_cast<const void*>(this), ++count);
    fs::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  fs::path path_;
};

std::string csv(const File& file) {
  std::string out;
  for (const Column& column : file.columns) out += (out.empty() ? "" : ",") + column.name;
  for (std::size_t i = 0; i < file.rows(); ++i) {
    std::string row = "\n";
    for (const Column& column : file.columns) {
      row +=
          (row.size() > 1 ? "," : "") + (std::isnan(column.values[i]) ? "" : fmt::format("{:.9g}", column.values[i]));
    }
    out += row;
  }
  return out + "\n";
}

double torque(double t) { return 1.5 * std::sin(2 * pi * 0.7 * t) + 0.8 * std::sin(2 * pi * 1.9 * t + 1); }

Records simulated(const Bench& bench, const Folder& folder, bool saturates, std::uint64_t seed) {
  folder.write("scene.toml", bench.scene);
  Records out{bench, {}, {}, {}, solvers::RandomStream(seed)};
  const auto rows = static_cast<std::size_t>(bench.duration * bench.rate);
  File input;
  if (!bench.input.empty()) {
    input.columns = {{"time", {}}, {bench.input, {}}};
    for (std::size_t i = 0; i <= rows; ++i) {
      const double t = static_cast<double>(i) / bench.rate, tau = torque(t);
      input.time().push_back(t);
      input[bench.input].push_back(saturates ? std::clamp(tau, -motor_most, motor_most) : tau);
    }
    folder.write("input.csv", csv(input));
  }
  std::string text = "scene = \"scene.toml\"\n" + bench.head;
  if (text.find("noise") == std::string::npos) text.insert(text.find("angle ="), "noise = 1e-3\n");
  for (std::size_t r = 0; r < bench.runs.size(); ++r) {
    std::string states = bench.runs[r];
    const std::string column = "\"tau\"";
    if (const auto at = states.find(column); at != std::string::npos) {
      states.replace(at, column.size(), "{ column = \"tau\", file = \"input.csv\" }");
    }
    text += fmt::format("[[run]]\n{}\n{}\nduration = {}\nrate = {}\n", states, bench.releases[r], bench.duration,
                        bench.rate);
  }
  const Experiment experiment = read_experiment(folder.write("truth.toml", text));
  const FitProblem problem(experiment);
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const Record record = problem.ideal_record(r);
    File& file = out.files.emplace_back();
    file.columns.push_back({"time", record.sensors.front().time});
    for (std::size_t k = 0; k < record.sensors.size(); ++k) {
      file.columns.push_back({bench.sensors[k], record.sensors[k].value});
      for (double& v : file.columns.back().values) v += bench.noise[k] * out.random.normal();
    }
    if (bench.input.empty()) continue;
    Column& tau = file.columns.emplace_back();
    tau.name = bench.input;
    for (const double t : file.time()) tau.values.push_back(torque(t));
  }
  return out;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

const std::vector<Damage>& damages() {
  static const std::vector<Damage> all = {
      // A free arm, J and c from its swings, noise not stated.
      {"swing", "none", ""},
      {"swing", "sign", "counts the other way"},
      {"swing", "degrees", "pi/180"},
      {"swing", "turns", "2 pi"},
      {"swing", "thousandths", "thousandth"},
      {"swing", "gain", "factor"},
      {"swing", "zero", "zero"},
      {"swing", "late", ""},
      {"swing", "clock 2 % fast", "", "a free pendulum with another inertia has the slower motion"},
      {"swing", "clock jump", "clock jumped"},
      {"swing", "clock stands", "lost"},
      {"swing", "milliseconds", "time_factor"},
      {"swing", "minutes", "time_factor"},
      {"swing", "tenths", "", "a slower motion of the same shape is that of another inertia"},
      {"swing", "row numbers", "time_factor"},
      {"swing", "row numbers from 1", "time_factor"},
      {"swing", "wrapped", "wraps"},
      {"swing", "wrapped degrees", "wraps"},
      {"swing", "clipped", "cut off"},
      {"swing", "stuck", "stand still"},
      {"swing", "rows lost", ""},
      {"swing", "marker -9999", "missing"},
      {"swing", "marker 0", "missing"},
      {"swing", "idle", "stands still"},
      {"swing", "held at the end", "last"},
      {"swing", "other motion", "another motion"},
      {"swing", "spikes", "wild"},
      {"swing", "quantized", ""},
      {"swing", "correlated noise", ""},
      {"swing", "averaged", "", "the mean over 15 readings is a shift in time, and 0.2 % of the amplitude"},
      {"swing", "gap", "gap"},
      {"swing", "rows twice", "after that of the row before"},
      {"swing", "rows exchanged", "after that of the row before"},
      {"swing", "uneven clock", ""},
      {"swing", "late clock", ""},
      {"swing", "records exchanged", ""},
      {"swing", "drift", "drifts"},
      {"swing", "more noise", ""},
      // A driven arm, with the motor's torque, an angle and a gyro; noise stated.
      {"driven", "none", ""},
      {"driven", "sign", "counts the other way"},
      {"driven", "sign of the second", "counts the other way"},
      {"driven", "all signs", "the other way"},
      {"driven", "sign of the input", "counts the other way"},
      {"driven", "degrees", "pi/180"},
      {"driven", "degrees, second", "pi/180"},
      {"driven", "turns per minute", "2 pi/60"},
      {"driven", "thousandths, second", "thousandth"},
      {"driven", "thousandths, input", "thousandth"},
      {"driven", "thousands, input", "thousand"},
      {"driven", "gain of the input", "factor"},
      {"driven", "exchanged", "exchanged"},
      {"driven", "zero", "zero"},
      {"driven", "zero, second", "zero"},
      {"driven", "zero, input", "zero"},
      {"driven", "late", "late or early"},
      {"driven", "late, second", "late or early"},
      {"driven", "late, input", "early or late"},
      {"driven", "clock 2 % fast", "clock"},
      {"driven", "clock jump", "clock jumped"},
      {"driven", "clipped, second", "cut off"},
      {"driven", "stuck, second", "stand still"},
      {"driven", "constant", "are"},
      {"driven", "marker 65535", "missing"},
      {"driven", "saturation", "saturates"},
      {"driven", "correlated noise", ""},
      // Two arms, noise stated.
      {"double", "none", ""},
      {"double", "sign of the second", "counts the other way"},
      {"double", "all signs", "the other way"},
      {"double", "degrees, all", "pi/180"},
      {"double", "exchanged", "exchanged"},
      {"double", "relative", "counts from"},
      {"double", "zero, second", "zero"},
      {"double", "late, second", "late or early"},
      {"double", "clipped, second", "cut off"},
      {"double", "clock stands", "lost"},
      {"double", "idle", "stands still"},
      {"double", "clock 2 % fast", "clock"},
      // A lift on a shut cylinder: four runs, equilibria and starts unknown.
      {"lift", "none", ""},
      {"lift", "sign", "can have at once"},
      {"lift", "degrees", "can have at once"},
      {"lift", "milliseconds", "time_factor"},
      {"lift", "clipped", "cut off"},
      {"lift", "clock jump", "clock jumped"},
      {"lift", "row numbers", "time_factor"},
      {"lift", "marker -9999", "missing"},
  };
  return all;
}

std::string to_string(JudgedDamage::Outcome outcome) {
  switch (outcome) {
    case JudgedDamage::Outcome::harmless:
      return "harmless";
    case JudgedDamage::Outcome::told:
      return "told";
    case JudgedDamage::Outcome::told_else:
      return "told, another cause";
    case JudgedDamage::Outcome::wrong:
      return "WRONG";
  }
  return "";
}

bool JudgedDamage::is_right(const Damage& damage) const {
  return outcome == Outcome::harmless || outcome == Outcome::told || !damage.undetectable.empty();
}

JudgedDamage judge_damage(const Damage& damage, std::uint64_t seed) {
  const Bench bench = bench_of(damage.bench);
  const Folder folder;
  Records records = simulated(bench, folder, damage.kind == "saturation", seed);
  hurts().at(damage.kind)(bench)(records);
  std::string text = "scene = \"scene.toml\"\n" + bench.head;
  for (std::size_t r = 0; r < records.files.size(); ++r) {
    folder.write(fmt::format("run{}.csv", r), csv(records.files[r]));
    text += fmt::format("[[run]]\ndata = \"run{}.csv\"\n{}\n{}", r, bench.runs[r], records.in_runs);
  }
  const fs::path file = folder.write("experiment.toml", text);
  JudgedDamage out;
  std::string lines;
  std::optional<Experiment> experiment;
  try {
    experiment = read_experiment(file);
    const FitProblem problem(*experiment);
    const Identification found = identify(*experiment);
    if (found.is_believable()) {
      for (const RecordFault& fault : found.faults) lines += fault.words + "; " + fault.cure + "\n";
      for (const Estimate& e : found.fit.estimates) {
        constexpr double most_errors = 4.5;
        if (e.withheld || std::abs(e.value - e.truth) <= most_errors * e.standard_error) continue;
        out.outcome = JudgedDamage::Outcome::wrong;
        out.words =
            fmt::format("{} = {:.6g} +- {:.2g} for {:.6g}; {}", e.name, e.value, e.standard_error, e.truth, lines);
        return out;
      }
      out.words = lines;
      return out;
    }
    for (const RecordFault& fault : found.faults) lines += fault.words + "; " + fault.cure + "\n";
    if (found.misfit) lines += found.misfit->words + "\n";
    if (!found.fit.usable()) lines += "no fit: " + found.fit.why + "\n";
    for (const MisfitCause& cause : found.causes) {
      lines += fmt::format("{}; {}; {:.3g} times the noise\n", cause.words, cause.cure, cause.over_noise);
    }
  } catch (const InputError& error) {
    lines = error.what();
  }
  const bool right = !damage.told_by.empty() && lower(lines).find(lower(damage.told_by)) != std::string::npos;
  out.outcome = right ? JudgedDamage::Outcome::told : JudgedDamage::Outcome::told_else;
  out.words = lines;
  return out;
}

}  // namespace poise::judge
