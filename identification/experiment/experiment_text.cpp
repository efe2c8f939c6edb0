#include "identification/experiment/experiment_text.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "identification/experiment/experiment.hpp"
#include "model/named_number.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"

namespace poise {
namespace {
namespace fs = std::filesystem;

/// The table under a key, which is added where there is none.
toml::table& table_in(toml::table& owner, const std::string& key) {
  if (owner.get_as<toml::table>(key) == nullptr) owner.insert_or_assign(key, toml::table());
  return *owner.get_as<toml::table>(key);
}

/// Inputs of readings at rest have a list with a number for each row: a planned one has a single row.
void put(toml::table& owner, const std::string& table, const std::string& key, double value) {
  toml::table& to = table.empty() ? owner : table_in(owner, table);
  if (table == "inputs")
    to.insert_or_assign(key, toml::array{value});
  else
    to.insert_or_assign(key, value);
}

void take_out(toml::table& owner, const std::string& table, const std::string& key) {
  if (table.empty()) {
    owner.erase(key);
    return;
  }
  toml::table* const inner = owner.get_as<toml::table>(table);
  if (inner == nullptr) return;
  inner->erase(key);
  if (inner->empty()) owner.erase(table);
}

/// Whether an unknown or a known number differs by that label.
bool is_used(const Experiment& experiment, std::string_view label) {
  const auto is_per = [&](const auto& number) { return number.per == label; };
  return std::any_of(experiment.unknowns.begin(), experiment.unknowns.end(), is_per) ||
         std::any_of(experiment.known.begin(), experiment.known.end(), is_per);
}

/// A run of the file without its name, its seed, and what the plan varies.
toml::table bare(toml::table run, const Experiment& experiment) {
  run.erase("name");
  run.erase("seed");
  for (const PlanChoice& choice : experiment.plan->vary) take_out(run, choice.table, choice.key);
  if (toml::table* const labels = run.get_as<toml::table>("labels")) {
    std::vector<std::string> unused;
    for (const auto& [label, value] : *labels) {
      if (!is_used(experiment, label.str())) unused.emplace_back(label.str());
    }
    for (const std::string& label : unused) take_out(run, "labels", label);
  }
  return run;
}

/// Names the sensors that a run reads where it does not, and not all are read in it.
void name_sensors(toml::table& table, const std::string& name, const Experiment& experiment) {
  const auto run =
      std::find_if(experiment.runs.begin(), experiment.runs.end(), [&](const Run& r) { return r.name == name; });
  if (run == experiment.runs.end() || run->sensors.empty() || table.contains("sensors")) return;
  if (run->sensors.size() == experiment.sensors.size()) return;
  toml::array names;
  for (const std::size_t k : run->sensors) names.push_back(experiment.sensors[k].name);
  table.insert_or_assign("sensors", std::move(names));
}

/// Visits the tables of a list, each with its name or the one that it has by default.
template <class Visit>
void for_each_table(const toml::table& root, const std::string& key, Visit visit) {
  const toml::array* const tables = root.get_as<toml::array>(key);
  if (tables == nullptr) return;
  for (std::size_t i = 0; i < tables->size(); ++i) {
    const toml::table& table = *tables->at(i).as_table();
    visit(table, table["name"].value_or(key + " " + std::to_string(i + 1)));
  }
}

/// Takes out sensors that none of the runs reads, and unknown and known numbers that are of these.
void leave_out_unread(toml::table& root, const toml::array& runs) {
  toml::array& sensors = *root.get_as<toml::array>("sensor");
  std::set<std::string> read;
  for (const toml::node& node : runs) {
    const toml::array* const names = node.as_table()->get_as<toml::array>("sensors");
    if (names == nullptr) return;
    for (const toml::node& name : *names) read.insert(name.value_or(std::string()));
  }
  for (auto sensor = sensors.begin(); sensor != sensors.end();) {
    const std::string name = (*sensor->as_table())["name"].value_or(std::string());
    if (read.contains(name)) {
      ++sensor;
      continue;
    }
    sensor = sensors.erase(sensor);
    for (const char* const table : {"unknown", "known"}) {
      toml::array* const numbers = root.get_as<toml::array>(table);
      if (numbers == nullptr) continue;
      for (auto number = numbers->begin(); number != numbers->end();) {
        const std::string path = (*number->as_table())["path"].value_or(std::string());
        const bool of_it = path.starts_with("sensor." + name + ".") && path.rfind('.') == name.size() + 7;
        number = of_it ? numbers->erase(number) : std::next(number);
      }
    }
  }
}

/// Writes what toml++ writes, with numbers as short as they are when read back, the name or title of a table
/// first and the runs of an experiment last.
class TomlWriter {
 public:
  std::string text(const toml::table& root) {
    for (const toml::key* key : keys_of(root)) {
      if (!root.get(*key)->is_array_of_tables()) write_line(*key, *root.get(*key));
    }
    for (const toml::key* key : keys_of(root)) {
      if (!root.get(*key)->is_array_of_tables()) continue;
      for (const toml::node& item : *root.get(*key)->as_array()) {
        out_ << "\n[[" << key->str() << "]]\n";
        const toml::table& table = *item.as_table();
        for (const toml::key* inner : keys_of(table)) write_line(*inner, *table.get(*inner));
      }
    }
    return out_.str();
  }

 private:
  static std::vector<const toml::key*> keys_of(const toml::table& table) {
    std::vector<const toml::key*> keys;
    for (const auto& [key, node] : table) keys.push_back(&key);
    const auto place = [](const toml::key& key) {
      return key == "name" || key == "title" ? 0 : key == "run" || key == "static" ? 2 : 1;
    };
    std::stable_sort(keys.begin(), keys.end(), [&](auto* a, auto* b) { return place(*a) < place(*b); });
    return keys;
  }

  void write_line(const toml::key& key, const toml::node& node) {
    write_key(key.str());
    out_ << " = ";
    write(node);
    out_ << "\n";
  }

  void write_key(std::string_view key) {
    const auto is_bare = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    if (!key.empty() && std::all_of(key.begin(), key.end(), is_bare))
      out_ << key;
    else
      out_ << toml::value<std::string>(key);
  }

  void write(const toml::node& node) {
    std::string_view between;
    if (const toml::table* const table = node.as_table()) {
      out_ << "{ ";
      for (const auto& [key, inner] : *table) {
        out_ << std::exchange(between, ", ");
        write_key(key.str());
        out_ << " = ";
        write(inner);
      }
      out_ << " }";
    } else if (const toml::array* const list = node.as_array()) {
      out_ << "[";
      for (const toml::node& inner : *list) {
        out_ << std::exchange(between, ", ");
        write(inner);
      }
      out_ << "]";
    } else if (const auto* const number = node.as_floating_point()) {
      out_ << fmt::format("{}", number->get());
    } else {
      node.visit([&](const auto& value) { out_ << value; });
    }
  }

  std::ostringstream out_;
};

}  // namespace

struct ExperimentText::Tables {
  toml::table root;  // without runs and plan
  std::vector<toml::table> measured, measured_at_rest, templates;
  std::string kind = "run";  // of the templates: or "static"
  fs::path folder;
};

ExperimentText::ExperimentText(const Experiment& experiment, const ExperimentOptions& options)
    : limits_(experiment.plan.value()) {
  Tables tables;
  tables.root = parse_toml(read_text_file(experiment.file), experiment.file);
  tables.folder = fs::path(experiment.file).parent_path();
  for (const std::string& setting : options.settings) {
    const NamedNumber given = read_named_number("--set", setting, "PATH=NUMBER");
    put(tables.root, "set", given.name, given.value);
  }
  for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
    toml::table& sensor = *tables.root.get_as<toml::array>("sensor")->at(k).as_table();
    sensor.insert_or_assign("name", experiment.sensors[k].name);
  }
  const auto add_template = [&](toml::table run, const std::string& name, const std::string& kind) {
    name_sensors(run, name, experiment);
    run = bare(std::move(run), experiment);
    if (toml::table* const inputs = kind == "static" ? run.get_as<toml::table>("inputs") : nullptr) {
      for (auto&& [path, rows] : *inputs) rows.as_array()->resize(1, 0.0);
    }
    if (std::find(tables.templates.begin(), tables.templates.end(), run) != tables.templates.end()) return;
    tables.templates.push_back(std::move(run));
    tables.kind = kind;
    names_.push_back(name);
  };
  for_each_table(tables.root, "run", [&](toml::table run, const std::string& name) {
    if (run.contains("data")) {
      if (!options.data.empty()) run.insert_or_assign("data", fs::absolute(options.data).string());
      tables.measured.push_back(std::move(run));
    } else {
      add_template(std::move(run), name, "run");
    }
  });
  for_each_table(tables.root, "static", [&](toml::table run, const std::string& name) {
    if (run.contains("data") || run.contains("readings"))
      tables.measured_at_rest.push_back(std::move(run));
    else
      add_template(std::move(run), name, "static");
  });
  tables.root.erase("run");
  tables.root.erase("static");
  tables.root.erase("plan");
  const auto is_taken = [&](const Run& run) { return !run.is_simulated() && run.name.starts_with(prefix_); };
  while (std::any_of(experiment.runs.begin(), experiment.runs.end(), is_taken)) prefix_ = "newly " + prefix_;
  tables_ = std::make_unique<const Tables>(std::move(tables));
}

ExperimentText::~ExperimentText() = default;

double ExperimentText::duration(const PlannedRun& run) const {
  for (std::size_t c = 0; c < limits_.vary.size(); ++c) {
    if (limits_.vary[c].table.empty()) return run.values[c];
  }
  return tables_->templates[run.like]["duration"].value_or(0.0);
}

std::string ExperimentText::with(const std::vector<PlannedRun>& runs, bool measured, const fs::path& folder) const {
  toml::table root = tables_->root;
  const fs::path to = fs::absolute(folder / ".").lexically_normal();
  const auto moved = [&](const std::string& file) {
    const fs::path path(file);
    if (path.is_absolute()) return file;
    const fs::path from = fs::absolute(tables_->folder / path).lexically_normal();
    return from.lexically_proximate(to).generic_string();
  };
  const auto move_paths = [&](toml::table& owner, const char* key) {
    if (toml::array* const files = owner.get_as<toml::array>(key)) {
      for (toml::node& file : *files) file.as_string()->get() = moved(file.as_string()->get());
    } else if (auto* const file = owner.get_as<std::string>(key)) {
      file->get() = moved(file->get());
    }
  };
  const auto move_data = [&](toml::table& run) {
    move_paths(run, "data");
    toml::table* const inputs = run.get_as<toml::table>("inputs");
    if (inputs == nullptr) return;
    for (auto&& [name, input] : *inputs) {
      if (input.is_table()) move_paths(*input.as_table(), "file");
    }
  };
  move_paths(root, "scene");
  toml::array in_motion, at_rest;
  if (measured) {
    for (toml::table run : tables_->measured) {
      move_data(run);
      in_motion.push_back(std::move(run));
    }
    for (toml::table run : tables_->measured_at_rest) {
      move_data(run);
      at_rest.push_back(std::move(run));
    }
  }
  for (const PlannedRun& planned : runs) {
    toml::table run = tables_->templates[planned.like];
    move_data(run);
    const std::size_t number = static_cast<std::size_t>(&planned - runs.data()) + 1;
    run.insert_or_assign("name", name_of(number));
    run.insert_or_assign("seed", static_cast<std::int64_t>(number));
    for (std::size_t c = 0; c < limits_.vary.size(); ++c) {
      const PlanChoice& choice = limits_.vary[c];
      put(choice.common ? root : run, choice.table, choice.key, planned.values[c]);
    }
    (tables_->kind == "run" ? in_motion : at_rest).push_back(std::move(run));
  }
  toml::array all = in_motion;
  for (const toml::node& run : at_rest) all.push_back(*run.as_table());
  leave_out_unread(root, all);
  if (!in_motion.empty()) root.insert_or_assign("run", std::move(in_motion));
  if (!at_rest.empty()) root.insert_or_assign("static", std::move(at_rest));
  return TomlWriter().text(root);
}

}  // namespace poise
