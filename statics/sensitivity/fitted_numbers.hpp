#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "model/dimension.hpp"
#include "model/scene.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {

/// Numbers of a scene as far as a fit knows them, SI: estimates p, the covariance V of their errors, and what the
/// readings of the fit leave open.
struct FittedNumbers {
  struct Number {
    /// An estimate that ended at an end of its range: the truth lies there or on the inner side.
    enum class Bound { none, least, most };
    enum class Origin {
      estimated,
      taken,   ///< as known by the fit, with an uncertainty
      sensor,  ///< a number of a sensor: of no scene
      several  ///< estimated with other values in other runs
    };
    std::string name;  ///< as the fit calls it: "k"
    std::string path;  ///< of the scene: "spring.oil.stiffness"
    Dimension dimension{};
    double value = 0.0;
    double unit = 1.0;  ///< SI value of the unit in which it is written
    Bound bound = Bound::none;
    Origin origin = Origin::estimated;
  };
  /// A direction of the numbers along which the readings do not say where they are.
  struct Direction {
    Eigen::VectorXd part;   ///< change of each number
    Eigen::VectorXd error;  ///< bounds of the errors of these parts
    std::string words;      ///< the direction, one sentence
  };

  std::string file;
  std::vector<Number> numbers;
  Eigen::MatrixXd covariance;  ///< of all, as if none were at a bound; nothing along the directions
  double degrees = std::numeric_limits<double>::infinity();  ///< degrees of freedom that it is estimated with
  /// Covariance of errors that scatter from run to run, where the fit found that they do, with the degrees of freedom
  /// of each number, NaN where they are not known: of both variances the larger counts where both are known.
  std::optional<Eigen::MatrixXd> by_runs;
  std::vector<double> degrees_by_runs;
  std::vector<Direction> unknown;
  std::vector<std::string> notes;  ///< what a reader must know of the fit, one sentence each

  /// Those that a scene has. Left out are numbers of sensors, numbers that differ from run to run, and those that the
  /// fit took as known where the scene has another value. Throws InputError where the scene lacks an estimated one.
  FittedNumbers of(const Scene& scene) const;
  /// Puts the values into a scene, moved by so much, SI. Throws InputError where the scene lacks a number.
  void put_into(Scene& scene, const Eigen::VectorXd& moved = {}) const;
  /// Leaves out a number that has a value of another origin.
  void leave_out(std::size_t number);
  /// L of V = L L^T, one column for each axis, in which numbers at bounds are held there; of V and by_runs the least
  /// that is at least both.
  Eigen::MatrixXd root() const;
  /// One column for each number at a bound: by how much all numbers move, to the inner side, where it moves by its
  /// standard deviation and the others follow.
  Eigen::MatrixXd inwards() const;
  /// Numbers, moved by parts of a standard deviation to both sides along each axis of V, at which predict() needs the
  /// results for second order: none of numbers at bounds is moved.
  std::vector<Eigen::VectorXd> moves() const;
};

/// A result f and its derivatives by the numbers of a fit, SI.
struct ResultGradient {
  double value = 0.0;
  std::string why;             ///< one sentence; it has no derivatives
  Eigen::VectorXd by;          ///< by each of FittedNumbers::numbers
  Eigen::VectorXd rounding{};  ///< these are known to within so much
};
/// That of a quantity; 0 by numbers that statics does not use.
ResultGradient gradient_by(const FittedNumbers& numbers, const QuantitySensitivity& quantity);

/// What a fit says of a result f, SI. With g its derivatives and u Student's t at 97.5 %:
///
///   first order    f(p) +- u sqrt(g^T V g)
///   second order   mean f(p) + 1/2 tr M and variance g^T V g + 1/2 tr M^2,  M = L^T H L,  V = L L^T,  H the second
///                  derivatives; ends at the mean + sigma (+-u + (u^2 - 1) skewness / 6), from the third cumulant
///                  3 a^T M a + tr M^3 with a = L^T g (E. A. Cornish, R. A. Fisher, 1938)
///
/// A number at its bound lies there or on the inner side, and the others follow it along d = V e / (e^T V e). On the
/// side to which g . d moves the result the interval has the V of a free number, on the other that of a known one.
///
/// There is no interval where a direction d that the readings leave open moves the result: where |g . d| is more than
/// the rounding of g and of d explain.
struct PredictedResult {
  std::string name;
  Dimension dimension{};
  double value = 0.0;
  std::string why;           ///< one sentence; there are no derivatives
  std::string undetermined;  ///< one sentence: the direction that moves it, which the readings do not determine
  double sigma = 0.0;        ///< first order, with numbers at bounds free
  double first_low = 0.0, first_high = 0.0;
  bool has_second = false;
  double shift = 0.0, second_sigma = 0.0;  ///< 1/2 tr M, and the root of that variance
  double low = 0.0, high = 0.0;            ///< 95 % interval: by second order where there is one
  bool is_linear = true;                   ///< second order moves no end by more than `linear_to` of sigma
  bool is_one_sided = false;               ///< a number at its bound moves it: the interval is wider on one side
  struct Share {
    std::size_t number = 0;  ///< of FittedNumbers::numbers
    double share = 0.0;      ///< g_i (V g)_i / g^T V g: they add up to 1; negative where errors cancel
    double slope = 0.0;      ///< g_i
  };
  std::vector<Share> shares;  ///< of the numbers that move it, the largest first

  bool is_known() const { return why.empty() && undetermined.empty(); }
  static constexpr double linear_to = 0.05;
};

/// `moved`: the same result at numbers.moves(), in their order; empty, or with a reason in one of them: first order.
PredictedResult predict(const FittedNumbers& numbers, const std::string& name, const Dimension& dimension,
                        const ResultGradient& result, const std::vector<ResultGradient>& moved = {});

/// Predictions of quantities in an equilibrium of a model whose scene has the numbers of the fit; of loads at folds by
/// predict_folds(). Throws InputError as sensitivities() does.
std::vector<PredictedResult> predict(const FittedNumbers& numbers, const StaticModel& model,
                                     const Equilibrium& equilibrium, const std::vector<SoughtQuantity>& of,
                                     const SensitivityOptions& options = {});

/// The same at a point of a path, at scaled coordinates x with the stops `active` acting: see sensitivities_near().
std::vector<PredictedResult> predict_near(const FittedNumbers& numbers, const StaticModel& model,
                                          const std::vector<double>& x, const std::vector<int>& active,
                                          const std::vector<SoughtQuantity>& of);

/// Predictions of the varied number at the folds of a path of such a scene, in the order of Path::events; `options` are
/// those of the path, which is followed anew for second order.
std::vector<PredictedResult> predict_folds(const FittedNumbers& numbers, const VariedScene& varied, const Path& found,
                                           const PathOptions& options);

}  // namespace poise
