#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "design/synthesis/read_synthesis.hpp"

namespace poise::app {

/// The four-bar that is written as a scene, in its first position, with the range of its input, rad.
struct ChosenFourBar {
  FourBar linkage;
  FourBarPose start;
  double from = 0.0, to = 0.0;
};

/// A linkage of a function with its error.
struct GeneratedFunction {
  FunctionLinkage linkage;
  std::optional<StructuralError> error;  ///< of a wanted function, without a defect
  bool suits = false;                    ///< no defect, and of the kind asked for
};

/// All linkages of a task, and which is the best that suits: that of the least structural error, else of the largest
/// transmission angle; -1 where none does.
struct FunctionAnswer {
  FunctionLinkages found;
  std::vector<GeneratedFunction> linkages;
  int best = -1;
};
FunctionAnswer generate(const FunctionSynthesis& task);

/// The best four-bar; empty where none suits.
std::optional<ChosenFourBar> chosen_of(const Guidance& guidance);
std::optional<ChosenFourBar> chosen_of(const FunctionAnswer& answer);

/// What `poise design` shows of four-bars through poses: how many guide the body, whether these are proved to be all,
/// the links, the four-bars with their defects, and as data the curve of centres. `confirmed`: the general kinematics
/// (motion/kinematics.hpp) drove the best through its poses.
Result guidance_result(const SynthesisProblem& problem, const PoseTask& task, const Guidance& guidance,
                       const std::optional<ChosenFourBar>& chosen, bool confirmed);

/// The same of a function, or of pairs of angles.
Result function_result(const SynthesisProblem& problem, const FunctionSynthesis& task, const FunctionAnswer& answer,
                       const std::optional<ChosenFourBar>& chosen, bool confirmed);

/// Charts of the curve of centres, and of the structural error of the best linkage; none where there is neither.
std::vector<Panel> guidance_panels(const SynthesisProblem& problem, const Guidance& guidance);
std::vector<Panel> function_panels(const FunctionAnswer& answer);

}  // namespace poise::app
