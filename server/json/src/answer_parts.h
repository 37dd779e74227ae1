#pragma once

#include "supple/json/answers.h"
#include "supple/json/json_writer.h"

// What several answers have in common.
namespace supple::json {

/// "effects" and "cost", which end every answer.
void write_bill(JsonWriter& out, const Bill& bill);

/// A matrix as the array of its rows.
template <class Matrix>
void write_rows(JsonWriter& out, const Matrix& matrix) {
  out.begin_array();
  for (decltype(matrix.rows()) i = 0; i < matrix.rows(); ++i) out.numbers(matrix.row(i).transpose().eval());
  out.end_array();
}

}  // namespace supple::json
