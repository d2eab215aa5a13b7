#pragma once
/// Views of a Matrix for Eigen: arithmetic element by element, whose bits do not depend on the order of anything, and whole
/// matrices for programs that go on with Eigen. Without Eigen this header is empty.
#if __has_include(<Eigen/Core>)
#include <Eigen/Core>

#include "selforg/matrix.h"

namespace sandlot::selforg {

/// All elements in one column.
inline Eigen::Map<Eigen::ArrayXd> array(Matrix& m) {
  return {m.data.data(), static_cast<Eigen::Index>(m.data.size())};
}
inline Eigen::Map<const Eigen::ArrayXd> array(const Matrix& m) {
  return {m.data.data(), static_cast<Eigen::Index>(m.data.size())};
}
inline Eigen::Map<Eigen::ArrayXd> column(Matrix& m, std::size_t j) {
  return {m.data.data() + j * m.rows, static_cast<Eigen::Index>(m.rows)};
}
inline Eigen::Map<const Eigen::ArrayXd> column(const Matrix& m, std::size_t j) {
  return {m.data.data() + j * m.rows, static_cast<Eigen::Index>(m.rows)};
}
/// The matrix as Eigen's. Its products have an order of additions of their own.
inline Eigen::Map<Eigen::MatrixXd> eigen(Matrix& m) {
  return {m.data.data(), static_cast<Eigen::Index>(m.rows), static_cast<Eigen::Index>(m.cols)};
}
inline Eigen::Map<const Eigen::MatrixXd> eigen(const Matrix& m) {
  return {m.data.data(), static_cast<Eigen::Index>(m.rows), static_cast<Eigen::Index>(m.cols)};
}

}  // namespace sandlot::selforg
#endif
