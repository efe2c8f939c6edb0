#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// What is known of a set of equilibria.
enum class Claim {
  complete,    ///< proved: these are all
  incomplete,  ///< proved: there are no others outside the undecided boxes
  sampled      ///< these were found; nothing is said of others
};

/// "complete", "incomplete", "sampled".
std::string to_string(Claim claim);

struct AllEquilibriaOptions {
  /// Boxes allowed for the proof, each of them times the square of the number of coordinates: about a minute.
  double work = 6e7;
  std::optional<double> seconds{};   ///< time allowed in place of `work`, for a person who waits; 0: no proof is tried
  int jobs = 1;                      ///< threads
  int starts = 1000;                 ///< random starts, where nothing is proved
  std::uint64_t seed = 1;            ///< of these
  bool assemblies = false;           ///< positions alone: all ways to close the loops; the scene must leave no freedom
  bool settling = true;              ///< also find which one the start settles into, and the barriers
  CertificateOptions certificate{};  ///< of each equilibrium
  const std::atomic<bool>* interrupt = nullptr;
  /// Called now and then with the decided share of the volume, in [0, 1], from any thread but never by two at once.
  std::function<void(double)> progress{};
  /// Called after every random start with the number of those that have ended, by one thread at a time.
  std::function<void(int)> searched{};
};

/// A box in which it is not known, or not of all, whether there are equilibria, and how many.
struct UndecidedBox {
  std::vector<double> lower, upper;  ///< scaled coordinates
  bool neutral = false;              ///< equilibria within it form a curve or more
  std::string why;                   ///< one sentence
  double joint_force = 0.0;          ///< of a singular pose: that equilibria in it need at least, times the loads
};

inline constexpr const char* neutral_curve = "equilibria in it are neutral: they form a curve";

/// All equilibria of a mechanism, as far as they are known.
struct EquilibriumSet {
  Claim claim = Claim::sampled;
  std::string statement;                ///< one sentence: the claim, and why it is no stronger
  std::vector<Equilibrium> equilibria;  ///< by energy, the lowest first
  std::vector<UndecidedBox> undecided;
  /// Around singular poses, in which the closures lose rank: an equilibrium in one of these needs a joint force of more
  /// than `joint_force` times the loads, 1e4 or more. The claim is about all others.
  std::vector<UndecidedBox> singular;
  /// Where it is given, the claim is not about equilibria in which an angle that springs or stops act on is further
  /// from the closed start, rad: it is not known which turns of the loops motion leads to, and there may be ever more.
  std::optional<double> angles_within{};
  int starts = 0;    ///< that were used; 0 where it is proved
  int met_once = 0;  ///< equilibria that one start alone led to: where there are some, more are likely
  bool interrupted = false;
  double decided = 0.0;       ///< share of the volume, in [0, 1]
  long boxes = 0;             ///< that were examined
  double microseconds = 0.0;  ///< of the proof and the search
  /// Index of the equilibrium in which `solve` settles from the scene's start (with `assemblies`: the way in which the
  /// start closes), or -1, and then why there is none.
  int settles_into = -1;
  std::string settles_nowhere;
  /// The lowest barrier on the way from one stable equilibrium to another that is its neighbour: released from the
  /// unstable equilibrium `over`, which has one unstable direction, the mechanism settles in `from` on one side and in
  /// `to` on the other. Each pair is given both ways. None with follower loads, which have no potential.
  struct Barrier {
    int from = -1, to = -1;  ///< indices into equilibria
    int over = -1;           ///< the unstable equilibrium on the way, index into equilibria
    double energy = 0.0;     ///< V(over) - V(from), J
  };
  std::vector<Barrier> barriers;
  /// Coordinates of each equilibrium that are arbitrary, proved: loads balance each other in every position of these,
  /// and the claim is about all of them.
  struct Balanced {
    std::vector<std::string> coordinates;  ///< they change together
    bool exact = false;                    ///< with the numbers as they are written; else to their rounding
    double effort = 0.0;    ///< where it is not exact: bound of what acts along them in every position, N m or N
    bool is_force = false;  ///< it is a force, not a torque
    /// In loops: coordinates that keep their angle meanwhile. The claim is then about the branch of closed poses on
    /// which they do, but for its change points; equilibria on other branches are single ones.
    std::vector<std::string> keeping{};
    double gap = 0.0;  ///< in loops that close to rounding only: bound of what is open in every position, m
  };
  std::vector<Balanced> balanced{};
};

/// Finds all equilibria of the mechanism, in all its assembly modes, and says what is known of the set. Angles: every
/// equilibrium is given once modulo full turns, but where springs or stops on angles tell turns apart; of loops then
/// only the turns that motion leads to (statics/all_equilibria/private/loop_turns.hpp). Of a curve of neutral
/// equilibria one is given; where coordinates are balanced in every position
/// (statics/all_equilibria/private/neutral_motions.hpp) that with these where they start. A stop whose limits are equal
/// holds its measure. The result is the same for any number of jobs. Throws InputError as assemble(), and with
/// `assemblies` where the mechanism can still move.
EquilibriumSet all_equilibria(const StaticModel& model, const AllEquilibriaOptions& options = {});

/// The scene without gravity, loads, force elements and what follows from them: for assemblies, which are positions
/// alone. Joints and stops remain.
Scene positions_alone(Scene scene);

/// Whether it is one where the closures lose rank, as where a parallelogram lies flat, and branches of motion cross: no
/// load does work along any of them.
bool is_change_point(const Equilibrium& equilibrium);

}  // namespace poise
