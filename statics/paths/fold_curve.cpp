#include "statics/paths/fold_curve.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "statics/model/curvature.hpp"
#include "statics/paths/private/event_accuracy.hpp"
#include "statics/paths/private/fold_tracer.hpp"

namespace poise {
namespace {

bool changes_pieces(const PathEvent& event) {
  return event.kind == PathEvent::Kind::stop || event.kind == PathEvent::Kind::slack;
}

class FoldFinder {
 public:
  FoldFinder(const VariedPair& pair, const FoldCurveOptions& options, FoldCurve& out)
      : pair_(pair), options_(options), out_(out), tracer_(pair_, options, out) {}

  void run() {
    const auto model = pair_.model_at(pair_.first().generic(), pair_.second().generic());
    const int size = model->mechanism().coordinates() + model->mechanism().equalities();
    if (size > solvers::Curve::spectrum_limit) {
      out_.status = FoldCurve::Status::too_large;
      out_.why = fmt::format("curves of folds are computed up to {} coordinates and closures, there are {}",
                             solvers::Curve::spectrum_limit, size);
      return;
    }
    const int last = std::max(2, options_.slices) - 1;
    for (const bool first_varies : {true, false}) {
      for (int k = 0; k <= last; ++k) {
        // The ends before the values between them: curves that cross the whole range begin there.
        const int place = k == 0 ? 0 : k == 1 ? last : k - 1;
        if (tracer_.interrupted() || full()) break;
        look(first_varies, static_cast<double>(place) / last);
      }
    }
    conclude(2 * (last + 1));
  }

 private:
  bool full() const {
    return std::any_of(out_.curves.begin(), out_.curves.end(), [](const FoldBranch& curve) {
      return curve.end[0] == FoldBranch::End::limit || curve.end[1] == FoldBranch::End::limit;
    });
  }

  // Looks for folds of one number while the other rests, from 0 to 1.
  void look(bool first_varies, double other_at) {
    const VariedScene& other = first_varies ? pair_.second() : pair_.first();
    const double value = other.value_at(other_at);
    const VariedScene varied = first_varies ? pair_.first_at(value) : pair_.second_at(value);
    PathOptions along;
    along.from = options_.from;
    along.branches = true;
    along.certify = false;
    along.interrupt = options_.interrupt;
    Path found;
    try {
      found = path(varied, along);
    } catch (const InputError& error) {
      // The mechanism cannot be assembled there; it can be elsewhere, or fold_curve() says so.
      found.status = Path::Status::no_start;
      found.why = error.what();
    }
    if (found.status == Path::Status::no_start) {
      ++out_.slices_without_start;
      why_not_ = found.why;
    }
    for (std::size_t e = 0; e < found.events.size(); ++e) {
      const PathEvent& event = found.events[e];
      if (event.kind != PathEvent::Kind::fold && event.kind != PathEvent::Kind::branch) continue;
      if (tracer_.interrupted() || full()) return;
      if (event.kind == PathEvent::Kind::fold && e > 0 && changes_pieces(found.events[e - 1]) &&
          found.events[e - 1].at.x == event.at.x) {
        ++out_.kinks;
        continue;
      }
      const double p = varied.part_at(event.at.parameter);
      begin(varied, event.at, first_varies ? p : other_at, first_varies ? other_at : p);
    }
  }

  void begin(const VariedScene& varied, const PathPoint& at, double p, double q) {
    const auto model = varied.model_at(at.parameter);
    const Mechanism<double>& m = model->mechanism();
    const PathPiece piece = piece_at(*model, at.x, at.active_stops);
    if (equalities_.empty()) equalities_ = independent_closures(m, at.x);
    std::vector<int> rows;
    for (const solvers::ActiveRow& active : active_rows(piece, equalities_, m.equalities())) rows.push_back(active.row);
    const DensePoint<double> point(m, at.x, rows);
    switch (tracer_.trace_through(piece, equalities_, at.x, point.multipliers(), p, q)) {
      case FoldTracer::Start::symmetric:
        ++out_.symmetric;
        break;
      case FoldTracer::Start::failed:
        ++out_.failed;
        break;
      case FoldTracer::Start::traced:
      case FoldTracer::Start::known:
        break;
    }
  }

  void conclude(int slices) {
    using Status = FoldCurve::Status;
    using End = FoldBranch::End;
    out_.status = Status::traced;
    for (const FoldBranch& curve : out_.curves) {
      for (std::size_t side = 0; side < 2; ++side) {
        const bool ended =
            curve.end[side] == End::range || curve.end[side] == End::closed || curve.end[side] == End::piece;
        if (ended || out_.status != Status::traced) continue;
        out_.status = Status::incomplete;
        out_.why = curve.why[side];
      }
    }
    if (tracer_.interrupted()) {
      out_.status = Status::interrupted;
      out_.why = "interrupted";
    } else if (out_.slices_without_start == slices) {
      out_.status = Status::no_start;
      out_.why = why_not_;
    } else if (out_.curves.empty()) {
      out_.status = Status::no_fold;
      out_.why = fmt::format("no smooth fold of {} was met at {} values of {}, nor the other way round{}",
                             pair_.first().name(), slices / 2, pair_.second().name(),
                             out_.symmetric > 0 ? ", only branch points that neither number disturbs" : "");
    }
  }

  const VariedPair& pair_;
  const FoldCurveOptions& options_;
  FoldCurve& out_;
  FoldTracer tracer_;
  std::vector<int> equalities_;
  std::string why_not_;
};

}  // namespace

int FoldCusp::digits() const { return decimal_digits(error, rounding_effect); }

FoldCurve fold_curve(const VariedPair& pair, const FoldCurveOptions& options) {
  FoldCurve out;
  const auto begin = std::chrono::steady_clock::now();
  FoldFinder(pair, options, out).run();
  out.microseconds = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace poise
