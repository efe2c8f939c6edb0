#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/many/simd.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// The values of one number of a scene in many variants.
struct ManyValues {
  std::string name;                ///< a path as for set_value(): "load.P", "point.link.B.x"
  std::span<const double> values;  ///< in the scene's own units: one for each variant, or one for all
};

/// How a variant was solved.
enum class SolvedBy : std::uint8_t {
  nothing,  ///< an interrupt came before its turn
  lanes,    ///< by Newton's method, together with others
  search,   ///< by solve() alone: a certificate confirms it, or free bodies where a proof would take too long
  none      ///< neither found an equilibrium; `notes` has the reasons of the first ones
};

/// "not solved", "in lanes", "by search", "not found".
std::string to_string(SolvedBy by);

/// What is known of the equilibrium of a variant.
enum class ProofOf : std::uint8_t {
  not_asked,
  proved,     ///< exactly one equilibrium lies within the radius of the coordinates (Certificate::confirmed())
  not_proved  ///< it was asked for, and there is none, or no equilibrium was found
};

struct ManyOptions {
  /// Quantities of each variant, by name (find_quantity()), in the order of ManySolutions::values.
  std::vector<std::string> quantities{};
  /// Also x, y and angle of every body of each variant.
  bool poses = false;
  enum class Prove {
    none,
    sample,  ///< `sample` variants, evenly spread over the indices
    all
  };
  Prove prove = Prove::none;
  std::size_t sample = 0;
  /// What lanes do not solve is searched with these, Seek::settle by virtual work; their interrupt ends everything.
  SolveOptions solve{};
  int jobs = 0;                                      ///< threads; 0: as many as there are cores
  std::function<void(std::size_t done)> progress{};  ///< variants; by one thread at a time
  /// Instructions; simd_to_use() if not given.
  std::optional<Simd> simd{};
};

/// Why a variant has no equilibrium, or a quantity of it no value.
struct VariantNote {
  std::size_t variant = 0;
  std::string why;  ///< one sentence
};

/// All arrays are flat, variant by variant: entry k of variant v is at [v * width + k]. What is not known is not a
/// number (NaN).
struct ManySolutions {
  std::size_t variants = 0;
  std::vector<SolvedBy> solved_by;       ///< one per variant
  std::vector<std::string> coordinates;  ///< of the mechanism: "arm" of an angle, ...
  std::vector<char> is_angle;            ///< of each of these: rad, else m
  std::vector<double> q;                 ///< variants x coordinates: rad or m, of a place in the world from its origin
  std::vector<SoughtQuantity> quantities;
  std::vector<double> values;       ///< variants x quantities, SI
  std::vector<std::string> bodies;  ///< with ManyOptions::poses: of the scene, without the ground
  std::vector<double> poses;        ///< with ManyOptions::poses: variants x bodies x (x, y, angle): m, m, rad
  std::vector<ProofOf> proofs;      ///< one per variant
  std::vector<double> radius;       ///< one per variant: of its proof, rad or mechanism sizes
  std::vector<VariantNote> notes;   ///< at most most_notes, of the variants of lowest index
  static constexpr std::size_t most_notes = 1000;

  std::size_t in_lanes = 0, by_search = 0, not_found = 0;  ///< how many variants were solved how
  std::size_t proved = 0, not_proved = 0;
  Simd simd = Simd::plain;   ///< the instructions used in lanes
  std::string why_no_lanes;  ///< one sentence where no variant can be solved in lanes; empty where they can
  bool interrupted = false;
};

/// Equilibria of many variants of one scene, which differ in the numbers given and in nothing else; each is the one
/// that solve() finds for it alone: in which the mechanism settles from the scene's start.
///
/// The scene is compiled once to a straight-line program for the steps of Newton's method on its equations of virtual
/// work, which runs over many variants at a time (statics/many/lanes.hpp). With the coordinates parted into dependent
/// and independent ones, J = (J_u, J_v) of closures and acting stops, F = dV/dq, y = -J_u^-T F_u,
/// N = (-J_u^-1 J_v, 1), and the tangent K at y, a step is
///
///   d = p + N d_v,   p = (-J_u^-1 c, 0),   (N^T K N) d_v = -(F_v + J_v^T y) - N^T K p,
///
/// taken until max |d| <= 1e-9 in scaled coordinates, as by Newton of solve(), the last one included. A variant is
/// taken from the lanes where
///   - no step is longer than 0.5, and each at most a quarter of the one before: then its solution is the only one
///     nearby (P. Deuflhard, "Newton Methods for Nonlinear Problems", 2011, section 2.1: an estimate, no proof),
///   - all pivots of N^T K N are positive at the start and at the end: no equilibrium, and none that is unstable, lies
///     on the way of the settling mechanism there,
///   - no pivot is less than a thousandth of that of the scene as it is,
///   - the stops that act there act here, are touched by the start, and press at start and end; all others are free,
///   - every curve and profile is read in the piece in which the scene as it is reads it.
/// Every other variant is solved by solve(), and marked SolvedBy::search. Where the scene as it is settles elsewhere
/// than Newton's method leads from its start, and where it has more than 64 coordinates, all are (why_no_lanes).
///
/// A variant's result depends on its numbers alone, not on the others nor on the number of threads. Between the sets of
/// instructions results differ by rounding: q by less than 1e-12 where the equilibrium is well conditioned. Sines and
/// cosines are SLEEF's with at most 1.0 units in the last place of error, those of plain doubles the standard
/// library's.
///
/// Throws InputError, one line, for an unknown name (with the nearest), a name given twice,
/// arrays of different lengths, and a value that the number cannot have, with the index of
/// the variant. Numerical failure is a mark, never an exception.
ManySolutions solve_many(const Scene& scene, const std::vector<ManyValues>& numbers, const ManyOptions& options = {});

}  // namespace poise
