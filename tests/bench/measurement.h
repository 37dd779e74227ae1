#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace supple::bench {

/// CPU time of the process, in seconds: what other programs on the machine do counts less than in wall time.
double cpu_seconds();
double wall_seconds();

/// CPU seconds that `action` takes.
template <typename Action>
double cpu_time(Action&& action) {
  const double start = cpu_seconds();
  std::forward<Action>(action)();
  return cpu_seconds() - start;
}

/// Middle value (of an even number, the mean of the middle two). Needs at least one value.
double median(std::vector<double> values);
double least(const std::vector<double>& values);
/// The value that a fraction `q` of all values does not exceed (nearest rank).
double quantile(std::vector<double> values, double q);
double mean(const std::vector<double>& values);
double root_mean_square(const std::vector<double>& values);
/// The p of y = c x^p by least squares of the logarithms. Needs two positive pairs at least.
double fitted_exponent(const std::vector<double>& x, const std::vector<double>& y);

/// How much a curve of equal steps shakes: the median size of its steps and of its second differences and the largest
/// of these, over its median value; and how many steps go against the trend. Needs at least three values.
struct Shaking {
  double typical = 0;
  double second = 0;
  double second_largest = 0;
  int against = 0;
};
Shaking shaking_of(const std::vector<double>& values);

/// Resident memory of the process in bytes: now, and the most since the last reset_peak_memory().
std::int64_t resident_bytes();
std::int64_t peak_resident_bytes();
/// Returns freed memory to the system and starts the peak anew.
void reset_peak_memory();

/// Keeps the compiler from dropping a computation whose result nobody reads.
inline void keep(const double& value) { asm volatile("" : : "m"(value) : "memory"); }

/// "CPU model, n threads, compiler, build flags, date": what a table of times must say about where it was measured.
std::string machine_line();

}  // namespace supple::bench
