#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "design/synthesis/function_generation.hpp"
#include "design/synthesis/guidance.hpp"
#include "model/units.hpp"

namespace poise {

enum class SynthesisKind { poses, function, path };

/// The `kind` of the table [synthesis] of a design file. Throws InputError.
SynthesisKind synthesis_kind(const std::filesystem::path& file);

/// A function, or pairs of angles, that a four-bar is to generate.
struct FunctionSynthesis {
  FunctionTask task{};
  std::optional<WantedFunction> wanted{};
  std::vector<double> points{};  ///< x of the pairs, where a function is wanted
  std::optional<GrashofKind> kind{};
};

struct SynthesisProblem {
  std::string file{}, title{}, source{};
  Units units{};
  std::variant<PoseTask, FunctionSynthesis> task{};
};

/// Reads a design file (TOML; docs/synthesis.md) of the kind "poses" or "function". Throws InputError.
SynthesisProblem read_synthesis(const std::filesystem::path& file);

}  // namespace poise
