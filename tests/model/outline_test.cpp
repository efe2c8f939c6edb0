// Clearances from outlines against the distance from what is nearest, over sets and lanes, and the convex parts of
// outlines.

#include "model/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "model/outline_parts.hpp"
#include "model/pack.hpp"
#include "solvers/interval.hpp"
#include "statics/model/interval_mechanism.hpp"
#include "tests/support/message_of.hpp"

namespace poise::outline_test {
namespace {

using comparison::Random;
using Way = std::vector<Vec2>;

double distance_from(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 edge = b - a;
  return norm(p - a - std::clamp(dot(p - a, edge) / dot(edge, edge), 0.0, 1.0) * edge);
}

double distance_from(Vec2 p, const Way& closed) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < closed.size(); ++k) {
    least = std::min(least, distance_from(p, closed[k], closed[(k + 1) % closed.size()]));
  }
  return least;
}

bool is_inside(Vec2 p, const Way& closed) {
  double around = 0.0;
  for (std::size_t k = 0; k < closed.size(); ++k) {
    const Vec2 a = closed[k] - p, b = closed[(k + 1) % closed.size()] - p;
    around += std::atan2(cross(a, b), dot(a, b));
  }
  return std::abs(around) > 1.0;
}

std::vector<OutlinePoint> numbered(const Way& way) {
  std::vector<OutlinePoint> out;
  for (std::size_t k = 0; k < way.size(); ++k) out.push_back({{1, static_cast<int>(k)}, way[k]});
  return out;
}

template <class S>
OutlineIn<S> in(const Outline& outline, const Way& places) {
  OutlineIn<S> out(outline, [&](PointRef point) { return places[static_cast<std::size_t>(point.point)]; });
  std::vector<Planar<S>> points;
  for (const PointRef& point : outline.points) {
    points.push_back(planar_cast<S>(places[static_cast<std::size_t>(point.point)]));
  }
  out.set_points(std::move(points));
  return out;
}

// A wheel with saw teeth, gone through clockwise around it, and its points.
Way ratchet(int teeth) {
  Way out;
  for (int k = 0; k < teeth; ++k) {
    const double at = -2 * M_PI * k / teeth;
    out.push_back(40.0 * unit(at));
    out.push_back(50.0 * unit(at - 0.02));
  }
  return out;
}

double clearance(const std::vector<Outline>& parts, const Way& places, Vec2 p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Outline& part : parts) least = std::min(least, in<double>(part, places).clearance(p).value);
  return least;
}

TEST(Outlines, PartsFillWhatAWayGoesAround) {
  Random random(1);
  for (const Way& way : {ratchet(12), ratchet(5), Way{{0, 0}, {0, 3}, {1, 3}, {1, 1}, {4, 1}, {4, 0}},
                         Way{{0, 0}, {0, 1}, {2, 2}, {3, 0}}}) {
    const std::vector<Outline> parts = parts_of_outline(numbered(way), true);
    for (int k = 0; k < 2000; ++k) {
      const double reach = way.size() > 8 ? 60.0 : 5.0;
      const Vec2 p{random.uniform(-reach, reach), random.uniform(-reach, reach)};
      const double found = clearance(parts, way, p);
      if (is_inside(p, way)) {
        EXPECT_LT(found, 1e-12);
      } else {
        EXPECT_NEAR(found, distance_from(p, way), 1e-12);
      }
    }
  }
  EXPECT_EQ(parts_of_outline(numbered(ratchet(12)), true).size(), 13U) << "each tooth and what they stand on";
  EXPECT_EQ(parts_of_outline(numbered({{0, 0}, {0, 1}, {2, 2}, {3, 0}}), true).size(), 1U);
}

// In front of an open outline each of its edges is as far as it is, and around its ends too.
TEST(Outlines, PartsOfAnOpenWayAreBehindIt) {
  const Way hook{{0, 0}, {4, 1}, {4, -1}, {9, -1}};
  const std::vector<Outline> parts = parts_of_outline(numbered(hook), false);
  ASSERT_EQ(parts.size(), 2U) << "cut in the corner to the left";
  EXPECT_EQ(parts[0].points.size(), 3U);
  EXPECT_TRUE(parts[1].backed);
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    const double x = random.uniform(-2.0, 11.0);
    const double ground = x < 0.0 ? 0.0 : x < 4.0 ? 0.25 * x : -1.0;
    const Vec2 p{x, ground + random.uniform(0.0, 3.0)};
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t e = 0; e + 1 < hook.size(); ++e)
      nearest = std::min(nearest, distance_from(p, hook[e], hook[e + 1]));
    EXPECT_NEAR(clearance(parts, hook, p), nearest, 1e-12);
  }
  // The inside of a box: four walls, each a part.
  EXPECT_EQ(parts_of_outline(numbered({{0, 0}, {4, 0}, {4, 3}, {0, 3}}), true).size(), 4U);
}

TEST(Outlines, ThatCrossThemselvesAreRefused) {
  const Way eight{{0, 0}, {2, 2}, {2, 0}, {0, 2}};
  const std::string message = test::message_of([&] { parts_of_outline(numbered(eight), true); });
  EXPECT_NE(message.find("does not cross itself"), std::string::npos) << message;
}

struct Case {
  Outline outline;
  Way places;
};

std::vector<Case> cases() {
  const Way arc{{0.5, 0.2}, {2.5, 0.2}, {0.5, -1.8}};
  const std::vector<PointRef> three{{1, 0}, {1, 1}, {1, 2}};
  std::vector<Case> out;
  out.push_back({{Outline::Form::polygon, {{1, 0}, {1, 1}}, true}, {{-1, 0}, {2, 1}}});
  out.push_back(
      {{Outline::Form::polygon, {{1, 0}, {1, 1}, {1, 2}, {1, 3}}, false}, {{-1, -1}, {-1, 1}, {1.5, 1.5}, {2, -1}}});
  for (const Outline::Form form : {Outline::Form::arc, Outline::Form::hollow_arc}) {
    out.push_back({{form, three, false}, arc});
    out.push_back({{form, {three[0], three[2], three[1]}, false}, arc});
    out.push_back({{form, {three[0], three[1], three[1]}, false}, arc});
  }
  return out;
}

// Every member of a function of the place.
template <class Use>
void each_member(const Use& use) {
  using Member = double PlaneValue<double>::*;
  using OfSets = Interval PlaneValue<Interval>::*;
  const auto one = [&](Member member, OfSets of_sets) { use(member, of_sets); };
  one(&PlaneValue<double>::value, &PlaneValue<Interval>::value);
  one(&PlaneValue<double>::x, &PlaneValue<Interval>::x);
  one(&PlaneValue<double>::y, &PlaneValue<Interval>::y);
  one(&PlaneValue<double>::xx, &PlaneValue<Interval>::xx);
  one(&PlaneValue<double>::xy, &PlaneValue<Interval>::xy);
  one(&PlaneValue<double>::yy, &PlaneValue<Interval>::yy);
  one(&PlaneValue<double>::xxx, &PlaneValue<Interval>::xxx);
  one(&PlaneValue<double>::yyy, &PlaneValue<Interval>::yyy);
}

TEST(Outlines, EncloseTheirValuesOverSetsOfPlaces) {
  Random random(3);
  for (const Case& one : cases()) {
    const OutlineIn<double> known = in<double>(one.outline, one.places);
    for (int k = 0; k < 300; ++k) {
      const Vec2 low{random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0)};
      const double width = std::pow(10.0, random.uniform(-6.0, 0.3));
      std::vector<Vec2> inside;
      for (int n = 0; n < 20; ++n) {
        inside.push_back(low + Vec2{random.uniform(0.0, width), random.uniform(0.0, width)});
      }
      const auto expect = [&](auto function) {
        const PlaneValue<Interval> set = [&] {
          const solvers::RoundingUp rounding;
          return function(in<Interval>(one.outline, one.places),
                          Planar<Interval>{Interval(low.x, low.x + width), Interval(low.y, low.y + width)});
        }();
        for (const Vec2& p : inside) {
          const PlaneValue<double> value = function(known, p);
          each_member([&](auto member, auto of_sets) {
            const double slack = 1e-12 * (1 + std::abs(value.*member));
            EXPECT_FALSE((set.*of_sets).lower() > value.*member + slack);
            EXPECT_FALSE((set.*of_sets).upper() < value.*member - slack);
          });
        }
      };
      expect([](const auto& outline, const auto& p) { return outline.clearance(p); });
    }
  }
}

TEST(Outlines, AreTheSameInEachLane) {
  using Four = Pack<double, 4>;
  Random random(4);
  for (const Case& one : cases()) {
    const OutlineIn<double> known = in<double>(one.outline, one.places);
    const OutlineIn<Four> lanes = in<Four>(one.outline, one.places);
    for (int k = 0; k < 200; ++k) {
      std::vector<Vec2> at;
      Planar<Four> p;
      for (int lane = 0; lane < 4; ++lane) {
        at.push_back({random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0)});
        p.x[lane] = at.back().x;
        p.y[lane] = at.back().y;
      }
      const PlaneValue<Four> clearances = lanes.clearance(p), ways = lanes.along(p, Four(0.3));
      for (int lane = 0; lane < 4; ++lane) {
        const Vec2 place = at[static_cast<std::size_t>(lane)];
        EXPECT_EQ(clearances.value[lane], known.clearance(place).value);
        EXPECT_EQ(clearances.xyy[lane], known.clearance(place).xyy);
        EXPECT_EQ(ways.value[lane], known.along(place, 0.3).value);
        EXPECT_EQ(ways.x[lane], known.along(place, 0.3).x);
      }
    }
  }
}

// A circle of radius r that does not turn slips along an outline as far as its centre goes, around corners too.
TEST(Outlines, WaysAlongThemAreHowFarACircleSlips) {
  const double r = 0.3;
  for (const Case& one : cases()) {
    const bool has_ends = one.outline.form != Outline::Form::polygon && one.outline.points[1] != one.outline.points[2];
    if (has_ends) continue;  // it would come to the other side of the arc
    const OutlineIn<double> outline = in<double>(one.outline, one.places);
    Vec2 p{-1.5, 1.2};
    if (one.outline.form == Outline::Form::hollow_arc) p = {0.0, 0.0};
    const auto touch = [&] {
      for (int k = 0; k < 4; ++k) {
        const PlaneValue<double> g = outline.clearance(p);
        p = p - (g.value - r) * Vec2{g.x, g.y};
      }
    };
    touch();
    int leaps = 0;
    for (int k = 0; k < 3000; ++k) {
      const double before = outline.along(p, r).value;
      const PlaneValue<double> g = outline.clearance(p);
      const Vec2 last = p;
      p = p + 1e-3 * Vec2{g.y, -g.x};
      touch();
      if (std::abs(outline.along(p, r).value - before - norm(p - last)) > 1e-6) ++leaps;
    }
    EXPECT_LE(leaps, 1) << "once around it the way begins anew";
  }
}

}  // namespace
}  // namespace poise::outline_test
