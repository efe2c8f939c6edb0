#include "app/results/cams.hpp"

namespace poise::app {

void add_cams(Group& group, const ScaledModel& model, const std::vector<CamReading>& cams,
              const std::vector<CamContact>& radii) {
  if (cams.empty()) return;
  const auto of = [&](double CamContact::*number) {
    return each(cams, [&](const CamReading& cam) -> std::optional<double> {
      return cam.contact ? std::optional<double>((*cam.contact).*number) : std::nullopt;
    });
  };
  Table& table = group.table("cams", "Contacts of cams", Rows::by_name);
  table.words("name", "cam", each(cams, &CamReading::name));
  const auto add = [&](const std::string& key, const std::string& title, Quantity quantity,
                       double CamContact::*number) {
    add_column(table, model, key, title, quantity, of(number), force_digits, widest(each(radii, number)));
  };
  add("pressure_angle", "pressure angle", Quantity::angle, &CamContact::pressure_angle);
  add("normal_force", "normal force", Quantity::force, &CamContact::normal);
  add("side_thrust", "side thrust", Quantity::force, &CamContact::side);
}

}  // namespace poise::app
