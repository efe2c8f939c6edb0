#include "design/synthesis/guidance.hpp"

#include <algorithm>
#include <utility>

namespace poise {
namespace {

GuidingFourBar driven_by(std::span<const GuidingDyad> links, int input, int output,
                         std::span<const BodyPosition> positions, const FourBarWishes& wishes) {
  const GuidingDyad &first = links[static_cast<std::size_t>(input)], &second = links[static_cast<std::size_t>(output)];
  GuidingFourBar out;
  out.input = input;
  out.output = output;
  out.linkage = four_bar_of(first, second);
  out.kind = grashof_kind(out.linkage);
  for (const BodyPosition& p : positions) out.positions.push_back(input_position(first, second, p));
  out.passage = passage_of(out.linkage, out.positions);
  out.wanted = (!wishes.kind || *wishes.kind == out.kind) &&
               (!wishes.within || (wishes.within->contains(first.fixed) && wishes.within->contains(second.fixed)));
  return out;
}

/// Whether the first one is to be preferred.
bool is_better(const GuidingFourBar& a, const GuidingFourBar& b) {
  if (a.suits() != b.suits()) return a.suits();
  return a.suits() && a.passage.transmission > b.passage.transmission;
}

/// Links whose pins coincide, in the world or on the body, make no four-bar.
bool are_apart(const GuidingDyad& a, const GuidingDyad& b) {
  constexpr double nothing = 1e-9;
  const double size = std::max(a.length, b.length);
  return norm(a.fixed - b.fixed) > nothing * size && norm(a.moving - b.moving) > nothing * size;
}

}  // namespace

std::vector<GuidingFourBar> four_bars_of(std::span<const GuidingDyad> links, std::span<const BodyPosition> positions,
                                         const FourBarWishes& wishes) {
  std::vector<GuidingFourBar> out;
  const int number = static_cast<int>(links.size());
  for (int i = 0; i < number; ++i) {
    for (int j = i + 1; j < number; ++j) {
      const GuidingDyad &a = links[static_cast<std::size_t>(i)], &b = links[static_cast<std::size_t>(j)];
      const bool are_links = a.kind == GuidingDyad::Kind::link && b.kind == GuidingDyad::Kind::link;
      if (!are_links || !are_apart(a, b)) continue;
      const GuidingFourBar one = driven_by(links, i, j, positions, wishes);
      const GuidingFourBar other = driven_by(links, j, i, positions, wishes);
      out.push_back(is_better(other, one) ? other : one);
    }
  }
  return out;
}

int best_of(const std::vector<GuidingFourBar>& found) {
  int best = -1;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found[k].suits()) continue;
    if (best < 0 || is_better(found[k], found[static_cast<std::size_t>(best)])) best = static_cast<int>(k);
  }
  return best;
}

BestPair best_pair(const CentreCurve& curve, std::span<const BodyPosition> positions, const FourBarWishes& wishes,
                   const std::atomic<bool>* interrupt) {
  constexpr double reach = 6.0;
  Vec2 middle{};
  for (const BodyPosition& p : positions) middle += (1.0 / static_cast<double>(positions.size())) * p.at;
  double size = 0.0;
  for (const BodyPosition& p : positions) size = std::max(size, norm(p.at - middle));
  const Rectangle around{middle - reach * Vec2{size, size}, middle + reach * Vec2{size, size}};
  const Rectangle& room = wishes.within ? *wishes.within : around;
  std::vector<GuidingDyad> links;
  for (const CentreCurve::Point& point : curve.links) {
    const bool pin_near = around.contains(world_of(positions.front(), point.link.moving));
    if (room.contains(point.link.fixed) && pin_near) links.push_back(point.link);
  }
  BestPair out;
  std::optional<GuidingFourBar> best;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (interrupt != nullptr && *interrupt) {
      out.interrupted = true;
      break;
    }
    for (std::size_t j = 0; j < links.size(); ++j) {
      if (i == j || !are_apart(links[i], links[j])) continue;
      ++out.pairs;
      const GuidingFourBar one = driven_by(links, static_cast<int>(i), static_cast<int>(j), positions, wishes);
      if (one.suits() && (!best || is_better(one, *best))) best = one;
    }
  }
  out.pairs /= 2;
  if (best) {
    out.links = {links[static_cast<std::size_t>(best->input)], links[static_cast<std::size_t>(best->output)]};
  }
  return out;
}

Guidance guide(const PoseTask& task, const std::atomic<bool>* interrupt) {
  Guidance out;
  const std::vector<BodyPosition>& positions = task.positions;
  const auto take = [&](const std::optional<GuidingDyad>& link) {
    if (link) out.links.push_back(*link);
  };
  if (positions.size() == 5) {
    out.five = dyads_through(positions);
    out.links = out.five.dyads;
  } else if (positions.size() == 4) {
    out.curve = centre_curve(positions);
    if (task.near.empty()) {
      BestPair best = best_pair(out.curve, positions, task.wishes, interrupt);
      out.links = std::move(best.links);
      out.pairs = best.pairs;
      out.interrupted = best.interrupted;
    }
    for (const Vec2& place : task.near) take(link_near(positions, out.curve, place));
  } else {
    for (const Vec2& pin : task.pins) take(link_with_pin(positions, pin));
    for (const Vec2& pivot : task.pivots) take(link_with_pivot(positions, pivot));
  }
  out.four_bars = four_bars_of(out.links, positions, task.wishes);
  out.best = best_of(out.four_bars);
  return out;
}

}  // namespace poise
