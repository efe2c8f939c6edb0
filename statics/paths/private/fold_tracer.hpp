#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/fold_system.hpp"
#include "statics/paths/fold_curve.hpp"
#include "statics/paths/path_piece.hpp"
#include "statics/paths/varied_mechanism.hpp"

namespace poise {

/// Equilibria of a scene of which two numbers vary, p and q, on one piece: p and q are 0 and 1 at the ends of their
/// ranges.
class PieceOfPair final : public solvers::CurveFamily {
 public:
  /// `pair` must outlive this. `equalities`: independent closures.
  PieceOfPair(const VariedPair& pair, PathPiece piece, std::vector<int> equalities);

  const PathPiece& piece() const { return piece_; }
  const std::vector<int>& equalities() const { return equalities_; }
  solvers::Curve& first_varies(double q) override;
  solvers::Curve& second_varies(double p) override;

 private:
  // The curve while one number varies and the other rests, from 0 to 1.
  struct OneVaries {
    OneVaries(VariedScene scene, const PieceOfPair& of, double other_at);
    double at;
    VariedScene varied;
    VariedMechanism mechanism;
    solvers::Curve curve;
  };
  // Newton's method and what follows it ask for few values again and again.
  static constexpr std::size_t most_recent = 4;
  template <class Make>
  solvers::Curve& recall(std::deque<std::unique_ptr<OneVaries>>& recent, double at, Make make);

  const VariedPair& pair_;
  PathPiece piece_;
  std::vector<int> equalities_;
  std::deque<std::unique_ptr<OneVaries>> of_q_, of_p_;
};

/// Follows curves of folds on one piece each.
class FoldTracer {
 public:
  FoldTracer(const VariedPair& pair, const FoldCurveOptions& options, FoldCurve& out)
      : pair_(pair), options_(options), out_(out) {}

  /// What became of a point where path() met a fold or a branch point.
  enum class Start { traced, known, symmetric, failed };
  /// Appends the curve through it, followed both ways, unless it is on one already. `piece` and `equalities` as for
  /// PieceOfPair; p and q from 0 to 1; `y` one multiplier for each active row.
  Start trace_through(const PathPiece& piece, const std::vector<int>& equalities, const std::vector<double>& x,
                      const Eigen::VectorXd& y, double p, double q);

  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

 private:
  struct Piece {
    Piece(const VariedPair& pair, const PathPiece& piece, const std::vector<int>& equalities)
        : family(pair, piece, equalities), system(family) {}
    PieceOfPair family;
    solvers::FoldSystem system;
    std::vector<std::vector<solvers::FoldPlace>> traced;
  };
  struct Trace {
    std::vector<solvers::FoldPlace> places;
    struct Cusp {
      solvers::FoldPlace place;
      std::size_t behind;  // place
    };
    std::vector<Cusp> cusps;
    FoldBranch::End end = FoldBranch::End::range;
    std::string why;
  };
  struct Segment {
    solvers::FoldPlace a, b;
    double h;
  };

  class Walk;

  std::optional<solvers::FoldPlace> step(Piece& piece, const solvers::FoldPlace& here, double h,
                                         const Eigen::VectorXd* bend, double& badness);
  std::optional<solvers::FoldPlace> at(Piece& piece, const Segment& segment, double s);
  std::optional<solvers::FoldPlace> crossing_of(Piece& piece, const Segment& segment, const Eigen::VectorXd& place);
  void watch(Piece& piece, const Eigen::VectorXd& z, std::vector<double>& values);
  std::string said_of(const Piece& piece, std::size_t watched) const;
  std::string place_text(const Eigen::VectorXd& z) const;
  Eigen::VectorXd turned_towards(Piece& piece, const Eigen::VectorXd& z, const Eigen::VectorXd& other) const;
  bool is_known(Piece& piece, const Eigen::VectorXd& z);
  FoldPoint report(Piece& piece, const solvers::FoldPlace& place);
  FoldCusp report_cusp(Piece& piece, const solvers::FoldPlace& place);

  // SI; exactly the ends at 0 and 1.
  double first_value(const Eigen::VectorXd& z) const;
  double second_value(const Eigen::VectorXd& z) const;

  const VariedPair& pair_;
  const FoldCurveOptions& options_;
  FoldCurve& out_;
  std::map<PathPiece, std::unique_ptr<Piece>> pieces_;
  int angles_ = 0;
  bool symmetric_ = true;
  double energy_ = 1.0;
  int points_ = 0;
};

}  // namespace poise
