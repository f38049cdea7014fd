#include "calib/terms/bases/polynomials.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Degree 1 to the highest by Bonnet's recursion.
BasisValues legendre(double x, int highest) {
  BasisValues functions;
  double before = 1.0;
  double here = x;
  for (int n = 1; n <= highest; ++n) {
    functions.push_back(here);
    const double order = n;
    const double next = ((2.0 * order + 1.0) * x * here - order * before) / (order + 1.0);
    before = here;
    here = next;
  }
  return functions;
}

}  // namespace

BasisValues Polynomials::values(const Argument& at) const {
  BasisValues functions = legendre(at.scaled(at.z), degree);
  if (at.dependence.covariate == vehicle::Covariate::time) return functions;
  const BasisValues at_rest = legendre(at.scaled(0.0), degree);
  for (std::size_t k = 0; k < functions.size(); ++k) functions[k] -= at_rest[k];
  return functions;
}

}  // namespace odomcalib::calib::terms
