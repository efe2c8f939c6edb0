// Tables of measurements: read column by column, with and without gaps, and as the data of an experiment.
#include "identification/experiment/experiment.hpp"
#include "model/csv_table.hpp"
#include "model/toml_text.hpp"
#include "tests/app/wheel_experiment.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  using namespace poise;
  fuzz::written("wheel.toml", app_tests::wheel);
  const std::filesystem::path data = fuzz::written("data.csv", fuzz::text_of(bytes, count));
  std::vector<std::string> header;
  if (!fuzz::reads([&] { header = read_csv_header(data); })) return 0;
  fuzz::reads([&] { read_csv(data, header); });
  fuzz::reads([&] { read_csv(data, header, {}, header); });
  fuzz::reads([&] { read_csv(data, {header.front()}, {header.back()}); });
  std::string experiment = app_tests::wheel_unknowns;
  const std::string noise = "noise = 0.02\n";
  experiment.insert(experiment.find(noise) + noise.size(), "column = " + toml_string(header.back()) + "\n");
  experiment +=
      fmt::format("[[run]]\nname = \"measured\"\ndata = \"data.csv\"\ntime = {}\n", toml_string(header.front()));
  fuzz::reads([&] { parse_experiment(experiment, fuzz::folder() / "experiment.toml"); });
  return 0;
}
