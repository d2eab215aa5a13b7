#pragma once
/// Quantiles of distributions: the value below which a share `p` in (0, 1) of the probability lies.

namespace sandlot::statistics {

double normal_quantile(double p);
/// @param freedom  degrees of freedom, > 0
double students_t_quantile(double p, double freedom);
double chi_squared_quantile(double p, double freedom);

}  // namespace sandlot::statistics
