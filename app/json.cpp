#include "app/json.hpp"

#include <algorithm>
#include <map>
#include <type_traits>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

namespace poise::app {
namespace {

using Array = std::vector<Json>;
using Object = std::map<std::string, Json>;

}  // namespace

struct Json::Value {
  explicit Value(auto value) : is(std::move(value)) {}

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object> is;

  nlohmann::json to_write() const {
    return std::visit(
        [](const auto& value) -> nlohmann::json {
          using Type = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<Type, Array>) {
            nlohmann::json out = nlohmann::json::array();
            for (const Json& item : value) out.push_back(item.value_->to_write());
            return out;
          } else if constexpr (std::is_same_v<Type, Object>) {
            nlohmann::json out = nlohmann::json::object();
            for (const auto& [name, item] : value) out[name] = item.value_->to_write();
            return out;
          } else {
            return value;
          }
        },
        is);
  }

  /// The name of a member, where this is a list of two that begins with a text.
  const std::string* member_name() const {
    const Array* pair = std::get_if<Array>(&is);
    return pair != nullptr && pair->size() == 2 ? std::get_if<std::string>(&pair->front().value_->is) : nullptr;
  }
};

Json::Json() : Json(nullptr) {}
Json::Json(std::nullptr_t) : value_(std::make_unique<Value>(nullptr)) {}
Json::Json(bool value) : value_(std::make_unique<Value>(value)) {}
Json::Json(double value) : value_(std::make_unique<Value>(value)) {}
Json::Json(const char* text) : Json(std::string(text)) {}
Json::Json(std::string text) : value_(std::make_unique<Value>(std::move(text))) {}
Json::Json(const std::vector<std::string>& texts)
    : value_(std::make_unique<Value>(Array(texts.begin(), texts.end()))) {}
Json::Json(const std::vector<double>& values) : value_(std::make_unique<Value>(Array(values.begin(), values.end()))) {}
Json::Json(Whole<std::int64_t> number) : value_(std::make_unique<Value>(number.value)) {}
Json::Json(Whole<std::uint64_t> number) : value_(std::make_unique<Value>(number.value)) {}
Json::Json(std::initializer_list<Json> items) {
  if (std::all_of(items.begin(), items.end(), [](const Json& item) { return item.value_->member_name() != nullptr; })) {
    Object members;
    for (const Json& item : items)
      members.emplace(*item.value_->member_name(), std::get<Array>(item.value_->is).back());
    value_ = std::make_unique<Value>(std::move(members));
  } else {
    value_ = std::make_unique<Value>(Array(items));
  }
}
Json::Json(const Json& other) : value_(std::make_unique<Value>(*other.value_)) {}
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(Json other) noexcept {
  value_ = std::move(other.value_);
  return *this;
}
Json::~Json() = default;

Json Json::array() {
  Json out;
  out.value_->is = Array();
  return out;
}

Json Json::object() {
  Json out;
  out.value_->is = Object();
  return out;
}

Json& Json::operator[](const std::string& name) {
  if (std::holds_alternative<std::nullptr_t>(value_->is)) value_->is = Object();
  return std::get<Object>(value_->is)[name];
}

bool Json::contains(const std::string& name) const { return std::get<Object>(value_->is).contains(name); }

void Json::push_back(Json item) {
  if (std::holds_alternative<std::nullptr_t>(value_->is)) value_->is = Array();
  std::get<Array>(value_->is).push_back(std::move(item));
}

std::string Json::dump(int indent) const {
  return value_->to_write().dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace poise::app
