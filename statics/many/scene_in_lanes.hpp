#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/parameters.hpp"
#include "model/varying_numbers.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/many/simd.hpp"
#include "statics/model/static_model.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// Where Newton's method begins in all lanes.
enum class LaneStart {
  scene,       ///< the scene's start: what it finds is where the mechanism settles
  equilibrium  ///< that of the scene as it is: what it finds is how that one continues
};

struct LaneOptions {
  LaneStart start = LaneStart::scene;
  /// Every one-way spring acts, or not, as in the scene as it is.
  bool keeps_sides = false;
  bool poses = false;  ///< x, y, angle of each body but the ground, before the quantities
  std::vector<SoughtQuantity> quantities{};
};

/// A scene some numbers of which vary, compiled to straight-line programs for many variants at once (solve_many.hpp has
/// the equations, and when a variant counts as solved).
class SceneInLanes {
 public:
  /// At most so many coordinates.
  static constexpr int most_coordinates = 64;

  /// `model` is compiled with room for what varies (VaryingNumbers), and at rest at `answer` with certificate; numbers
  /// are given times `factors` in the units of the scaled scene.
  SceneInLanes(const StaticModel& model, const Equilibrium& answer, const std::vector<ParameterRow>& rows,
               const std::vector<double>& factors, const LaneOptions& options);
  ~SceneInLanes();
  SceneInLanes(SceneInLanes&&) noexcept;
  SceneInLanes& operator=(SceneInLanes&&) noexcept;

  /// Why nothing can be solved in lanes, in one sentence; empty where it can.
  const std::string& why_not() const;
  /// Whether quantity k has values in lanes.
  bool has_value(std::size_t k) const;
  /// Numbers per variant: those of poses and quantities; of the latter those without values are left out.
  std::size_t values() const;
  std::size_t instructions() const;

  /// Memory of a thread.
  class Work {
   public:
    virtual ~Work() = default;
  };
  std::unique_ptr<Work> work(Simd simd) const;
  /// Variants that are solved together; a result does not depend on it.
  static std::size_t block(Simd simd);

  enum class Lane : std::uint8_t { not_solved = 0, solved = 1, with_values = 3 };
  /// Solves variants first .. first + count - 1, at most a block of them. numbers: one array per row, of which
  /// strides[k] is 1, or 0 where one value is for all. Writes count marks, and where solved the coordinates, rad and m,
  /// and values, SI.
  void solve(std::span<const double* const> numbers, std::span<const std::size_t> strides, std::size_t first,
             std::size_t count, Work& work, double* q, double* values, Lane* lanes) const;

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace poise
