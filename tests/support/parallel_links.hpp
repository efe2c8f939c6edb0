#pragma once

#include <numbers>
#include <string>

namespace poise::test {

/// A scene file in which three parallel links l1, l2, l3 on a level ground carry a bed. Two are 1 m long; the one in
/// the middle is shorter by `shorter`, m, and its pin on the bed is higher by that, so that the loops close where the
/// links point in the direction `angle`, rad. Each body weighs 1 kg, in a field that pulls with `push` m/s^2 to the
/// right. Unless `shorter` is 0 the links can begin to turn, to first order, and no more. It ends within its table
/// `[start]`.
std::string three_links(double shorter, double angle = -std::numbers::pi / 2, double push = 0.0);

}  // namespace poise::test
