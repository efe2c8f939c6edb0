#include "statics/quantities/quantity_value.hpp"

namespace poise {

bool is_same(const Measure& a, const Measure& b) {
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case Measure::Kind::angle:
      return a.body_a == b.body_a && a.body_b == b.body_b;
    case Measure::Kind::travel:
      return a.joint == b.joint;
    case Measure::Kind::x:
    case Measure::Kind::y:
      return a.b == b.b;
    case Measure::Kind::distance:
    case Measure::Kind::component:
      return a.a == b.a && a.b == b.b;
    case Measure::Kind::rope:
      return std::equal(a.contacts.begin(), a.contacts.end(), b.contacts.begin(), b.contacts.end(),
                        [](const RopeContact& one, const RopeContact& other) { return one.at == other.at; });
    case Measure::Kind::sum:
      break;
  }
  return std::equal(
      a.terms.begin(), a.terms.end(), b.terms.begin(), b.terms.end(),
      [](const Measure::Term& one, const Measure::Term& other) { return is_same(one.measure, other.measure); });
}

}  // namespace poise
