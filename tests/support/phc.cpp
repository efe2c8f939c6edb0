#include "tests/support/phc.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <stdlib.h>

#include "model/phasor_sum.hpp"

namespace poise::test {
namespace {

namespace fs = std::filesystem;

// Names of the unknowns of a monomial, sorted, one for each factor.
using Monomial = std::vector<std::string>;

class Polynomial {
 public:
  Polynomial() = default;
  explicit Polynomial(double constant) { terms_[{}] = constant; }
  explicit Polynomial(const std::string& unknown) { terms_[{unknown}] = 1.0; }

  friend Polynomial operator+(Polynomial a, const Polynomial& b) {
    for (const auto& [monomial, factor] : b.terms_) a.terms_[monomial] += factor;
    return a;
  }
  friend Polynomial operator*(const Polynomial& a, const Polynomial& b) {
    Polynomial out;
    for (const auto& [p, x] : a.terms_) {
      for (const auto& [q, y] : b.terms_) {
        Monomial both = p;
        both.insert(both.end(), q.begin(), q.end());
        std::sort(both.begin(), both.end());
        out.terms_[both] += x * y;
      }
    }
    return out;
  }
  friend Polynomial operator*(double factor, const Polynomial& a) { return Polynomial(factor) * a; }

  /// By the angle whose cosine and sine are the unknowns c and s: dc = -s, ds = c.
  Polynomial by_angle(const std::string& c, const std::string& s) const {
    Polynomial out;
    for (const auto& [monomial, factor] : terms_) {
      for (std::size_t i = 0; i < monomial.size(); ++i) {
        if (monomial[i] != c && monomial[i] != s) continue;
        Monomial changed = monomial;
        changed[i] = monomial[i] == c ? s : c;
        std::sort(changed.begin(), changed.end());
        out.terms_[changed] += monomial[i] == c ? -factor : factor;
      }
    }
    return out;
  }

  /// Terms that are zero but for rounding are left out: phc takes its start systems from the terms that are there, and
  /// loses paths where coefficients are 1e-17.
  std::string text() const {
    double largest = 0.0;
    for (const auto& [monomial, factor] : terms_) largest = std::max(largest, std::abs(factor));
    std::string out;
    for (const auto& [monomial, factor] : terms_) {
      if (std::abs(factor) <= 1e-14 * largest) continue;
      out += fmt::format(" {} {:.16E}", factor < 0.0 ? '-' : '+', std::abs(factor));
      for (const std::string& unknown : monomial) out += "*" + unknown;
    }
    return out.empty() ? "0" : out;
  }

 private:
  std::map<Monomial, double> terms_;
};

struct Place {
  Polynomial x, y;
};

std::string cosine(int k) { return fmt::format("c{}", k); }
std::string sine(int k) { return fmt::format("s{}", k); }

// A sum of phasors: (a + i b)(c + i s) of each term.
Place place(const PhasorSum<double>& sum) {
  Place out{Polynomial(sum.constant().x), Polynomial(sum.constant().y)};
  for (const auto& term : sum.terms()) {
    const Polynomial c(cosine(term.coordinate)), s(sine(term.coordinate));
    out.x = out.x + term.coefficient.x * c + -term.coefficient.y * s;
    out.y = out.y + term.coefficient.x * s + term.coefficient.y * c;
  }
  return out;
}

class Writer {
 public:
  explicit Writer(const StaticModel& model)
      : layout_(model.layout()), phasors_(model.mechanism().phasors()), scene_(model.scaled_scene()) {}

  Polynomials write(bool assemblies) {
    if (layout_.kept > layout_.angles) return {{}, "it has a slide"};
    if (!scene_.stops.empty()) return {{}, "it has a stop"};
    for (int k = 0; k < layout_.kept; ++k) {
      const Polynomial c(cosine(k)), s(sine(k));
      add(c * c + s * s + Polynomial(-1.0));
    }
    for (std::size_t l = 0; l < layout_.closures.size(); ++l) {
      const Place gap = place(PhasorSum<double>(phasors_, layout_.closures[l].arms));
      add(gap.x);
      add(gap.y);
      lagrangian_ =
          lagrangian_ + Polynomial(fmt::format("mx{}", l)) * gap.x + Polynomial(fmt::format("my{}", l)) * gap.y;
    }
    if (assemblies) return out_;
    if (std::string why = add_loads(); !why.empty()) return {{}, why};
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      if (std::string why = add_element(scene_.elements[e], e); !why.empty()) return {{}, why};
    }
    for (int k = 0; k < layout_.kept; ++k) add(lagrangian_.by_angle(cosine(k), sine(k)));
    return out_;
  }

 private:
  void add(const Polynomial& equation) { out_.equations.push_back(equation.text()); }

  Place between(int body_a, const Vec2& a, int body_b, const Vec2& b) const {
    return place(PhasorSum<double>(phasors_, layout_.path(body_a, a, body_b, b)));
  }

  std::string add_loads() {
    if (!scene_.torques.empty()) return "it has a torque";
    const auto add_force = [&](int body, const Vec2& at, const Vec2& force) {
      const Place p = between(0, {}, body, at);
      lagrangian_ = lagrangian_ + -force.x * p.x + -force.y * p.y;
    };
    for (const Force& force : scene_.forces) {
      if (force.follows >= 0) return "a force follows a body";
      add_force(force.at.body, scene_.local(force.at), force.vector);
    }
    for (std::size_t b = 1; b < scene_.bodies.size(); ++b) {
      const Body& body = scene_.bodies[b];
      if (body.mass > 0.0) add_force(static_cast<int>(b), body.center, body.mass * scene_.gravity);
    }
    return {};
  }

  std::string add_element(const Element& element, std::size_t number) {
    if (!stores_energy(element.law)) return {};
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    if (spring == nullptr || spring->acts != LinearSpring::Acts::both)
      return "it has a " + element.family() + " that is not linear";
    if (element.on.kind != Measure::Kind::distance) return "a spring acts on something else than a distance";
    const Place d =
        between(element.on.a.body, scene_.local(element.on.a), element.on.b.body, scene_.local(element.on.b));
    const Polynomial square = d.x * d.x + d.y * d.y;
    if (spring->free_length == 0.0) {
      lagrangian_ = lagrangian_ + 0.5 * spring->stiffness * square;
      return {};
    }
    const Polynomial length(fmt::format("l{}", number)), tension(fmt::format("t{}", number));
    lagrangian_ = lagrangian_ + 0.5 * tension * square;
    add(length * length + -1.0 * square);
    add(tension * length + -spring->stiffness * (length + Polynomial(-spring->free_length)));
    return {};
  }

  const Layout& layout_;
  const Phasors<double>& phasors_;
  Scene scene_;
  Polynomial lagrangian_;
  Polynomials out_;
};

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "poise-phc-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

using Solution = std::map<std::string, std::pair<double, double>>;

// Solutions as phc writes them: lines "name :  real  imaginary" between "the solution for t :" and "== err : ...",
// which ends with the residual.
std::vector<Solution> read_solutions(const fs::path& file) {
  std::ifstream in(file);
  std::vector<Solution> out;
  bool within = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("the solution for t")) {
      out.emplace_back();
      within = true;
    } else if (line.starts_with("== err")) {
      within = false;
      const std::size_t at = line.rfind("res :");
      if (at == std::string::npos || !(std::stod(line.substr(at + 5)) < 1e-8)) out.pop_back();
    } else if (within) {
      std::istringstream words(line);
      std::string name, colon;
      std::pair<double, double> value;
      if (words >> name >> colon >> value.first >> value.second) out.back()[name] = value;
    }
  }
  return out;
}

// Real solutions are exactly so but for rounding; complex ones come in pairs that are this near only next to a fold.
bool is_real(const Solution& solution) {
  for (const auto& [name, value] : solution) {
    if (!(std::abs(value.second) <= 1e-8 * (1.0 + std::abs(value.first)))) return false;
    if (name.starts_with("l") && !(value.first > 0.0)) return false;
  }
  return true;
}

}  // namespace

bool has_phc() { return std::system("command -v phc > /dev/null") == 0; }

Polynomials polynomials(const StaticModel& model, bool assemblies) { return Writer(model).write(assemblies); }

PhcSolutions solve_with_phc(const StaticModel& model, bool assemblies, int seconds) {
  const Polynomials system = polynomials(model, assemblies);
  if (!system.why_not.empty()) throw std::invalid_argument("no polynomials: " + system.why_not);
  const Folder folder;
  {
    std::ofstream file(folder.path() / "system");
    file << system.equations.size() << '\n';
    for (const std::string& equation : system.equations) file << equation << ";\n";
  }
  // phc appends the solutions to its input.
  const auto begin = std::chrono::steady_clock::now();
  const std::string command =
      fmt::format("cd '{}' && timeout {} phc -b system output > log 2>&1", folder.path().string(), seconds);
  PhcSolutions out;
  out.ran = std::system(command.c_str()) == 0;
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!out.ran) return out;
  const std::vector<Solution> solutions = read_solutions(folder.path() / "system");
  out.complex = static_cast<int>(solutions.size());
  for (const Solution& solution : solutions) {
    if (!is_real(solution)) continue;
    std::vector<double>& x = out.real.emplace_back();
    for (int k = 0; k < model.layout().kept; ++k) {
      x.push_back(std::atan2(solution.at(sine(k)).first, solution.at(cosine(k)).first));
    }
  }
  return out;
}

}  // namespace poise::test
