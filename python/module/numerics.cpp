// The equations of equilibrium, for solvers and programs of others.

#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "app/commands/options.hpp"
#include "model/input_error.hpp"
#include "model/named_item.hpp"
#include "model/nearest_name.hpp"
#include "python/module/arrays.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"
#include "python/module/lock.hpp"
#include "python/module/scene_object.hpp"
#include "python/module/system_object.hpp"
#include "statics/proof/certificate.hpp"

namespace poise::python {
namespace {

using SharedScene = std::shared_ptr<const SceneObject>;
using Shape = std::vector<py::ssize_t>;

/// Smaller systems are evaluated faster than the interpreter's lock is given away.
constexpr int most_with_lock = 60;

/// Calls `work(VirtualWork&)` on the system at x.
template <class Work>
void evaluate(SystemObject& system, const py::object& x, const Work& work) {
  const NumbersIn at(x, "x", {system.coordinates()});
  std::optional<WithoutLock> others;
  if (system.coordinates() > most_with_lock) others.emplace();
  const std::lock_guard lock(system.mutex());
  system.work().place(at.data());
  work(system.work());
}

/// A function of x alone.
template <class Member>
py::object at_x(SystemObject& system, const py::object& x, const py::object& out, const Shape& shape, Member member) {
  NumbersOut result(out, shape);
  evaluate(system, x, [&](VirtualWork& work) { (work.*member)(result.data()); });
  return result.object();
}

/// A function of x, or, where multipliers are given, another one of both.
template <class Plain, class With>
py::object at_x_and_y(SystemObject& system, const py::object& x, const py::object& multipliers, const py::object& out,
                      bool is_matrix, Plain plain, With with) {
  const bool has_multipliers = !multipliers.is_none();
  const py::ssize_t size = system.coordinates() + (has_multipliers ? system.rows() : 0);
  NumbersOut result(out, is_matrix ? Shape{size, size} : Shape{size});
  if (!has_multipliers) {
    evaluate(system, x, [&](VirtualWork& work) { (work.*plain)(result.data()); });
  } else {
    const NumbersIn y(multipliers, "multipliers", {system.rows()});
    evaluate(system, x, [&](VirtualWork& work) { (work.*with)(y.data(), result.data()); });
  }
  return result.object();
}

py::object hessian(SystemObject& system, const py::object& x, const py::object& multipliers, const py::object& out) {
  NumbersOut result(out, {system.coordinates(), system.coordinates()});
  std::optional<NumbersIn> y;
  if (!multipliers.is_none()) y.emplace(multipliers, "multipliers", Shape{system.rows()});
  evaluate(system, x, [&](VirtualWork& work) { work.hessian(y ? y->data() : nullptr, result.data()); });
  return result.object();
}

TouchedLimit touched_limit(const Scene& scene, const std::string& name, const std::optional<std::string>& side) {
  const NamedItem found = find_item(scene.stops, name, [](const Stop& stop) { return !stop.holds(); });
  if (!found) {
    throw InputError(fmt::format("touching: expected the name of a stop, found \"{}\"{}", name,
                                 did_you_mean_or_list(name, found.known)));
  }
  const Stop& stop = scene.stops[static_cast<std::size_t>(found.index)];
  const bool has_min = std::isfinite(stop.min), has_max = std::isfinite(stop.max);
  const bool at_max = side ? *side == "max" : !has_min;
  if (side ? *side != "min" && *side != "max" : has_min && has_max) {
    throw InputError(
        fmt::format("touching: expected \"min\" or \"max\" for the stop \"{}\", found {}; write "
                    "{{\"{}\": \"min\"}}",
                    name, side ? "\"" + *side + "\"" : std::string("none"), name));
  }
  if (!(at_max ? has_max : has_min)) {
    throw InputError(fmt::format("touching: the stop \"{}\" has no {}", name, at_max ? "max" : "min"));
  }
  return {found.index, at_max};
}

/// From {"name": "min"} or from names.
std::vector<TouchedLimit> touched_limits(const Scene& scene, const py::object& given) {
  const auto text = [](const py::handle& word) {
    if (py::isinstance<py::str>(word)) return utf8(word);
    throw InputError(fmt::format("touching: expected the name of a stop, found {}", shown(word)));
  };
  std::vector<TouchedLimit> out;
  if (py::hasattr(given, "items")) {
    for (const auto& [name, side] : py::dict(given)) {
      out.push_back(touched_limit(scene, text(name), py::isinstance<py::str>(side) ? text(side) : shown(side)));
    }
  } else if (py::isinstance<py::str>(given) || !py::hasattr(given, "__iter__")) {
    throw InputError(
        fmt::format("touching: expected a list of names of stops or a dictionary {{\"NAME\": \"min\"}}, "
                    "found {}",
                    shown(given)));
  } else {
    for (const py::handle& name : py::list(given)) out.push_back(touched_limit(scene, text(name), std::nullopt));
  }
  return out;
}

/// What certify() says of a place.
struct Proof {
  std::shared_ptr<const StaticModel> model;
  Certificate certificate;
};

std::shared_ptr<Proof> certify_place(const SharedScene& scene, const py::object& x, double farthest,
                                     const std::optional<double>& seconds) {
  const std::shared_ptr<const StaticModel> model = scene->model();
  const NumbersIn at(x, "x", {model->mechanism().coordinates()});
  if (!(farthest > 0.0 && std::isfinite(farthest))) {
    throw InputError(fmt::format("farthest: expected a number > 0, found {}", farthest));
  }
  CertificateOptions options;
  if (seconds) options = app::read_proof(*seconds);
  options.farthest = farthest;
  std::vector<double> scaled = in_scaled_units(*model, {at.data(), at.data() + at.size()});
  const WithoutLock others;
  return std::make_shared<Proof>(Proof{model, certify(*model, scaled, options)});
}

py::list coordinate_names(const SceneObject& scene) {
  const std::shared_ptr<const StaticModel> model = scene.model();
  const Layout& layout = model->layout();
  py::list out;
  for (int i = 0; i < layout.kept; ++i) {
    const std::string& unit = i < layout.angles ? "rad" : model->scene().units.length_name;
    out.append(py::make_tuple(text_of(layout.coordinates[static_cast<std::size_t>(i)].name), text_of(unit)));
  }
  return out;
}

/// Name and unit of each equation.
py::list equation_names(const SystemObject& system) {
  const VirtualWork& work = system.work();
  const StaticModel& model = work.model();
  const Units& units = model.scene().units;
  py::list out;
  for (const int v : work.independent()) {
    const bool is_angle = v < model.layout().angles;
    const std::string unit = is_angle ? units.force_name + " " + units.length_name : units.force_name;
    out.append(py::make_tuple(text_of(model.layout().coordinates[static_cast<std::size_t>(v)].name), text_of(unit)));
  }
  for (int row = 0; row < work.rows(); ++row) {
    out.append(py::make_tuple(text_of(work.row_names()[static_cast<std::size_t>(row)]),
                              text_of(work.row_is_angle(row) ? "rad" : units.length_name)));
  }
  return out;
}

py::list stop_rows(const SystemObject& system) {
  const StaticModel& model = system.work().model();
  const Units& units = model.scene().units;
  py::list out;
  for (const int s : system.work().stops()) {
    const Stop& stop = model.scene().stops[static_cast<std::size_t>(s)];
    const double unit = stop.on.is_angle() ? 1.0 : units.length;
    out.append(py::make_tuple(text_of(stop.name), stop.min / unit, stop.max / unit,
                              text_of(stop.on.is_angle() ? "rad" : units.length_name)));
  }
  return out;
}

py::array indices(const std::vector<int>& of) {
  return py::array_t<int>(static_cast<py::ssize_t>(of.size()), of.data());
}

constexpr const char* system_help =
    R"(The equations of equilibrium of a scene, for SciPy, CasADi, JAX and programs of your own.

x are the n coordinates: angles in rad, lengths in the scene's unit (`Scene.coordinates`). With the energy V,

    F(x) = dV/dx        minus the generalised forces; loads that follow a body have no V, but an F
    c(x) = 0            m rows that hold: joints that close loops, couplings, limits that are touched
    J(x) = dc/dx,       K(x, y) = dF/dx + sum_r y_r d2c_r/dx2

and the coordinates parted into m dependent ones u and n - m independent ones v (by pivoting J where the mechanism is
assembled), the directions in which it can move are N = (-J_u^-1 J_v; 1), and

    equations(x) = (N^T F; c) = (F_v + J_v^T y; c),  y = -J_u^-T F_u        n values, zero in equilibrium
    jacobian(x)  = (N^T K(x, y); J)                                         n x n, its derivative

With multipliers y given they are unknowns too: equations(x, y) = (F + J^T y; c) with n + m values, and jacobian(x, y) =
(K, J^T; J, 0). hessian(x) is dF/dx, hessian(x, y) is K(x, y).

Units: `force length` of the scene for work along angles, `force` along lengths, `rad` or `length` for c. Where J_u is
singular what needs its inverse is nan. Stops are rows apart (`stop_values`); those named in `touching` hold. Arrays are
float64; `out=` is filled and returned where it is given. Raises InputError for arrays of the wrong shape and for x that
is not finite.
)";

void bind_system(py::module_& m) {
  using System = SystemObject;
  const py::arg_v no_out = py::arg("out") = py::none();
  const py::arg_v no_multipliers = py::arg("multipliers") = py::none();
  py::class_<System, std::shared_ptr<System>>(m, "System", system_help)
      .def(
          "equations",
          [](System& self, const py::object& x, const py::object& y, const py::object& out) {
            return at_x_and_y(self, x, y, out, false, &VirtualWork::equations, &VirtualWork::equations_with);
          },
          py::arg("x"), no_multipliers, no_out,
          "(N^T F; c), shape (n,); with multipliers (F + J^T y; c), shape (n + m,).")
      .def(
          "jacobian",
          [](System& self, const py::object& x, const py::object& y, const py::object& out) {
            return at_x_and_y(self, x, y, out, true, &VirtualWork::jacobian, &VirtualWork::jacobian_with);
          },
          py::arg("x"), no_multipliers, no_out,
          "The derivative of equations(), shape (n, n); with multipliers by (x, y), shape (n + m, n + m).")
      .def("hessian", hessian, py::arg("x"), no_multipliers, no_out,
           "dF/dx, with multipliers K(x, y) = dF/dx + sum_r y_r d2c_r/dx2; shape (n, n). Symmetric where V is.")
      .def(
          "energy",
          [](System& self, const py::object& x) {
            double out = 0.0;
            evaluate(self, x, [&](VirtualWork& work) { out = work.energy(); });
            return out;
          },
          py::arg("x"), "V, force times length; nan with loads that follow a body, which have none.")
      .def(
          "gradient",
          [](System& self, const py::object& x, const py::object& out) {
            return at_x(self, x, out, {self.coordinates()}, &VirtualWork::gradient);
          },
          py::arg("x"), no_out, "F(x) = dV/dx, shape (n,).")
      .def(
          "closures",
          [](System& self, const py::object& x, const py::object& out) {
            return at_x(self, x, out, {self.rows()}, &VirtualWork::closures);
          },
          py::arg("x"), no_out, "c(x), shape (m,).")
      .def(
          "closure_jacobian",
          [](System& self, const py::object& x, const py::object& out) {
            return at_x(self, x, out, {self.rows(), self.coordinates()}, &VirtualWork::closure_jacobian);
          },
          py::arg("x"), no_out, "J = dc/dx, shape (m, n).")
      .def(
          "multipliers",
          [](System& self, const py::object& x, const py::object& out) {
            return at_x(self, x, out, {self.rows()}, &VirtualWork::multipliers);
          },
          py::arg("x"), no_out, "y = -J_u^-T F_u, shape (m,): forces that keep the rows c, force or force length.")
      .def(
          "directions",
          [](System& self, const py::object& x, const py::object& out) {
            return at_x(self, x, out, {self.coordinates(), self.coordinates() - self.rows()}, &VirtualWork::directions);
          },
          py::arg("x"), no_out, "N, shape (n, n - m): J N = 0.")
      .def(
          "stop_values",
          [](System& self, const py::object& x, const py::object& out) {
            return at_x(self, x, out, {self.stops()}, &VirtualWork::stop_values);
          },
          py::arg("x"), no_out, "What each of `stops` limits, shape (stops,): rad or length.")
      .def(
          "stop_jacobian",
          [](System& self, const py::object& x, const py::object& out) {
            return at_x(self, x, out, {self.stops(), self.coordinates()}, &VirtualWork::stop_jacobian);
          },
          py::arg("x"), no_out, "Its derivative, shape (stops, n).")
      .def_property_readonly(
          "start",
          [](const System& self) {
            const std::vector<double>& start = self.work().start();
            return py::array_t<double>(static_cast<py::ssize_t>(start.size()), start.data());
          },
          "x where the mechanism is assembled from its start, shape (n,).")
      .def_property_readonly(
          "independent", [](const System& self) { return indices(self.work().independent()); },
          "Indices of the independent coordinates v, in the order of the equations.")
      .def_property_readonly(
          "dependent", [](const System& self) { return indices(self.work().dependent()); },
          "Indices of the dependent coordinates u.")
      .def_property_readonly("names", equation_names, "(name, unit) of each of the n equations.")
      .def_property_readonly("stops", stop_rows, "(name, min, max, unit) of each stop.");
}

void bind_proof(py::module_& m) {
  py::class_<Proof, std::shared_ptr<Proof>>(m, "Certificate", "What certify() says of a place (docs/certificate.md).")
      .def_property_readonly(
          "proved", [](const Proof& self) { return self.certificate.confirmed(); },
          "An equilibrium is known to exist near the place, and what is said of it is proved.")
      .def("__bool__", [](const Proof& self) { return self.certificate.confirmed(); })
      .def_property_readonly(
          "outcome", [](const Proof& self) { return to_string(self.certificate.outcome); },
          "proved, neutral, degenerate, no equilibrium, not proved (docs/certificate.md).")
      .def_property_readonly(
          "statement", [](const Proof& self) { return text_of(self.certificate.statement); }, "One sentence.")
      .def("__repr__", [](const Proof& self) { return text_of(self.certificate.statement); })
      .def_property_readonly(
          "x",
          [](const Proof& self) -> py::object {
            if (!self.certificate.confirmed()) return py::none();
            const std::vector<double> x = in_scene_units(*self.model, self.certificate.x);
            return py::array_t<double>(static_cast<py::ssize_t>(x.size()), x.data());
          },
          "The middle of the enclosure, shape (n,), in the units of Scene.coordinates; None where nothing is proved.")
      .def_property_readonly(
          "radius",
          [](const Proof& self) {
            return self.certificate.confirmed() ? std::optional(self.certificate.radius) : std::nullopt;
          },
          "How close every coordinate of the equilibrium is to x, rad or sizes of the mechanism; None where nothing is "
          "proved.")
      .def_property_readonly(
          "radii",
          [](const Proof& self) -> py::object {
            if (!self.certificate.confirmed()) return py::none();
            const std::vector<double> radii =
                in_scene_units(*self.model, std::vector<double>(self.certificate.x.size(), self.certificate.radius));
            return py::array_t<double>(static_cast<py::ssize_t>(radii.size()), radii.data());
          },
          "The same for each coordinate in its own unit, shape (n,).")
      .def_property_readonly(
          "moved",
          [](const Proof& self) {
            return self.certificate.confirmed() ? std::optional(self.certificate.moved) : std::nullopt;
          },
          "The largest distance of a coordinate from the place given to x, rad or sizes of the mechanism.")
      .def_property_readonly(
          "stability",
          [](const Proof& self) {
            return self.certificate.confirmed() ? std::optional(to_string(self.certificate.stability)) : std::nullopt;
          },
          "stable, unstable, neutral or unknown; None where nothing is proved.")
      .def_property_readonly(
          "unstable_directions",
          [](const Proof& self) {
            return self.certificate.confirmed() ? std::optional(self.certificate.unstable_directions) : std::nullopt;
          },
          "In how many directions the equilibrium is unstable; None where nothing is proved.")
      .def_property_readonly(
          "touching",
          [](const Proof& self) {
            return self.certificate.confirmed()
                       ? touching_names(*self.model, self.certificate.active_stops, self.certificate.x)
                       : py::dict();
          },
          "The stops that act there, and at which limit: {\"over_centre\": \"min\"}.");
}

}  // namespace

void bind_numerics(py::module_& m) {
  bind_system(m);
  bind_proof(m);
  m.def("system", [](const SharedScene& scene, const py::object& touching) {
    if (touching.is_none()) return scene->system();
    std::vector<TouchedLimit> limits = touched_limits(*scene->scene(), touching);
    const WithoutLock others;
    return std::make_shared<SystemObject>(scene->model(), std::move(limits));
  });
  m.def(
      "shown", [](const py::object& given) { return text_of(shown(given)); }, py::arg("given"));
  m.def("coordinates", [](const SharedScene& scene) { return coordinate_names(*scene); });
  m.def("certify", certify_place, py::arg("scene"), py::arg("x"), py::arg("farthest"), py::arg("proof_seconds"));
}

}  // namespace poise::python
