#include "exchange/private/pmks_words.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "exchange/private/reading.hpp"
#include "model/input_error.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr std::string_view pmks_digits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-";
constexpr std::size_t check_characters = 62;  // the first of these
constexpr std::size_t most_digits = 8;        // 2^48, exact as a double
constexpr double thousand = 1000.0;

std::optional<std::int64_t> whole(std::string_view word) {
  if (word.empty() || word.size() > most_digits + 1) return std::nullopt;
  const bool is_negative = word.size() > 1 && word.front() == '0';
  std::int64_t value = 0;
  for (const char c : word) {
    const std::size_t digit = pmks_digits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    value = value * 64 + static_cast<std::int64_t>(digit);
  }
  return is_negative ? -value : value;
}

std::string digits_of(std::int64_t value) {
  std::string out;
  for (std::int64_t rest = std::abs(value); rest > 0 || out.empty(); rest /= 64) {
    out.insert(out.begin(), pmks_digits[static_cast<std::size_t>(rest % 64)]);
  }
  return value < 0 ? "0" + out : out;
}

std::string digits_of(double value) {
  constexpr double largest = 1e11;  // of eight digits
  if (!(std::abs(value) < largest)) {
    throw InputError(fmt::format("--pmks: expected numbers within {:g} of their units, found {:g}", largest, value));
  }
  return digits_of(static_cast<std::int64_t>(std::llround(value * thousand)));
}

char check_character(std::size_t length) { return pmks_digits[length % check_characters]; }

/// The words of an address in their order.
class PmksReader {
 public:
  PmksReader(std::string_view text, const std::string& file) : rest_(text), file_(file) {}

  [[noreturn]] void fail(const std::string& message) const { fail_at(file_, 1, item_, message); }
  void now_at(std::string item) { item_ = std::move(item); }
  bool is_at_end() const { return rest_.empty(); }

  /// The text up to a mark, which is taken too; all where there is none.
  std::string_view up_to(char mark) {
    const std::size_t end = rest_.find(mark);
    const std::string_view out = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return out;
  }
  /// The next record, or none where the list is closed by a full stop or the text ends.
  std::optional<std::string_view> record(std::size_t read) {
    if (read > most_items) fail(fmt::format("expected at most {} of a kind", most_items));
    if (rest_.empty()) return std::nullopt;
    if (rest_.front() == '.') {
      rest_.remove_prefix(1);
      return std::nullopt;
    }
    return up_to('.');
  }
  double number(std::string_view word) const { return static_cast<double>(whole_number(word)) / thousand; }
  std::int64_t whole_number(std::string_view word) const {
    const std::optional<std::int64_t> value = whole(word);
    if (!value) fail(fmt::format("expected a number in the digits of PMKS+, found \"{}\"", one_line(word)));
    return *value;
  }
  std::int64_t flags(std::string_view word) const {
    std::int64_t bits = 0;
    for (const char c : word) {
      const std::size_t digit = pmks_digits.find(c);
      if (digit == std::string_view::npos || word.size() > 2) {
        fail(fmt::format("expected flags, found \"{}\"", one_line(word)));
      }
      bits = bits * 64 + static_cast<std::int64_t>(digit);
    }
    return bits;
  }

 private:
  std::string_view rest_;
  const std::string& file_;
  std::string item_ = "address";
};

std::vector<std::string_view> words_of_record(std::string_view record) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t comma = record.find(',');
    out.push_back(record.substr(0, comma));
    if (comma == std::string_view::npos) return out;
    record.remove_prefix(comma + 1);
  }
}

PmksJoint read_pmks_joint(PmksReader& reader, std::string_view record) {
  const std::vector<std::string_view> words = words_of_record(record);
  if (words.size() != 5 && words.size() != 8) {
    reader.fail(
        fmt::format("expected a joint as id, name, x, y, angle, and of a slot its link and two joints, found {}",
                    one_line(record)));
  }
  PmksJoint out;
  const std::int64_t flags = reader.flags(words[0].substr(0, 1));
  out.slides = (flags & 1) != 0;
  out.is_input = (flags & 2) != 0;
  out.is_grounded = (flags & 4) != 0;
  out.is_welded = (flags & 8) != 0;
  out.id = words[0].substr(std::min<std::size_t>(words[0].size(), 1));
  if (out.id.empty()) reader.fail("expected a joint with an id");
  reader.now_at(fmt::format("joint \"{}\"", one_line(out.id)));
  out.name = words[1];
  out.x = reader.number(words[2]);
  out.y = reader.number(words[3]);
  out.angle = reader.number(words[4]);
  if (words.size() == 8) {
    out.carrier = words[5];
    out.from = words[6];
    out.to = words[7];
  }
  return out;
}

PmksLink read_pmks_link(PmksReader& reader, std::string_view record) {
  const std::vector<std::string_view> words = words_of_record(record);
  const std::string_view first = words[0];
  const bool is_known =
      first.size() > 2 && (first[0] == 'Y' || first[0] == 'N') && (first[1] == 'R' || first[1] == 'P');
  if (words.size() < 8 || !is_known) {
    reader.fail(
        fmt::format("expected a link as YR or YP with its id, name, mass, inertia, x, y, colour and joints, "
                    "found {}",
                    one_line(record)));
  }
  PmksLink out;
  out.is_root = first[0] == 'Y';
  out.is_block = first[1] == 'P';
  out.id = first.substr(2);
  reader.now_at(fmt::format("link \"{}\"", one_line(out.id)));
  out.name = words[1];
  out.mass = reader.number(words[2]);
  out.inertia = reader.number(words[3]);
  if (out.mass < 0 || out.inertia < 0) reader.fail("expected a mass and an inertia >= 0");
  out.x = reader.number(words[4]);
  out.y = reader.number(words[5]);
  auto word = words.begin() + 7;  // behind the colour
  for (; word != words.end() && !word->empty(); ++word) out.joints.emplace_back(*word);
  for (; word != words.end(); ++word) {
    if (!word->empty()) out.parts.emplace_back(*word);
  }
  return out;
}

PmksForce read_pmks_force(PmksReader& reader, std::string_view record) {
  const std::vector<std::string_view> words = words_of_record(record);
  if (words.size() != 8 || words[0].size() < 2) {
    reader.fail(fmt::format("expected a force as id, link, name, x, y, x, y, size, found {}", one_line(record)));
  }
  PmksForce out;
  const std::int64_t flags = reader.flags(words[0].substr(0, 1));
  out.is_local = (flags & 1) != 0;
  out.is_outward = (flags & 2) != 0;
  out.id = words[0].substr(1);
  reader.now_at(fmt::format("force \"{}\"", one_line(out.id)));
  out.link = words[1];
  out.name = words[2];
  out.x = reader.number(words[3]);
  out.y = reader.number(words[4]);
  out.to_x = reader.number(words[5]);
  out.to_y = reader.number(words[6]);
  out.size = reader.number(words[7]);
  return out;
}

}  // namespace

PmksMechanism read_pmks_query(std::string_view query, const std::string& file) {
  PmksReader reader(query.substr(0, query.empty() ? 0 : query.size() - 1), file);
  if (query.size() < 2) reader.fail("expected the address of a mechanism, found nothing behind its question mark");
  if (const char check = check_character(query.size() - 1); query.back() != check) {
    reader.fail(fmt::format("expected {} as the last character, which counts the others, found {}; copy all of it",
                            check, one_line(query.substr(query.size() - 1))));
  }
  PmksMechanism out;
  const std::int64_t flags = reader.flags(reader.up_to('.'));
  out.is_clockwise = (flags & 1) != 0;
  out.has_gravity = (flags & 2) != 0;
  reader.up_to('.');  // the size of symbols
  out.speed = reader.whole_number(words_of_record(reader.up_to('.'))[0]);
  const std::string_view units = reader.up_to('.');
  reader.now_at("units");
  if (units.empty() || units[0] < '0' || units[0] > '2') {
    reader.fail(fmt::format("expected 0, 1 or 2 for inches, centimetres or metres, found \"{}\"",
                            one_line(units.substr(0, 1))));
  }
  out.length = static_cast<PmksMechanism::Length>(units[0] - '0');
  reader.now_at("joints");
  while (const auto record = reader.record(out.joints.size())) out.joints.push_back(read_pmks_joint(reader, *record));
  reader.now_at("links");
  while (const auto record = reader.record(out.links.size())) out.links.push_back(read_pmks_link(reader, *record));
  reader.now_at("forces");
  while (const auto record = reader.record(out.forces.size())) out.forces.push_back(read_pmks_force(reader, *record));
  return out;
}

std::string pmks_query(const PmksMechanism& mechanism) {
  constexpr std::int64_t grids = 8 + 16, forces = 128;  // what is shown
  const auto bits = [](bool first, bool second, bool third = false, bool fourth = false) {
    return (first ? 1 : 0) + (second ? 2 : 0) + (third ? 4 : 0) + (fourth ? 8 : 0);
  };
  std::string flags = digits_of(std::int64_t{bits(mechanism.is_clockwise, mechanism.has_gravity)} + grids + forces);
  // Length, angles in degrees, force, system of units.
  constexpr std::string_view units[] = {"0000", "1011", "2012"};
  std::string out = fmt::format("{}.{}.{},0.{}.", flags, digits_of(1.0), digits_of(mechanism.speed),
                                units[static_cast<std::size_t>(mechanism.length)]);
  for (const PmksJoint& joint : mechanism.joints) {
    const int of_joint = bits(joint.slides, joint.is_input, joint.is_grounded, joint.is_welded);
    out += fmt::format("{}{},{},{},{},{}", digits_of(std::int64_t{of_joint}), joint.id, joint.name, digits_of(joint.x),
                       digits_of(joint.y), digits_of(joint.angle));
    if (!joint.carrier.empty()) out += fmt::format(",{},{},{}", joint.carrier, joint.from, joint.to);
    out += ".";
  }
  out += ".";
  for (const PmksLink& link : mechanism.links) {
    out += fmt::format("Y{}{},{},{},{},{},{},c5cae9,", link.is_block ? "P" : "R", link.id, link.name,
                       digits_of(link.mass), digits_of(link.inertia), digits_of(link.x), digits_of(link.y));
    for (const std::string& joint : link.joints) out += joint + ",";
    out += ",.";
  }
  out += ".";
  for (const PmksForce& force : mechanism.forces) {
    out += fmt::format("{}{},{},{},{},{},{},{},{}.", digits_of(std::int64_t{bits(force.is_local, force.is_outward)}),
                       force.id, force.link, force.name, digits_of(force.x), digits_of(force.y), digits_of(force.to_x),
                       digits_of(force.to_y), digits_of(force.size));
  }
  out += ".N";
  return out + check_character(out.size());
}

}  // namespace poise
