#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "design/synthesis/path_search.hpp"
#include "model/input_error.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::path_synthesis_test {
namespace {

constexpr double turn = 2 * std::numbers::pi;

PathProblem problem_of(const std::string& text) {
  const app_tests::TempFolder folder;
  return read_path_problem(folder.write("path.toml", "[synthesis]\nkind = \"path\"\n" + text));
}

std::string points_text(const std::vector<Vec2>& points) {
  std::string out = "points = [";
  for (const Vec2& p : points) out += fmt::format("[{:.17g}, {:.17g}],", p.x, p.y);
  return out + "]\n";
}

/// A linkage by its numbers, whose coupler point is found by intersecting two circles.
class Judge {
 public:
  Judge(PathLinkage kind, const PathVector& x) : kind_(kind), x_(x) {}

  /// Both coupler points at an angle of the crank: left and right of the line from the crank's pin to the other pivot
  /// (of a slider-crank by the side of the foot on the line); none where the circles do not meet.
  std::vector<Vec2> points_at(double angle) const {
    const double crank = std::exp(x_[4]), coupler = std::exp(x_[5]), output = std::exp(x_[6]);
    const Vec2 pin{x_[0] + crank * std::cos(angle), x_[1] + crank * std::sin(angle)};
    std::vector<Vec2> ends;
    if (kind_ == PathLinkage::four_bar) {
      const double dx = x_[2] - pin.x, dy = x_[3] - pin.y, square = dx * dx + dy * dy;
      const double k = (coupler * coupler - output * output + square) / (2 * square);
      const double h = coupler * coupler / square - k * k;
      if (h < 0.0) return {};
      for (const double s : {1.0, -1.0}) {
        ends.push_back({pin.x + k * dx - s * std::sqrt(h) * dy, pin.y + k * dy + s * std::sqrt(h) * dx});
      }
    } else {
      const double cx = std::cos(x_[2]), cy = std::sin(x_[2]);
      const double across = x_[3] - (-cy * (pin.x - x_[0]) + cx * (pin.y - x_[1]));
      const double h = coupler * coupler - across * across;
      if (h < 0.0) return {};
      for (const double s : {-1.0, 1.0}) {
        ends.push_back({pin.x - across * cy + s * std::sqrt(h) * cx, pin.y + across * cx + s * std::sqrt(h) * cy});
      }
    }
    std::vector<Vec2> out;
    for (const Vec2& end : ends) {
      const double cx = (end.x - pin.x) / coupler, cy = (end.y - pin.y) / coupler;
      out.push_back({pin.x + cx * x_[7] - cy * x_[8], pin.y + cy * x_[7] + cx * x_[8]});
    }
    return out;
  }

  double miss(const PathVisit& visit, const Vec2& p) const {
    const std::vector<Vec2> both = points_at(visit.angle);
    if (both.empty()) return 1e300;
    const Vec2 at = both[visit.closure > 0 ? 0 : 1];
    return std::hypot(at.x - p.x, at.y - p.y);
  }

  /// Turns the crank in small steps from where the first point is until all are met in their order, without another
  /// closure: whether that ends well one way or the other.
  bool passes_in_order(const PathVisit& from, const std::vector<Vec2>& points) const {
    constexpr int steps = 20'000;
    for (const double side : {1.0, -1.0}) {
      std::size_t next = 1;
      double last = 1e300, before = 1e300;
      for (int k = 1; k <= steps && next < points.size(); ++k) {
        const std::vector<Vec2> both = points_at(from.angle + side * turn * k / steps);
        if (both.empty()) break;
        const Vec2 at = both[from.closure > 0 ? 0 : 1];
        const double d = std::hypot(at.x - points[next].x, at.y - points[next].y);
        // The step before was nearest, and as near as a step is long.
        if (before < 1e299 && last < before && last <= d && last < 2 * (before - last + d - last) + 1e-9) {
          ++next;
          last = before = 1e300;
        } else {
          before = last;
          last = d;
        }
      }
      if (next == points.size() || (next + 1 == points.size() && last < 1e-3)) return true;
    }
    return false;
  }

 private:
  PathLinkage kind_;
  PathVector x_;
};

PathAnswer searched(const PathProblem& problem, int starts = 300, int jobs = 0) {
  PathSearchOptions options;
  options.starts = starts;
  options.jobs = jobs;
  return search_paths(problem, options);
}

void expect_passed(const PathProblem& problem, const PathSolution& solution) {
  const Judge judge(problem.linkage, solution.x);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    // The nearer to a dead point, the fewer digits of the point does the angle of the crank tell.
    const double least = least_transmission(problem.linkage, solution.x, solution.range, solution.visits);
    EXPECT_LE(judge.miss(solution.visits[i], problem.points[i]), problem.tolerance * (1 + 1e-3 / least)) << i;
  }
}

bool has_linkage(const PathAnswer& answer, const FourBar& wanted, double tolerance) {
  return std::any_of(answer.solutions.begin(), answer.solutions.end(), [&](const PathSolution& solution) {
    const std::vector<FourBar> forms = same_curve(four_bar_of(solution.x));
    return std::any_of(forms.begin(), forms.end(), [&](const FourBar& form) {
      return norm(form.a - wanted.a) < tolerance && norm(form.b - wanted.b) < tolerance &&
             std::abs(form.input - wanted.input) < tolerance && std::abs(form.coupler - wanted.coupler) < tolerance &&
             std::abs(form.output - wanted.output) < tolerance && norm(form.point - wanted.point) < tolerance;
    });
  });
}

const FourBar known{{0, 0}, {4, 0}, 1.5, 3.5, 3.0, {2.5 * std::cos(turn / 9), 2.5 * std::sin(turn / 9)}};

// The coupler point of a known four-bar at nine angles; the points are given to ten digits.
TEST(PathSynthesis, NinePointsOfAKnownFourBar) {
  const PathProblem problem = problem_of(
      "points = [[1.1900588956,2.4807129039],[1.7721646341,3.3852863112],[1.3239148854,3.7397521919],"
      "[0.4318848866,3.5020242869],[-0.3559237840,2.7801638947],[-0.8008957172,1.9117488343],"
      "[-0.8537072763,1.1988099283],[-0.5094184768,0.9012896304],[0.1747125412,1.3381291732]]\n");
  const PathAnswer answer = searched(problem, 150);
  ASSERT_TRUE(problem.exact());
  EXPECT_GE(answer.within, 10);
  for (const PathSolution& solution : answer.solutions) expect_passed(problem, solution);
  EXPECT_TRUE(has_linkage(answer, known, 1e-7));
  // The best one has no defect, and an independent crank confirms it.
  const PathSolution& best = answer.solutions.front();
  EXPECT_FALSE(best.defects.any());
  EXPECT_TRUE(Judge(problem.linkage, best.x).passes_in_order(best.visits.front(), problem.points));
}

// A. P. Morgan, C. W. Wampler 1990, in PHCpack: 33 solutions, 15 of them real.
TEST(PathSynthesis, FivePointsWithGivenPivotsHaveFifteenRealSolutions) {
  const PathProblem problem = problem_of(
      "points = [[0.50,1.06],[-0.83,-0.27],[-0.34,0.22],[-0.13,0.43],[0.22,0.78]]\npivots = [[0,0],[1,0]]\n");
  const PathAnswer answer = searched(problem);
  EXPECT_EQ(answer.within, 15);
  for (const PathSolution& solution : answer.solutions) {
    expect_passed(problem, solution);
    EXPECT_EQ(solution.x[at_b], 1.0);
    // What is said of defects is what a crank shows that turns in small steps.
    const bool good = Judge(problem.linkage, solution.x).passes_in_order(solution.visits.front(), problem.points);
    EXPECT_EQ(good, !solution.defects.any()) << to_string(solution.defects);
  }
}

// J. A. Cabrera, A. Simon, M. Prado 2002; the errors are the least that were found before.
TEST(PathSynthesis, TasksOfCabrera) {
  const auto sum = [](const PathProblem& problem, const PathSolution& solution) {
    const Judge judge(problem.linkage, solution.x);
    double squares = 0.0;
    for (std::size_t i = 0; i < problem.points.size(); ++i) {
      squares += std::pow(judge.miss(solution.visits[i], problem.points[i]), 2);
    }
    EXPECT_TRUE(solution.range.full());
    return squares;
  };
  const PathProblem six =
      problem_of("points = [[20,20],[20,25],[20,30],[20,35],[20,40],[20,45]]\nfull_turn = true\nlongest = 50\n");
  EXPECT_LE(sum(six, searched(six, 60).solutions.front()), 1e-15);
  const PathProblem five = problem_of(
      "points = [[3,3],[2.759,3.363],[2.372,3.663],[1.890,3.862],[1.355,3.943]]\ncrank = [30,60,90,120,150]\n"
      "crank_from = \"ground\"\nfull_turn = true\nlongest = 50\n");
  EXPECT_LE(sum(five, searched(five).solutions.front()), 3.69983809e-6 * (1 + 1e-6));
  const PathProblem eighteen = problem_of(
      "points = [[0.5,1.1],[0.4,1.1],[0.3,1.1],[0.2,1.0],[0.1,0.9],[0.05,0.75],[0.02,0.6],[0,0.5],[0,0.4],[0.03,0.3],"
      "[0.1,0.25],[0.15,0.2],[0.2,0.3],[0.3,0.4],[0.4,0.5],[0.5,0.7],[0.6,0.9],[0.6,1.0]]\ncrank_step = 20\n"
      "full_turn = true\nlongest = 50\n");
  const PathAnswer answer = searched(eighteen);
  EXPECT_LE(sum(eighteen, answer.solutions.front()), 0.00979882704 * (1 + 1e-6));
  const std::vector<PathVisit>& visits = answer.solutions.front().visits;
  for (std::size_t i = 1; i < visits.size(); ++i) {
    EXPECT_NEAR(visits[i].angle - visits[i - 1].angle, turn / 18, 1e-12);
  }
}

/// A crank that turns fully, with its coupler point at angles in order.
struct Planted {
  PathVector x{};
  std::vector<Vec2> points;
};

Planted planted(std::mt19937& random, std::size_t count, PathLinkage kind = PathLinkage::four_bar) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  while (true) {
    Planted out;
    const auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
    const bool four_bar = kind == PathLinkage::four_bar;
    out.x = {between(-1, 1),
             between(-1, 1),
             four_bar ? between(-1, 1) : between(0, turn),
             four_bar ? between(-1, 1) : between(-0.5, 0.5),
             std::log(between(0.2, 1)),
             std::log(between(0.2, 2)),
             four_bar ? std::log(between(0.2, 2)) : 0.0,
             between(-2, 2),
             between(-2, 2)};
    if (!crank_range(kind, out.x).full()) continue;
    const Judge judge(kind, out.x);
    const std::size_t side = unit(random) < 0.5 ? 0 : 1;
    for (std::size_t i = 0; i < count; ++i) {
      const double share = (static_cast<double>(i) + between(-0.3, 0.3)) / static_cast<double>(count);
      out.points.push_back(judge.points_at(turn * share)[side]);
    }
    return out;
  }
}

// Four-bars are chosen, points computed, four-bars forgotten.
TEST(PathSynthesis, LinkagesThroughPointsOfRandomFourBars) {
  std::mt19937 random(5);
  for (const std::size_t count : {5, 7, 9}) {
    int found = 0;
    constexpr int tasks = 12;
    for (int k = 0; k < tasks; ++k) {
      const PathProblem problem = problem_of(points_text(planted(random, count).points));
      PathAnswer answer;
      for (const int starts : {20, 300}) {
        answer = searched(problem, starts);
        if (answer.within > 0) break;
      }
      found += answer.within > 0 ? 1 : 0;
      for (const PathSolution& solution : answer.solutions) expect_passed(problem, solution);
    }
    EXPECT_GE(found, 11) << count;
  }
}

TEST(PathSynthesis, SliderCrankThroughEightPoints) {
  std::mt19937 random(3);
  for (int k = 0; k < 3; ++k) {
    const PathProblem problem =
        problem_of("linkage = \"slider-crank\"\n" + points_text(planted(random, 8, PathLinkage::slider_crank).points));
    ASSERT_TRUE(problem.exact());
    const PathAnswer answer = searched(problem, 150);
    EXPECT_GE(answer.within, 1);
    for (const PathSolution& solution : answer.solutions) expect_passed(problem, solution);
  }
}

TEST(PathSynthesis, ThousandPointsWithNoise) {
  std::mt19937 random(11);
  const Judge judge(PathLinkage::four_bar, unknowns_of(known));
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<Vec2> points;
  for (int i = 0; i < 1000; ++i) {
    const Vec2 p = judge.points_at(turn * i / 1000)[0];
    points.push_back({p.x + noise(random), p.y + noise(random)});
  }
  const PathProblem problem = problem_of(points_text(points) + "full_turn = true\norder = false\n");
  const PathAnswer answer = searched(problem, 12);
  ASSERT_FALSE(answer.solutions.empty());
  const PathSolution& best = answer.solutions.front();
  EXPECT_FALSE(best.defects.any());
  // Across the curve only one of the two parts of the noise is left.
  EXPECT_NEAR(best.rms, 0.01, 0.001);
  EXPECT_TRUE(has_linkage({{best}}, known, 0.1));
}

TEST(PathSynthesis, LimitsAreKept) {
  const PathProblem problem = problem_of(
      "points = [[0,0],[1,0.2],[2,0.3],[3,0.2],[4,0]]\nfull_turn = true\nwithin = [0, -3, 4, -1]\nlongest = 5\n");
  const PathAnswer answer = searched(problem);
  ASSERT_GE(answer.within, 1);
  for (const PathSolution& solution : answer.solutions) {
    const FourBar linkage = four_bar_of(solution.x);
    for (const Vec2& pivot : {linkage.a, linkage.b}) {
      EXPECT_GE(pivot.x, -1e-7);
      EXPECT_LE(pivot.x, 4 + 1e-7);
      EXPECT_GE(pivot.y, -3 - 1e-7);
      EXPECT_LE(pivot.y, -1 + 1e-7);
    }
    for (const double length : {linkage.input, linkage.coupler, linkage.output, norm(linkage.b - linkage.a)}) {
      EXPECT_LE(length, 5 + 1e-7);
    }
    EXPECT_EQ(solution.defects.turn, !solution.range.full());
  }
  EXPECT_FALSE(answer.solutions.front().defects.any());
}

TEST(PathSynthesis, TransmissionIsKept) {
  const std::string points = "points = [[0,0],[1,0.2],[2,0.3],[3,0.2],[4,0]]\nfull_turn = true\n";
  const PathProblem problem = problem_of(points + "transmission = 50\n");
  const PathAnswer answer = searched(problem, 100);
  ASSERT_GE(answer.within, 1);
  const PathSolution& best = answer.solutions.front();
  ASSERT_FALSE(best.defects.any());
  // The angle of the triangle of coupler, output and diagonal, in small steps.
  const FourBar linkage = four_bar_of(best.x);
  for (int k = 0; k < 720; ++k) {
    const auto pose = pose_of(linkage, turn * k / 720, best.visits.front().closure);
    ASSERT_TRUE(pose.has_value());
    const double angle = std::abs(std::remainder(pose->coupler_angle - pose->output_angle, turn / 2));
    EXPECT_GE(angle, 50 * turn / 360 - 1e-5);
  }
}

TEST(PathSynthesis, SameAnswerOnAnyNumberOfThreads) {
  std::mt19937 random(2);
  const PathProblem problem = problem_of(points_text(planted(random, 7).points));
  const PathAnswer one = searched(problem, 60, 1);
  for (const int jobs : {2, 16}) {
    const PathAnswer other = searched(problem, 60, jobs);
    ASSERT_EQ(one.solutions.size(), other.solutions.size());
    for (std::size_t k = 0; k < one.solutions.size(); ++k) EXPECT_EQ(one.solutions[k].x, other.solutions[k].x);
  }
}

TEST(PathSynthesis, InterruptKeepsWhatIsFound) {
  std::mt19937 random(2);
  const PathProblem problem = problem_of(points_text(planted(random, 5).points));
  std::atomic<bool> stop = false;
  PathSearchOptions options;
  options.jobs = 1;
  options.interrupt = &stop;
  options.progress = [&](std::size_t done) { stop = done >= 30; };
  const PathAnswer answer = search_paths(problem, options);
  EXPECT_TRUE(answer.interrupted);
  EXPECT_EQ(answer.starts, 30);
  EXPECT_FALSE(answer.solutions.empty());
}

// A crank-rocker has a circuit for each closure; a rocker as the input has one for each side of the ground; a linkage
// whose links all rock has one.
TEST(PathDefectsTest, KnownMotions) {
  const auto defects = [](const FourBar& linkage, std::vector<PathVisit> visits) {
    return to_string(defects_of(crank_range(PathLinkage::four_bar, unknowns_of(linkage)), visits, true, false));
  };
  EXPECT_EQ(defects(known, {{0, 1}, {1, 1}, {2, 1}, {3, 1}}), "none");
  EXPECT_EQ(defects(known, {{5, 1}, {6, 1}, {7, 1}, {8, 1}}), "none");
  EXPECT_EQ(defects(known, {{3, 1}, {2, 1}, {1, 1}, {0, 1}}), "none");
  EXPECT_EQ(defects(known, {{0, 1}, {2, 1}, {1, 1}}), "none");  // backwards once round
  EXPECT_EQ(defects(known, {{0, 1}, {2, 1}, {1, 1}, {3, 1}}), "order");
  EXPECT_EQ(defects(known, {{0, 1}, {1, -1}}), "circuit");
  // The same linkage is given with the rocker as the input, which stands between 46.57 and 104.48 deg from the ground,
  // or below it.
  const FourBar rocker{{0, 0}, {4, 0}, 3.0, 3.5, 1.5, {}};
  EXPECT_EQ(defects(rocker, {{0.9, 1}, {1.2, 1}, {1.5, 1}}), "none");
  EXPECT_EQ(defects(rocker, {{0.9, 1}, {1.2, -1}}), "branch");
  EXPECT_EQ(defects(rocker, {{0.9, 1}, {-0.9, -1}}), "circuit");
  EXPECT_EQ(defects(rocker, {{0.9, 1}, {1.5, 1}, {1.2, 1}}), "order");
  const FourBar rocking{{0, 0}, {4, 0}, 3.0, 1.5, 2.0, {}};
  EXPECT_EQ(grashof_kind(rocking), GrashofKind::triple_rocker);
  EXPECT_EQ(defects(rocking, {{0.3, 1}, {-0.3, 1}}), "none");
  EXPECT_EQ(defects(rocking, {{0.3, 1}, {-0.3, -1}}), "branch");
}

TEST(PathFiles, ErrorsAreOneLineWithItsPlace) {
  const std::string points = "points = [[0,0],[1,0],[2,1]]\n";
  const std::vector<std::array<std::string, 2>> wrong = {
      {"", "expected points = [[X, Y], ...] or curve"},
      {"points = [[0,0]]\n", "expected 2 to 100000 points, found 1"},
      {"points = [[0,0],[0,0],[1,1]]\n", "expected another point than the one before"},
      {"points = [[0,0],[1]]\n", "expected a list of pairs"},
      {points + "crank = [1, 2]\n", "expected an angle for each of the 3 points, found 2"},
      {points + "crank = [1, 2, 3]\ncrank_step = 20\n", "expected crank or crank_step, found both"},
      {points + "crank_step = 0\n", "expected an angle other than 0"},
      {points + "crank_from = \"ground\"\n", "expected crank = [...] or crank_step with it"},
      {points + "linkage = \"six-bar\"\n", "expected one of four-bar, slider-crank, found \"six-bar\""},
      {points + "linkage = \"slider-crank\"\npivots = [[0,0],[1,0]]\n", "expected a four-bar with it"},
      {points + "pivots = [[0,0],[0,0]]\n", "expected two different pivots"},
      {points + "within = [1, 0, 0, 1]\n", "expected [LEFT, LOWER, RIGHT, UPPER]"},
      {points + "longest = -1\n", "expected a finite number > 0, found -1"},
      {points + "shortest = 2\nlongest = 1\n", "expected shortest below longest"},
      {points + "curve = \"x.csv\"\n", "expected points or a curve, found both"},
      {points + "transmission = 30\n", "expected full_turn = true with it"},
      {points + "turn = true\n", "expected one of the keys"},
      {"curve = \"missing.csv\"\n", "missing.csv: cannot be read"}};
  for (const auto& [text, why] : wrong) {
    try {
      problem_of(text);
      ADD_FAILURE() << "was read: " << text;
    } catch (const InputError& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find(why), std::string::npos) << said;
      EXPECT_NE(said.find("path.toml:"), std::string::npos) << said;
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    }
  }
}

}  // namespace
}  // namespace poise::path_synthesis_test
