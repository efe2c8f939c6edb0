// Equilibria of many variants of a scene at once.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "app/commands/options.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"
#include "python/module/interrupt_scope.hpp"
#include "python/module/listener.hpp"
#include "python/module/lock.hpp"
#include "python/module/many_numbers.hpp"
#include "python/module/scene_object.hpp"
#include "statics/many/solve_many.hpp"

namespace poise::python {
namespace {

using SharedSolutions = std::shared_ptr<const ManySolutions>;

/// An array over the memory of what was found, which it keeps alive.
template <class T>
py::array array_of(const std::vector<T>& values, std::vector<py::ssize_t> shape, const SharedSolutions& owner) {
  // Marks of a byte are whole numbers for NumPy.
  using Shown = std::conditional_t<std::is_floating_point_v<T>, T, std::uint8_t>;
  static_assert(sizeof(Shown) == sizeof(T));
  const py::capsule keep(new SharedSolutions(owner), [](void* kept) { delete static_cast<SharedSolutions*>(kept); });
  return py::array_t<Shown>(std::move(shape), reinterpret_cast<const Shown*>(values.data()), keep);
}

py::list quantity_units(const ManySolutions& found, const Units& units) {
  py::list out;
  for (const SoughtQuantity& one : found.quantities) {
    out.append(py::make_tuple(text_of(one.name), text_of(one.dimension.unit_name(units)), one.dimension.unit(units)));
  }
  return out;
}

/// What was found, in SI; names and units besides.
py::dict solutions_in_python(const SharedSolutions& found, const Units& units) {
  const auto variants = static_cast<py::ssize_t>(found->variants);
  const auto coordinates = static_cast<py::ssize_t>(found->coordinates.size());
  const auto quantities = static_cast<py::ssize_t>(found->quantities.size());
  py::list names, notes;
  for (std::size_t i = 0; i < found->coordinates.size(); ++i) {
    names.append(py::make_tuple(text_of(found->coordinates[i]),
                                text_of(found->is_angle[i] != 0 ? "rad" : units.length_name),
                                found->is_angle[i] != 0 ? 1.0 : units.length));
  }
  for (const VariantNote& note : found->notes) notes.append(py::make_tuple(note.variant, text_of(note.why)));
  py::dict out;
  out["coordinates"] = names;
  out["q"] = array_of(found->q, {variants, coordinates}, found);
  out["quantities"] = quantity_units(*found, units);
  out["values"] = array_of(found->values, {variants, quantities}, found);
  out["by"] = array_of(found->solved_by, {variants}, found);
  out["proofs"] = array_of(found->proofs, {variants}, found);
  out["radius"] = array_of(found->radius, {variants}, found);
  out["notes"] = notes;
  out["simd"] = to_string(found->simd);
  out["why_no_lanes"] = text_of(found->why_no_lanes);
  out["interrupted"] = found->interrupted;
  return out;
}

py::dict solve_variants(const std::shared_ptr<const SceneObject>& scene, const ManyNumbers& numbers,
                        const std::vector<std::string>& of, std::size_t prove_all_or,
                        const std::optional<double>& seconds, int jobs, const py::object& progress) {
  constexpr std::size_t all = ~std::size_t{0};
  std::vector<ManyValues> varied;
  std::size_t variants = 1;
  for (const auto& [name, values] : numbers) {
    const auto size = static_cast<std::size_t>(values.size());
    varied.push_back({name, std::span(values.data(), size)});
    variants = std::max(variants, size);
  }
  std::atomic<bool> interrupt = false;
  ManyOptions options;
  options.quantities = of;
  options.prove = prove_all_or == all ? ManyOptions::Prove::all
                  : prove_all_or != 0 ? ManyOptions::Prove::sample
                                      : ManyOptions::Prove::none;
  options.sample = prove_all_or == all ? 0 : prove_all_or;
  options.solve.certificate = app::read_proof(seconds);
  options.solve.interrupt = &interrupt;
  options.jobs = app::read_jobs(jobs);
  Listener listener(progress, interrupt);
  if (listener.is_wanted()) {
    options.progress = [&](std::size_t done) { listener(variants_done(done, variants)); };
  }
  SharedSolutions found;
  const InterruptScope scope(interrupt);
  {
    const WithoutLock others;
    found = std::make_shared<const ManySolutions>(solve_many(*scene->scene(), varied, options));
  }
  scope.hand_back_unless(found->interrupted);
  listener.rethrow();
  return solutions_in_python(found, scene->scene()->units);
}

}  // namespace

void bind_many(py::module_& m) {
  m.def("solve_many", solve_variants, py::arg("scene"), py::arg("numbers"), py::arg("of"), py::arg("samples"),
        py::arg("proof_seconds"), py::arg("jobs"), py::arg("progress"));
  m.attr("every_sample") = ~std::size_t{0};
}

}  // namespace poise::python
