#include <cctype>
#include <optional>
#include <set>

#include "model/expression.hpp"
#include "model/part_placing.hpp"

namespace poise {
namespace {

bool is_letter_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

}  // namespace

namespace parts {

void fail_number_taken(const TomlPlace& place, const std::string& name) {
  place.fail("expected numbers of different names, found two called \"" + name +
             "\": one that all parts of a file share, and one that a part gives; give the part another name");
}

namespace {

/// The expression with other names in the place of its own: rename(name) of each that is neither pi nor a function.
template <class Rename>
std::string renamed(std::string_view text, Rename rename) {
  const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  const auto is_letter = [&](std::size_t i) { return i < text.size() && is_letter_of_name(text[i]); };
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t begin = i;
    if (is_digit(i) || (text[i] == '.' && is_digit(i + 1))) {
      while (is_digit(i) || (i < text.size() && text[i] == '.')) ++i;
      if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        const std::size_t sign = i + 1 < text.size() && (text[i + 1] == '+' || text[i + 1] == '-') ? 1 : 0;
        if (is_digit(i + 1 + sign)) i += 1 + sign;
        while (is_digit(i)) ++i;
      }
      out += text.substr(begin, i - begin);
    } else if (is_letter(i)) {
      while (is_letter(i) || (i < text.size() && text[i] == '.' && is_letter(i + 1))) ++i;
      const std::string name(text.substr(begin, i - begin));
      const std::size_t next = text.find_first_not_of(" \t\r\n", i);
      const bool is_called = next != std::string_view::npos && text[next] == '(';
      out += is_called || name == "pi" ? name : rename(name);
    } else {
      out += text[i++];
    }
  }
  return out;
}

}  // namespace

void Placing::scope_numbers() {
  toml::table none;  // where the part has no numbers
  toml::table* const numbers = part_.document.contains("numbers") ? table_in(part_.document, "numbers") : &none;
  if (numbers == nullptr) {
    TomlTable(part_.document, part_.place, nullptr, &shared_.out.files_).find_table("numbers");
    return;
  }
  std::set<std::string> own;
  if (group_.numbers != nullptr) {
    for (auto&& [key, node] : *group_.numbers) own.insert(std::string(key.str()));
  }
  for (bool grows = !own.empty(); grows;) {
    grows = false;
    for (auto&& [key, node] : *numbers) {
      const std::string name(key.str());
      if (!node.is_string() || own.contains(name)) continue;
      bool uses = false;
      renamed(node.as_string()->get(), [&](const std::string& used) {
        uses = uses || own.contains(used);
        return used;
      });
      if (uses) grows = own.insert(name).second || grows;
    }
  }
  for (auto&& [key, node] : *numbers) {
    const std::string name(key.str());
    scoped_[name] = (own.contains(name) ? group_.name : group_.number_scope) + "." + name;
  }
  for (PartUse* const one : part_.uses) {
    for (auto& [path, name] : one->replaced) name = scoped(name);
  }
  toml::table* const above = own.empty() ? nullptr : made_table(level_.document, "numbers");
  if (group_.numbers != nullptr && above != nullptr) {
    const TomlTable given = *group_.table->find_table("numbers");
    for (auto&& [key, node] : *group_.numbers) {
      const std::string path(key.str());
      const bool is_named = numbers->contains(path);
      const std::string name = group_.name + "." + name_in_expressions(path);
      if (!is_named) use_.replaced[name_in_expressions(path)] = name;
      if (k_ > 1) continue;
      if (!is_named) {
        TomlPlace place = given.place_of(path);
        shared_.out.replacements_.push_back({&use_, path, std::move(place)});
      }
      if (above->contains(name) || shared_.globals.contains(name)) fail_number_taken(given.place_of(path), name);
      // Left in its table, which other instances look into.
      const toml::key at(name, key.source());
      above->insert_or_assign(at, std::move(node));
    }
  }
  for (auto&& [key, node] : *numbers) {
    const std::string name(key.str());
    const bool is_own = own.contains(name);
    if (is_own && group_.numbers != nullptr && group_.numbers->contains(name)) continue;
    toml::table* const to = is_own ? above : &shared_.globals;
    if (to == nullptr || to->contains(scoped_[name])) continue;
    if (node.is_string()) rename(*node.as_string());
    to->insert_or_assign(toml::key(scoped_[name], key.source()), std::move(node));
  }
  part_.document.erase("numbers");
}

std::string Placing::scoped(const std::string& name) const {
  const auto found = scoped_.find(name);
  if (found != scoped_.end()) return found->second;
  return shared_.globals.contains(name) ? name : group_.number_scope + "." + name;
}

void Placing::multiply_scales() const {
  for (PartUse* const one : part_.uses) {
    const auto in_document = [&](const std::string& name) { return scoped(name); };
    const Amount scale = Amount{one->scale, renamed(one->scale_text, in_document)} * group_.scale;
    if (!group_.scale.is_number()) one->scale_place = group_.table->place_of("scale");
    one->scale = scale.is_number() ? scale.value : 1.0;
    one->scale_text = scale.text;
  }
}

void Placing::rename(toml::value<std::string>& expression, std::string_view but) const {
  expression = renamed(expression.get(), [&](const std::string& name) { return name == but ? name : scoped(name); });
}

}  // namespace parts

void check_number_name(const std::string& name, const TomlTable& numbers) {
  if (Expression::is_name(name)) return;
  numbers.place_of(name).fail(
      "expected a name of letters, digits and underscores that does not begin with a digit and is neither pi nor a "
      "function");
}

std::string name_in_expressions(std::string_view path) {
  std::string out;
  for (const char c : path) out += is_letter_of_name(c) || c == '.' ? c : '_';
  if (out.empty() || (out.front() >= '0' && out.front() <= '9')) out.insert(0, "_");
  return out;
}

}  // namespace poise
