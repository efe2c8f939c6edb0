// Experiment files, with a scene and data beside them that fit.
#include "identification/experiment/experiment.hpp"
#include "tests/app/wheel_experiment.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  using namespace poise;
  static const bool prepared = [] {
    fuzz::written("wheel.toml", app_tests::wheel);
    fuzz::written("turn.csv", "part,time,turn\na,0,20\na,0.1,18\na,0.2,13\na,0.3,7\nb,0,15\nb,0.1,13\nb,0.2,9\n");
    return true;
  }();
  static_cast<void>(prepared);
  fuzz::reads([&] { parse_experiment(std::string(fuzz::text_of(bytes, count)), fuzz::folder() / "experiment.toml"); });
  return 0;
}
