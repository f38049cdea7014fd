#include "calib/terms/parameter_meaning.hpp"

#include "calib/terms/catalogue.hpp"

namespace odomcalib::calib::terms {
namespace {

constexpr auto kMeaningAmong = [](const auto& catalogue, std::string_view effect,
                                  std::string_view parameter) -> const ParameterMeaning* {
  for (const auto& one : catalogue)
    for (const auto& own : one->parameters())
      if (one->name() == effect && own.name == parameter) return &own.meaning;
  return nullptr;
};

}  // namespace

const ParameterMeaning* meaning_of(std::string_view effect, std::string_view parameter) {
  const ParameterMeaning* of_wheels = kMeaningAmong(effect_catalogue(), effect, parameter);
  return of_wheels ? of_wheels : kMeaningAmong(lidar_catalogue(false), effect, parameter);
}

}  // namespace odomcalib::calib::terms
