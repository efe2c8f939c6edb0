#include "app/results/motion/response.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "model/controllers.hpp"
#include "model/joint_friction.hpp"
#include "motion/equilibrium_pose.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise::app {
namespace {

struct ResponseRequest {
  Request common;
  std::string excite;
  std::vector<std::string> of;
  std::optional<double> from, to, amplitude;
  std::string at;
  int steps = 200;
  std::string seek = "settle";
};

constexpr int most_frequencies = 100'000;

void check(const ResponseRequest& request) {
  for (const auto& [option, value] : {std::pair("--from", request.from), std::pair("--to", request.to)}) {
    if (value) expect_number(option, *value, *value > 0, "a frequency > 0, Hz");
  }
  if (request.amplitude) expect_number("--amplitude", *request.amplitude, *request.amplitude > 0, "a number > 0");
  expect_between("--steps", request.steps, 2, most_frequencies);
  if (!request.at.empty() && !request.amplitude) {
    throw InputError("--at: it asks for all periodic motions of one amplitude; expected --amplitude too");
  }
}

SoughtQuantity read_of(const ResponseRequest& request, const Scene& scene) {
  std::vector<SoughtQuantity> of = read_quantities("--of", request.of, scene, AskedOf::motion);
  if (of.size() != 1) throw InputError(fmt::format("--of: expected one quantity, found {}", of.size()));
  try {
    refuse_without_response(scene, of[0]);
  } catch (const InputError& error) {
    throw InputError(std::string("--of ") + error.what());
  }
  return of[0];
}

Excitation read_excitation(const ResponseRequest& request, const Scene& scene) {
  try {
    return excitation_of(scene, request.excite);
  } catch (const InputError& error) {
    throw InputError(std::string("--excite ") + error.what());
  }
}

/// The range asked for; what is not given is that about the natural frequencies.
void read_range(const ResponseRequest& request, ResponseAnswer& answer) {
  const std::optional<solvers::Bracket> usual = answer.linear->usual_range();
  if (!usual && !(request.from && request.to)) {
    throw InputError("--from: no mode oscillates, so that no range of frequencies is usual; expected --from and --to");
  }
  answer.from = request.from ? *request.from : usual->from;
  answer.to = request.to ? *request.to : usual->to;
  if (answer.from < answer.to) return;
  throw InputError(fmt::format("--to: expected more than {:.6g} Hz, at which the range begins, found {:.6g}",
                               answer.from, answer.to));
}

std::vector<double> read_at(const ResponseRequest& request, const ResponseAnswer& answer) {
  if (request.at.empty()) return {};
  std::vector<double> out = read_numbers("--at", request.at);
  for (const double one : out) {
    expect_number("--at", one, one >= answer.from && one <= answer.to,
                  fmt::format("frequencies from {:.6g} to {:.6g} Hz", answer.from, answer.to));
  }
  return out;
}

/// The response at evenly spaced frequencies, at all peaks and troughs, and none where it is unbounded.
void respond(const ResponseRequest& request, ResponseAnswer& answer) {
  const FrequencyResponse& linear = *answer.linear;
  answer.at_rest = linear.at(0.0);
  answer.resonances = linear.resonances(answer.from, answer.to);
  answer.frequency = FrequencyResponse::frequencies(answer.from, answer.to, request.steps);
  for (const Resonance& one : answer.resonances) answer.frequency.push_back(one.frequency);
  std::sort(answer.frequency.begin(), answer.frequency.end());
  answer.frequency.erase(std::unique(answer.frequency.begin(), answer.frequency.end()), answer.frequency.end());
  for (const double frequency : answer.frequency) {
    const bool unbounded = std::any_of(answer.resonances.begin(), answer.resonances.end(), [&](const Resonance& one) {
      return one.kind == Resonance::Kind::unbounded && std::abs(one.frequency - frequency) <= 1e-9 * frequency;
    });
    answer.value.push_back(unbounded ? std::complex<double>(NAN, NAN) : linear.at(frequency));
  }
}

PeriodicResponse swing(const ResponseRequest& request, const Scene& scene, const MotionModel& model,
                       const std::vector<double>& x, const ResponseAnswer& answer, Progress& progress) {
  PeriodicOptions options;
  options.amplitude = answer.amplitude;
  options.from = answer.from;
  options.to = answer.to;
  options.at = answer.at;
  options.interrupt = &request.common.interrupt();
  options.progress = [&](double frequency) {
    progress.now_and_then([&] { return fmt::format("following periodic motions: {:.4g} Hz", frequency); });
  };
  return periodic_response(scene, model, x, *answer.linear, answer.excitation, answer.of, options);
}

int run_response(const ResponseRequest& request, const Palette& palette) {
  check(request);
  SolveOptions options;
  options.seek = read_seek(request.seek);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const Scene written = load_moving_scene(request.common);
  const Scene scene = scene_at_rest(written);
  ResponseAnswer answer;
  answer.of = read_of(request, scene);
  answer.excitation = read_excitation(request, scene);
  if (request.amplitude) answer.amplitude = *request.amplitude * answer.excitation.dimension.unit(scene.units);
  const MotionModel model(scene);
  OutputFiles files(request.common);
  options.interrupt = &request.common.interrupt();
  if (request.amplitude) {
    refuse_controllers(scene, "periodic motions of an amplitude");
    refuse_blades(scene, "periodic motions of an amplitude");
    for (const Element& element : scene.elements) {
      if (!is_motor(element.law)) continue;
      throw InputError(fmt::format(
          "{}:{}: motor \"{}\": periodic motions of an amplitude are not known here with motors; expected a scene "
          "without it",
          scene.file, element.line, element.name));
    }
  }

  progress.now("looking for the equilibrium");
  std::vector<double> x;
  answer.loop = loop_where_kept(model);
  if (!answer.loop) {
    const StaticModel statics(scene);
    answer.equilibrium = solve(statics, options);
    if (answer.equilibrium.found()) {
      x = motion_coordinates(model, statics, answer.equilibrium.x);
      answer.linear = std::make_unique<const FrequencyResponse>(model, x, answer.excitation, answer.of);
    }
  } else if (answer.loop->known) {
    answer.linear = std::make_unique<const FrequencyResponse>(model, *answer.loop, answer.excitation, answer.of);
  }
  if (answer.linear) {
    if (request.amplitude) refuse_without_periodic_response(scene, *answer.linear, answer.excitation);
    if (answer.linear->modes().known) {
      read_range(request, answer);
      answer.at = read_at(request, answer);
      progress.now("computing the response");
      respond(request, answer);
      if (request.amplitude && answer.is_stable()) {
        answer.periodic = swing(request, scene, model, x, answer, progress);
      }
    }
  }
  const Result result = response_result(written, answer, request.common.settings);
  const std::vector<Panel> panels = response_panels(scene.units, answer);
  Pictures pictures;
  if (!panels.empty() && files.wants_svg()) pictures.svg = draw_plot(panels);
  if (!panels.empty() && files.wants_html()) pictures.figures = chart_figures("Response over the frequency", panels);
  return finish(request.common, result, &files, pictures, answer.is_answered(), progress, palette);
}

}  // namespace

Command response_command() {
  const auto request = std::make_shared<ResponseRequest>();
  Command command{"response", "Find amplitude and phase over the frequency of what swings about an equilibrium"};
  add_scene_options(command, request->common);
  command.add({"--excite", &request->excite, "NUMBER",
               "What swings as a cosine: a load, load.NAME, a number of a spring, say\n"
               "spring.NAME.free_length, or controller.NAME.reference (docs/response.md)",
               Presence::required});
  command.add({"--of", &request->of, "NAME",
               "What answers: x.BODY.POINT, angle.BODY, travel.JOINT, length.ELEMENT,\n"
               "force.ELEMENT, d(A)/dt, or an expression of them (docs/quantities.md)",
               Presence::required});
  command.add({"--from", &request->from, "HZ", "Lowest frequency (a tenth of the lowest natural frequency)"});
  command.add({"--to", &request->to, "HZ", "Highest frequency (three times the highest natural frequency)"});
  command.add({"--steps", &request->steps, "N", "Frequencies between, on a logarithmic scale (200)"});
  command.add({"--amplitude", &request->amplitude, "NUMBER",
               "Amplitude of a load, in its unit: follow the periodic motions, which\n"
               "may fold and jump, in place of the response to first order"});
  command.add({"--at", &request->at, "LIST", "Frequencies, Hz, of which all periodic motions are listed"});
  add_seek_option(command, request->seek);
  add_output_options(command, request->common,
                     {.svg = "Draw amplitude and phase over the frequency into FILE",
                      .csv = "Write a line for each frequency, or point of a branch, to FILE"});
  command.run = [request](const Palette& palette) { return run_response(*request, palette); };
  return command;
}

}  // namespace poise::app
