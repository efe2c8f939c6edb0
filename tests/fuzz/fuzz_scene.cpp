// Scene files: whatever is read is compiled, and the text in which its numbers are written anew is read again.
#include "model/rewritten_scene.hpp"
#include "model/scene.hpp"
#include "statics/model/static_model.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  using namespace poise;
  const std::string text(fuzz::text_of(bytes, count));
  const std::string file = (fuzz::folder() / "scene.toml").string();
  Scene scene;
  if (!fuzz::reads([&] { scene = parse_scene(text, file); })) return 0;
  fuzz::reads([&] { const StaticModel model(scene); });
  std::string again;
  if (fuzz::reads([&] { again = rewritten_scene(text, file, scene); })) {
    fuzz::expect(fuzz::reads([&] { parse_scene(again, file); }), "the scene that was written anew is refused");
  }
  return 0;
}
