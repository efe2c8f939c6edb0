#pragma once

// Runs the built program.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace poise::app_tests {

/// A folder of its own for a test, gone afterwards.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path path(const std::string& name) const { return path_ / name; }
  /// Writes a file into the folder and returns its path.
  std::string write(const std::string& name, std::string_view text) const;
  /// Names of what lies in it, sorted.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

struct ProgramRun {
  int exit_code = -1;  ///< -1 when it was killed
  std::string out;
  std::string err;
};

/// Runs poise with its output in files. `environment` holds further "NAME=VALUE".
ProgramRun run_poise(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {});

/// Runs poise in a terminal of its own, where standard output and error are one.
ProgramRun run_poise_in_terminal(const std::vector<std::string>& arguments,
                                 const std::vector<std::string>& environment = {});

/// Path of one of the project's own scenes: dataset("zeeman").
std::string dataset(const std::string& name);

/// What a file holds.
std::string contents(const std::filesystem::path& file);

/// Why a text is not well-formed XML; empty when it is. Knows elements, attributes, references and text.
std::string objection_to_xml(std::string_view text);

}  // namespace poise::app_tests
