#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace supple::bench {

/// CPU time of the process in seconds, which other programs on the machine disturb less than wall time.
double cpu_seconds();
double wall_seconds();

/// CPU seconds that `action` takes.
template <typename Action>
double cpu_time(Action&& action) {
  const double start = cpu_seconds();
  std::forward<Action>(action)();
  return cpu_seconds() - start;
}

/// Middle value, or the mean of the two in the middle. Needs at least one value.
double median(std::vector<double> values);
double least(const std::vector<double>& values);
/// The least value that a fraction `q` of all values does not exceed (nearest rank).
double quantile(std::vector<double> values, double q);
double mean(const std::vector<double>& values);
double root_mean_square(const std::vector<double>& values);
/// The p of y = c x^p by least squares of the logarithms. Needs two positive pairs at least.
double fitted_exponent(const std::vector<double>& x, const std::vector<double>& y);

/// Resident memory of the process in bytes: now, and its maximum since the last reset_peak_memory().
std::int64_t resident_bytes();
std::int64_t peak_resident_bytes();
/// Returns freed memory to the system and starts the peak anew.
void reset_peak_memory();

/// Keeps the compiler from leaving out a computation whose result nobody reads.
inline void keep(const double& value) { asm volatile("" : : "m"(value) : "memory"); }

/// What a table of times must say about where it was measured: processor, threads, compiler, date and load average,
/// because elapsed times mean little on a machine that others use.
std::string machine_line();

}  // namespace supple::bench
