#include "app/results/motion/contacts.hpp"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "app/result/each.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

/// Places are found to rounding; so many digits are shown of them and of rates.
constexpr int found_digits = 10;
/// Changes of one contact that are told; JSON has all.
constexpr std::size_t told_changes = 6;

const Stop& stop_of(const MotionModel& model, const Contact& contact) { return model.scene().stops[contact.stop]; }

std::string place_in_words(const MotionModel& model, const ForcesAlong& found, double at) {
  return found.measure ? with_unit(model, at, *found.measure, found_digits) : significant(at, found_digits) + " s";
}

/// What becomes of a contact where p becomes positive or negative.
std::string_view word_of_change(const Contact& contact, bool presses) {
  if (contact.guided) return "changes side";
  if (presses) return "presses again";
  return contact.at_max ? "goes slack" : "lifts off";
}

/// "changes side at 12 deg and 47 deg", "lifts off at 66.5 deg, presses again at 80 deg".
std::string changes_in_words(const MotionModel& model, const ForcesAlong& found, const ContactCourse& course) {
  std::vector<std::string> out;
  for (const ContactChange& change : course.changes) {
    if (out.size() == told_changes) {
      out.push_back(fmt::format("and {} more", course.changes.size() - told_changes));
      break;
    }
    out.push_back(fmt::format("{} at {}", word_of_change(course.contact, change.presses),
                              place_in_words(model, found, change.at)));
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

/// "9451.2 deg/s", of an angle with its turns per minute.
std::string rate_in_words(const MotionModel& model, const ForcesAlong& found, double rate) {
  const Quantity quantity = found.measure.value_or(Quantity::angle);
  const Units& units = model.scene().units;
  std::string out = amount(rate, quantity, units, found_digits, "/s");
  if (quantity == Quantity::angle) out += fmt::format(" ({} rpm)", significant(rate * 30 / M_PI, found_digits));
  return out;
}

void add_contact_data(Group& group, const MotionModel& model, const ForcesAnswer& answer) {
  const Units& units = model.scene().units;
  const auto place = [&](double at) { return answer.found.measure ? in_unit(at, *answer.found.measure, units) : at; };
  const bool is_along = !answer.found.at.empty();
  Branch& contacts = group.array("contacts");
  for (const ContactCourse& course : answer.contacts) {
    const Stop& stop = stop_of(model, course.contact);
    Group& one = contacts.parts.emplace_back();
    one.data("name", stop.name);
    one.data("kind", stop.table);
    one.data("guided", course.contact.guided);
    one.data("least_force", in_unit(course.least, effort_of(stop.on), units));
    one.data("least_at", is_along ? place(course.least_at) : std::nan(""));
    one.data("pulls", course.pulls && !course.contact.guided);
    Branch& changes = one.array("changes");
    for (const ContactChange& change : course.changes) {
      Group& there = changes.parts.emplace_back();
      there.data("at", place(change.at));
      there.data("what", std::string(word_of_change(course.contact, change.presses)));
    }
  }
  if (answer.lift_offs.empty()) return;
  Branch& lift_offs = group.array("lift_off");
  for (const LiftOff& found : answer.lift_offs) {
    Group& one = lift_offs.parts.emplace_back();
    one.data("name", stop_of(model, found.contact).name);
    const Quantity quantity = answer.found.measure.value_or(Quantity::angle);
    one.data("rate", found.rate ? in_unit(*found.rate, quantity, units) : std::nan(""));
    one.data("at", found.rate ? place(found.at) : std::nan(""));
  }
}

}  // namespace

std::string pulls_in_words(const MotionModel& model, const ForcesAnswer& answer) {
  std::vector<std::string> out;
  for (const ContactCourse& course : answer.contacts) {
    if (!course.pulls || course.contact.guided) continue;
    const std::string most = with_unit(model, -course.least, effort_of(stop_of(model, course.contact).on));
    std::string text = fmt::format("{} would have to pull, with {}", stop_of(model, course.contact).title(), most);
    if (!answer.found.at.empty()) {
      text += fmt::format(" at {} = {}", answer.found.along, place_in_words(model, answer.found, course.least_at));
      const std::string changes = changes_in_words(model, answer.found, course);
      text += changes.empty() ? " and everywhere" : ": it " + changes;
    }
    out.push_back(std::move(text));
  }
  return fmt::format("{}", fmt::join(out, "; "));
}

void add_contacts(Group& group, const MotionModel& model, const ForcesAnswer& answer) {
  add_contact_data(group, model, answer);
  const ForcesAlong& found = answer.found;
  if (!answer.contacts.empty()) {
    const bool is_along = !found.at.empty();
    const auto least = [&](const ContactCourse& course) {
      const std::string force = with_unit(model, course.least, effort_of(stop_of(model, course.contact).on));
      return is_along ? force + " at " + place_in_words(model, found, course.least_at) : force;
    };
    const auto changes = [&](const ContactCourse& course) {
      std::string words = changes_in_words(model, found, course);
      if (!words.empty()) return words;
      if (std::isnan(course.least)) return std::string("-");
      if (course.contact.guided) return std::string("stays on one side");
      return std::string(course.pulls ? "would have to pull" : "presses");
    };
    Table& table = group.table("", "Contacts, positive where they press", Rows::list);
    table.words("", "contact", each(answer.contacts, [&](const ContactCourse& course) {
                  return stop_of(model, course.contact).title() + (course.contact.guided ? ", guided" : "");
                }));
    table.words("", "least force", each(answer.contacts, least));
    table.words("", is_along ? "along " + found.along : "here", each(answer.contacts, changes));
  }
  for (const LiftOff& lift : answer.lift_offs) {
    const std::string_view what = word_of_change(lift.contact, false);
    const std::string name = stop_of(model, lift.contact).title();
    if (!lift.rate)
      group.fact("lift-off", fmt::format("{} {} at no rate", name, what));
    else if (*lift.rate == 0.0)
      group.fact("lift-off", fmt::format("{} {} at rest already, at {} = {}", name, what, found.along,
                                         place_in_words(model, found, lift.at)));
    else
      group.fact("lift-off",
                 fmt::format("{} {} first at {}, at {} = {}", name, what, rate_in_words(model, found, *lift.rate),
                             found.along, place_in_words(model, found, lift.at)));
  }
}

}  // namespace poise::app
