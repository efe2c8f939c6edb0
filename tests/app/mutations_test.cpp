// Thousands of damaged files and command lines: each is either read, or answered in one line.

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "app/command_line.hpp"
#include "model/one_line.hpp"
#include "tests/app/mutate.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"
#include "tests/app/wheel_experiment.hpp"
#include "tests/support/seed.hpp"

namespace poise::app_tests::mutations_test {
namespace {
namespace fs = std::filesystem;

using Words = std::vector<std::string>;

struct File {
  std::string name, text;
};

/// A command that succeeds, and the files that it reads.
struct Command {
  Words words;
  std::vector<File> files;
};

/// How many cases, and the first of them: a number is the whole description of a case.
int from_environment(const char* name, int otherwise) {
  const char* const value = std::getenv(name);
  return value == nullptr ? otherwise : std::atoi(value);
}

File dataset_file(const std::string& name) {
  return {fs::path(name).filename().string() + ".toml", contents(dataset(name))};
}

/// Every scene of a folder of datasets that is small enough to be computed in a moment, under every command.
void add_scenes(const std::string& folder, std::vector<Command>& out) {
  constexpr std::size_t largest = 6000;
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(POISE_SOURCE_DIR) / folder)) {
    if (entry.path().extension() == ".toml") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) {
    const File scene{path.filename().string(), contents(path)};
    const bool is_scene = scene.text.find("[ground]") != std::string::npos;
    if (!is_scene || scene.text.size() > largest) continue;
    for (const Words& words :
         {Words{"check"}, Words{"solve", "--svg", "o.svg"}, Words{"compare", "--json", "o.json", "--markdown", "o.md"},
          Words{"modes", "--json", "o.json"}, Words{"motion", "--duration", "0.02", "--csv", "o.csv"},
          Words{"equations", "--from", "start", "--code", "o.c", "--python", "o.py"},
          Words{"response", "--excite", "load.P", "--of", "energy + force.spring", "--csv", "o.csv"},
          Words{"forces", "--verbose", "--svg", "o.svg"}, Words{"sensitivity", "--of", "energy", "--csv", "o.csv"},
          Words{"hold", "--vary", "loads"},
          Words{"find", "--vary", "loads=0.5..1", "--for", "energy = 0", "--csv", "o.csv"},
          Words{"loads", "--svg", "o.svg", "--csv", "o.csv"}, Words{"export", "--dxf", "o.dxf", "--pmks", "o.url"},
          Words{"export", "--mjcf", "o.xml"}}) {
      out.push_back({words, {scene}});
      out.back().words.insert(out.back().words.begin() + 1, scene.name);
    }
  }
}

/// A scene of two parts, and their file.
const char* const parted = R"([ground]
points = { O = [0, 0] }
[[part]]
name = "left"
file = "strut.toml"
repeat = 2
step = [1, 0]
[[part]]
name = "right"
file = "strut.toml"
mirror = true
at = ["K", 0]
angle = 1
join = { A = "left_2.rod.B" }
numbers = { k = "2*K", "body.rod.mass" = 3 }
[numbers]
K = 4
)";
const char* const strut = R"([numbers]
k = 40
[ground]
points = { A = [0, 0] }
[body.rod]
points = { A = [0, 0], B = [0, 1] }
mass = 2
[[pin]]
points = ["ground.A", "rod.A"]
[[torsion_spring]]
bodies = ["ground", "rod"]
stiffness = "k"
[start]
rod = 0.1
)";

/// An arm on a spring and a shock absorber, with a force of zero along a direction.
const char* const sized = R"([ground]
points = { O = [0, 0], B = [0, 1] }
[body.arm]
points = { O = [0, 0], A = [1, 0] }
mass = 1
inertia = 0.1
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "arm"]
stiffness = 3
free_angle = 0.1
[[damper]]
name = "shock"
points = ["ground.B", "arm.A"]
coefficient = 2
[[force]]
name = "P"
at = "arm.A"
direction = [0, 1]
size = 0
)";

const char* const measured_run = R"([[run]]
name = "measured"
data = "turn.csv"
time = "time"
split = "part"
segments = ["a", "b"]
every = 1
labels = { day = "first" }
)";

std::string readings() {
  std::string text = "part,time,turn,\"a \"\"note\"\"\"\n";
  for (const char part : {'a', 'b'}) {
    const double released = part == 'a' ? 20 : 15;
    for (int i = 0; i < 12; ++i) {
      text += fmt::format("{},{:.2f},{:.4f},x\n", part, 0.05 * i, released * std::cos(0.2 * i));
    }
  }
  return text;
}

/// What `poise identify --json` writes for an experiment.
File fit_of(const std::vector<File>& files) {
  const TempFolder folder;
  for (const File& file : files) folder.write(file.name, file.text);
  const std::string json = folder.path("fit.json");
  EXPECT_EQ(run_poise({"identify", folder.path(files.front().name), "--json", json}).exit_code, 0);
  return {"fit.json", contents(json)};
}

std::vector<Command> all_commands() {
  std::vector<Command> out;
  const File wheel_scene{"wheel.toml", wheel}, csv{"turn.csv", readings()};
  const File simulated{"simulated.toml", std::string(wheel_unknowns) +
                                             "[[run]]\nname = \"only\"\nset = { \"body.wheel.inertia\" = 3 }\n"
                                             "release = { wheel = 20 }\nrelease_rate = { wheel = 1 }\nduration = 1\n"
                                             "rate = 20\nseed = 3\n"};
  const File measured{"measured.toml", std::string(wheel_unknowns) + measured_run};
  const File joint{"joint.toml", "title = \"Both\"\nexperiments = [\"measured.toml\", \"simulated.toml\"]\n"};
  const File undamped{"undamped.toml",
                      std::string(wheel_unknowns).substr(0, std::string(wheel_unknowns).rfind("[[")) + measured_run};
  const File fitted = fit_of({measured, wheel_scene, csv});
  for (int weight = 0; weight < 10; ++weight) {
    out.push_back({{"identify", "measured.toml", "--json", "o.json", "--csv", "o.csv"}, {measured, wheel_scene, csv}});
    out.push_back({{"identify", "measured.toml", "--bootstrap", "20", "--profile", "k", "--scene", "o.toml"},
                   {measured, wheel_scene, csv}});
    out.push_back({{"identify", "joint.toml", "--json", "o.json"}, {joint, measured, simulated, wheel_scene, csv}});
    out.push_back(
        {{"identify", "undamped.toml", "measured.toml", "--json", "o.json"}, {undamped, measured, wheel_scene, csv}});
    out.push_back({{"validate", "measured.toml", "--with", "fit.json", "--json", "o.json"},
                   {fitted, measured, wheel_scene, csv}});
    out.push_back({{"validate", "simulated.toml", "--with", "fit.json", "--starts", "measured", "--csv", "o.csv"},
                   {fitted, simulated, wheel_scene}});
    out.push_back({{"identify", "measured.toml", "--data", "turn.csv"}, {csv, measured, wheel_scene}});
    out.push_back({{"identifiability", "measured.toml", "--base"}, {measured, wheel_scene, csv}});
    out.push_back({{"forces", "wheel.toml", "--motion", "motion.csv"},
                   {{"motion.csv", "time,wheel,wheel.rate\n0,0,1\n0.1,5.7,1\n0.2,11,1\n0.3,17,1\n"}, wheel_scene}});
    out.push_back({{"identify", "simulated.toml", "--start", "given"}, {simulated, wheel_scene}});
    out.push_back({{"plan", "plan.toml", "--jobs", "1", "--experiment", "o.toml"},
                   {{"plan.toml", simulated.text + "[plan]\nruns = 2\ncriterion = \"D\"\ntime = 1.5\ncandidates = 4\n"
                                                   "[[plan.vary]]\nwhat = \"release.wheel\"\nmin = 5\nmax = 20\n"
                                                   "[[plan.vary]]\nwhat = \"duration\"\nvalues = [0.5, 1]\n"},
                    wheel_scene}});
    out.push_back(
        {{"montecarlo", "simulated.toml", "--trials", "2", "--jobs", "1", "--seed", "1"}, {simulated, wheel_scene}});
    out.push_back({{"tolerance", "toggle_clamp.toml", "--tolerances", "toggle_clamp_tolerances.toml", "--of",
                    "force.rubber,load_at_fold.P", "--samples", "50", "--json", "o.json"},
                   {dataset_file("toggle_clamp_tolerances"), dataset_file("toggle_clamp")}});
    out.push_back({{"design", "lift_design.toml", "--starts", "1", "--scene", "found.toml"},
                   {dataset_file("lift_design"), dataset_file("lift")}});
    for (const auto& [design, scene] :
         {std::pair{"desk_lamp_design", "desk_lamp"}, {"four_bar_shaking_design", "four_bar_gravity"}}) {
      out.push_back({{"design", std::string(design) + ".toml", "--scene", "found.toml"},
                     {dataset_file(design), dataset_file(scene)}});
    }
    out.push_back({{"design", "wall_bed_design.toml", "--starts", "1", "--json", "o.json", "--scene", "found.toml"},
                   {dataset_file("wall_bed_design"), dataset_file("wall_bed")}});
    out.push_back(
        {{"design", "sprung_design.toml", "--starts", "1", "--jobs", "1", "--svg", "o.svg"},
         {{"sprung_design.toml",
           "scene = \"wall_bed.toml\"\ntolerances = \"half_widths.toml\"\nshare = \"99.7 %\"\n[variables]\n"
           "\"point.bed.B.y\" = [-0.1, 0]\n\"spring.balance.stiffness\" = { range = [9000, 9009], whole = true }\n"
           "[ties]\n\"point.ground.S.y\" = \"0.1 + point.bed.B.y\"\n[[catalogue]]\nfile = \"free.csv\"\n"
           "items = [\"spring.balance\"]\n[[goal]]\nof = \"mean(force.drive)\"\nalong = \"angle.bed\"\n"
           "over = [5, 60]\npositions = 5\nequals = 80\nwithin = 40\n[[goal]]\nof = \"force.drive\"\n"
           "along = \"angle.bed\"\nat = [5, 20]\naim = \"flat\"\nweight = 2\n[[goal]]\n"
           "equilibrium = \"none\"\nalong = \"angle.bed\"\nover = [5, 30]\n"},
          {"free.csv", "name,free_length,shortest,longest\nlong,0.3,0.2,0.6\nshort,0.2,0.15,0.5\n"},
          {"half_widths.toml", "[tolerances]\n\"body.bed.mass\" = 0.1\n"},
          dataset_file("wall_bed")}});
    out.push_back({{"stress", "balanced-arm", "--catalogue", ".", "--starts", "1", "--work", "1000", "--methods",
                    "virtual-work,energy"},
                   {{"catalogue.toml", "files = [\"neutral.cases.toml\"]\n"},
                    {"neutral.cases.toml",
                     "kind = \"Neutral\"\n[[case]]\nname = \"balanced-arm\"\ntitle = \"arm\"\nsource = \"ours\"\n"
                     "scene = \"balanced_arm.toml\"\nseek = \"nearest\"\neverywhere = true\n"},
                    dataset_file("hard/balanced_arm")}});
    out.push_back({{"kinematics", "lift.toml", "--drive", "stroke=0.5..0.52", "--steps", "2", "--point", "platform.Q",
                    "--csv", "o.csv"},
                   {dataset_file("lift")}});
    out.push_back({{"motion",     "pendulum.toml",  "--duration", "0.1",     "--rate", "100",    "--release",
                    "rod=0.1",    "--release-rate", "rod=1",      "--noise", "0.1",    "--seed", "3",
                    "--accuracy", "1e-6",           "--csv",      "o.csv",   "--json", "o.json"},
                   {{"pendulum.toml", pendulum}}});
    out.push_back({{"path", "clamp.toml", "--vary", "load.P=0..60", "--at", "10,20", "--measure", "arm", "--csv",
                    "o.csv", "--json", "o.json"},
                   {{"clamp.toml", dataset_file("toggle_clamp").text}}});
    out.push_back(
        {{"path", "clamp.toml", "--vary", "load.P=0..20", "--at", "10", "--show", "y.arm.T", "--variant",
          "soft: spring.rubber.stiffness=200", "--beside", "other.toml", "--csv", "o.csv", "--json", "o.json"},
         {{"other.toml", dataset_file("toggle_clamp").text}, {"clamp.toml", dataset_file("toggle_clamp").text}}});
    out.push_back(
        {{"loads", "arm.toml", "--vary", "load.P=0..2", "--steps", "2", "--csv", "o.csv"}, {{"arm.toml", sized}}});
    out.push_back({{"forces", "arm.toml", "--drive", "length.shock=1.2..1.1", "--steps", "2", "--rate", "1"},
                   {{"arm.toml", sized}}});
    out.push_back(
        {{"motion", "arm.toml", "--duration", "0.02", "--rate", "100", "--motors", "length.shock", "--csv", "o.csv"},
         {{"arm.toml", std::string(sized) + "[[drive]]\nname = \"motor\"\npoints = [\"ground.B\", "
                                            "\"arm.A\"]\nrate = 0.1\n"}}});
    out.push_back({{"import", "four_bar.txt", "--units", "in", "--scene", "o.toml", "--json", "o.json"},
                   {{"four_bar.txt", contents(fs::path(POISE_SOURCE_DIR) / "datasets/exchange/four_bar.txt")}}});
    for (const char* const file : {"arm.urdf", "four_bar.xml", "crank_slider.linkage2", "four_bar.url"}) {
      out.push_back({{"import", file, "--scene", "o.toml"},
                     {{file, contents(fs::path(POISE_SOURCE_DIR) / "datasets/exchange" / file)}}});
    }
    out.push_back({{"import", "four_bar.dxf", "--tolerance", "0.01"},
                   {{"four_bar.dxf", contents(fs::path(POISE_SOURCE_DIR) / "datasets/exchange/four_bar.dxf")}}});
    out.push_back({{"compare", "pendulum.toml", "--tolerances", "1e-2..1e-4", "--repeat", "1", "--methods",
                    "virtual-work,energy"},
                   {{"pendulum.toml", pendulum}}});
    for (const char* const setting :
         {"load.P=2", "body.rod.mass=1", "point.rod.tip.x=2", "start.rod=-1", "gravity.y=-9"}) {
      out.push_back({{"solve", "pendulum.toml", "--set", setting}, {{"pendulum.toml", pendulum}}});
    }
  }
  for (const char* const word : {"check", "solve"}) {
    out.push_back({{word, "parted.toml"}, {{"parted.toml", parted}, {"strut.toml", strut}}});
  }
  const std::string odd_name = "o\xFF\x1b[31m \xC2\xB5.toml";
  for (const Words& words :
       {Words{"solve", odd_name, "--json", "o.json"}, Words{"check", odd_name, "--svg", "o.svg"}}) {
    out.push_back({words, {{odd_name, pendulum}}});
  }
  add_scenes("datasets", out);
  add_scenes("datasets/hard", out);
  add_scenes("datasets/structures", out);
  add_scenes("datasets/friction", out);
  return out;
}

/// A command of which a file or a word has been damaged.
struct Case {
  std::string how;
  Words words;
  std::vector<File> files;
  std::vector<std::string> folders;  ///< in place of files

  Case(const std::vector<Command>& commands, unsigned number) {
    Random random(number);
    const Command& command = random.of(commands);
    words = command.words;
    files = command.files;
    if (random.below(5) == 0) {
      damage_words(random);
    } else {
      damage_files(random);
    }
  }

  std::string command_line() const {
    return "poise " + one_line(fmt::format("{}", fmt::join(words, " "))).substr(0, 300);
  }

 private:
  void damage_words(Random& random) {
    const std::size_t at = random.below(words.size());
    switch (random.below(5)) {
      case 0:
        how = "word left out";
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      case 1:
        how = "word twice";
        words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), words[at]);
        break;
      case 2: {
        how = "empty option";
        const Words options = {"--json",  "--svg",     "--html",       "--csv",     "--markdown", "--set",
                               "--data",  "--motion",  "--from",       "--methods", "--seek",     "--scene",
                               "--drive", "--release", "--tolerances", "--with",    "--profile",  "--jobs"};
        const std::string& option = random.of(options);
        if (random.below(2) == 0) {
          words.push_back(option + "=");
        } else {
          words.insert(words.end(), {option, ""});
        }
        break;
      }
      default:
        how = "word " + std::to_string(at);
        words[at] = mutated_word(words[at], random);
    }
  }

  void damage_files(Random& random) {
    // The first file half of the time: the others are tried as first files of other commands.
    const std::size_t at = random.below(2) == 0 ? 0 : random.below(files.size());
    how = files[at].name + ": ";
    if (random.below(50) == 0) {
      how += "a folder";
      folders.push_back(files[at].name);
      files.erase(files.begin() + static_cast<std::ptrdiff_t>(at));
    } else if (random.below(50) == 0) {
      how += "missing";
      files.erase(files.begin() + static_cast<std::ptrdiff_t>(at));
    } else if (random.below(50) == 0) {
      how += "another file";
      files[at].text = random.of(files).text;
    } else {
      std::string damage;
      files[at].text = mutated(files[at].text, random, damage);
      how += damage;
    }
  }
};

// After the time of a case: as Ctrl-C first, which has to end it.
void interrupt_then_kill(int) {
  std::signal(SIGALRM, SIG_DFL);
  ::alarm(60);
  ::raise(SIGINT);
}

/// Runs poise in the folder, in a process of its own that a crash or an endless loop ends alone. Exit code: negative,
/// the signal that ended it.
ProgramRun run_in(const TempFolder& folder, const TempFolder& output, const Words& words, unsigned seconds) {
  std::fflush(nullptr);  // or else the child prints it too
  const pid_t child = ::fork();
  if (child == 0) {
    for (const auto& [name, stream] : {std::pair("out", STDOUT_FILENO), std::pair("err", STDERR_FILENO)}) {
      ::dup2(::open(output.path(name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), stream);
    }
    std::signal(SIGALRM, interrupt_then_kill);
    ::alarm(seconds);
    fs::current_path(folder.path(""));
    std::vector<const char*> argv = {"poise"};
    for (const std::string& word : words) argv.push_back(word.c_str());
    const int code = app::run(static_cast<int>(argv.size()), argv.data());
    std::fflush(nullptr);
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), contents(output.path("out")),
          contents(output.path("err"))};
}

/// Lines without control characters, in valid UTF-8.
bool is_plain(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text == one_line(text);
}

/// Whether a text shows a number that is none: "nan", "-inf" as words of their own.
bool shows_no_number(std::string text) {
  text.resize(std::min(text.size(), text.find("\nwrote ")));  // names of files
  const auto is_letter = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '_');
  };
  for (const std::string word : {"nan", "inf"}) {
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
      if (!is_letter(at - 1) && !is_letter(at + 3)) return true;
    }
  }
  return false;
}

std::string objection_to_bad_input(const Case& damaged, const ProgramRun& run, const Words& before,
                                   const Words& after) {
  // check shows in its report why a scene cannot be assembled.
  if (!run.out.empty() && damaged.words.front() != "check") return "prints a report beside the error";
  if (run.err.empty() || run.err.back() != '\n') return "no line";
  const std::string line = run.err.substr(0, run.err.size() - 1);
  if (line != one_line(line)) return "more than a line of plain text";
  if (line.size() > 1000) return "too long";
  if (before != after) return "files were written";
  const auto names = [&](const std::string& place) { return line.find(one_line(place)) != std::string::npos; };
  const bool file =
      std::any_of(damaged.files.begin(), damaged.files.end(), [&](const File& f) { return names(f.name); });
  const bool folder = std::any_of(damaged.folders.begin(), damaged.folders.end(), names);
  const bool word = names("--") || line.starts_with("poise: ");
  const bool missing = names("cannot be read") || names("there is no");
  const bool listed = line.starts_with("CASE: ") || line.starts_with("EXPERIMENT: ");  // words without an option
  if (!file && !folder && !word && !missing && !listed) return "no place";
  if (!names("expected") && !names("; ") && !names("TOML syntax")) return "nothing is expected";
  return "";
}

/// What is wrong with how poise has answered; empty where nothing is.
std::string objection(const Case& damaged, const ProgramRun& run, const TempFolder& folder, const Words& before) {
  const Words after = folder.names();
  if (run.exit_code == -SIGALRM) return "does not end";
  if (run.exit_code < 0) return fmt::format("ends by signal {}", -run.exit_code);
  if (run.exit_code > 2) return fmt::format("exit code {}", run.exit_code);
  // A start from which a mechanism is not assembled is a search that failed.
  const bool not_assembled = run.exit_code == 1 && !run.err.empty();
  if (run.exit_code == 2 || not_assembled) return objection_to_bad_input(damaged, run, before, after);
  if (!run.err.empty()) return "a result and an error";
  if (run.out.empty() || !is_plain(run.out)) return "no plain text";
  if (shows_no_number(run.out)) return "a report with nan or inf";
  for (const std::string& name : after) {
    if (std::find(before.begin(), before.end(), name) != before.end()) continue;
    const std::string text = contents(folder.path(name));
    if (name.ends_with(".json") && !nlohmann::json::accept(text)) return "no JSON";
    if (name.ends_with(".svg") && !objection_to_xml(text).empty()) return "SVG: " + objection_to_xml(text);
    if (shows_no_number(text)) return name + " with nan or inf";
  }
  return "";
}

// POISE_FIRST_MUTATION=N begins with another case, POISE_SHOW_MUTATIONS=1 prints what is answered;
// docs/architecture.md.
TEST(Mutations, AreReadOrAnsweredInOneLine) {
  constexpr int count = 200;
  const int first = from_environment("POISE_FIRST_MUTATION", count * static_cast<int>(test::campaign_round()));
  const bool shown = from_environment("POISE_SHOW_MUTATIONS", 0) != 0;
  const auto seconds = static_cast<unsigned>(from_environment("POISE_MUTATION_SECONDS", 60));
  const std::vector<Command> commands = all_commands();
  std::array<int, 3> answers{};
  for (int number = first; number < first + count; ++number) {
    const Case damaged(commands, static_cast<unsigned>(number));
    const TempFolder folder, output;
    for (const File& file : damaged.files) folder.write(file.name, file.text);
    for (const std::string& name : damaged.folders) fs::create_directory(folder.path(name));
    const Words before = folder.names();
    const auto begun = std::chrono::steady_clock::now();
    const ProgramRun run = run_in(folder, output, damaged.words, seconds);
    if (std::chrono::steady_clock::now() - begun > std::chrono::seconds(seconds)) {
      fmt::print("interrupted: {}, {}\n  {}\n", number, one_line(damaged.how), damaged.command_line());
    }
    if (run.exit_code >= 0 && run.exit_code <= 2) ++answers[static_cast<std::size_t>(run.exit_code)];
    if (shown)
      fmt::print("{} {}\n  {} {}", number, damaged.command_line(), run.exit_code,
                 run.err + run.out.substr(0, run.out.find('\n') + 1));
    const std::string wrong = objection(damaged, run, folder, before);
    EXPECT_EQ(wrong, "") << "POISE_FIRST_MUTATION=" << number << ", " << one_line(damaged.how) << "\n"
                         << damaged.command_line() << "\n"
                         << run.exit_code << ": " << run.err.substr(0, 3000) << run.out.substr(0, 1500);
  }
  fmt::print("exit codes 0, 1, 2: {}\n", fmt::join(answers, ", "));
  // Neither is everything damaged beyond reading, nor is the damage overlooked.
  if (count < 100) return;
  EXPECT_GT(answers[0], count / 20);
  EXPECT_GT(answers[1], 0);
  EXPECT_GT(answers[2], count / 4);
}

}  // namespace
}  // namespace poise::app_tests::mutations_test
