#include "symbolic_analysis.h"

#include <cholmod.h>

#include <algorithm>
#include <new>
#include <span>

#include "supple/base/byte_codec.h"
#include "supple/base/process_random.h"
#include "supple/numerics/helper_tasks.h"

namespace supple::numerics {
namespace {

constexpr std::string_view analysis_task = "numerics/analysis";

/// Entries of a pattern whose analysis takes about a tenth of a second, so that sending it to a helper process pays.
constexpr Eigen::Index min_entries_for_helper = 500'000;

/// CHOLMOD's workspace and its analysis, which are released together.
class CholmodAnalysis {
 public:
  CholmodAnalysis(int n, const int* columns, const int* rows, std::vector<int> ordering, OrderingSearch search) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    if (!ordering.empty()) {
      common_.nmethods = 1;
      common_.method[0].ordering = CHOLMOD_GIVEN;
    } else if (search == OrderingSearch::thorough) {
      common_.nmethods = 2;
      common_.method[0].ordering = CHOLMOD_AMD;
      common_.method[1].ordering = CHOLMOD_METIS;
    }  // otherwise CHOLMOD's own strategy
    cholmod_sparse view{};
    view.nrow = view.ncol = static_cast<std::size_t>(n);
    view.nzmax = static_cast<std::size_t>(columns[n]);
    view.p = const_cast<int*>(columns);
    view.i = const_cast<int*>(rows);
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_PATTERN;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    if (ordering.empty()) {
      const auto random = lock_process_random();  // METIS draws from it
      factor_ = cholmod_analyze(&view, &common_);
    } else {
      factor_ = cholmod_analyze_p(&view, ordering.data(), nullptr, 0, &common_);
    }
  }
  ~CholmodAnalysis() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }
  CholmodAnalysis(const CholmodAnalysis&) = delete;
  CholmodAnalysis& operator=(const CholmodAnalysis&) = delete;

  const cholmod_factor& factor() const {
    if (!factor_) throw std::bad_alloc();
    return *factor_;
  }
  double entries() const { return common_.lnz; }

 private:
  cholmod_common common_{};
  cholmod_factor* factor_ = nullptr;
};

void write_integers(ByteWriter& writer, std::span<const int> values) {
  writer.text({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

std::vector<int> read_integers(ByteReader& reader) {
  const std::string bytes = reader.text();
  std::vector<int> values(bytes.size() / sizeof(int));
  std::copy_n(bytes.data(), values.size() * sizeof(int), reinterpret_cast<char*>(values.data()));
  return values;
}

std::string run_analysis_task(std::string_view request) {
  ByteReader reader(request);
  const std::vector<int> columns = read_integers(reader);
  const std::vector<int> rows = read_integers(reader);
  const std::vector<int> ordering = read_integers(reader);
  const auto search = static_cast<OrderingSearch>(reader.number<std::int32_t>());
  const SymbolicAnalysis analysis =
      analyse_here(static_cast<int>(columns.size()) - 1, columns.data(), rows.data(), ordering, search);
  ByteWriter answer;
  for (const auto* values : {&analysis.old_index, &analysis.first, &analysis.row_begin, &analysis.rows})
    write_integers(answer, *values);
  return answer.number(analysis.entries).take();
}

}  // namespace

SymbolicAnalysis analyse_here(int n, const int* columns, const int* rows, const std::vector<int>& ordering,
                              OrderingSearch search) {
  const CholmodAnalysis analysis(n, columns, rows, ordering, search);
  const cholmod_factor& l = analysis.factor();
  const auto list = [](const void* begin, std::size_t count) {
    const auto* const integers = static_cast<const int*>(begin);
    return std::vector<int>(integers, integers + count);
  };
  SymbolicAnalysis result;
  result.old_index = list(l.Perm, l.n);
  result.first = list(l.super, l.nsuper + 1);
  result.row_begin = list(l.pi, l.nsuper + 1);
  result.rows = list(l.s, static_cast<std::size_t>(result.row_begin.back()));
  result.entries = analysis.entries();
  return result;
}

SymbolicAnalysis analyse(const SparseMatrix& matrix, const std::vector<int>& ordering,
                         const CancellationToken& cancellation, OrderingSearch search) {
  cancellation.throw_if_requested();
  const auto n = static_cast<int>(matrix.rows());
  const auto helpers = matrix.nonZeros() >= min_entries_for_helper ? helper_processes() : nullptr;
  if (!helpers) return analyse_here(n, matrix.outerIndexPtr(), matrix.innerIndexPtr(), ordering, search);
  ByteWriter request;
  write_integers(request, {matrix.outerIndexPtr(), static_cast<std::size_t>(n) + 1});
  write_integers(request, {matrix.innerIndexPtr(), static_cast<std::size_t>(matrix.nonZeros())});
  write_integers(request, ordering);
  request.number(static_cast<std::int32_t>(search));
  Execution execution;
  execution.cancellation = cancellation;
  const std::string answer = helpers->run(analysis_task, request.take(), execution);
  ByteReader reader(answer);
  SymbolicAnalysis result;
  for (auto* values : {&result.old_index, &result.first, &result.row_begin, &result.rows})
    *values = read_integers(reader);
  result.entries = reader.number<double>();
  return result;
}

HelperTasks helper_tasks() {
  HelperTasks tasks;
  tasks.emplace(analysis_task, run_analysis_task);
  return tasks;
}

}  // namespace supple::numerics
