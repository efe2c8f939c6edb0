#include "model/set_parameter.hpp"

#include "model/named_number.hpp"

namespace poise {

void set_parameter(Scene& scene, const std::string& change) {
  const NamedNumber given = read_named_number("--set", change, "PATH=NUMBER, say load.P=40");
  try {
    set_value(scene, given.name, given.value);
  } catch (const InputError& e) {
    throw InputError(std::string("--set ") + e.what());
  }
}

}  // namespace poise
