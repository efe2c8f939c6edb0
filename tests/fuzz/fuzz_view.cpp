// What a page sends to `poise view`: a request in JSON on each line, or a scene as text. Every answer is JSON, an error
// changes nothing, and the state can always be looked at.
#include <nlohmann/json.hpp>

#include "app/view/view_session.hpp"
#include "model/text_file.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

constexpr int most_requests = 12;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  using namespace poise;
  using nlohmann::json;
  static const std::string four_bar =
      read_text_file(std::filesystem::path(POISE_SOURCE_DIR) / "datasets/four_bar_gravity.toml");
  app::ViewSession session(fuzz::written("scene.toml", four_bar));
  std::string_view text = fuzz::text_of(bytes, count);
  const auto act = [&](json request) {
    // Most requests are to get beyond this check.
    if (!request.contains("revision")) request["revision"] = session.poll(0)["revision"];
    const json answer = json::parse(session.act(request));
    if (answer.contains("error")) {
      const json now = json::parse(session.act({{"do", "look"}}));
      fuzz::expect(!now.contains("error"), "the state cannot be looked at after " + answer["error"].dump());
    }
  };
  if (text.empty() || text.front() != '{') {
    act({{"do", "text"}, {"text", std::string(text)}});
    return 0;
  }
  for (int k = 0; k < most_requests && !text.empty(); ++k) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    json request = json::parse(line, nullptr, false);
    act(request.is_object() ? request : json::object());
  }
  return 0;
}
