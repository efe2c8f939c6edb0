#pragma once

// Reads the controllers of a scene. Private to model/read_elements.cpp.

#include "model/read_measure.hpp"
#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// The element of a table [[controller]], of which nothing is read yet but the measure that it acts on, if any.
Element read_what_controller_acts_on(const TomlTable& table, const MeasureReader& measures);

/// Reads the rest of all controllers, when all elements of the scene have their names: what they read and follow, and
/// their numbers. Adds the bodies that are their states.
class ControllerReader {
 public:
  /// All must outlive this; `root` is the document.
  ControllerReader(const TomlTable& root, const MeasureReader& measures, Scene& scene)
      : root_(root), measures_(measures), scene_(scene) {}

  void read();

 private:
  struct One {
    int element;
    TomlTable table;
  };

  Element& element(const One& one) { return scene_.elements[static_cast<std::size_t>(one.element)]; }
  int other(const One& one, const TomlText& name) const;
  void read_sources(const One& one);
  void read_force(const TomlText& name, Feedback& feedback) const;
  void read_reaction(const TomlTable& reads, Feedback& feedback) const;
  void refuse_at_once(const One& one) const;
  void read_set_number(const One& one);
  void refuse_loops() const;
  void refuse_idle() const;
  void find_dimensions();
  void read_law(const One& one);
  void add_states(const One& one);

  const TomlTable& root_;
  const MeasureReader& measures_;
  Scene& scene_;
  std::vector<One> all_;
};

}  // namespace poise
