#include "app/commands/commands.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pybind11/stl.h>

#include "app/commands/call.hpp"
#include "app/present/csv.hpp"
#include "app/present/document.hpp"
#include "app/present/html.hpp"
#include "app/present/json.hpp"
#include "app/present/markdown.hpp"
#include "app/present/text.hpp"
#include "model/nearest_name.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"
#include "python/module/interrupt_scope.hpp"
#include "python/module/listener.hpp"
#include "python/module/lock.hpp"

namespace poise::python {
namespace {

using SharedOutcome = std::shared_ptr<const app::Outcome>;

/// What a command found that was called from Python.
struct CalledOutcome : app::Outcome {
  bool interrupted = false;  ///< by Ctrl-C, or since the listener raised an exception
};

/// The columns of a table by their keys: texts, or numbers with their unit. Of those that have one key, "at[]", the
/// parts of a list, the second is "at[1]".
py::dict columns_of(const app::Table& table, const SharedOutcome& owner) {
  py::dict out;
  std::map<std::string, int> parts;
  for (const app::Column& column : table.columns) {
    if (column.key.empty()) continue;
    const bool is_part = column.key.ends_with("[]");
    const py::str key = text_of(
        is_part ? fmt::format("{}[{}]", column.key.substr(0, column.key.size() - 2), parts[column.key]++) : column.key);
    if (column.is_words()) {
      py::list words;
      for (const std::string& word : column.words) words.append(text_of(word));
      out[key] = words;
    } else if (column.numbers.size() == table.size()) {
      out[key] = py::make_tuple(view_of(column.numbers, owner), text_of(column.unit));
    }
  }
  return out;
}

/// Tables by their place in the data. Those in lists of parts, such as the points of a path, are left out: there are
/// very many, and the table of the CSV file has columns over all parts.
void add_tables(py::dict& out, const app::Group& group, const std::string& path, const SharedOutcome& owner) {
  const auto below = [&](const std::string& key) {
    return path.empty() || key.empty() ? path + key : path + "." + key;
  };
  for (const app::Item& item : group.items()) {
    if (const auto* table = std::get_if<app::Table>(&item.content); table != nullptr && !item.key.empty()) {
      out[text_of(below(item.key))] = columns_of(*table, owner);
    } else if (const auto* branch = std::get_if<app::Branch>(&item.content); branch != nullptr && !branch->array) {
      for (const app::Group& part : branch->parts) add_tables(out, part, below(item.key), owner);
    }
  }
}

std::string page_of(const app::Outcome& outcome) {
  return app::html_page(app::page_document(outcome.result, outcome.origin, outcome.pictures.figures));
}

/// Whether the verdict or a warning says that the work was interrupted.
bool says_interrupted(const app::Result& result) {
  const auto says = [](const app::Line& line) { return line.text.find("nterrupted") != std::string::npos; };
  return says(result.verdict) || std::any_of(result.warnings.begin(), result.warnings.end(), says);
}

std::shared_ptr<CalledOutcome> call_command(const std::string& command, const std::vector<app::GivenOption>& options,
                                            const std::shared_ptr<SceneObject>& scene, bool pictures,
                                            const py::object& progress) {
  app::Caller caller;
  if (scene != nullptr) caller.scene = scene->as_read();
  caller.wants_pictures = pictures;
  Listener listener(progress, caller.interrupt);
  if (listener.is_wanted()) caller.listener = [&listener](const std::string& doing) { listener(doing); };
  const InterruptScope scope(caller.interrupt);
  {
    const WithoutLock others;
    app::call(command, options, caller);
  }
  scope.hand_back_unless(says_interrupted(caller.outcome.result));
  listener.rethrow();
  return std::make_shared<CalledOutcome>(CalledOutcome{std::move(caller.outcome), caller.interrupt});
}

py::list table_of_commands() {
  py::list out;
  for (const app::CommandEntry& entry : app::all_commands()) {
    py::list options;
    for (const app::Option& option : entry.command.options) {
      options.append(py::dict(py::arg("name") = option.name, py::arg("kind") = app::kind_of(option),
                              py::arg("value") = option.value, py::arg("help") = option.help,
                              py::arg("required") = option.presence == app::Presence::required));
    }
    out.append(py::dict(py::arg("name") = entry.command.name, py::arg("help") = entry.command.help,
                        py::arg("example") = entry.example, py::arg("options") = options));
  }
  return out;
}

void bind_outcome(py::module_& m) {
  using Shared = std::shared_ptr<app::Outcome>;
  py::class_<app::Outcome, Shared>(m, "Outcome", "What a command found.")
      .def_readonly("code", &app::Outcome::code)
      .def_property_readonly("verdict", [](const app::Outcome& self) { return text_of(self.result.verdict.text); })
      .def_property_readonly("warnings",
                             [](const app::Outcome& self) {
                               py::list out;
                               for (const app::Line& line : self.result.warnings) out.append(text_of(line.text));
                               return out;
                             })
      .def(
          "text",
          [](const app::Outcome& self, int level) {
            const app::Verbosity levels[] = {app::Verbosity::quiet, app::Verbosity::normal, app::Verbosity::verbose};
            return text_of(app::plain_text(self.result, app::Palette{}, levels[level < 0 ? 0 : level > 2 ? 2 : level]));
          },
          py::arg("level") = 1)
      .def("to_dict", [](const app::Outcome& self) { return to_python(app::result_json(self.result)); })
      .def("json", [](const app::Outcome& self) { return text_of(app::json_text(self.result)); })
      .def("csv",
           [](const app::Outcome& self) {
             return self.result.csv() != nullptr ? text_of(app::csv_text(*self.result.csv())) : py::str();
           })
      .def("markdown", [](const app::Outcome& self) { return text_of(app::markdown_text(self.result)); })
      .def("page", [](const app::Outcome& self) { return text_of(page_of(self)); })
      .def_property_readonly("svg", [](const app::Outcome& self) { return text_of(self.pictures.svg); })
      .def_property_readonly("written", [](const app::Outcome& self) { return text_of(self.written); })
      .def("columns",
           [](const Shared& self) {
             const app::Table* const table = self->result.csv();
             return table != nullptr ? columns_of(*table, self) : py::dict();
           })
      .def("tables", [](const Shared& self) {
        py::dict out;
        add_tables(out, self->result.content, "", self);
        return out;
      });
}

}  // namespace

void bind_commands(py::module_& m) {
  bind_outcome(m);
  py::class_<CalledOutcome, app::Outcome, std::shared_ptr<CalledOutcome>>(m, "CalledOutcome", "What a call found.")
      .def_readonly("interrupted", &CalledOutcome::interrupted);
  m.def("commands", table_of_commands);
  m.def("si_unit", si_unit, py::arg("unit"));
  m.def("did_you_mean", did_you_mean_or_list, py::arg("name"), py::arg("known"));
  m.def("call", call_command);
}

}  // namespace poise::python
