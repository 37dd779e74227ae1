#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/numerics/objective.h"

namespace supple::numerics {

/// Second derivatives as they are added. The matrix is symmetric: an unordered pair of degrees of freedom is one place,
/// each entry is given once, and entries of the same place add up.
///
/// Terms add the same places in the same order at every state, or nearly so. The first assembly sorts them; later ones
/// recognize the sequence and add each value straight to its place. Places once seen stay in the pattern, so that
/// factorizations keep their symbolic analysis while contacts come and go.
class HessianEntries {
 public:
  /// Degrees of freedom from `border` on are few and couple with all others: they are kept as dense columns.
  explicit HessianEntries(Eigen::Index border = std::numeric_limits<std::int32_t>::max());

  void add(Eigen::Index i, Eigen::Index j, double value) {
    const auto [low, high] = i < j ? std::pair(i, j) : std::pair(j, i);
    if (high >= border_) {
      require_border(high);
      border_columns_(low, high - border_) += value;
      return;
    }
    const Place place = static_cast<Place>(low) << 32 | static_cast<Place>(high);
    if (cursor_ < sequence_.size() && sequence_[cursor_] == place) {
      values_[slots_[cursor_++]] += value;
    } else {
      add_unexpected(place, value);
    }
  }

  /// An element's matrix at once: `rows` are its degrees of freedom, all below the border, and lower[k (k + 1) / 2 + l]
  /// is the entry of rows[k] and rows[l], l <= k. The same as adding these one by one, several times as fast.
  static constexpr std::size_t block_size = 12;
  using Block = std::array<std::int32_t, block_size>;
  static constexpr std::size_t block_entries = block_size * (block_size + 1) / 2;
  void add_block(const Block& rows, const double* lower);

  /// The entries of `row` and first, first + 1, ..., all greater than `row`; fast where `first` is the border's first.
  template <int count>
  void add_row(Eigen::Index row, Eigen::Index first, const double* values) {
    if (first == border_) {
      require_border(border_ + count - 1);
      for (int k = 0; k < count; ++k) border_columns_(row, k) += values[k];
    } else {
      for (int k = 0; k < count; ++k) add(row, first + k, values[k]);
    }
  }

  /// Zeroes the values and begins again at the start of the sequence.
  void clear();

  /// The n x n matrix, both triangles filled; without a border.
  SparseMatrix matrix(Eigen::Index n);

  /// The same matrix in parts, for n degrees of freedom of which the last n - border are the border's.
  void assemble(Eigen::Index n, BorderedMatrix& into);

 private:
  using Place = std::uint64_t;  ///< column << 32 | row of the lower triangle: sorting gives compressed columns

  void add_unexpected(Place place, double value);
  void require_border(Eigen::Index high) {
    if (high >= border_columns_.rows() || high - border_ >= border_columns_.cols()) grow_border(high);
  }
  void grow_border(Eigen::Index high);
  void learn();
  void add_to_pattern();
  SparseMatrix lower(Eigen::Index n) const;

  Eigen::Index border_;
  std::vector<Place> sequence_;       ///< places in the order in which they were added last
  std::vector<std::uint32_t> slots_;  ///< for each of them the index into values_
  std::size_t cursor_ = 0;
  std::vector<Place> pattern_;  ///< sorted, without repetition
  std::vector<double> values_;  ///< one for each place of the pattern
  bool diverged_ = false;       ///< this time the sequence is another from cursor_ on
  std::vector<std::pair<Place, double>> unexpected_;
  std::vector<std::pair<std::size_t, Block>> blocks_;  ///< those of the sequence, each after where it begins
  std::size_t next_block_ = 0;
  /// Row: any degree of freedom; column: one of the border's.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> border_columns_;
};

/// The running sum that energies add themselves to.
struct EnergySum {
  double value = 0;
  Eigen::VectorXd gradient{};  ///< one entry per degree of freedom; empty for order 0
  HessianEntries hessian{};    ///< unused below order 2
};

/// One term of a scene's energy: an elastic element group, a contact, a spring, a pressure.
///
/// A term reads the scene's degrees of freedom x (it knows which are its own) and adds its share to the sum. It holds
/// no state that depends on x, so a scene may evaluate it from several threads. Adding physics means adding one class
/// like this; no solver changes.
class Energy {
 public:
  virtual ~Energy() = default;

  /// A stable name for the bill and for error messages, e.g. "neo_hookean".
  virtual std::string_view name() const = 0;

  /// Adds the value (order 0), the gradient (1) and the Hessian (2) at x. An infinite value marks x as invalid.
  virtual void add(const Eigen::VectorXd& x, int order, EnergySum& sum) const = 0;

  /// The largest t > 0 for which x + t * step is valid for this term; infinity where every step is.
  virtual double largest_step(const Eigen::VectorXd& /*x*/, const Eigen::VectorXd& /*step*/) const {
    return std::numeric_limits<double>::infinity();
  }
};

}  // namespace supple::numerics
